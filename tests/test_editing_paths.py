"""Paths that are bent: of the whole body on the ground, of a hand through a point, of two hands on a bar."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
import walkers
from gmr import DatasetError, GmrError, Motion, SkeletonError
from gmr.demo import demo_folder
from gmr.editing import Bar, GroundPath, Limb, grip, ground_path, reach, warp_path
from gmr.formats.bvh import write_bvh
from gmr.frames import Rows
from gmr.skeleton import Skeleton

Floats = NDArray[np.float64]

WALK = gmr.read(demo_folder() / "07_01.bvh")
RUN = gmr.read(demo_folder() / "09_01.bvh")


def bone_lengths(motion: Motion) -> Floats:
    places = motion.positions(dtype=float)
    whole = np.flatnonzero(motion.skeleton.parents >= 0)
    return np.asarray(
        np.linalg.norm(places[:, whole] - places[:, motion.skeleton.parents[whole]], axis=2), np.float64
    )


def jump(motion: Motion) -> float:
    """The largest change of a number of a row from a frame to the next, the added T-pose left out."""
    return float(np.abs(np.diff(motion.rows[3:], axis=0)).max())


# The path on the ground


@settings(max_examples=15)
@given(st.floats(0.6, 1.8), st.floats(-0.9, 0.9), st.floats(-3, 3))
def test_the_path_of_a_walker_is_the_arc_that_it_walks(
    speed: float, turn_rate: float, heading: float
) -> None:
    motion = walkers.walker(3.0, speed, turn_rate, heading=heading)
    path = ground_path(motion)
    times = np.arange(motion.frame_count) / 60
    np.testing.assert_allclose(path.ground, walkers.arc(times, speed, turn_rate, heading), atol=2e-3)
    off = path.heading - heading - turn_rate * times
    np.testing.assert_allclose(off - 2 * np.pi * np.round(off / (2 * np.pi)), 0, atol=2e-3)


@settings(max_examples=15)
@given(st.floats(-150, 150), st.floats(0.5, 2))
def test_a_bent_straight_line_is_an_arc_of_its_length(turn_deg: float, scale: float) -> None:
    straight = GroundPath(np.column_stack([np.zeros(200), np.linspace(1, 4, 200)]), np.zeros(200))
    bent = straight.bent(turn_deg, scale)
    turn = np.radians(turn_deg)
    np.testing.assert_allclose(
        bent.ground - [0, 1], walkers.arc(np.linspace(0, 1, 200), 3 * scale, turn, 0), atol=1e-3
    )
    np.testing.assert_allclose(bent.heading[[0, -1]], np.array([0, turn]), atol=1e-12)
    steps = [np.linalg.norm(np.diff(path.ground, axis=0), axis=1) for path in (straight, bent)]
    np.testing.assert_allclose(steps[1], scale * steps[0], rtol=1e-9)


def test_a_path_passes_through_its_points_and_faces_along_itself() -> None:
    straight = GroundPath(np.column_stack([np.zeros(200), np.linspace(0, 4, 200)]), np.zeros(200))
    path = straight.through({60: (0.5, 1.3), 140: (-0.4, 2.9)})
    wanted = np.array([[0, 0], [0.5, 1.3], [-0.4, 2.9]])
    np.testing.assert_allclose(path.ground[[0, 60, 140]], wanted, atol=1e-12)
    way = np.gradient(path.ground, axis=0)
    np.testing.assert_allclose(path.heading, np.arctan2(way[:, 0], way[:, 1]), atol=1e-9)
    assert np.abs(np.diff(path.ground, 2, axis=0)).max() < 1e-3


def test_the_path_of_a_take_leaves_out_its_added_pose() -> None:
    path = ground_path(WALK)
    np.testing.assert_array_equal(path.ground[0], path.ground[1])
    assert np.linalg.norm(np.diff(path.ground[1:], axis=0), axis=1).max() * gmr_unit() < 0.02


def gmr_unit() -> float:
    return 0.0254 / 0.45


# Another path


def test_a_motion_sent_along_its_own_path_is_itself() -> None:
    assert warp_path(WALK).motion is WALK
    assert warp_path(WALK, ground_path(WALK)).motion is WALK


@settings(max_examples=15)
@given(st.floats(-170, 170), st.tuples(st.floats(-20, 20), st.floats(-20, 20)))
def test_each_frame_is_moved_as_one_rigid_whole(turn_deg: float, shift: tuple[float, float]) -> None:
    before = ground_path(WALK)
    turn = np.radians(turn_deg)
    path = GroundPath(before.ground + shift, before.heading + turn)
    warped = warp_path(WALK, path).motion
    places = WALK.positions(dtype=float) - np.insert(before.ground, 1, 0, axis=1)[:, None]
    cosine, sine = np.cos(turn), np.sin(turn)
    matrix = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    wanted = places @ matrix.T + np.insert(path.ground, 1, 0, axis=1)[:, None]
    np.testing.assert_allclose(warped.positions(dtype=float), wanted, rtol=0, atol=1e-9)


@pytest.mark.parametrize("how", [{"turn_deg": 80}, {"scale": 0.8}, {"via": {200: (12.0, 10.0)}}])
def test_a_warped_motion_keeps_its_bones_and_has_the_path_asked_for(how: dict[str, object]) -> None:
    edited = warp_path(WALK, **how)  # type: ignore[arg-type]
    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(WALK), rtol=0, atol=1e-9)
    assert isinstance(edited.motion.source, Rows)
    assert jump(edited.motion) < jump(WALK) + 3
    np.testing.assert_array_equal(edited.motion.rows[:, 6:], WALK.rows[:, 6:])
    if "via" in how:
        np.testing.assert_allclose(edited.report.path.ground[200], [12, 10], atol=1e-9)


def test_a_warp_makes_feet_slide_and_locking_holds_them() -> None:
    loose, locked = (warp_path(WALK, turn_deg=70, lock=lock) for lock in (False, True))
    assert loose.report.slide_mm.mean() > 1.1 * warp_path(WALK).report.slide_mm.mean()
    assert locked.report.lock is not None
    assert locked.report.lock.slide_after_mm.max() < 1e-6
    np.testing.assert_allclose(bone_lengths(locked.motion), bone_lengths(WALK), rtol=0, atol=1e-9)
    assert "turned by 70.0 degrees at its end" in str(locked.report)
    again = gmr.read(write_bvh(locked.motion), format="bvh")
    np.testing.assert_allclose(again.positions(dtype=float), locked.motion.positions(dtype=float), atol=1e-9)


def test_a_warp_goes_back_where_it_came_from() -> None:
    there = warp_path(WALK, turn_deg=60)
    back = warp_path(there.motion, GroundPath(ground_path(WALK).ground, ground_path(WALK).heading))
    path = ground_path(there.motion)
    np.testing.assert_allclose(path.ground[30:-30], there.report.path.ground[30:-30], atol=0.3)
    np.testing.assert_allclose(
        back.motion.positions(dtype=float)[30:-30], WALK.positions(dtype=float)[30:-30], atol=1
    )


# A hand through a point


def hand(motion: Motion, joint: str = "RightHand") -> Floats:
    return np.asarray(motion.positions(dtype=float, joints=[joint])[:, 0], np.float64)


@settings(max_examples=15)
@given(
    st.tuples(*[st.floats(-3, 3)] * 3),
    st.integers(60, 250),
    st.sampled_from(["RightHand", "LeftFoot", "Head"]),
)
def test_a_joint_is_at_the_point_or_as_near_as_the_report_says(
    way: tuple[float, ...], frame: int, joint: str
) -> None:
    target = hand(WALK, joint)[frame] + way
    edited = reach(WALK, joint, target, frame, window=0.3)
    off = np.linalg.norm(hand(edited.motion, joint)[frame] - target)
    assert off == pytest.approx(edited.report.missed, abs=1e-9)
    assert edited.report.missed == pytest.approx(edited.report.stretch.missed[frame], abs=1e-9)
    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(WALK), rtol=0, atol=1e-9)
    far = np.abs(np.arange(WALK.frame_count) - frame) > 36
    np.testing.assert_array_equal(edited.motion.rows[far], WALK.rows[far])


def test_a_point_within_reach_is_reached_without_a_jump() -> None:
    shoulder = hand(WALK, "RightArm")[100]
    edited = reach(WALK, "RightHand", shoulder + np.array([-2.5, 1.0, 7.0]), 100, window=0.6)
    assert edited.report.missed_mm < 1e-6
    assert jump(edited.motion) < jump(WALK) + 3
    speeds = np.linalg.norm(np.diff(hand(edited.motion), axis=0), axis=1)
    assert (
        np.abs(np.diff(speeds[3:])).max()
        < np.abs(np.diff(np.linalg.norm(np.diff(hand(WALK), axis=0), axis=1)[3:])).max() + 0.05
    )


def test_a_move_that_is_held_is_held() -> None:
    edited = reach(WALK, "RightHand", hand(WALK)[150] + [0.5, 1.0, 0.0], 150, window=0.3, hold=0.1)
    moved = hand(edited.motion) - hand(WALK)
    np.testing.assert_allclose(moved[138:163], np.broadcast_to([0.5, 1.0, 0.0], (25, 3)), atol=1e-9)


def test_reaching_for_where_the_hand_is_changes_nothing() -> None:
    assert reach(WALK, "RightHand", hand(WALK)[100], 100).motion is WALK
    assert reach(WALK, "RightHand", hand(WALK)[-1], -1).report.frame == WALK.frame_count - 1


def test_a_finger_takes_its_hand_along() -> None:
    target = hand(WALK, "RightHandIndex1")[100] + [0.5, 1.0, 0.5]
    edited = reach(WALK, "RightHandIndex1", target, 100)
    np.testing.assert_allclose(hand(edited.motion, "RightHandIndex1")[100], target, atol=1e-9)


def test_a_point_out_of_reach_is_no_error_but_reported() -> None:
    target = hand(WALK)[100] + [0.0, 60.0, 0.0]
    edited = reach(WALK, "RightHand", target, 100)
    arm = [WALK.skeleton.index(name) for name in ("RightArm", "RightForeArm", "RightHand")]
    at = edited.motion.positions(dtype=float, joints=arm)[100]
    straight = np.linalg.norm(np.diff(at, axis=0), axis=1).sum()
    assert np.linalg.norm(at[2] - at[0]) == pytest.approx(straight, abs=1e-9)
    assert edited.report.missed == pytest.approx(np.linalg.norm(target - at[0]) - straight, abs=1e-9)
    assert "mm short of the point" in str(edited.report)


# Hands on a bar


@pytest.mark.parametrize("motion", [WALK, RUN], ids=["walk", "run"])
def test_hands_on_a_bar_that_goes_along_stay_as_far_apart(motion: Motion) -> None:
    edited = grip(motion)
    report = edited.report
    np.testing.assert_array_equal(edited.motion.rows[0], motion.rows[0])  # the pose that a converter added
    left, right = hand(edited.motion, "LeftHand"), hand(edited.motion, "RightHand")
    off = np.abs(np.linalg.norm(left - right, axis=1) - report.spacing)
    lacking = sum(one.missed for one in report.stretch)
    off[0] = 0
    assert (off <= lacking + 1e-9).all()
    assert (off < 1e-9).mean() > 0.7
    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(motion), rtol=0, atol=1e-9)
    middles = [(hand(one, "LeftHand") + hand(one, "RightHand")) / 2 for one in (motion, edited.motion)]
    reached = lacking < 1e-9
    np.testing.assert_allclose(middles[0][reached], middles[1][reached], atol=1e-9)


def carried_bar() -> Bar:
    path = ground_path(WALK)
    ahead = np.stack([np.sin(path.heading), np.zeros(len(path)), np.cos(path.heading)], axis=1)
    return Bar(np.insert(path.ground, 1, 18.0, axis=1) + 6 * ahead, np.cross(ahead, [0, 1, 0]))


def test_hands_hold_a_bar_that_is_carried() -> None:
    bar = carried_bar()
    edited = grip(WALK, bar=bar, spacing=8.0)
    point, along = bar.over(WALK.frame_count)
    for joint, side in (("LeftHand", -4.0), ("RightHand", 4.0)):
        from_bar = hand(edited.motion, joint) - point
        shift = (from_bar * along).sum(axis=1)
        np.testing.assert_allclose((from_bar - shift[:, None] * along)[1:], 0, atol=1e-9)
        np.testing.assert_allclose((shift - side)[1:], np.median(shift - side), atol=1e-9)
    assert edited.report.spacing == 8.0
    assert max(one.greatest for one in edited.report.stretch) < 1e-9


def test_a_fixed_bar_is_held_only_in_its_frames() -> None:
    middle = (hand(WALK, "LeftHand")[150] + hand(WALK, "RightHand")[150]) / 2
    edited = grip(WALK, bar=Bar(middle + np.array([0, 1, 1]), [-1, 0, 0]), frames=(145, 156), blend=0.2)
    assert not (edited.motion.rows[:121] != WALK.rows[:121]).any()
    assert not (edited.motion.rows[180:] != WALK.rows[180:]).any()
    held = hand(edited.motion, "LeftHand")[145:156]
    np.testing.assert_allclose(held, np.broadcast_to(held[0], held.shape), atol=1e-9)
    assert jump(edited.motion) < jump(WALK) + 10


def test_the_order_of_the_hands_is_that_along_the_bar() -> None:
    one, other = grip(WALK), grip(WALK, ("RightHand", "LeftHand"))
    np.testing.assert_allclose(
        one.motion.positions(dtype=float), other.motion.positions(dtype=float), atol=1e-9
    )
    assert [stretch.joint for stretch in other.report.stretch] == ["RightHand", "LeftHand"]


def test_hands_of_one_name_are_told_apart_by_their_places() -> None:
    skeleton = WALK.skeleton
    names = ["Hand" if name in ("LeftHand", "RightHand") else name for name in skeleton.names]
    alike = replace(WALK, skeleton=replace(skeleton, names=tuple(names)))
    hands = skeleton.index("LeftHand"), skeleton.index("RightHand")
    for one, other in (hands, hands[::-1]):
        edited, named = grip(alike, (one, other)), grip(WALK, (one, other))
        assert (edited.motion.positions() == named.motion.positions()).all()
        for mine, theirs in zip(edited.report.stretch, named.report.stretch, strict=True):
            assert (mine.missed == theirs.missed).all()


def nobody() -> Motion:
    skeleton = Skeleton.post_rotation(["dot"], [-1], np.zeros((1, 3)))
    return Motion.from_pose(skeleton, np.zeros((9, 0, 4)), np.zeros((9, 1, 3)), 0.01, unit=1.0)


def refusals() -> dict[str, tuple[Callable[[], object], type[Exception], str]]:
    path = ground_path(WALK)
    short = GroundPath(path.ground[:10], path.heading[:10])
    return {
        "no body": (lambda: ground_path(nobody()), DatasetError, "no joint that is known as hips"),
        "no frames": (lambda: ground_path(WALK[:0]), GmrError, "no frames, so it has no path"),
        "shapes": (lambda: GroundPath(np.zeros((3, 3)), np.zeros(3)), GmrError, "needs .* places and"),
        "finite": (lambda: GroundPath(np.full((3, 2), np.nan), np.zeros(3)), GmrError, "finite numbers"),
        "scale": (lambda: path.bent(scale=0), GmrError, "a scale above 0"),
        "point": (lambda: path.through({5: (1, 2, 3)}), GmrError, "must be x and z"),
        "beyond": (lambda: path.through({999: (1, 2)}), GmrError, "no frame 999.* 0 to 316"),
        "length": (lambda: warp_path(WALK, short), GmrError, "the path has 10 frames, the motion 317"),
        "both": (lambda: warp_path(WALK, path, scale=2), GmrError, "either a path, or via"),
        "joint": (lambda: reach(WALK, "RightHnd", [0, 0, 0], 5), SkeletonError, "did you mean 'RightHand'"),
        "frame": (lambda: reach(WALK, "RightHand", [0, 0, 0], 317), GmrError, "no frame 317.*0 to 316"),
        "empty": (lambda: reach(WALK[:0], "RightHand", [0, 0, 0], 0), GmrError, "has no frames"),
        "target": (lambda: reach(WALK, "RightHand", [0, 0], 5), GmrError, "three coordinates of a point"),
        "window": (lambda: reach(WALK, "RightHand", [0, 0, 0], 5, -1), GmrError, "give seconds, 0 or more"),
        "hips": (lambda: reach(WALK, "Hips", [0, 0, 0], 5), SkeletonError, "'Hips' cannot be placed"),
        "one arm": (lambda: grip(WALK, ("LeftHand", "LeftHandIndex1")), SkeletonError, "one of each arm"),
        "frames": (lambda: grip(WALK, frames=(5, 400)), GmrError, "one past the last of the motion's 317"),
        "bar": (lambda: Bar([0, 0, 0], [0, 0, 0]), GmrError, "direction must not be 0"),
        "bar's shape": (lambda: Bar([0, 0], [1, 0, 0]), GmrError, "point must be"),
        "bar's frames": (lambda: grip(WALK[:9], bar=carried_bar()), GmrError, "moves over 317 frames"),
    }  # fmt: skip


@pytest.mark.parametrize("case", refusals())
def test_what_cannot_be_bent_is_refused_in_words(case: str) -> None:
    call, kind, sentence = refusals()[case]
    with pytest.raises(kind, match=sentence):
        call()


def test_a_limb_can_be_stated() -> None:
    limb = Limb.of(WALK.skeleton, "Spine", "Spine1", "Neck1")
    edited = reach(WALK, "Neck1", hand(WALK, "Neck1")[100] - [0, 0.4, 0], 100, limb=limb)
    assert edited.report.missed < 1e-9
    assert all(one != other for one, other in pairwise(edited.motion.skeleton.names))


def test_a_body_that_cannot_turn_is_not_sent_around_a_bend() -> None:
    none = np.full(WALK.skeleton.joint_count, -1, np.int32)
    statue = replace(WALK.skeleton, slots=none, slot_count=0)
    motion = Motion.from_pose(statue, np.zeros((317, 0, 4)), WALK.translations, 1 / 120, unit=gmr_unit())
    with pytest.raises(
        SkeletonError, match="the bone that ends in 'LHipJoint' has no rotation, so it cannot"
    ):
        warp_path(motion, turn_deg=70)
