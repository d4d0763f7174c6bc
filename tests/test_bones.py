"""Heads and tails of bones by the three rules, at rest and in frames."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import gmr
from gmr import Motion
from gmr.bone_tails import FALLBACK, SHORTEST
from gmr.demo import demo_folder
from gmr.formats.bvh import read_bvh
from gmr.skeleton import End
from strategies import motions, poses

RULES = ("centroid", "first_child", "per_child")
Floats = NDArray[np.float64]

HIP = """HIERARCHY
ROOT hip
{{
OFFSET 0 0 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
{children}
}}
MOTION
Frames: 1
Frame Time: 0.01
1 2 3 {angles}
"""
CHILDREN = {"abdomen": (0, 3, 0), "thighL": (2, -1, 0), "thighR": (-2, -1, 1)}


def hip(*order: str) -> Motion:
    """The toy of the post, a hip with three children, in this order; its one frame turns the hip."""
    child = "JOINT {}\n{{\nOFFSET {} {} {}\nCHANNELS 3 Zrotation Xrotation Yrotation\n}}"
    text = "\n".join(child.format(name, *CHILDREN[name]) for name in order)
    return read_bvh(HIP.format(children=text, angles="90 0 0 " + "0 0 0 " * len(order)).encode())


def own_children(motion: Motion, joint: int) -> list[int]:
    ends = motion.skeleton.ends
    return [child for child in motion.skeleton.children[joint] if ends[child] != End.TIP]


def is_proper(motion: Motion, joint: int) -> bool:
    return bool(motion.skeleton.ends[joint] == End.JOINT or own_children(motion, joint))


def reach(motion: Motion) -> float:
    """Longest distance in the motion: what rounding is a share of."""
    places = [motion.positions(dtype=np.float64), *gmr.bones(motion)]
    return max(1.0, *(float(np.abs(place).max(initial=0.0)) for place in places))


def test_a_hips_tail_is_the_mean_of_its_three_children() -> None:
    motion = hip("abdomen", "thighL", "thighR")
    heads, tails = gmr.bones(motion)
    np.testing.assert_array_equal(heads[0], 0)
    np.testing.assert_allclose(tails[0], (0, 1 / 3, 1 / 3), rtol=1e-15)


@given(st.permutations(list(CHILDREN)))
def test_the_order_of_children_changes_the_tail_of_the_first_child_and_not_the_centroid(
    order: list[str],
) -> None:
    motion = hip(*order)
    np.testing.assert_allclose(gmr.bones(motion).tails[0], (0, 1 / 3, 1 / 3), rtol=1e-15)
    np.testing.assert_array_equal(gmr.bones(motion, "first_child").tails[0], CHILDREN[order[0]])


def test_per_child_leaves_no_gap_between_a_hip_and_its_thighs() -> None:
    motion = hip("abdomen", "thighL", "thighR")
    bones = gmr.bones(motion, "per_child")
    of_hip = bones.joints == motion.skeleton.index("hip")
    np.testing.assert_array_equal(bones.tails[of_hip], bones.heads[~of_hip])


def test_the_bone_of_a_turned_hip_turns_with_it() -> None:
    heads, tails = gmr.bones(hip("abdomen", "thighL", "thighR"), frame=0)
    np.testing.assert_array_equal(heads[0], (1, 2, 3))
    np.testing.assert_allclose(tails[0] - heads[0], (-1 / 3, 0, 1 / 3), atol=1e-15)  # z of 90 degrees


def test_a_leaf_without_end_site_ends_above_its_head_and_turns() -> None:
    motion = hip("thighL")
    for rule in RULES:
        heads, tails = gmr.bones(motion, rule)
        np.testing.assert_allclose((tails - heads)[1], FALLBACK, atol=1e-15)
        heads, tails = gmr.bones(motion, rule, frame=0)
        np.testing.assert_allclose((tails - heads)[1], (-0.1, 0, 0), atol=1e-15)


@given(motions() | poses(), st.sampled_from(["centroid", "first_child"]))
def test_there_is_a_bone_for_each_joint_and_none_to_see_for_an_end_site(motion: Motion, rule: str) -> None:
    bones = gmr.bones(motion, rule)
    assert bones.joints.tolist() == list(range(motion.skeleton.joint_count))
    for joint in bones.joints.tolist():
        length = np.linalg.norm(bones.tails[joint] - bones.heads[joint])
        assert (length > 0) == is_proper(motion, joint)


@given(motions() | poses())
def test_per_child_draws_every_edge_of_the_tree_once_and_a_stub_for_each_bare_leaf(motion: Motion) -> None:
    bones = gmr.bones(motion, "per_child")
    count = motion.skeleton.joint_count
    edges = [(joint, child) for joint in range(count) for child in own_children(motion, joint)]
    bare = [joint for joint in range(count) if not own_children(motion, joint) and is_proper(motion, joint)]
    assert bones.joints.tolist() == sorted([joint for joint, _ in edges] + bare)
    offsets = motion.skeleton.offsets
    vectors = (bones.tails - bones.heads).tolist()
    for joint, child in edges:
        expected = offsets[child] + (FALLBACK if np.linalg.norm(offsets[child]) < SHORTEST else np.zeros(3))
        nearest = min(
            float(np.abs(np.subtract(vector, expected)).max())
            for vector, owner in zip(vectors, bones.joints.tolist(), strict=True)
            if owner == joint
        )
        assert nearest <= 1e-12 * reach(motion)


@given(motions() | poses(), st.sampled_from(RULES))
def test_no_bone_is_too_short_to_be_drawn(motion: Motion, rule: str) -> None:
    for frame in (None, slice(None)):
        bones = gmr.bones(motion, rule, frame=frame)
        drawn = [k for k, joint in enumerate(bones.joints.tolist()) if is_proper(motion, joint)]
        lengths = np.linalg.norm(bones.tails - bones.heads, axis=-1)[..., drawn]
        assert (lengths >= SHORTEST - 1e-12 * reach(motion)).all()


@given(motions() | poses(), st.sampled_from(RULES))
def test_heads_are_the_joints(motion: Motion, rule: str) -> None:
    bones = gmr.bones(motion, rule, frame=slice(None))
    np.testing.assert_array_equal(bones.heads, motion.positions(dtype=np.float64)[:, bones.joints])


@given(motions())
def test_centroid_bones_move_rigidly_with_their_joints(motion: Motion) -> None:
    rest, moved = gmr.bones(motion), gmr.bones(motion, frame=slice(None))
    turns = motion.joint_rotations(dtype=np.float64)
    for joint, vector in enumerate(rest.tails - rest.heads):
        expected = Rotation.from_quat(turns[:, joint]).apply(vector)
        actual = (moved.tails - moved.heads)[:, joint]
        np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * reach(motion))


@given(motions() | poses(), st.sampled_from(["first_child", "per_child"]))
def test_lines_between_joints_end_where_the_children_are(motion: Motion, rule: str) -> None:
    positions = motion.positions(dtype=np.float64)
    bones = gmr.bones(motion, rule, frame=slice(None))
    taken = {joint: iter(own_children(motion, joint)) for joint in bones.joints.tolist()}
    for k, joint in enumerate(bones.joints.tolist()):
        child = next(taken[joint], None)
        if child is None:
            continue
        long = np.linalg.norm(positions[:, child] - positions[:, joint], axis=-1) >= SHORTEST
        np.testing.assert_array_equal(bones.tails[long, k], positions[long, child])


@given(motions() | poses(), st.sampled_from(RULES))
def test_a_slice_of_frames_is_the_frames_one_by_one(motion: Motion, rule: str) -> None:
    together = gmr.bones(motion, rule, frame=slice(None))
    for frame in range(motion.frame_count):
        for index in (frame, frame - motion.frame_count):
            alone = gmr.bones(motion, rule, frame=index)
            np.testing.assert_array_equal(alone.heads, together.heads[frame])
            np.testing.assert_array_equal(alone.tails, together.tails[frame])


@given(motions(), st.sampled_from(RULES))
def test_a_frame_in_which_nothing_turns_or_moves_is_the_rest_pose(motion: Motion, rule: str) -> None:
    skeleton = motion.skeleton
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (1, skeleton.slot_count, 1))
    still = Motion.from_pose(skeleton, rotations, skeleton.offsets[None, list(skeleton.roots)], 0.01)
    rest, frame = gmr.bones(still, rule), gmr.bones(still, rule, frame=0)
    np.testing.assert_allclose(frame.heads, rest.heads, rtol=0, atol=1e-12 * reach(still))
    np.testing.assert_allclose(frame.tails, rest.tails, rtol=0, atol=1e-9 * reach(still))


def test_where_thighs_turn_on_their_own_the_hips_tail_is_the_mean_of_their_places() -> None:
    motion = gmr.read(demo_folder() / "07_01.bvh").drop_dummies()
    joint = motion.skeleton.index("Hips")
    children = list(motion.skeleton.children[joint])
    assert len(children) == 3
    with pytest.raises(gmr.SkeletonError, match="no one frame"):
        motion.joint_rotations()
    means = motion.positions(dtype=np.float64)[:, children].mean(axis=1)
    np.testing.assert_allclose(gmr.bones(motion, frame=slice(None)).tails[:, joint], means, atol=1e-12)
    rest = gmr.bones(motion)
    np.testing.assert_allclose(rest.tails[joint], motion.skeleton.offsets[children].mean(axis=0), atol=1e-12)


def test_the_tip_that_is_left_of_a_dropped_leaf_draws_nothing_to_itself() -> None:
    motion = read_bvh(
        HIP.format(
            children="JOINT abdomen {{ OFFSET 0 3 0 CHANNELS 0 }} "
            "JOINT bare {{ OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation }}".format(),
            angles="0 0 0 0 0 0",
        ).encode()
    ).drop_dummies()
    assert motion.skeleton.names == ("hip", "abdomen", "bare_end")
    for rule in RULES:
        heads, tails = gmr.bones(motion, rule)
        np.testing.assert_array_equal(tails[0] - heads[0], (0, 3, 0))
        assert len(gmr.bones(motion, rule).joints) == (2 if rule == "per_child" else 3)


def test_arrays_of_bones_are_read_only() -> None:
    bones = gmr.bones(hip("thighL"))
    for array in (bones.joints, bones.heads, bones.tails):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_an_unknown_rule_is_answered_with_the_known() -> None:
    with pytest.raises(gmr.GmrError, match="'centroid', 'first_child', 'per_child'"):
        gmr.bones(hip("thighL"), "average")


@pytest.mark.parametrize("frame", [1, -2, 10**30])
def test_a_frame_that_is_not_there_is_refused(frame: int) -> None:
    with pytest.raises(gmr.GmrError, match=f"no frame {frame}; the motion has 1"):
        gmr.bones(hip("thighL"), frame=frame)


def test_no_frames_are_no_bones_in_frames() -> None:
    motion = hip("thighL")[:0]
    assert gmr.bones(motion, frame=slice(None)).tails.shape == (0, motion.skeleton.joint_count, 3)


@given(motions(min_frames=1), st.sampled_from(RULES), st.data())
def test_bones_do_not_depend_on_which_joints_are_roots(
    motion: Motion, rule: str, data: st.DataObject
) -> None:
    joint = data.draw(st.integers(0, motion.skeleton.joint_count - 1))
    moved = motion.shift_root(joint)
    for frame in (None, slice(None)):
        one, other = gmr.bones(motion, rule, frame), gmr.bones(moved, rule, frame)
        np.testing.assert_array_equal(one.joints, other.joints)
        np.testing.assert_allclose(one.heads, other.heads, atol=1e-9)
        np.testing.assert_allclose(one.tails, other.tails, atol=1e-9)
