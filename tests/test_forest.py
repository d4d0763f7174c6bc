"""The laws of the General Motion Representation, on random forests and on real files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import gmr
import strategies
from gmr import forest
from gmr.demo import demo_folder
from gmr.dummies import find_dummies
from gmr.errors import SkeletonError
from gmr.formats.bvh import write_bvh
from gmr.frames import Pose, Rows
from gmr.motion import Motion
from gmr.partial import below
from gmr.tpose import leading_rest_frames
from gmr.world import quaternion_job
from walks import walks_of

CLOSE = 1e-12
"""Error in f64, as a share of the motion's reach."""

motions = strategies.motions(max_joints=8) | strategies.poses(max_joints=8)


def walks() -> st.SearchStrategy[tuple[Motion, Motion]]:
    """A motion, and the same after some operations."""
    return walks_of(motions)


def reach(motion: Motion) -> float:
    return 1 + float(np.abs(motion.positions(dtype=float)).max(initial=0))


def assert_same_motion(one: Motion, other: Motion) -> None:
    """Every joint's position and every bone's rotation are the same."""
    places = one.positions(dtype=float), other.positions(dtype=float)
    np.testing.assert_allclose(*places, rtol=0, atol=CLOSE * 10 * reach(one))
    turns = np.einsum("fjc,fjc->fj", one.bone_rotations(dtype=float), other.bone_rotations(dtype=float))
    np.testing.assert_allclose(np.abs(turns), 1, rtol=0, atol=CLOSE)


def assert_same_numbers(one: Motion, other: Motion) -> None:
    """The configurations are equal, and all that is stored agrees to rounding."""
    assert one.skeleton == other.skeleton
    np.testing.assert_array_equal(one.translated, other.translated)
    np.testing.assert_allclose(one.rotations, other.rotations, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(one.translations, other.translations, rtol=0, atol=CLOSE * 10 * reach(one))


def without_memory(motion: Motion) -> Motion:
    """The motion without the rows that it was read as, so that all must be computed."""
    source = motion.source
    return replace(motion, source=replace(source, rows=None)) if isinstance(source, Pose) else motion


@given(walks())
def test_operations_keep_every_joint_and_every_bone_in_place(walk: tuple[Motion, Motion]) -> None:
    assert_same_motion(*walk)


@given(walks())
def test_the_configuration_alone_determines_the_motion(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    straight = forest.carried(motion, moved.skeleton)
    assert_same_numbers(without_memory(straight), without_memory(moved))


@given(walks())
def test_what_was_read_comes_back_to_the_bit(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    assert forest.home(moved).skeleton == motion.skeleton
    if isinstance(motion.source, Rows):
        assert forest.home(moved) == motion


@given(walks())
def test_without_memory_the_way_home_gives_every_number_back(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    motion = replace(motion, source=replace(motion.pose, rows=None))
    assert_same_numbers(forest.home(without_memory(moved)), motion)


@given(walks(), st.data())
def test_shifting_there_and_back_gives_every_number_back(
    walk: tuple[Motion, Motion], data: st.DataObject
) -> None:
    _, moved = walk
    joint = data.draw(st.integers(0, moved.skeleton.joint_count - 1))
    root = moved.skeleton.forest.root_of(joint)
    there = without_memory(moved.shift_root(joint))
    assert joint in there.skeleton.roots
    assert_same_numbers(there.shift_root(root), moved)


@given(motions, st.data())
def test_join_undoes_split(motion: Motion, data: st.DataObject) -> None:
    joints = [joint for joint, parent in enumerate(motion.skeleton.parents) if parent >= 0]
    if joints:
        joint = data.draw(st.sampled_from(joints))
        split = motion.split(joint)
        assert set(split.roots) == {*motion.roots, motion.skeleton.names[joint]}
        assert split.skeleton.links[joint] == motion.skeleton.parents[joint]
        back = without_memory(split).join(joint)
        assert_same_numbers(back, replace(motion, source=replace(motion.pose, rows=None)))


@given(walks(), st.data())
def test_any_roots_are_reached_from_anywhere(walk: tuple[Motion, Motion], data: st.DataObject) -> None:
    motion, moved = walk
    every = range(motion.skeleton.joint_count)
    roots = data.draw(st.sets(st.sampled_from(every)))
    try:
        straight = motion.with_roots(roots)
    except SkeletonError as error:
        assert "would have no root" in str(error)  # noqa: PT017
        return
    assert set(straight.skeleton.roots) == roots
    assert_same_numbers(without_memory(moved.with_roots(roots)), without_memory(straight))


@given(motions)
def test_with_all_joints_as_roots_positions_are_what_is_stored(motion: Motion) -> None:
    apart = motion.with_roots(range(motion.skeleton.joint_count))
    np.testing.assert_array_equal(apart.translated, np.arange(motion.skeleton.joint_count))
    np.testing.assert_array_equal(apart.positions(dtype=float), apart.translations)
    assert_same_motion(motion, apart)


@given(walks())
def test_positions_do_not_depend_on_rotations_that_move_nothing(walk: tuple[Motion, Motion]) -> None:
    _, moved = walk
    moved = replace(moved, source=moved.pose)
    job = quaternion_job(moved, np.dtype(np.float32), only_positions=False)
    all_read = np.empty((moved.frame_count, moved.skeleton.joint_count, 3), np.float32)
    gmr._core.forward_kinematics(*job, None, None, all_read, None, 1)
    np.testing.assert_array_equal(moved.positions(), all_read)
    slots, _ = moved.skeleton.turning
    idle = np.setdiff1d(np.arange(moved.skeleton.slot_count), slots)
    spoiled = moved.rotations.copy()
    spoiled[:, idle] = np.nan
    other = replace(moved, source=replace(moved.pose, rotations=spoiled, rows=None))
    np.testing.assert_array_equal(other.positions(), all_read)


@given(walks())
def test_frames_of_joints_are_kept_too(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    turns = motion.joint_rotations(dtype=float), moved.joint_rotations(dtype=float)
    np.testing.assert_allclose(np.abs(np.einsum("fjc,fjc->fj", *turns)), 1, rtol=0, atol=CLOSE)


@given(walks())
def test_rotations_are_those_of_scipy(walk: tuple[Motion, Motion]) -> None:
    """The definition, spelled out with SciPy: the rotations stored compose to the bones' world rotations."""
    _, moved = walk
    skeleton = moved.skeleton
    world: dict[int, Rotation] = {}
    places = np.zeros((moved.frame_count, skeleton.joint_count, 3))
    columns = {joint: k for k, joint in enumerate(moved.translated.tolist())}
    for joint in skeleton.parents_first:
        slot, parent = skeleton.slots[joint], skeleton.parents[joint]
        own = (
            Rotation.from_quat(moved.rotations[:, slot].copy())
            if slot >= 0
            else Rotation.identity(moved.frame_count)
        )
        world[joint] = own if parent < 0 else world[parent] * own
        vector = (
            moved.translations[:, columns[joint]].copy()
            if joint in columns
            else np.tile(skeleton.offsets[joint], (moved.frame_count, 1))
        )
        places[:, joint] = vector if parent < 0 else places[:, parent] + world[joint].apply(vector)
    np.testing.assert_allclose(moved.positions(dtype=float), places, rtol=0, atol=1e-11 * reach(moved))


@given(walks(), st.data())
def test_a_partial_motion_has_its_joints_where_they_were(
    walk: tuple[Motion, Motion], data: st.DataObject
) -> None:
    motion, moved = walk
    every = range(motion.skeleton.joint_count)
    kept = sorted(data.draw(st.sets(st.sampled_from(every), min_size=1)))
    part = moved.select(kept)
    assert part.skeleton.names == tuple(motion.skeleton.names[joint] for joint in kept)
    np.testing.assert_allclose(
        part.positions(dtype=float),
        motion.positions(dtype=float, joints=kept),
        rtol=0,
        atol=1e-11 * reach(motion),
    )
    turns = np.einsum(
        "fjc,fjc->fj", part.bone_rotations(dtype=float), motion.bone_rotations(dtype=float)[:, kept]
    )
    np.testing.assert_allclose(np.abs(turns), 1, rtol=0, atol=CLOSE)
    assert set(part.roots) >= {motion.skeleton.names[root] for root in moved.skeleton.roots if root in kept}


@given(walks())
def test_what_is_written_as_bvh_is_the_same_motion(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    plain = moved.to_post_rotation()
    assert plain.skeleton.home is None
    joints = range(motion.skeleton.joint_count)
    np.testing.assert_allclose(
        plain.positions(dtype=float, joints=joints),
        motion.positions(dtype=float),
        rtol=0,
        atol=1e-11 * reach(motion),
    )
    plain.rows  # noqa: B018  its channels can say it


@given(walks())
def test_changes_of_the_whole_motion_commute_with_operations(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    metres = moved.with_unit("cm").to_unit("m")
    assert_same_motion(metres, motion.with_unit("cm").to_unit("m"))
    assert forest.home(metres).skeleton == motion.with_unit("cm").to_unit("m").skeleton
    assert_same_motion(moved[1:], motion[1:])
    assert forest.home(moved[1:]).skeleton == motion.skeleton


@given(walks())
def test_dummies_go_and_come_back_in_any_configuration(walk: tuple[Motion, Motion]) -> None:
    motion, moved = walk
    lean = moved.drop_dummies()
    gone = {moved.skeleton.names[joint] for joint in find_dummies(moved)}
    assert set(lean.skeleton.names) == set(motion.skeleton.names) - gone
    assert set(lean.roots) >= set(moved.roots)
    joints = [motion.skeleton.index(name) for name in lean.skeleton.names]
    np.testing.assert_allclose(
        lean.positions(dtype=float),
        motion.positions(dtype=float, joints=joints),
        rtol=0,
        atol=1e-11 * reach(motion),
    )
    if gone:
        assert_same_motion(lean.restore_dummies(), motion)


@given(strategies.symmetric_motions(), st.data())
def test_the_mirror_image_of_a_root_is_a_root(motion: Motion, data: st.DataObject) -> None:
    joint = data.draw(st.integers(0, motion.skeleton.joint_count - 1))
    mirrored = motion.mirror()
    moved = motion.shift_root(joint).mirror()
    assert_same_motion(moved, mirrored)
    assert moved.mirror().skeleton == motion.shift_root(joint).skeleton


def test_an_edited_root_is_joined_by_a_bone_that_moves() -> None:
    motion = gmr.read(demo_folder() / "07_01.bvh")
    foot = motion.split("LeftFoot")
    column = foot.translated.tolist().index(motion.skeleton.index("LeftFoot"))
    translations = foot.translations.copy()
    translations[10:20, column, 1] += 0.5
    pose = foot.pose
    edited = replace(foot, source=Pose(pose.rotations, pose.translated, translations, pose.layout))
    joined = edited.join("LeftFoot")
    assert motion.skeleton.index("LeftFoot") in joined.translated
    wanted = motion.positions(dtype=float)
    wanted[10:20, below(motion.skeleton, "LeftFoot"), 1] += 0.5
    np.testing.assert_allclose(joined.positions(dtype=float), wanted, rtol=0, atol=1e-12 * 100)


def test_a_walk_written_with_its_neck_as_root_is_the_same_picture() -> None:
    motion = gmr.read(demo_folder() / "07_01.bvh")
    again = gmr.read(write_bvh(motion.shift_root("Neck")), format="bvh")
    assert again.roots == ("Neck",)
    places = again.positions(dtype=float, joints=motion.skeleton.names)
    np.testing.assert_allclose(places, motion.positions(dtype=float), rtol=0, atol=1e-10)


def refusals() -> dict[str, tuple[Callable[[Motion], Motion], str]]:
    return {
        "last root": (lambda m: m.join("Hips"), "'Hips' is the last root, and a skeleton needs one"),
        "no root": (lambda m: m.join("Head"), "'Head' is no root.*the root of its tree is 'Hips'"),
        "no link": (lambda m: m.split("Head").join("Hips"), "'Hips' has no soft link.*Join the other roots"),
        "already": (lambda m: m.split("Head").split("Head"), "'Head' is a root already"),
        "unknown": (lambda m: m.split("Haed"), "there is no joint 'Haed'; did you mean 'Head'"),
        "none": (lambda m: m.with_roots([]), "the tree of 'Hips' would have no root; name one of its joints"),
        "twice": (lambda m: m.with_roots(["Head", "Head"]), "'Head' is named twice"),
        "nothing": (lambda m: m.select([]), "no joint is selected"),
        "other tree": (
            lambda m: m.split("Head").shift_root("Head", root="Hips"),
            "'Head' does not hang below the root 'Hips' but below 'Head'",
        ),
    }


@pytest.mark.parametrize("case", refusals())
def test_what_cannot_be_done_is_refused_with_what_to_do(case: str) -> None:
    operation, sentence = refusals()[case]
    with pytest.raises(SkeletonError, match=sentence):
        operation(gmr.read(demo_folder() / "07_01.bvh"))


@settings(max_examples=20)
@given(walks())
def test_motions_pickle_in_any_configuration(walk: tuple[Motion, Motion]) -> None:
    import pickle

    _, moved = walk
    again = pickle.loads(pickle.dumps(moved))
    assert again == moved
    assert forest.home(again) == forest.home(moved)


def test_an_added_tpose_is_seen_in_any_configuration_and_without_dummies() -> None:
    motion = gmr.read(demo_folder() / "07_01.bvh")
    for changed in (motion, motion.drop_dummies(), motion.with_roots(["LeftFoot", "Head"])):
        assert leading_rest_frames(changed) == 1


@pytest.mark.parametrize("threads", [0, 1, 3])
def test_the_bits_do_not_depend_on_the_threads(walk_path: Path, threads: int) -> None:
    walk = gmr.read(walk_path)
    operations: dict[str, Callable[..., Motion]] = {
        "with_roots": lambda **how: walk.with_roots(["Hips", "LeftHand"], **how),
        "shift_root": lambda **how: walk.shift_root("Neck", **how),
        "split": lambda **how: walk.split("LeftHand", **how),
        "join": lambda **how: walk.with_roots(["Head", "LeftHand"]).join("LeftHand", **how),
        "select": lambda **how: walk.select(["Hips", "LeftLeg", "Head"], **how),
        "drop_dummies": lambda **how: walk.shift_root("Neck").drop_dummies(**how),
    }
    for operation in operations.values():
        usual, found = operation(), operation(threads=threads)
        assert found == usual
        assert found.rotations.tobytes() == usual.rotations.tobytes()
        with pytest.raises(ValueError, match="there cannot be -1 threads"):
            operation(threads=-1)
        with pytest.raises(TypeError, match="threads must be a whole number"):
            operation(threads="all")
