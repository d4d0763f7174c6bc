"""A motion drives characters with other names, another rest pose and other proportions."""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import figures
import gmr
from gmr import Character, FormatError, FormatWarning, GmrError, Motion, SkeletonError
from gmr.demo import demo_folder
from gmr.editing import contacts
from gmr.quaternions import IDENTITY, about, conjugate, matrices, multiply, rotated
from gmr.skeleton import Skeleton
from gmr.skinning import drive
from gmr.skinning.driving.body_parts import find_body
from restless import without_rest

Floats = NDArray[np.float64]

DATA = Path(__file__).parent / "data"
CESIUM_MAN = Path(os.environ.get("GMR_DATA", "/nowhere")) / "gltf" / "cesium_man.gltf"
WALK = gmr.read(demo_folder() / "07_01.bvh")
SHORT = WALK[1:60:6]
"""Of the recording; frame 0 is a T-pose."""
CMU = 0.0254 / 0.45
LIMBS = {
    "UpperArm": ("LowerArm", "Arm", "ForeArm"),
    "LowerArm": ("Hand", "ForeArm", "Hand"),
    "UpperLeg": ("LowerLeg", "UpLeg", "Leg"),
    "LowerLeg": ("Foot", "Leg", "Foot"),
}
"""Where a bone of the figure begins -> where it ends; the same in CMU's names."""
seeds = st.integers(0, 2**32)


def own_character(motion: Motion, seed: int = 0) -> Character:
    """A character that has a motion's own skeleton, in metres, its joints turned otherwise."""
    skeleton = motion.skeleton
    kept = [joint for joint in skeleton.parents_first if not skeleton.ends[joint]]
    places = np.zeros((skeleton.joint_count, 3))
    for joint in kept:
        above = skeleton.parents[joint]
        places[joint] = (places[above] if above >= 0 else 0) + skeleton.offsets[joint] * CMU
    parents = [
        kept.index(int(skeleton.parents[joint])) if skeleton.parents[joint] >= 0 else -1 for joint in kept
    ]
    return figures.character([skeleton.names[joint] for joint in kept], parents, places[kept], seed)


def places_of(poses: Floats, character: Character, *names: str) -> Floats:
    """(F, K, 3)"""
    return poses[..., :3, 3][:, [character.joint_names.index(name) for name in names]]


def directions(one: Floats, other: Floats) -> Floats:
    way = other - one
    return np.asarray(way / np.linalg.norm(way, axis=-1, keepdims=True), np.float64)


def renamed(motion: Motion, names: list[str]) -> Motion:
    return replace(motion, skeleton=replace(motion.skeleton, names=tuple(names)))


@given(seeds)
@settings(max_examples=5)
def test_a_motion_that_drives_its_own_skeleton_is_itself(seed: int) -> None:
    character = own_character(WALK, seed)
    driven = drive(WALK[1:30], character, ground=False)
    joints = list(character.joint_names)
    assert np.allclose(
        driven.poses[..., :3, 3],
        WALK[1:30].positions(joints=joints, dtype=np.float64) * CMU,
        rtol=0,
        atol=1e-12,
    )
    turned = matrices(WALK[1:30].joint_rotations(dtype=np.float64)[:, WALK.skeleton.indices(joints)])
    rest = character.rest_pose()[:, :3, :3]
    assert np.allclose(driven.poses[..., :3, :3], turned @ rest, rtol=0, atol=1e-12)
    assert driven.report.scale == pytest.approx(1)
    assert not driven.report.unmatched_character


def test_the_rest_pose_drives_the_rest_pose() -> None:
    unturned = np.tile(IDENTITY, (*SHORT.rotations.shape[:2], 1))
    still = replace(SHORT, source=replace(SHORT.pose, rotations=unturned, rows=None))
    character = own_character(WALK)
    driven = drive(still, character, ground=False)
    poses = driven.poses - np.pad(
        (driven.poses[:, :1, :3, 3] - character.rest_pose()[0, :3, 3])[..., None],
        [(0, 0), (0, 0), (0, 1), (3, 0)],
    )
    assert np.allclose(poses, character.rest_pose(), rtol=0, atol=1e-12)


@given(seeds)
@settings(max_examples=12)
def test_bones_point_as_in_the_motion_from_any_rest_pose(seed: int) -> None:
    rng = np.random.default_rng(seed)
    joints = [f"{side}{bone}" for side in ("Left", "Right") for bone in LIMBS]
    bend = {joint: figures.turned_at_random(rng, 1.0 if "Arm" in joint else 0.4) for joint in joints}
    character = figures.body(seed, bend=bend, facing=rng.uniform(-3, 3), size=rng.uniform(0.3, 3))
    driven = drive(SHORT, character, ground=False)
    for side in ("Left", "Right"):
        for bone, (end, source, source_end) in LIMBS.items():
            mine = places_of(driven.poses, character, side + bone, side + end)
            theirs = SHORT.positions(joints=[side + source, side + source_end], dtype=np.float64)
            apart = directions(mine[:, 0], mine[:, 1]) - directions(theirs[:, 0], theirs[:, 1])
            assert np.abs(apart).max() < 1e-9, side + bone


@given(seeds)
@settings(max_examples=12)
def test_joints_that_follow_nothing_keep_their_rest_pose_relative_to_their_parents(seed: int) -> None:
    character = figures.body(seed)
    driven = drive(SHORT, character)
    assert driven.report.unmatched_character == ("Tail",)
    assert set(driven.report.unmatched_motion) >= {"LHipJoint", "LThumb", "Spine"}
    hips, tail = character.joint_names.index("Hips"), character.joint_names.index("Tail")
    rest = character.rest_pose()
    now = np.linalg.inv(driven.poses[:, hips]) @ driven.poses[:, tail]
    assert np.allclose(now, np.linalg.inv(rest[hips]) @ rest[tail], atol=1e-12)


def test_bones_keep_their_lengths() -> None:
    character = figures.body()
    driven = drive(SHORT, character)
    held = np.flatnonzero(character.joint_parents >= 0)
    places, rest = driven.poses[..., :3, 3], character.rest_pose()[:, :3, 3]
    now = np.linalg.norm(places[:, held] - places[:, character.joint_parents[held]], axis=2)
    assert np.allclose(
        now, np.linalg.norm(rest[held] - rest[character.joint_parents[held]], axis=1), atol=1e-12
    )


@given(seeds)
@settings(max_examples=5)
def test_renaming_the_motion_with_a_map_changes_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    character = figures.body()
    driven = drive(SHORT, character)
    strange = [f"j{k}" for k in rng.permutation(SHORT.skeleton.joint_count)]
    names = {mine: strange[SHORT.skeleton.index(theirs)] for mine, theirs in driven.report.follows.items()}
    again = drive(renamed(SHORT, strange), character, names={**names, "Tail": ""})
    assert np.allclose(again.poses, driven.poses, rtol=0, atol=1e-9)
    assert again.report.feet == driven.report.feet


@given(seeds)
@settings(max_examples=5)
def test_a_body_whose_names_say_nothing_is_told_by_its_shape(seed: int) -> None:
    order = np.random.default_rng(seed).permutation(100)
    rename = {name: f"node_{order[k]}" for k, name in enumerate(figures.BODY)}
    named, strange = figures.body(seed), figures.body(seed, rename=rename)
    one, other = drive(SHORT, named), drive(SHORT, strange)
    assert "shape" in other.report.matched_by
    assert other.report.follows == {rename[name]: bone for name, bone in one.report.follows.items()}
    assert np.allclose(one.poses, other.poses, rtol=0, atol=1e-12)


def test_a_turned_world_and_another_unit_change_nothing() -> None:
    character = figures.body()
    driven = drive(SHORT, character)
    turn = about(np.array([1.0, 0, 0]), np.array(np.pi / 2))  # +Y becomes +Z
    rotations = multiply(turn, multiply(SHORT.rotations, conjugate(turn)))
    skeleton = replace(SHORT.skeleton, offsets=rotated(turn, SHORT.skeleton.offsets))
    lying = Motion.from_pose(skeleton, rotations, rotated(turn, SHORT.translations), SHORT.frame_time)
    other = drive(lying, character)
    assert other.report.up == "+Z"
    assert np.allclose(other.poses, driven.poses, rtol=0, atol=1e-9)
    metres = drive(SHORT.with_unit("cmu").to_unit("m"), character)
    assert np.allclose(metres.poses, driven.poses, rtol=0, atol=1e-9)


def test_asf_and_bvh_of_one_take_drive_the_same() -> None:
    acclaim, bvh = gmr.read(DATA / "amc" / "07_01.amc"), WALK
    count = min(acclaim.frame_count, bvh.frame_count - 1)
    character = figures.body()
    one = drive(acclaim[:count], character)
    other = drive(bvh[1 : count + 1], character)
    assert one.report.follows["LeftUpperLeg"] == "lfemur"
    limbs = [f"{side}{bone}" for side in ("Left", "Right") for bone in (*LIMBS, "Foot", "Hand")]
    apart = places_of(one.poses, character, *limbs) - places_of(other.poses, character, *limbs)
    assert (
        np.abs(apart[:, [k for k, name in enumerate(limbs) if "Leg" in name or "Foot" in name]]).max() < 1e-3
    )
    joints = [character.joint_names.index(name) for name in limbs]
    turns = [figures.joint_turns(driven.poses)[:, joints] for driven in (one, other)]
    assert np.degrees(2 * np.arccos(np.minimum(np.abs((turns[0] * turns[1]).sum(axis=-1)), 1))).max() < 1.0


@pytest.mark.parametrize("seed", range(4))
def test_a_motion_without_a_rest_pose_is_driven_from_a_frame(seed: int) -> None:
    motion = without_rest(SHORT, seed)
    assert np.allclose(motion.positions(dtype=np.float64), SHORT.positions(dtype=np.float64), atol=1e-9)
    character = figures.body()
    with pytest.raises(GmrError, match=r"no rest pose.*rest=0 in Python, gmr skin --rest 0$"):
        drive(motion, character)
    one, other = drive(motion, character, rest=3), drive(SHORT, character, rest=3)
    assert "frame 3" in one.report.rest
    assert np.allclose(one.poses, other.poses, rtol=0, atol=1e-7)
    with pytest.raises(GmrError, match="frames 0 to 9"):
        drive(motion, character, rest=10)


def contact_heights(motion: Motion, character: Character, poses: Floats) -> dict[str, Floats]:
    """Heights of the lowest vertex of each foot, as it is skinned, in the motion's contacts."""
    held = contacts(motion)
    found = {}
    for k, side in enumerate(("Left", "Right")):
        foot = character.joint_names.index(f"{side}Foot")
        own = (character.merged.joints[:, 0] == foot) | (character.merged.joints[:, 0] == foot + 1)
        found[side] = character.skin(poses[held.mask[:, k]])[:, own, 1].min(axis=1).astype(np.float64)
    return found


@pytest.mark.parametrize(("size", "take"), [(1.0, "07_01"), (0.4, "07_01"), (2.5, "09_01"), (1.0, "02_01")])
def test_feet_stand_on_the_ground_and_slide_no_more_than_the_motion(size: float, take: str) -> None:
    motion = gmr.read(demo_folder() / f"{take}.bvh")[1:]
    character = figures.body(size=size)
    driven = drive(motion, character)
    soles = character.skin(character.rest_pose())[..., 1].min()
    for side, heights in contact_heights(motion, character, driven.poses).items():
        assert np.abs(heights - soles).max() < 0.003, side
    for foot, before in zip(driven.report.feet, driven.report.feet_before, strict=True):
        assert foot.contacts > 0
        assert foot.height_mm < 2
        assert foot.height_mm <= before.height_mm
        assert foot.lowest_mm > -2
        assert foot.slide_mm < foot.source_slide_mm + 2 * size


@pytest.mark.parametrize("facing", [0.0, 2.0])
def test_left_is_left_and_knees_bend_forward(facing: float) -> None:
    character = figures.body(facing=facing)
    driven = drive(WALK, character)
    scale = driven.report.scale
    assert scale is not None
    assert driven.report.left_out == 1
    theirs = WALK[1:].positions(joints=["LeftFoot", "RightFoot"], dtype=np.float64) * CMU * scale
    mine = places_of(driven.poses, character, "LeftFoot", "RightFoot")
    assert np.linalg.norm((mine - theirs)[..., [0, 2]], axis=2).max() < 0.1
    assert np.linalg.norm(mine[:, 0] - theirs[:, 1], axis=1).max() > 0.5
    hips = places_of(driven.poses, character, "LeftUpperLeg", "RightUpperLeg")
    left = directions(hips[:, 1], hips[:, 0])
    for side in ("Left", "Right"):
        hip, knee, ankle = np.moveaxis(
            places_of(driven.poses, character, *(side + n for n in ("UpperLeg", "LowerLeg", "Foot"))), 1, 0
        )
        bend = np.cross(directions(hip, knee), directions(knee, ankle))
        assert ((bend * left).sum(axis=1) > -0.02).all()
        assert ((bend * left).sum(axis=1) > 0.5).any()


def test_a_leg_as_a_whole_is_as_long_as_the_hips_are_high() -> None:
    character = figures.body()
    driven = drive(WALK, character)
    hips = places_of(driven.poses, character, "LeftUpperLeg", "RightUpperLeg")[..., 1].mean(axis=1)
    standing = character.rest_pose()[character.joint_names.index("LeftUpperLeg"), 1, 3]
    assert 0.9 * standing < np.median(hips) < 1.02 * standing


def test_frames_a_second() -> None:
    driven = drive(WALK, figures.body(), fps=30)
    assert driven.frame_time == pytest.approx(1 / 30)
    assert len(driven.poses) == WALK[1:].resample(30).frame_count


def test_the_scale_can_be_stated() -> None:
    character = figures.body()
    one, other = drive(SHORT, character, ground=False), drive(SHORT, character, root_scale=2.0, ground=False)
    assert other.report.scale == pytest.approx(2)
    hips = ("LeftUpperLeg", "RightUpperLeg")
    ways = [places_of(d.poses, character, *hips).mean(axis=1) for d in (one, other)]
    assert one.report.scale is not None
    assert np.allclose(ways[1], ways[0] * 2 / one.report.scale)
    with pytest.raises(GmrError, match="root_scale=0"):
        drive(SHORT, character, root_scale=0.0)


def test_nothing_matched_names_both_sides_and_what_is_near() -> None:
    rod = figures.character(["Hip", "tip"], [-1, 0], np.array([[0.0, 0, 0], [0, 1, 0]]))
    with pytest.raises(SkeletonError) as caught:
        drive(SHORT, rod)
    said = str(caught.value)
    for part in ("'Hip', 'tip'", "'Hips', 'LHipJoint'", "'Hip': 'Hips'", "names={", "--map FILE"):
        assert part in said


def test_a_stated_joint_is_enough() -> None:
    rod = figures.character(["Hip", "tip"], [-1, 0], np.array([[0.0, 0, 0], [0, 1, 0]]))
    driven = drive(SHORT, rod, names={"Hip": "Hips"})
    assert driven.report.follows == {"Hip": "Hips"}
    assert driven.report.unmatched_character == ("tip",)
    assert np.allclose(
        driven.poses[:, 0, :3, 3], SHORT.positions(joints=["Hips"], dtype=np.float64)[:, 0] * CMU
    )
    assert "no legs" in str(driven.report)


@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_a_map_is_read_from_a_file(tmp_path: Path, suffix: str) -> None:
    character = figures.body(rename={"Head": "noggin"})
    file = tmp_path / f"names{suffix}"
    table = {"follows": {"Tail": "LThumb"}, "character": {"head": "noggin"}, "motion": {"head": "Neck1"}}
    text = "\n".join(
        f"[{name}]\n" + "\n".join(f'{a} = "{b}"' for a, b in rows.items()) for name, rows in table.items()
    )
    file.write_text(text if suffix == ".toml" else json.dumps(table))
    follows = drive(SHORT, character, names=file).report.follows
    assert (follows["noggin"], follows["Tail"]) == ("Neck1", "LThumb")
    assert drive(SHORT, character, names=table).report.follows == follows


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[", "TOML, or JSON"),
        ("[who]\na = 'b'", "no table 'who'"),
        ("a = 3", "'a' is 3"),
        ("[follows]\na = [1]", "'a' is"),
    ],
)
def test_a_map_that_is_none_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "names.toml").write_text(text)
    with pytest.raises(FormatError, match=said):
        drive(SHORT, figures.body(), names=tmp_path / "names.toml")
    with pytest.raises(FormatError, match="cannot be read"):
        drive(SHORT, figures.body(), names=tmp_path / "none.toml")


def test_a_map_with_joints_that_are_not_there_is_refused() -> None:
    with pytest.raises(SkeletonError, match="no joint 'Hed'; did you mean 'Head'"):
        drive(SHORT, figures.body(), names={"Hed": "Head"})
    with pytest.raises(SkeletonError, match="no joint 'Hed'; did you mean 'Head'"):
        drive(SHORT, figures.body(), names={"Head": "Hed"})


def test_poses_that_are_not_known_are_refused() -> None:
    pose = SHORT.pose
    translations = pose.translations.copy()
    translations[4] = np.nan
    holed = Motion.from_pose(
        SHORT.skeleton, pose.rotations, translations, SHORT.frame_time, translated=pose.translated
    )
    with pytest.raises(GmrError, match="not known, first in frame 4"):
        drive(holed, figures.body())
    with pytest.raises(GmrError, match="no frames"):
        drive(SHORT[:0], figures.body())


def test_one_frame_is_set_on_the_ground() -> None:
    character = figures.body()
    driven = drive(SHORT[:1], character)
    assert character.skin(driven.poses)[..., 1].min() == pytest.approx(0, abs=2e-3)


def test_shipped_namings_tell_bodies() -> None:
    skeletons = {
        "Mixamo": "mixamorig:Hips mixamorig:%UpLeg mixamorig:%Foot mixamorig:%ToeBase mixamorig:%HandRing1",
        "Bandai-Namco": "Hips Spine Chest UpperLeg_% LowerLeg_% Foot_% Toes_% UpperArm_% LowerArm_%",
        "Unreal": "pelvis spine_01 spine_02 thigh_% calf_% foot_% ball_% upperarm_%",
        "Biped": "Bip01_Pelvis Bip01_Spine Bip01_%_Thigh Bip01_%_Calf Bip01_%_Foot Bip01_%_UpperArm",
        "Poser": "hip abdomen chest %Thigh %Shin %Foot %Shldr",
        "ASF": "root lowerback thorax %femur %tibia %foot %radius",
        "Biovision": "Hips Chest %Collar %Shoulder %Elbow %Hip %Knee %Ankle",
        "Xsens": "Pelvis L5 T8 %UpperLeg %LowerLeg %Foot %UpperArm",
        "LaFAN1": "Hips Spine Spine1 Spine2 %UpLeg %Leg %Foot %Toe %Shoulder %Arm",
        "CMU BVH": "Hips LowerBack Spine Spine1 %UpLeg %Leg %Foot %ToeBase",
    }
    sides = {"Bandai-Namco": "LR", "Unreal": "lr", "Biped": "LR", "Poser": "lr", "ASF": "lr"}
    for title, pattern in skeletons.items():
        words = pattern.split()
        called = sides.get(title, ("Left", "Right"))
        names = [word.replace("%", side) for word in words for side in (called if "%" in word else ("",))]
        skeleton = Skeleton.post_rotation(names, [-1, *[0] * (len(names) - 1)], np.zeros((len(names), 3)))
        body = find_body(skeleton, np.zeros((len(names), 3)))
        assert body is not None
        assert body.found_by == title
        known = {joint for joints in body.parts.values() for joint in joints}
        assert [name for k, name in enumerate(names) if k not in known] == []


def cesium_man() -> Character:
    if not CESIUM_MAN.exists():
        pytest.skip("needs GMR_DATA")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        return gmr.read_character(CESIUM_MAN)


@pytest.mark.parametrize(
    "file", [demo_folder() / "07_01.bvh", DATA / "amc" / "07_01.amc"], ids=["bvh", "amc"]
)
def test_cesium_man_walks(file: Path) -> None:
    character = cesium_man()
    motion = gmr.read(file)
    driven = drive(motion, character)
    body = find_body(character.skeleton, character.rest_pose()[:, :3, 3])
    assert body is not None
    at = {part: driven.poses[:, joints[0], :3, 3] for part, joints in body.parts.items()}
    assert not driven.report.unmatched_character
    left = directions(at["right_up_leg"], at["left_up_leg"])
    for side in ("left", "right"):
        assert (at[f"{side}_forearm"] - at[f"{side}_arm"])[:, 1].max() < -0.15  # of 0.24 m: the arms hang
        bend = np.cross(at[f"{side}_leg"] - at[f"{side}_up_leg"], at[f"{side}_foot"] - at[f"{side}_leg"])
        assert ((bend * left).sum(axis=1) > -1e-3).all()  # knees bend forward
    forward = np.cross(left, [0, 1, 0])
    way = at["hips"][-1] - at["hips"][0]
    assert way @ forward.mean(axis=0) > 0.9 * np.linalg.norm(way)
    vertices = character.skin(driven.poses)
    assert vertices[..., 1].min() > -0.005
    for foot in driven.report.feet:
        assert foot.height_mm < 1
        assert foot.slide_mm < foot.source_slide_mm + 1


def test_a_fox_is_no_man() -> None:
    fox = CESIUM_MAN.with_name("fox.glb")
    if not fox.exists():
        pytest.skip("needs GMR_DATA")
    character = gmr.read_character(fox)
    with pytest.raises(SkeletonError, match="tell the body of the character"):
        drive(WALK, character)
    partly = drive(WALK, character, names={"b_Neck_04": "Neck", "b_Hip_01": "Hips"})
    assert len(partly.report.unmatched_character) == len(character.joints) - 2
    own = drive(gmr.read(fox, animation="Survey"), character)
    assert np.allclose(own.poses, character.animation(), atol=1e-6 * np.abs(own.poses).max())
