"""Skeletons: what they refuse, how joints are found, how layouts number what turns and moves."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given

from gmr import ChannelLayout, Motion, Skeleton, SkeletonError
from gmr.skeleton import owned_slots
from strategies import motions


def chain(*names: str) -> Skeleton:
    """Joints that hang each on the one before."""
    count = len(names)
    return Skeleton.post_rotation(names, np.arange(count) - 1, np.zeros((count, 3)), turning=range(count))


@given(motions())
def test_the_slots_of_a_layout_are_those_of_its_skeleton(motion: Motion) -> None:
    layout = motion.layout
    assert layout is not None
    assert layout.fits(motion.skeleton)
    assert len(layout.rotation_columns) == motion.skeleton.slot_count
    columns = np.concatenate([layout.rotation_columns.ravel(), layout.translation_columns.ravel()])
    assert sorted(columns[columns >= 0].tolist()) == list(range(layout.column_count))


@given(motions())
def test_a_skeleton_survives_pickling(motion: Motion) -> None:
    again = pickle.loads(pickle.dumps(motion.skeleton))
    assert again == motion.skeleton
    assert hash(again) == hash(motion.skeleton)


def test_joints_are_found_by_name_and_by_index() -> None:
    skeleton = chain("Hips", "Spine", "Head")
    assert skeleton.index("Spine") == skeleton.index(1) == skeleton.index(np.int64(1)) == 1
    assert skeleton.indices(["Head", 0]).tolist() == [2, 0]


@pytest.mark.parametrize(
    ("joint", "said"),
    [
        ("Spin", "did you mean 'Spine'"),
        ("zzz", "the skeleton has 'Hips'"),
        (3, "joints 0 to 2"),
        (-1, "joints 0 to 2"),
    ],
)
def test_an_unknown_joint_is_answered_with_the_known(joint: str | int, said: str) -> None:
    with pytest.raises(SkeletonError, match=said):
        chain("Hips", "Spine", "Head").index(joint)


def test_a_name_that_two_joints_have_is_ambiguous() -> None:
    with pytest.raises(SkeletonError, match=r"2 joints are named 'Hand'.*by index, 1, 2"):
        chain("Hips", "Hand", "Hand").index("Hand")


@pytest.mark.parametrize(
    ("parents", "said"),
    [([-1, 2, 1], "its own ancestor"), ([-1, 7, 0], "parent 7"), ([-1, -5, 0], "parent -5")],
)
def test_what_is_no_forest_is_refused(parents: list[int], said: str) -> None:
    with pytest.raises(SkeletonError, match=said):
        Skeleton(
            ("a", "b", "c"), np.array(parents, np.int32), np.zeros((3, 3)), np.full(3, -1, np.int32), 0,
            np.zeros(3, np.uint8),
        )  # fmt: skip


def test_arrays_of_another_length_are_refused() -> None:
    with pytest.raises(SkeletonError, match=r"offsets has the shape \(2, 3\) where \(1, 3\) is needed"):
        Skeleton(
            ("a",), np.array([-1], np.int32), np.zeros((2, 3)), np.array([-1], np.int32), 0,
            np.zeros(1, np.uint8),
        )  # fmt: skip


def test_a_joint_owns_a_slot_for_its_children_or_its_channels() -> None:
    parents = np.array([-1, 0, 1, 0], np.int32)
    assert owned_slots(parents).tolist() == [0, 1, -1, -1]
    assert owned_slots(parents, [3]).tolist() == [0, 1, -1, 2]


@pytest.mark.parametrize(
    ("channels", "said"),
    [
        (("Wrotation",), "unknown channel 'Wrotation'"),
        (("Xposition", "xPosition"), "position channel twice"),
        (("Xrotation", "Yrotation", "Zrotation", "Xrotation"), "more than three rotation"),
    ],
)
def test_channels_that_cannot_be_composed_are_refused(channels: tuple[str, ...], said: str) -> None:
    with pytest.raises(SkeletonError, match=said):
        ChannelLayout((channels,), (-1,))


def test_a_joint_without_one_frame_says_whose_bones_differ() -> None:
    skeleton = Skeleton(
        ("Hips", "Left", "Right"), np.array([-1, 0, 0], np.int32), np.ones((3, 3)),
        np.array([-1, 0, 1], np.int32), 2, np.zeros(3, np.uint8),
    )  # fmt: skip
    with pytest.raises(SkeletonError, match="'Left' and 'Right' turn independently"):
        skeleton.frame_slots  # noqa: B018


@pytest.mark.parametrize(
    ("channels", "completed"),
    [
        ("Yrotation", "Yrotation"),
        ("Zrotation Xrotation", "Zrotation Xrotation Yrotation"),
        ("Xposition Yrotation Zrotation", "Xposition Yrotation Zrotation Xrotation"),
        ("Xrotation Yrotation Xrotation", "Xrotation Yrotation Xrotation"),
        ("Xrotation Xrotation Yrotation", "Zrotation Xrotation Yrotation"),
    ],
)
def test_two_angles_are_completed_to_three(channels: str, completed: str) -> None:
    layout = ChannelLayout((tuple(channels.split()),), (-1,))
    assert layout.completed().names == (tuple(completed.split()),)
