"""Contacts of feet, and feet that are held in them."""

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
from gmr.editing import Contact, Contacts, Edited, LockReport, contacts, lock_feet
from gmr.formats.bvh import write_bvh
from gmr.frames import Rows
from gmr.quaternions import multiply, rotated
from gmr.skeleton import Skeleton
from gmr.tpose import leading_rest_frames

Floats = NDArray[np.float64]

WALK = gmr.read(demo_folder() / "07_01.bvh")
RUN = gmr.read(demo_folder() / "09_01.bvh")
CLIPS = {name: gmr.read(demo_folder() / f"{name}.bvh") for name in ("02_01", "07_04", "08_01", "09_05")}
CLIPS |= {"07_01": WALK, "09_01": RUN}
LEGS = {
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
}


def bone_lengths(motion: Motion) -> Floats:
    places = motion.positions(dtype=float)
    whole = np.flatnonzero(motion.skeleton.parents >= 0)
    return np.asarray(
        np.linalg.norm(places[:, whole] - places[:, motion.skeleton.parents[whole]], axis=2), np.float64
    )


def steps_deg(motion: Motion) -> Floats:
    """(F - 1, S) by how much each joint turns from a frame to the next, the added T-pose left out."""
    rotations = motion.rotations[3:]
    cosines = np.abs((rotations[1:] * rotations[:-1]).sum(axis=-1))
    return np.asarray(np.degrees(2 * np.arccos(np.minimum(cosines, 1))), np.float64)


def near_contacts(edited: Edited[LockReport], blends: int) -> NDArray[np.bool_]:
    """(F,) whether a frame is within some blends of a contact."""
    found = np.zeros(edited.motion.frame_count, bool)
    frames = round(blends * 0.1 * edited.motion.fps)
    for one in edited.report.contacts:
        found[max(one.first - frames, 0) : one.end + frames] = True
    return found


def dot(height: Floats, ahead: Floats, fps: float = 100.0) -> Motion:
    """A motion of one joint that goes up and down and ahead, metres."""
    skeleton = Skeleton.post_rotation(["dot"], [-1], np.zeros((1, 3)))
    places = np.stack([np.zeros(len(height)), height, ahead], axis=1)[:, None]
    return Motion.from_pose(skeleton, np.zeros((len(height), 0, 4)), places, 1 / fps, unit=1.0)


def test_a_contact_is_where_a_joint_is_low_and_slow() -> None:
    """Rests for 0.5 s, goes at 2 m/s for 0.5 s 0.2 m higher, and rests again."""
    goes = (np.arange(150) >= 50) & (np.arange(150) < 100)
    motion = dot(np.where(goes, 0.2, 0.0), np.cumsum(goes * 0.02))
    found = contacts(motion, ["dot"])
    edges = [edge for one in found for edge in (one.first, one.end)]
    assert edges == pytest.approx(
        [0, 50, 100, 150], abs=2
    )  # speeds are measured over a thirtieth of a second
    np.testing.assert_array_equal(np.flatnonzero(~found.mask[:, 0]), np.arange(edges[1], edges[2]))


def test_a_contact_needs_the_strict_thresholds_and_reaches_as_far_as_the_loose_ones() -> None:
    speed = np.concatenate(
        [np.full(40, 2.0), np.full(10, 0.5), np.full(30, 0.1), np.full(10, 0.5), np.full(40, 2.0)]
    )
    motion = dot(np.zeros(len(speed)), np.cumsum(speed / 100))
    (one,) = contacts(motion, ["dot"])
    assert one.first == pytest.approx(40, abs=2)
    assert one.end == pytest.approx(90, abs=2)
    assert not len(contacts(motion, ["dot"], speed=(0.05, 0.6)))
    (strict,) = contacts(motion, ["dot"], speed=(0.3, 0.3))
    assert strict.first == pytest.approx(50, abs=2)
    assert len(strict) == strict.end - strict.first
    assert not len(contacts(motion, ["dot"], least=0.6))


def test_a_foot_that_is_held_up_stands_on_nothing() -> None:
    height = np.concatenate([np.zeros(100), np.full(300, 0.3)])
    (one,) = contacts(dot(height, np.zeros(400)), ["dot"])
    assert (one.first, one.end) == pytest.approx((0, 100), abs=2)
    assert len(contacts(dot(height, np.zeros(400)), ["dot"], uneven=0.5)) == 2
    assert not len(contacts(dot(height, np.zeros(400)), ["dot"], ground=-1.0))


def test_contacts_do_not_depend_on_the_unit() -> None:
    walk = WALK.with_unit("cmu")
    assert contacts(walk).intervals == contacts(WALK).intervals == contacts(walk.to_unit("m")).intervals
    assert contacts(WALK).scene.unit.guessed
    assert not contacts(walk).scene.unit.guessed


@pytest.mark.parametrize("name", CLIPS)
def test_feet_of_walks_and_runs_rest_in_turn(name: str) -> None:
    found = contacts(CLIPS[name])
    begins = sorted((one.first, one.joint) for one in found)
    assert len(begins) >= 4
    assert all(one[1] != other[1] for one, other in pairwise(begins))
    seconds = np.array([len(one) for one in found if one.first > 5 and one.end < CLIPS[name].frame_count])
    shortest, longest = (0.1, 0.25) if name.startswith("09") else (0.35, 0.95)
    assert ((seconds / 120 > shortest) & (seconds / 120 < longest)).all()


@pytest.mark.parametrize("name", CLIPS)
def test_locked_feet_do_not_slide_and_bones_keep_their_lengths(name: str) -> None:
    motion = CLIPS[name]
    edited = lock_feet(motion)
    report = edited.report
    assert report.slide_before_mm.min() > 10
    assert report.slide_after_mm.max() < 1e-6
    for one in report.contacts:
        places = edited.motion[one.first : one.end].positions(dtype=float, joints=[one.joint])[:, 0]
        before = motion[one.first : one.end].positions(dtype=float, joints=[one.joint])[:, 0]
        np.testing.assert_allclose(
            places, np.broadcast_to(np.median(before, axis=0), places.shape), atol=1e-9
        )
    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(motion), rtol=0, atol=1e-9)
    assert max(one.greatest for one in report.stretch) < 1e-9


@pytest.mark.parametrize("name", CLIPS)
def test_what_locking_leaves_alone_keeps_its_bits(name: str) -> None:
    motion = CLIPS[name]
    edited = lock_feet(motion)
    assert isinstance(edited.motion.source, Rows)
    changed = edited.motion.rows != motion.rows
    assert not changed[~near_contacts(edited, 2)].any()
    assert not changed[: leading_rest_frames(motion)].any()
    layout = motion.layout
    assert layout is not None
    joints = {
        motion.skeleton.names[joint]
        for joint, (first, end) in enumerate(zip(layout.starts, layout.starts[1:], strict=False))
        if changed[:, first:end].any()
    }
    assert joints <= LEGS


@pytest.mark.parametrize("name", CLIPS)
def test_locking_makes_no_joint_jump(name: str) -> None:
    """No joint turns by ten degrees a frame more than it did, and no knee faster than any in the take."""
    motion = CLIPS[name]
    edited = lock_feet(motion).motion
    assert (steps_deg(edited) - steps_deg(motion)).max() < 10
    layout = motion.layout
    assert layout is not None
    knees = [int(layout.owned_slots[motion.skeleton.index(f"{side}Leg")]) for side in ("Left", "Right")]
    assert steps_deg(edited)[:, knees].max() < max(steps_deg(motion)[:, knees].max(), 6)
    jumps = np.abs(np.diff(edited.rows[3:], axis=0)).max()
    assert jumps < np.abs(np.diff(motion.rows[3:], axis=0)).max() + 10


def test_locked_feet_stay_locked_in_a_file() -> None:
    edited = lock_feet(WALK)
    again = gmr.read(write_bvh(edited.motion), format="bvh")
    assert again.skeleton == WALK.skeleton
    np.testing.assert_allclose(again.positions(dtype=float), edited.motion.positions(dtype=float), atol=1e-9)


def test_locking_what_is_locked_changes_nothing() -> None:
    once = lock_feet(WALK)
    twice = lock_feet(once.motion, once.report.contacts, hold_heading=False, blend=0)
    places = [edited.motion.positions(dtype=float) for edited in (once, twice)]
    np.testing.assert_allclose(places[0], places[1], rtol=0, atol=1e-6)


def test_without_contacts_the_motion_comes_back() -> None:
    none = replace(contacts(WALK), intervals=())
    edited = lock_feet(WALK, none)
    assert edited.motion is WALK
    assert "nothing was locked" in str(edited.report)


def test_hips_that_sink_and_heels_that_lift_both_let_the_legs_reach() -> None:
    nothing, heel, hips = (lock_feet(WALK, too_short=way) for way in ("nothing", "heel", "hips"))
    assert max(one.mm.max() for one in nothing.report.stretch) > 5
    assert nothing.report.slide_after_mm.max() > 1
    assert heel.report.heel_lift_deg.max() > 5
    assert not heel.report.hips_lowered.any()
    assert hips.report.hips_lowered_mm.max() > 5
    assert not hips.report.heel_lift_deg.any()
    for edited in (heel, hips):
        assert edited.report.slide_after_mm.max() < 1e-6
        np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(WALK), rtol=0, atol=1e-9)
    down = (
        WALK.positions(dtype=float, joints=["Hips"])[:, 0]
        - hips.motion.positions(dtype=float, joints=["Hips"])[:, 0]
    )
    np.testing.assert_allclose(down[:, 1], hips.report.hips_lowered, atol=1e-12)
    np.testing.assert_allclose(down[:, [0, 2]], 0, atol=1e-12)


def test_ankles_can_be_held_too() -> None:
    held = contacts(WALK, ["LeftFoot", "RightFoot"])
    edited = lock_feet(WALK, held)
    assert len(held) >= 4
    assert edited.report.slide_after_mm.max() < 1e-6


def test_a_held_foot_does_not_turn_about_the_vertical() -> None:
    def turns(motion: Motion, one: Contact) -> float:
        joints = [motion.skeleton.index(one.joint.replace("ToeBase", part)) for part in ("Foot", "ToeBase")]
        ankle, ball = np.moveaxis(motion[one.first : one.end].positions(dtype=float, joints=joints), 1, 0)
        return float(np.ptp(np.degrees(np.unwrap(np.arctan2(*(ball - ankle)[:, [0, 2]].T)))))

    edited, free = lock_feet(WALK), lock_feet(WALK, hold_heading=False)
    one = edited.report.contacts.of("LeftToeBase")[0]
    assert turns(edited.motion, one) < 0.5 * turns(free.motion, one)


@settings(max_examples=10)
@given(st.floats(0.8, 1.6), st.floats(-0.8, 0.8), st.sampled_from([30.0, 60.0]), st.floats(0.2, 0.7))
def test_made_up_walkers_stand_still_where_they_are_told_to(
    speed: float, turn_rate: float, fps: float, swing: float
) -> None:
    motion = walkers.walker(2.0, speed, turn_rate, fps=fps, swing=swing)
    scene = contacts(motion).scene
    frames = motion.frame_count
    told = (
        Contact("LeftToeBase", frames // 5, frames // 3),
        Contact("RightFoot", frames // 2, frames // 2 + 6),
    )
    held = Contacts(told, ("LeftToeBase", "RightFoot"), frames, scene)
    edited = lock_feet(motion, held)
    np.testing.assert_allclose(bone_lengths(edited.motion), bone_lengths(motion), rtol=0, atol=1e-9)
    lacking = {one.joint: one.missed for one in edited.report.stretch}
    for one, ankle in zip(told, ("LeftFoot", "RightFoot"), strict=True):
        places = edited.motion[one.first : one.end].positions(dtype=float, joints=[one.joint])[:, 0]
        off = np.linalg.norm(places - np.median(places, axis=0), axis=1)
        assert (off <= 2 * lacking[ankle][one.first : one.end].max() + 1e-9).all()


def test_feet_are_found_where_up_is_another_axis() -> None:
    """The walk lying on its side, as files with Z up have it, has the same contacts and locks alike."""
    quarter = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    pose = WALK.pose
    rotations, translations = pose.rotations.copy(), pose.translations.copy()
    rotations[:, 0] = multiply(np.broadcast_to(quarter, rotations[:, 0].shape), rotations[:, 0])
    translations[:, 0] = rotated(np.broadcast_to(quarter, rotations[:, 0].shape), translations[:, 0])
    tipped = Motion.from_pose(WALK.skeleton, rotations, translations, WALK.frame_time, layout=pose.layout)
    found = contacts(tipped)
    assert found.scene.up == "+Z"
    edited = lock_feet(
        tipped[1:], replace(found, intervals=_shifted(found), frame_count=tipped.frame_count - 1)
    )
    assert edited.report.slide_after_mm.max() < 1e-6


def _shifted(found: Contacts) -> tuple[Contact, ...]:
    return tuple(Contact(one.joint, max(one.first - 1, 0), one.end - 1) for one in found)


def test_the_report_says_what_it_guessed() -> None:
    said = str(lock_feet(WALK).report)
    assert "unit guessed from the body: cmu" in said
    assert "5 contacts; a foot slid 67.6 mm in each on average, now 0.0 mm" in said
    assert "guessed" not in str(lock_feet(WALK.with_unit("cmu")).report)


def nobody() -> Motion:
    return dot(np.zeros(20), np.zeros(20))


def refusals() -> dict[str, tuple[Callable[[], object], type[Exception], str]]:
    found = contacts(WALK)
    both = contacts(WALK, ["LeftFoot", "LeftToeBase"])
    twice = replace(found, intervals=(Contact("LeftToeBase", 10, 30), Contact("LeftToeBase", 20, 40)))
    beyond = replace(found, intervals=(Contact("LeftToeBase", 300, 400),))
    return {
        "unknown": (lambda: contacts(WALK, ["LeftToe"]), SkeletonError, "no joint 'LeftToe'; did you mean"),
        "no feet": (lambda: contacts(nobody()), DatasetError, "no feet found: .*Say which are hips"),
        "no unit": (
            lambda: contacts(nobody().with_unit(None), ["dot"]), GmrError, "declare it first",
        ),
        "no time": (lambda: contacts(replace(WALK, frame_time=0.0)), GmrError, "frame time of 0"),
        "named twice": (lambda: contacts(WALK, ["Head", "Head"]), SkeletonError, "named twice"),
        "thresholds": (lambda: contacts(WALK, height=(0.1, 0.05)), GmrError, "not above the second"),
        "least": (lambda: contacts(WALK, least=-1), GmrError, "cannot be shorter than 0 seconds"),
        "one leg": (lambda: lock_feet(WALK, both), SkeletonError, "moved by the limb that ends in"),
        "length": (lambda: lock_feet(WALK[:100], found), GmrError, "of 317 frames, the motion has 100"),
        "overlap": (lambda: lock_feet(WALK, twice), GmrError, "overlap: frames 10 to 29 and 20 to 39"),
        "beyond": (lambda: lock_feet(WALK, beyond), GmrError, "not within the 317 frames"),
        "blend": (lambda: lock_feet(WALK, blend=-1), GmrError, "seconds of blending"),
        "way": (lambda: lock_feet(WALK, too_short="toes"), GmrError, "say what gives way, one of 'both'"),  # type: ignore[arg-type]
    }  # fmt: skip


@pytest.mark.parametrize("case", refusals())
def test_what_cannot_be_locked_is_refused_in_words(case: str) -> None:
    call, kind, sentence = refusals()[case]
    with pytest.raises(kind, match=sentence):
        call()
