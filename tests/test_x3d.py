"""A motion as a humanoid of H-Anim: every joint where the motion has it, whatever browser plays the file."""

from __future__ import annotations

import os
import warnings
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gmr
import walkers
import x3d_model
import x3d_schema
from gmr import FormatError, FormatWarning, GmrError, Motion, Skeleton, SkeletonError
from gmr.body.measures import UP_TURNS, turned_upright
from gmr.demo import demo_folder
from gmr.formats import motion_files
from gmr.formats.hanim import LOA_1, NECK, SPINE, articulations
from gmr.formats.x3d import write_x3d, x3d_chunks
from gmr.formats.x3d_figure import Figure, figure_of
from gmr.formats.x3d_humanoid import humanoid_of
from gmr.formats.x3d_parts import levels
from gmr.quaternions import conjugate, multiply, rotated
from gmr.skinning.driving.parts import parts_by_name
from x3d_player import Player

DATA = Path(__file__).parent / "data"
GMR_DATA = Path(os.environ.get("GMR_DATA", "/nowhere"))
LAW = 1e-4
"""Of the stature."""

SHIPPED = [
    DATA / "cmu_07_01.bvh",
    DATA / "cmu_10_03.bvh",
    DATA / "cmu_12_01.bvh",
    DATA / "amc" / "07_01.amc",
    *(demo_folder() / f"{take}.bvh" for take in ("02_01", "08_01", "09_01", "09_12")),
]
LARGE = [
    "cmu_bvh/01_01.bvh",
    "cmu_bvh/131_01.bvh",
    "cmu_asf_amc/02_01.amc",
    "cmu_asf_amc/35_01.amc",
    "bvh_exporters/freebvh.bvh",
    "bvh_exporters/pybvh_bvh_test3.bvh",
    "bvh_exporters/mocapbank.bvh",
    "locomotion/bandai_namco/dataset-1_walk_normal_001.bvh",
]
QUAD = ["Hips", "Spine", "Head", "LeftLeg"]


def quietly(motion: Motion, **options: Any) -> bytes:
    """The file, without a word about units."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        return b"".join(x3d_chunks(motion, **options))


def faults(data: bytes) -> list[str]:
    """What the schema and the object model of X3D have against a file."""
    return [*x3d_schema.faults(data), *x3d_model.faults(data)]


def figure(motion: Motion) -> Figure:
    return figure_of(humanoid_of(motion, None, None))


def assert_the_law_holds(motion: Motion, data: bytes, frames: int = 9) -> None:
    """Joints of the humanoid are where those of the motion are, at keys and, root and all, in order."""
    known = figure(motion)
    player = Player.of(data)
    last = motion.frame_count - 1
    for frame in sorted({round(k * last / frames) for k in range(frames + 1)}):
        true = known.body.motion[frame : frame + 1].positions(dtype=np.float64)[0]
        places = turned_upright(true * known.body.metres, known.body.scene.up)
        found = player.places(frame / max(last, 1))
        for name, stand in known.body.stands.items():
            apart = float(np.linalg.norm(found[name] - places[stand.joint]))
            assert apart < LAW * known.stature, f"{name} in frame {frame}: {apart:.6f} m"


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_joints_are_where_the_motion_has_them(path: Path) -> None:
    motion = gmr.read(path)
    data = quietly(motion)
    assert_the_law_holds(motion, data)
    assert faults(data) == []


@pytest.mark.parametrize("name", LARGE)
def test_joints_of_large_files_are_where_the_motion_has_them(name: str) -> None:
    if not (GMR_DATA / name).exists():
        pytest.skip("needs GMR_DATA")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        motion = gmr.read(GMR_DATA / name)
    data = quietly(motion)
    assert_the_law_holds(motion, data)
    assert faults(data) == []


def turned(rng: np.random.Generator, shape: tuple[int, ...]) -> Any:
    found = rng.normal(size=(*shape, 4))
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


@given(st.integers(0, 2**32), st.integers(1, 5), st.sampled_from(["m", "cm", "in"]))
@settings(max_examples=25)
def test_the_law_holds_however_joints_turn(seed: int, frames: int, unit: str) -> None:
    rng = np.random.default_rng(seed)
    skeleton = walkers.body(scale=1 / gmr.units.UNITS[unit])
    motion = Motion.from_pose(
        skeleton,
        turned(rng, (frames, skeleton.slot_count)),
        rng.normal(size=(frames, 1, 3)) / gmr.units.UNITS[unit],
        1 / 60,
        unit=gmr.units.UNITS[unit],
    )
    data = quietly(motion)
    assert_the_law_holds(motion, data)
    assert faults(data) == []


def walk() -> Motion:
    return gmr.read(DATA / "cmu_07_01.bvh").with_unit("cmu")


@pytest.mark.parametrize("up", [axis for axis in UP_TURNS if axis != "+Y"])
def test_any_axis_may_point_up(up: str) -> None:
    upright = walk()
    turn = conjugate(np.array(UP_TURNS[up]))
    (root,) = upright.skeleton.roots
    rotations = upright.rotations.copy()
    own = int(upright.skeleton.slots[upright.skeleton.children[root][0]])
    rotations[:, own] = multiply(turn, rotations[:, own])
    tipped = Motion.from_pose(
        upright.skeleton,
        rotations,
        rotated(turn, upright.translations),
        upright.frame_time,
        unit=upright.unit,
    )
    assert humanoid_of(tipped, None, None).scene.up == up
    one, other = Player.of(quietly(upright)), Player.of(quietly(tipped))
    for fraction in (0.0, 0.5, 1.0):
        for name, place in one.places(fraction).items():
            np.testing.assert_allclose(other.places(fraction)[name], place, rtol=0, atol=1e-4)


def test_roots_elsewhere_change_nothing() -> None:
    motion = walk()
    assert quietly(motion.with_roots(["Neck", "LeftArm"])) == quietly(motion)


def test_bones_that_change_their_length_are_followed() -> None:
    motion = walk()[10:20]
    arm = motion.skeleton.index("LeftArm")
    translated = np.append(motion.translated, arm)
    rng = np.random.default_rng(3)
    moves = motion.skeleton.offsets[arm] * rng.uniform(0.8, 1.2, (len(motion), 1, 1))
    stretched = Motion.from_pose(
        motion.skeleton,
        motion.rotations,
        np.concatenate([motion.translations, moves], axis=1),
        motion.frame_time,
        translated=translated,
        unit=motion.unit,
    )
    assert figure(stretched).moving == {"humanoid_root", "l_shoulder"}
    assert_the_law_holds(stretched, quietly(stretched))


def test_between_keys_it_is_the_motion_at_a_higher_rate() -> None:
    motion = walk()[1::2]
    fine = motion.resample(2 * motion.fps)
    player, known = Player.of(quietly(motion)), figure(motion)
    for frame in (1, 2, 21, 41, 55):
        found = player.places(frame / 2 / (len(motion) - 1))
        true = fine[frame : frame + 1].positions(dtype=np.float64)[0] * known.body.metres
        for name, stand in known.body.stands.items():
            np.testing.assert_allclose(found[name], true[stand.joint], atol=LAW)


def test_it_lasts_as_long_as_the_motion() -> None:
    motion = walk()
    (clock,) = Player.of(quietly(motion)).root.iter("TimeSensor")
    assert float(clock.attrib["cycleInterval"]) == pytest.approx(
        (len(motion) - 1) * motion.frame_time, abs=1e-6
    )
    assert clock.attrib["loop"] == "true"


def test_every_joint_of_the_first_level_is_there_under_its_own_name() -> None:
    for motion in (walk(), walkers.walker()):
        player = Player.of(quietly(motion))
        names = [joint.attrib["name"] for joint in player.joints]
        assert len(set(names)) == len(names)
        assert set(names) >= LOA_1
        assert set(names) <= set(x3d_model.model.HANIMJOINTNAMEVALUES)
        segments = [
            node.attrib["name"] for node in player.humanoid.iter("HAnimSegment") if "name" in node.attrib
        ]
        assert len(segments) == len(names)
        assert set(segments) <= set(x3d_model.model.HANIMSEGMENTNAMEVALUES)
        for kind, field in (("HAnimJoint", "joints"), ("HAnimSegment", "segments")):
            listed = [
                n.attrib["USE"] for n in player.humanoid.findall(kind) if n.get("containerField") == field
            ]
            assert sorted(listed) == sorted(
                n.attrib["DEF"] for n in player.humanoid.iter(kind) if "DEF" in n.attrib
            )


def test_joints_nest_as_h_anim_says() -> None:
    player = Player.of(quietly(walk()))
    above = {
        child.get("name", ""): node.get("name", "")
        for node in player.joints
        for child in node.findall("HAnimJoint")
    }
    for name, parent in above.items():
        known = articulations()[name].parent
        while known != parent:
            assert known not in above
            known = articulations()[known].parent


@pytest.mark.parametrize("path", [*SHIPPED[:4], SHIPPED[-1]], ids=lambda path: path.name)
def test_the_default_pose_stands_with_its_arms_at_its_sides(path: Path) -> None:
    centres = figure(gmr.read(path)).centres
    assert min(centre[1] for centre in centres.values()) == pytest.approx(0, abs=0.08)
    assert centres["skullbase"][1] > centres["vl5"][1] > centres["l_knee"][1]
    for letter, side in (("l", 1), ("r", -1)):
        for upper, lower in (
            ("shoulder", "elbow"),
            ("elbow", "radiocarpal"),
            ("hip", "knee"),
            ("knee", "talocrural"),
        ):
            way = centres[f"{letter}_{lower}"] - centres[f"{letter}_{upper}"]
            np.testing.assert_allclose(way / np.linalg.norm(way), [0, -1, 0], atol=1e-6)
        assert side * centres[f"{letter}_hip"][0] > 0.03
        assert side * centres[f"{letter}_shoulder"][0] > 0.1
        foot = centres[f"{letter}_metatarsophalangeal_2"] - centres[f"{letter}_talocrural"]
        assert foot[2] > 0.05
        assert abs(foot[0]) < 1e-6


def test_a_single_frame_is_a_posture_that_stays() -> None:
    motion = walk()
    data = quietly(motion[33:34])
    player = Player.of(data)
    assert not list(player.root.iter("TimeSensor"))
    assert not list(player.root.iter("ROUTE"))
    assert_the_law_holds(motion[33:34], data)
    assert faults(data) == []


@given(st.text(min_size=1), st.text(min_size=1))
@settings(max_examples=40)
def test_names_are_only_names(name: str, joint: str) -> None:
    motion = walk()[:2]
    skeleton = motion.skeleton
    names = [f"{old}{joint}" if old == "LThumb" else old for old in skeleton.names]
    named = replace(skeleton, names=tuple(names))
    renamed = Motion.from_pose(
        named, motion.rotations, motion.translations, motion.frame_time, unit=motion.unit, name=name
    )
    data = quietly(renamed)
    assert len(Player.of(data).joints) >= len(LOA_1)
    assert faults(data) == []


def test_markup_in_names_is_text() -> None:
    nasty = "a<b>&\"'\0.x"
    data = quietly(walk()[:2].with_name(nasty))
    (world,) = Player.of(data).root.iter("WorldInfo")
    assert world.get("title") == "a<b>&\"'\N{REPLACEMENT CHARACTER}"
    assert faults(data) == []


@pytest.mark.parametrize(
    ("name", "token"),
    [
        ("walks/07_01.v2.bvh", "07_01.v2"),
        ("walk fast (1).bvh", "walk_fast__1_"),
        ("/", "motion"),
        ("", "motion"),
        ("\u6b69", "_"),
    ],
)
def test_a_humanoid_is_named_by_an_nmtoken(name: str, token: str) -> None:
    data = quietly(walk()[:2].with_name(name))
    assert Player.of(data).humanoid.get("name") == token
    assert faults(data) == []


def of_size(metres: float) -> Motion:
    """A walk of a body whose unit is so long; it is 25 units tall."""
    motion = walk()[:3]
    return Motion.from_pose(
        motion.skeleton, motion.rotations, motion.translations, motion.frame_time, unit=metres
    )


@pytest.mark.parametrize("metres", [1e-3, 0.0564, 1e20])
def test_a_body_of_any_size_that_metres_can_say_is_valid(metres: float) -> None:
    motion = of_size(metres)
    data = quietly(motion)
    assert faults(data) == []
    assert_the_law_holds(motion, data)


@pytest.mark.parametrize("metres", [1e-9, 1e-6, 1e-4, 1e35, 1e200])
def test_a_body_that_metres_cannot_say_is_refused(metres: float) -> None:
    with pytest.raises(GmrError, match=r"m tall, .*state how long a unit is: motion.with_unit"):
        x3d_chunks(of_size(metres))


@pytest.fixture(scope="module")
def short_walk() -> str:
    """A file without a fault."""
    data = quietly(walk()[:2])
    assert faults(data) == []
    return data.decode()


def test_joints_and_segments_share_no_name() -> None:
    joints = articulations()
    parts = [joint.segment for joint in joints.values()]
    assert len({*joints, *parts}) == len(joints) + len(parts)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('loa="1"', 'loa="5"'),
        ('name="cmu_07_01" version', 'name="cmu 07 01" version'),
        ('version="2.0"', 'version="1.0"'),
        ('level="1"', 'level="6"'),
        (' level="1"', ""),
        ('profile="Immersive"', 'profile="Immerse"'),
        ("0.93 0.94 0.96", "1.93 0.94 0.96"),
        ('containerField="skeleton"', 'containerField="skeletons"'),
        ('<Sphere radius="', '<Sphere radius="-'),
        ('<Sphere radius="', '<Sphere radius="0" class="'),
        ('USE="hanim_l_hip"', 'USE="hanim_l_hop"'),
        ('toNode="hanim_l_hip"', 'toNode="hanim_l_hop"'),
        ('DEF="hanim_l_hip"', 'DEF="hanim_r_hip"'),
        ('DEF="clock"', 'DEF="1clock"'),
        ('center="0 ', 'center="'),
        ('center="0 ', 'center="0, '),
        ('center="0 ', 'center="nan '),
        ('key="0\n', 'key="0 x\n'),
        ('keyValue="', 'keyValue="1 '),
        ('loop="true"', 'loop="TRUE"'),
        ("<head>\n", '<head>\n<meta name="a" content="b"/>\n'),
        ("<Scene>\n", "<Scene>\n<Sphere/>\n"),
        ("<Scene>\n", "<Scene>\nwalk\n"),
        ("</Shape>", "<Sphere/></Shape>"),
        ("<Appearance>", "<Appearance/><Appearance>"),
        ('cycleInterval="', 'cycleInterval="-'),
        ('<HAnimJoint DEF="hanim_l_hip"', '<Transform/><HAnimJoint DEF="hanim_l_hip"'),
        (' fromField="fraction_changed"', ""),
        ('global="true"', 'globe="true"'),
        ('fieldOfView="0.785398"', 'fieldOfView="3.2"'),
    ],
)
def test_the_rules_of_the_schema_find_what_breaks_them(short_walk: str, old: str, new: str) -> None:
    assert old in short_walk
    assert x3d_schema.faults(short_walk.replace(old, new, 1).encode())


def test_a_guessed_unit_is_said_and_a_stated_one_is_not() -> None:
    motion = gmr.read(DATA / "cmu_07_01.bvh")
    with pytest.warns(FormatWarning, match="taken to be in cmu, guessed from the body"):
        x3d_chunks(motion)
    data = b"".join(x3d_chunks(motion.with_unit("cmu")))
    assert b"guessed" not in data


def test_where_nothing_stands_at_rest_the_most_upright_frame_is_taken_and_said() -> None:
    motion = walk()[1:]
    bent = motion.pose
    skeleton = motion.skeleton
    flat = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    crooked = {skeleton.index(name) for name in ("LeftUpLeg", "RightLeg", "Spine")}
    offsets, rotations = skeleton.offsets.copy(), bent.rotations.copy()
    for joint in crooked:
        own = int(skeleton.slots[skeleton.children[joint][0]])
        rotations[:, own] = multiply(rotations[:, own], flat)
        for below in skeleton.children[joint]:
            offsets[below] = rotated(conjugate(flat), offsets[below])
            if not skeleton.ends[below] and skeleton.children[below]:
                slot = int(skeleton.slots[skeleton.children[below][0]])
                rotations[:, slot] = multiply(conjugate(flat), rotations[:, slot])
    odd = Motion.from_pose(
        replace(skeleton, offsets=offsets),
        rotations,
        motion.translations,
        motion.frame_time,
        unit=motion.unit,
    )
    np.testing.assert_allclose(odd.positions(), motion.positions(), atol=1e-4)
    with pytest.warns(FormatWarning, match="stands most upright; name another frame"):
        data = b"".join(x3d_chunks(odd))
    assert_the_law_holds(odd, data)
    assert_the_law_holds(odd, quietly(odd, rest=3))


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        (lambda motion: motion[0:0], GmrError, "has no frames"),
        (lambda motion: replace(motion, frame_time=0.0), GmrError, "how long a frame lasts"),
    ],
    ids=["no frames", "no frame time"],
)
def test_what_cannot_be_played_is_refused(change: Any, error: type[Exception], said: str) -> None:
    with pytest.raises(error, match=said):
        x3d_chunks(change(walk()))


def test_an_unknown_place_names_joint_and_frame() -> None:
    motion = walk()
    moves = motion.translations.copy()
    moves[7] = np.nan
    with pytest.raises(FormatError, match="'Hips' has no place in frame 7"):
        x3d_chunks(
            Motion.from_pose(motion.skeleton, motion.rotations, moves, motion.frame_time, unit=motion.unit)
        )


def test_a_body_that_is_not_known_says_what_is_missing_and_how_to_name_it() -> None:
    skeleton = Skeleton.post_rotation(QUAD, [-1, 0, 1, 0], np.eye(4, 3) + 1)
    still = np.tile([0.0, 0.0, 0.0, 1.0], (3, skeleton.slot_count, 1))
    motion = Motion.from_pose(skeleton, still, np.zeros((3, 1, 3)), 1 / 30, unit=1.0)
    with pytest.raises(SkeletonError) as caught:
        x3d_chunks(motion)
    said = str(caught.value)
    assert "left_up_leg, right_up_leg, left_foot, right_foot" in said
    assert all(f"'{name}'" in said for name in QUAD)
    assert "names={'left_up_leg': ..., " in said


def test_a_body_whose_names_say_nothing_is_told_by_names_that_are_given(tmp_path: Path) -> None:
    motion = walk()[1:5]
    skeleton = motion.skeleton
    told = parts_by_name(
        ["" if end else name for name, end in zip(skeleton.names, skeleton.ends, strict=True)]
    )
    assert told is not None
    plain = [f"joint_{k}" for k in range(skeleton.joint_count)]
    names = {
        f"{part}.{k}": plain[joint] for part, joints in told[1].items() for k, joint in enumerate(joints)
    }
    renamed = Motion.from_pose(
        replace(skeleton, names=tuple(plain)),
        motion.rotations,
        motion.translations,
        motion.frame_time,
        unit=motion.unit,
    )
    write_x3d(renamed, tmp_path / "a.x3d", names=names)
    one, other = Player.of((tmp_path / "a.x3d").read_bytes()), Player.of(quietly(motion))
    for name, place in other.places(1.0).items():
        np.testing.assert_allclose(one.places(1.0)[name], place, atol=1e-6)


def test_pieces_of_a_long_motion_are_no_larger_than_those_of_a_short_one() -> None:
    motion = walk()
    layout = motion.layout
    assert layout is not None

    def longest(repeats: int) -> int:
        long = Motion.from_rows(
            motion.skeleton,
            layout,
            np.tile(motion.rows, (repeats, 1)),
            motion.frame_time,
            unit=motion.unit,
        )
        return max(map(len, x3d_chunks(long)))

    assert longest(300) < 1.25 * longest(150)


def test_every_name_of_h_anim_is_a_part_of_the_body() -> None:
    names = list(articulations())
    found = parts_by_name(names)
    assert found is not None
    naming, parts = found
    assert naming.title == "H-Anim"
    said = {names[joint] for joints in parts.values() for joint in joints}
    assert said == set(names) - {"sacroiliac"}
    assert [names[joint] for joint in parts["spine"]] == list(SPINE)
    assert [names[joint] for joint in parts["neck"]] == list(NECK)


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=5), st.booleans())
def test_vertebrae_rise_along_a_back(wanted: list[float], first: bool) -> None:
    offered = np.linspace(-5, 5, 7).tolist()
    chosen = levels(wanted, offered, first=first)
    assert len(chosen) == len(wanted)
    assert all(0 <= level < len(offered) for level in chosen)
    assert all(above > below for below, above in pairwise(chosen))
    assert chosen[0] == 0 or not first


def test_a_file_is_written_by_its_suffix_and_read_by_none(tmp_path: Path) -> None:
    path = tmp_path / "walk.x3d"
    gmr.write(walk(), path)
    assert path.read_bytes() == quietly(walk())
    with pytest.raises(FormatError, match="gmr writes X3D but does not read it"):
        gmr.read(path)
    with pytest.raises(FormatError, match="gmr writes X3D but does not read it"):
        gmr.read(path.read_bytes())
    assert motion_files(tmp_path) == []


def test_what_was_there_stays_when_a_motion_cannot_be_written(tmp_path: Path) -> None:
    path = tmp_path / "walk.x3d"
    path.write_text("before")
    with pytest.raises(GmrError):
        gmr.write(walk()[0:0], path)
    assert path.read_text() == "before"
