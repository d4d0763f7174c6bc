"""Partial motions united, and the upper body of one clip on the lower body of another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
import strategies
from gmr import DatasetError, GmrError, Motion, SkeletonError
from gmr.demo import demo_folder
from gmr.editing import ground_path, splice, unite, warp_path
from gmr.formats.bvh import write_bvh
from gmr.frames import Pose
from gmr.partial import below
from gmr.quaternions import about, conjugate, multiply, rotated

Floats = NDArray[np.float64]

WALK, RUN, OTHER = (gmr.read(demo_folder() / f"{name}.bvh") for name in ("07_01", "09_01", "02_01"))


def uniquely_named(motion: Motion) -> bool:
    return len(set(motion.skeleton.names)) == motion.skeleton.joint_count


def turned_alike(one: Floats, other: Floats) -> None:
    np.testing.assert_allclose(np.abs((one * other).sum(axis=-1)), 1, rtol=0, atol=1e-9)


# Uniting


@settings(max_examples=30)
@given((strategies.motions(max_joints=7) | strategies.poses(max_joints=7)).filter(uniquely_named), st.data())
def test_parts_united_are_the_motion_again(motion: Motion, data: st.DataObject) -> None:
    """Any partition of the joints, hung together as they were: same places, same turns, same tree."""
    skeleton = motion.skeleton
    whose = [data.draw(st.integers(0, 2)) for _ in skeleton.names]
    parts = [[joint for joint, one in enumerate(whose) if one == number] for number in range(3)]
    cut = [
        joint
        for joint, parent in enumerate(skeleton.parents.tolist())
        if parent >= 0 and whose[parent] != whose[joint]
    ]
    links = {skeleton.names[joint]: skeleton.names[skeleton.parents[joint]] for joint in cut}
    united = unite([motion.select(part) for part in parts if part], links, order=skeleton.names)

    assert united.skeleton.names == skeleton.names
    np.testing.assert_array_equal(united.skeleton.parents, skeleton.parents)
    reach = 1 + np.abs(motion.positions(dtype=float)).max()
    places = united.positions(dtype=float), motion.positions(dtype=float)
    np.testing.assert_allclose(*places, rtol=0, atol=1e-10 * reach)
    turned_alike(united.bone_rotations(dtype=float), motion.bone_rotations(dtype=float))
    assert set(united.translated.tolist()) <= set(motion.translated.tolist())
    loose = unite([motion.select(part) for part in parts if part], links, order=skeleton.names, join=False)
    assert set(loose.roots) == set(motion.roots) | set(links)
    np.testing.assert_allclose(loose.positions(dtype=float), places[1], rtol=0, atol=1e-10 * reach)


def test_a_file_that_was_taken_apart_is_put_together_as_it_was() -> None:
    upper = below(WALK.skeleton, "Spine1")
    lower = sorted(set(range(WALK.skeleton.joint_count)) - set(upper))
    united = unite([WALK.select(lower), WALK.select(upper)], {"Spine1": "Spine"}, order=WALK.skeleton.names)
    assert united.skeleton == WALK.skeleton
    np.testing.assert_array_equal(united.skeleton.offsets, WALK.skeleton.offsets)
    again = gmr.read(write_bvh(united), format="bvh")
    np.testing.assert_allclose(again.positions(dtype=float), WALK.positions(dtype=float), atol=1e-9)


def test_a_part_that_moves_by_itself_hangs_on_a_bone_that_moves() -> None:
    hand, rest = WALK.select(below(WALK.skeleton, "LeftHand")), OTHER[: WALK.frame_count]
    rest = rest.select(sorted(set(range(rest.skeleton.joint_count)) - set(below(rest.skeleton, "LeftHand"))))
    united = unite([rest, hand], {"LeftHand": "LeftForeArm"})
    assert united.skeleton.index("LeftHand") in united.translated
    for part in (hand, rest):
        joints = part.skeleton.names
        places = united.positions(dtype=float, joints=joints), part.positions(dtype=float)
        np.testing.assert_allclose(*places, rtol=0, atol=1e-9)
    assert united.skeleton.names == rest.skeleton.names + hand.skeleton.names


def test_bodies_without_links_stay_side_by_side() -> None:
    names = tuple(f"other:{name}" for name in RUN.skeleton.names)
    other = replace(RUN, skeleton=replace(RUN.skeleton, names=names))
    both = unite([RUN, other])
    assert both.roots == ("Hips", "other:Hips")
    np.testing.assert_array_equal(
        both.positions(dtype=float), np.concatenate([RUN.positions(dtype=float)] * 2, axis=1)
    )


# Splicing


@pytest.mark.parametrize("keep", ["heading", "pelvis", "world"])
def test_a_motion_spliced_with_itself_is_itself(keep: str) -> None:
    edited = splice(WALK, WALK, "Spine", keep=keep)  # type: ignore[arg-type]
    assert edited.motion.skeleton == WALK.skeleton
    np.testing.assert_allclose(edited.motion.positions(dtype=float), WALK.positions(dtype=float), atol=1e-9)
    assert edited.report.seam_deg.max() < 1e-5
    assert edited.motion.layout == WALK.layout


def test_the_lower_body_is_the_one_clips_and_the_upper_one_has_the_others_bones() -> None:
    edited = splice(WALK, OTHER, "Spine")
    skeleton, count = WALK.skeleton, edited.motion.frame_count
    hanging = [joint for joint in below(skeleton, "Spine") if joint != skeleton.index("Spine")]
    staying = sorted(set(range(skeleton.joint_count)) - set(hanging))
    assert count == min(WALK.frame_count, OTHER.frame_count)
    np.testing.assert_allclose(
        edited.motion.positions(dtype=float, joints=staying),
        WALK[:count].positions(dtype=float, joints=staying),
        rtol=0,
        atol=1e-9,
    )
    np.testing.assert_array_equal(edited.motion.skeleton.offsets[hanging], OTHER.skeleton.offsets[hanging])
    np.testing.assert_array_equal(edited.motion.skeleton.offsets[staying], WALK.skeleton.offsets[staying])
    assert edited.motion.translated.tolist() == [0]


@pytest.mark.parametrize("keep", ["heading", "pelvis", "world"])
def test_the_upper_body_turns_as_a_whole_by_what_is_kept(keep: str) -> None:
    edited = splice(WALK, RUN, "Spine", keep=keep, blend=0)  # type: ignore[arg-type]
    hanging = [j for j in below(WALK.skeleton, "Spine") if j != WALK.skeleton.index("Spine")]
    ours, theirs = (
        motion[: RUN.frame_count].bone_rotations(dtype=float)[:, hanging] for motion in (edited.motion, RUN)
    )
    if keep == "world":
        turn = np.tile([0.0, 0.0, 0.0, 1.0], (RUN.frame_count, 1))
    elif keep == "heading":
        turn = about(
            np.array([0.0, 1, 0]), ground_path(WALK[: RUN.frame_count]).heading - ground_path(RUN).heading
        )
    else:
        hip = WALK.skeleton.index("LeftUpLeg")
        one, other = (motion[: RUN.frame_count].bone_rotations(dtype=float)[:, hip] for motion in (WALK, RUN))
        turn = multiply(one, conjugate(other))
    turned_alike(ours, multiply(turn[:, None], theirs))


def test_the_heading_of_the_upper_clip_does_not_matter() -> None:
    aside = warp_path(
        RUN, gmr.editing.GroundPath(ground_path(RUN).ground, ground_path(RUN).heading + 2)
    ).motion
    places = [splice(WALK, upper).motion.positions(dtype=float) for upper in (RUN, aside)]
    np.testing.assert_allclose(places[0], places[1], rtol=0, atol=1e-3)  # headings are smoothed in float32


def test_blending_goes_over_from_one_clip_to_the_other() -> None:
    """At the first bone above the seam a third of the way, then two thirds, then all."""
    hard, soft = splice(WALK, RUN, "Spine", blend=0).motion, splice(WALK, RUN, "Spine", blend=2).motion
    lower = WALK[: soft.frame_count].bone_rotations(dtype=float)
    upper, blended = hard.bone_rotations(dtype=float), soft.bone_rotations(dtype=float)
    for name, share in (("Spine1", 1 / 3), ("Neck", 2 / 3), ("Neck1", 1), ("LeftArm", 1), ("LeftHand", 1)):
        joint = WALK.skeleton.index(name)
        whole, part = (
            2 * np.arccos(np.minimum(np.abs((lower[:, joint] * one[:, joint]).sum(axis=1)), 1))
            for one in (upper, blended)
        )
        np.testing.assert_allclose(part, share * whole, atol=1e-6)


def test_a_frame_map_says_which_frames_go_together() -> None:
    slow = np.minimum(np.arange(WALK.frame_count) // 2, RUN.frame_count - 1)
    edited = splice(WALK, RUN, "Spine", keep="world", blend=0, frames=slow)
    assert edited.motion.frame_count == WALK.frame_count
    arm = WALK.skeleton.index("LeftHand")
    turned_alike(
        edited.motion.bone_rotations(dtype=float)[:, arm], RUN.bone_rotations(dtype=float)[slow, arm]
    )


def test_an_upper_body_with_other_joints_can_be_put_on() -> None:
    lean = RUN[1:].drop_dummies()
    edited = splice(WALK[1:], lean, "Spine", blend=1)
    assert len(lean.skeleton.names) < len(RUN.skeleton.names)
    dense = splice(WALK[1:], RUN[1:], "Spine", blend=1).motion
    joints = [name for name in lean.skeleton.names if name in edited.motion.skeleton.names]
    np.testing.assert_allclose(
        edited.motion.positions(dtype=float, joints=joints),
        dense.positions(dtype=float, joints=joints),
        atol=1e-9,
    )
    again = gmr.read(write_bvh(edited.motion), format="bvh")
    joints = [name for name in joints if not name.endswith("_end")]
    np.testing.assert_allclose(
        again.positions(dtype=float, joints=joints), dense.positions(dtype=float, joints=joints), atol=1e-9
    )


def test_what_was_spliced_is_written_without_jumps() -> None:
    edited = splice(WALK, RUN, "Spine").motion
    again = gmr.read(write_bvh(edited), format="bvh")
    assert again.skeleton == edited.skeleton
    jumps = [np.abs(np.diff(motion.rows[3:], axis=0)).max() for motion in (WALK, RUN, again)]
    assert jumps[2] < max(jumps[:2]) + 3


def upended(motion: Motion) -> Motion:
    """The same with +Z up."""
    pose, quarter = motion.pose, np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    rotations = pose.rotations.copy()
    rotations[:, 0] = multiply(quarter, rotations[:, 0])
    source = Pose(rotations, pose.translated, rotated(quarter, pose.translations), pose.layout)
    return replace(motion, source=source)


def refusals() -> dict[str, tuple[Callable[[], object], type[Exception], str]]:
    other = RUN.resample(60)
    arms = WALK.select(below(WALK.skeleton, "Spine"))
    legs = WALK.select(["Hips", "LHipJoint", "LeftUpLeg"])
    return {
        "joint": (lambda: splice(WALK, RUN, "Spin"), SkeletonError, "no joint 'Spin'; did you mean 'Spine'"),
        "rates": (lambda: splice(WALK, other), GmrError, "120 frames a second, the upper one 60; resample"),
        "units": (lambda: splice(WALK.with_unit("cm"), RUN), GmrError, "unit of 0.01 metres.*None; declare"),
        "up": (lambda: splice(WALK, upended(RUN)), GmrError, r"up is \+Y in the lower .* \+Z in the upper"),
        "keep": (lambda: splice(WALK, RUN, keep="arms"), GmrError, "'heading', 'pelvis' or 'world'"),  # type: ignore[arg-type]
        "blend": (lambda: splice(WALK, RUN, blend=-1), GmrError, "a number of bones, 0 or more"),
        "leaf": (lambda: splice(WALK, RUN, "Head_end"), SkeletonError, "nothing hangs on 'Head_end'"),
        "frames": (lambda: splice(WALK, RUN, frames=[0, 1]), GmrError, "one for each of 317"),
        "beyond": (lambda: splice(WALK[:2], RUN, frames=[0, 999]), GmrError, r"\[1\] is 999.* 0 to 148"),
        "no body": (lambda: splice(arms, arms, "Spine1"), DatasetError, "known as hips"),
        "nothing": (lambda: unite([]), GmrError, "nothing to unite"),
        "twice": (lambda: unite([WALK, legs]), SkeletonError, "in part 0 and in part 1"),
        "lengths": (lambda: unite([arms, legs[:5]]), GmrError, "part 1 has 5 frames, part 0 has 317"),
        "no root": (lambda: unite([arms, legs], {"Neck": "Hips"}), SkeletonError, "is no root"),
        "circle": (lambda: unite([arms, legs], {"Spine": "Hips", "Hips": "Neck"}), SkeletonError, "a circle"),
        "own tree": (lambda: unite([arms, legs], {"Spine": "Neck"}), SkeletonError, "hangs below it"),
        "order": (lambda: unite([arms, legs], order=["Hips"]), SkeletonError, "name every joint once"),
    }  # fmt: skip


@pytest.mark.parametrize("case", refusals())
def test_what_cannot_be_put_together_is_refused_in_words(case: str) -> None:
    call, kind, sentence = refusals()[case]
    with pytest.raises(kind, match=sentence):
        call()
