"""What every edit of a limb rests on: cut, move the root, join again with every bone as long as it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
import strategies
from gmr import ChannelLayout, Motion, SkeletonError
from gmr.demo import demo_folder
from gmr.editing import Limb, cut_at, limb_of, moved_roots, rejoin
from gmr.editing.limbs import limb_that_moves, path_down
from gmr.editing.nearest_angles import nearest_angles
from gmr.forest import home
from gmr.formats.bvh import write_bvh
from gmr.frames import Rows
from gmr.partial import below
from gmr.skeleton import Skeleton

Floats = NDArray[np.float64]

WALK = gmr.read(demo_folder() / "07_01.bvh")


def bone_lengths(motion: Motion) -> Floats:
    """(F, J - roots) length of every bone at home."""
    skeleton = home(motion).skeleton
    places = motion.positions(dtype=float)
    whole = np.flatnonzero(skeleton.parents >= 0)
    return np.asarray(
        np.linalg.norm(places[:, whole] - places[:, skeleton.parents[whole]], axis=2), np.float64
    )


def foot_moved(motion: Motion, moves: Floats, end: str = "LeftFoot") -> tuple[Motion, Motion]:
    """A motion cut at a foot that was moved, and what comes of joining it."""
    joint = motion.skeleton.index(end)
    places = motion.positions(dtype=float, joints=[joint])[:, 0] + moves
    loose = moved_roots(cut_at(motion, [end]), {joint: places})
    return loose, rejoin(loose, motion).motion


def choices(motion: Motion) -> list[Limb]:
    """The limbs of a random motion, with bones that have a length in every frame and turn by themselves."""
    skeleton, found = home(motion).skeleton, []
    lengths = dict(
        zip(np.flatnonzero(skeleton.parents >= 0).tolist(), bone_lengths(motion).min(axis=0), strict=True)
    )
    for joint in range(skeleton.joint_count):
        try:
            limb = limb_of(skeleton, joint)
        except SkeletonError:
            continue
        joints = [*path_down(skeleton, limb.top, limb.middle), *path_down(skeleton, limb.middle, limb.end)]
        if all(lengths[one] > 0.1 for one in (limb.middle, limb.end)) and len(joints) == 2:
            found.append(limb)
    return found


@st.composite
def limbed_motions(draw: st.DrawFn) -> Motion:
    """A random motion whose first three joints hang on each other by bones that have a length."""
    count = draw(st.integers(3, 8))
    parents = [-1, 0, 1, *(draw(st.integers(0, joint - 1)) for joint in range(3, count))]
    offsets = np.array([draw(strategies.offsets) for _ in parents])
    offsets[1:3][np.abs(offsets[1:3]).max(axis=1) < 1] += [1.0, 2.0, 0.5]
    channels = [draw(strategies.channels(root=parent < 0)) for parent in parents]
    for joint in (1, 2):
        channels[joint] = tuple(name for name in channels[joint] if name.endswith("rotation"))
    names = [f"joint{k}" for k in range(count)]
    turning = [joint for joint, own in enumerate(channels) if own]
    skeleton = Skeleton.post_rotation(names, parents, offsets, turning=turning)
    layout = ChannelLayout.of(skeleton, channels)
    motion = draw(strategies.rows_on(skeleton, layout, draw(st.integers(1, 5))))
    return replace(motion, source=motion.pose) if draw(st.booleans()) else motion


moves = st.floats(-20, 20, allow_nan=False, allow_subnormal=False)


@settings(max_examples=25)
@given(limbed_motions(), st.data())
def test_bones_keep_their_lengths_and_ends_go_where_they_were_put(
    motion: Motion, data: st.DataObject
) -> None:
    limbs = choices(motion)
    assume(limbs)
    limb = data.draw(st.sampled_from(limbs))
    ways = np.array([[data.draw(moves) for _ in range(3)] for _ in range(motion.frame_count)])
    still = np.array([data.draw(st.booleans()) for _ in range(motion.frame_count)])
    ways[still] = 0
    places = motion.positions(dtype=float, joints=[limb.end])[:, 0] + ways
    loose = moved_roots(cut_at(motion, [limb.end]), {limb.end: places})
    edited = rejoin(loose, motion, limbs=[limb])
    reach = 1 + np.abs(motion.positions(dtype=float)).max()

    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(motion), rtol=0, atol=1e-9 * reach)
    (stretch,) = edited.report.stretch
    ends = edited.motion.positions(dtype=float, joints=[limb.end])[:, 0]
    np.testing.assert_allclose(np.linalg.norm(ends - places, axis=1), stretch.missed, atol=1e-7 * reach)
    upper, lower = (
        bone_lengths_of(motion, *pair) for pair in ((limb.top, limb.middle), (limb.middle, limb.end))
    )
    tops = motion.positions(dtype=float, joints=[limb.top])[:, 0]
    way = np.linalg.norm(places - tops, axis=1)
    lacking = np.maximum(np.maximum(way - upper - lower, np.abs(upper - lower) - way), 0)
    np.testing.assert_allclose(stretch.missed, lacking, atol=1e-9 * reach)

    np.testing.assert_array_equal(edited.motion.rotations[still], motion.rotations[still])
    elsewhere = sorted(set(range(motion.skeleton.joint_count)) - set(below(motion.skeleton, limb.top)))
    np.testing.assert_array_equal(
        edited.motion.positions(dtype=float, joints=elsewhere),
        motion.positions(dtype=float, joints=elsewhere),
    )


def bone_lengths_of(motion: Motion, one: int, other: int) -> Floats:
    places = motion.positions(dtype=float, joints=[one, other])
    return np.asarray(np.linalg.norm(places[:, 1] - places[:, 0], axis=1), np.float64)


@settings(max_examples=25)
@given(limbed_motions(), st.data())
def test_joining_what_nobody_moved_gives_the_motion_back(motion: Motion, data: st.DataObject) -> None:
    limbs = choices(motion)
    assume(limbs)
    limb = data.draw(st.sampled_from(limbs))
    joint = data.draw(st.integers(0, motion.skeleton.joint_count - 1))
    moved = motion.shift_root(joint)
    assert rejoin(cut_at(moved, [limb.end]), moved, limbs=[limb]).motion is moved


def test_what_hangs_on_the_end_keeps_its_rotation_in_the_world() -> None:
    _, edited = foot_moved(WALK, np.broadcast_to([0.3, 0.6, 0.2], (WALK.frame_count, 3)))
    feet = [WALK.skeleton.index(name) for name in ("LeftToeBase", "LeftToeBase_end")]
    turns = [motion.bone_rotations(dtype=float)[:, feet] for motion in (WALK, edited)]
    np.testing.assert_allclose(np.abs((turns[0] * turns[1]).sum(axis=-1)), 1, rtol=0, atol=1e-12)


def test_rows_that_were_read_keep_their_bits_where_nothing_moved() -> None:
    ways = np.zeros((WALK.frame_count, 3))
    ways[100:120] = [0.0, 0.4, 0.0]
    _, edited = foot_moved(WALK, ways)
    assert isinstance(edited.source, Rows)
    changed = edited.rows != WALK.rows
    assert not changed[:100].any()
    assert not changed[120:].any()
    layout = WALK.layout
    assert layout is not None
    legs = [layout.rotation_columns[int(layout.owned_slots[WALK.skeleton.index(name)])]
            for name in ("LeftUpLeg", "LeftLeg", "LeftFoot")]  # fmt: skip
    assert set(np.flatnonzero(changed.any(axis=0)).tolist()) <= set(np.concatenate(legs).tolist())


def test_the_configuration_of_the_motion_before_comes_back() -> None:
    turned = WALK.with_roots(["Neck", "RightHand"])
    ways = np.broadcast_to([0.0, 0.5, 0.0], (WALK.frame_count, 3))
    _, edited = foot_moved(turned, ways)
    assert edited.skeleton == turned.skeleton
    _, plain = foot_moved(WALK, ways)
    np.testing.assert_allclose(edited.positions(dtype=float), plain.positions(dtype=float), atol=1e-10)


def test_a_motion_without_its_dummies_is_edited_alike() -> None:
    lean = WALK.drop_dummies()
    ways = np.broadcast_to([0.0, 0.5, 0.0], (WALK.frame_count, 3))
    _, edited = foot_moved(lean, ways)
    _, plain = foot_moved(WALK, ways)
    joints = list(lean.skeleton.names)
    np.testing.assert_allclose(
        edited.positions(dtype=float), plain.positions(dtype=float, joints=joints), rtol=0, atol=1e-10
    )
    back = edited.restore_dummies()
    np.testing.assert_allclose(back.positions(dtype=float), plain.positions(dtype=float), rtol=0, atol=1e-10)


def test_the_hips_go_down_while_the_feet_stay() -> None:
    """The forest at work: hips and feet are roots, and moving the one leaves the others where they are."""
    loose = cut_at(WALK, ["LeftFoot", "RightFoot"])
    hips = WALK.skeleton.index("Hips")
    down = WALK.positions(dtype=float, joints=[hips])[:, 0] - [0.0, 1.0, 0.0]
    edited = rejoin(moved_roots(loose, {hips: down}), WALK)
    feet = ["LeftFoot", "RightToeBase"]
    places = [motion.positions(dtype=float, joints=feet) for motion in (WALK, edited.motion)]
    np.testing.assert_allclose(places[0], places[1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(edited.motion.positions(dtype=float, joints=[hips])[:, 0], down, atol=1e-12)
    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(WALK), rtol=0, atol=1e-9)


def test_a_hinge_gets_the_channels_that_its_new_turns_need() -> None:
    layout = WALK.layout
    assert layout is not None
    names = list(layout.names)
    names[WALK.skeleton.index("LeftLeg")] = ("Xrotation",)
    narrow = replace(layout, names=tuple(names))
    columns = [c for c in range(layout.column_count) if c not in _columns(layout, "LeftLeg")[:2]]
    motion = Motion.from_rows(WALK.skeleton, narrow, WALK.rows[:, columns], WALK.frame_time)
    ways = np.broadcast_to([0.3, 0.5, 0.0], (WALK.frame_count, 3))
    _, edited = foot_moved(motion, ways)
    assert edited.layout is not None
    assert len(edited.layout.names[WALK.skeleton.index("LeftLeg")]) == 3
    again = gmr.read(write_bvh(edited), format="bvh")
    np.testing.assert_allclose(again.positions(dtype=float), edited.positions(dtype=float), atol=1e-9)


def _columns(layout: gmr.ChannelLayout, joint: str) -> list[int]:
    index = WALK.skeleton.index(joint)
    return list(range(int(layout.starts[index]), int(layout.starts[index + 1])))


angles = st.tuples(*[st.floats(-720, 720)] * 3)


@given(
    st.lists(angles, min_size=1, max_size=5),
    st.lists(angles, min_size=5, max_size=5),
    st.permutations(range(3)),
)
def test_the_nearest_angles_name_the_same_rotations(
    found: list[tuple[float, ...]], to: list[tuple[float, ...]], axes: list[int]
) -> None:
    from scipy.spatial.transform import Rotation

    given_, wanted = np.array(found), np.array(to[: len(found)])
    near = nearest_angles(given_, wanted, axes)
    order = "".join("XYZ"[axis] for axis in axes)
    turns = [Rotation.from_euler(order, one, degrees=True) for one in (given_, near)]
    np.testing.assert_allclose((turns[0].inv() * turns[1]).magnitude(), 0, atol=1e-6)
    assert (np.abs(near - wanted).max(axis=1) <= 360).all()


def test_limbs_are_found_by_names_and_else_by_length() -> None:
    skeleton = WALK.skeleton

    def named(limb: Limb) -> tuple[str, ...]:
        return tuple(skeleton.names[joint] for joint in (limb.top, limb.middle, limb.end))

    assert named(limb_of(skeleton, "RightFoot")) == ("RightUpLeg", "RightLeg", "RightFoot")
    assert named(limb_of(skeleton, "LeftHand")) == ("LeftArm", "LeftForeArm", "LeftHand")
    assert named(limb_that_moves(skeleton, "LeftToeBase_end")) == ("LeftUpLeg", "LeftLeg", "LeftFoot")
    assert named(limb_that_moves(skeleton, "RightHandIndex1")) == ("RightArm", "RightForeArm", "RightHand")
    assert named(limb_of(skeleton, "Head")) == ("Neck", "Neck1", "Head")


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda: limb_of(WALK.skeleton, "Hips"),
            "'Hips' cannot be placed: a limb needs two bones.*there is none",
        ),
        (lambda: limb_of(WALK.skeleton, "LeftUpLeg"), "two bones above its end, and there is one"),
        (lambda: Limb.of(WALK.skeleton, "LeftLeg", "LeftUpLeg", "LeftFoot"), "does not hang below 'LeftLeg'"),
        (lambda: Limb.of(WALK.skeleton, "LeftLeg", "LeftLeg", "LeftFoot"), "named twice in a limb"),
        (lambda: cut_at(WALK, ["LeftFot"]), "there is no joint 'LeftFot'; did you mean 'LeftFoot'"),
        (
            lambda: rejoin(cut_at(WALK, ["LeftFoot", "LeftToeBase"]), WALK, limbs=[toes()]),
            "share the bone of 'LeftFoot'; move one of them at a time",
        ),
        (lambda: rejoin(cut_at(WALK, ["LeftFoot"]), WALK.drop_dummies()), "not of the same skeleton"),
        (lambda: rejoin(cut_at(WALK, ["LeftFoot"])[:10], WALK), "has 10 frames, the one before the edit 317"),
    ],
)
def test_what_cannot_be_joined_is_refused_in_words(call, sentence: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(gmr.GmrError, match=sentence):
        call()


def test_a_bone_without_a_rotation_of_its_own_is_not_turned() -> None:
    names, slots = ("root", "still", "turning"), np.array([-1, -1, 0], np.int32)
    parents, ends = np.array([-1, 0, 0], np.int32), np.zeros(3, np.uint8)
    skeleton = Skeleton(names, parents, np.eye(3), slots, 1, ends)
    motion = Motion.from_pose(skeleton, np.tile([0.0, 0, 0, 1], (4, 1, 1)), np.zeros((4, 1, 3)), 0.1)
    half_turn = np.tile([0.0, 1, 0, 0], (4, 1))
    with pytest.raises(SkeletonError, match="ends in 'still' has no rotation of its own"):
        moved_roots(motion, {}, {1: half_turn})
    assert moved_roots(motion, {}, {2: half_turn}).rotations[:, 0].tolist() == half_turn.tolist()


def toes() -> Limb:
    return Limb.of(WALK.skeleton, "LeftLeg", "LeftFoot", "LeftToeBase")
