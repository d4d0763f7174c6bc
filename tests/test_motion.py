"""The one type: what it holds, what it refuses."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from gmr import ChannelLayout, GmrError, Motion, Skeleton, SkeletonError

ROOT = ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
TURN = ("Zrotation", "Xrotation", "Yrotation")
SKELETON = Skeleton.post_rotation(
    ["Hips", "Spine", "LeftLeg", "LeftLeg_end"],
    [-1, 0, 0, 2],
    [[0, 0, 0], [0, 2, 0], [1, -1, 0], [0, -3, 0]],
    ends=[0, 0, 0, 1],
    turning=[1],
)
LAYOUT = ChannelLayout.of(SKELETON, [ROOT, TURN, ("Xrotation", "Yposition"), ()])


def walker(frames: int = 5) -> Motion:
    rows = np.arange(frames * 11.0).reshape(frames, 11)
    return Motion.from_rows(SKELETON, LAYOUT, rows, 1 / 60, unit=0.01, name="walk.bvh")


def test_slots_are_numbered_in_file_order_and_shared_by_siblings() -> None:
    assert SKELETON.slots.tolist() == [-1, 0, 0, 2]
    assert SKELETON.slot_count == 3


def test_layout_says_which_column_turns_and_moves_what() -> None:
    assert LAYOUT.rotation_columns.tolist() == [[3, 4, 5], [6, 7, 8], [9, -1, -1]]
    assert LAYOUT.rotation_axes[:2].tolist() == [[2, 0, 1], [2, 0, 1]]
    assert LAYOUT.translated.tolist() == [0, 2]
    assert LAYOUT.translation_columns.tolist() == [[0, 1, 2], [-1, 10, -1]]


def test_a_cut_shares_memory_and_a_stride_lasts_longer() -> None:
    motion = walker()
    assert np.shares_memory(motion[1:3].rows, motion.rows)
    assert motion[1:3].rows.tolist() == motion.rows[1:3].tolist()
    assert motion[::2].frame_time == pytest.approx(2 / 60)
    with pytest.raises(TypeError, match="slice"):
        motion[3]  # type: ignore[index]


def test_nothing_of_a_motion_can_be_written_to() -> None:
    mine = np.zeros((2, 11))
    held = Motion.from_rows(SKELETON, LAYOUT, mine, 0.1)
    mine[:] = 7
    assert not held.rows.any()
    for array in (held.rows, SKELETON.offsets, SKELETON.parents, pickle.loads(pickle.dumps(held)).rows):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(AttributeError):
        held.unit = 1.0  # type: ignore[misc]


def test_equality_hash_and_pickle_agree() -> None:
    motion = walker()
    other = pickle.loads(pickle.dumps(motion.with_name("run.bvh")))
    assert motion == other
    assert hash(motion) == hash(other)
    assert motion != motion.with_unit("m")
    assert motion != motion[1:]


@pytest.mark.parametrize("frame_time", [-1.0, float("nan"), float("inf")])
def test_a_frame_lasts_a_finite_time(frame_time: float) -> None:
    with pytest.raises(GmrError, match="seconds"):
        Motion.from_rows(SKELETON, LAYOUT, np.zeros((1, 11)), frame_time)


def test_rows_must_have_a_column_for_each_channel() -> None:
    with pytest.raises(GmrError, match=r"\(frames, 11\)"):
        Motion.from_rows(SKELETON, LAYOUT, np.zeros((3, 10)), 0.1)


def test_a_pose_needs_a_translation_for_every_root() -> None:
    with pytest.raises(SkeletonError, match="root 'Hips' has no translation"):
        Motion.from_pose(SKELETON, np.zeros((1, 3, 4)), np.zeros((1, 1, 3)), 0.1, translated=[1])


def test_repr_tells_name_length_and_unit() -> None:
    assert repr(walker()) == (
        "Motion('walk.bvh', 5 frames at 60 fps = 0.083 s, 4 joints, roots: Hips, unit 0.01 m)"
    )


def test_repr_counts_roots_beyond_a_handful() -> None:
    many = Skeleton.post_rotation(
        [f"root{k}" for k in range(100_000)], np.full(100_000, -1), np.zeros((100_000, 3))
    )
    shown = "roots: root0, root1, root2, root3, root4 and 99995 more"
    assert repr(many) == f"Skeleton(100000 joints, {shown})"
    still = Motion.from_pose(many, np.zeros((1, 0, 4)), np.zeros((1, 100_000, 3)), 0.1)
    assert repr(still) == (
        f"Motion(None, 1 frames at 10 fps = 0.100 s, 100000 joints, {shown}, unit unknown)"
    )


def test_every_public_name_is_there_whatever_was_imported_before() -> None:
    import importlib
    import pkgutil
    import types

    import gmr

    for module in pkgutil.iter_modules(gmr.__path__):
        if module.name != "__main__":
            importlib.import_module(f"gmr.{module.name}")
    for name in gmr.__all__:
        is_module = isinstance(getattr(gmr, name), types.ModuleType)
        assert is_module == (name in gmr._MODULES), name
    with pytest.raises(AttributeError, match="no attribute 'walk'"):
        gmr.walk  # noqa: B018
