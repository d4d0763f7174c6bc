"""What operations on motions keep: the laws, on random motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from gmr import ChannelLayout, GmrError, Motion, Skeleton, SkeletonError
from gmr.concatenation import concatenate
from gmr.dummies import find_dummies
from gmr.sides import pair_joints
from strategies import motions, poses, symmetric_motions

either = st.one_of(motions(), poses())


def close(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> None:
    """Equal to rounding at the size of what is compared."""
    scale = 1 + np.abs(wanted).max(initial=0)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * scale)


def places(motion: Motion) -> NDArray[np.float64]:
    return motion.positions(dtype=np.float64)


@given(either, st.data())
def test_parts_of_a_motion_put_end_to_end_are_the_motion(motion: Motion, data: st.DataObject) -> None:
    cut = data.draw(st.integers(0, motion.frame_count))
    assert concatenate([motion[:cut], motion[cut:]]) == motion


@given(either, st.data())
def test_a_cut_shows_the_same_frames(motion: Motion, data: st.DataObject) -> None:
    part = data.draw(st.slices(motion.frame_count))
    close(places(motion[part]), places(motion)[part])


@given(motions())
def test_rows_and_their_pose_show_the_same(motion: Motion) -> None:
    close(places(replace(motion, source=motion.pose)), places(motion))


@given(motions())
def test_rows_made_from_a_pose_show_the_same(motion: Motion) -> None:
    pose = replace(motion, source=motion.pose)
    assert pose.layout is not None
    again = Motion.from_rows(motion.skeleton, pose.layout, pose.rows, motion.frame_time)
    close(places(again), places(motion))


@given(symmetric_motions(), st.booleans())
def test_mirroring_twice_gives_back_every_bit(motion: Motion, as_pose: bool) -> None:
    if as_pose:
        motion = replace(motion, source=motion.pose)
    assert motion.mirror().mirror() == motion


@given(symmetric_motions(), st.booleans())
def test_a_mirrored_motion_is_the_mirror_image(motion: Motion, as_pose: bool) -> None:
    if as_pose:
        motion = replace(motion, source=motion.pose)
    pair = pair_joints(motion.skeleton)
    close(places(motion.mirror())[:, pair], places(motion) * (-1, 1, 1))


@given(symmetric_motions())
def test_mirroring_and_dropping_dummies_can_be_exchanged(motion: Motion) -> None:
    pair, dummies = pair_joints(motion.skeleton), find_dummies(motion)
    if set(pair[list(dummies)].tolist()) != set(dummies):
        with pytest.raises(SkeletonError, match="was a dummy and is dropped"):
            motion.drop_dummies().mirror()
        return
    mirrored = motion.drop_dummies().mirror()
    close(places(mirrored), places(motion.mirror().drop_dummies()))
    close(places(mirrored.restore_dummies()), places(motion.mirror()))


@given(either)
def test_dropping_dummies_moves_no_joint_that_stays(motion: Motion) -> None:
    lean = motion.drop_dummies()
    assert not lean.dummies
    kept = [j for j, name in enumerate(motion.skeleton.names) if name not in motion.dummies]
    assert lean.skeleton.names == tuple(motion.skeleton.names[j] for j in kept)
    close(places(lean), places(motion)[:, kept])
    turned = motion.bone_rotations(dtype=np.float64)[:, kept]
    same = np.abs((lean.bone_rotations(dtype=np.float64) * turned).sum(axis=-1))
    np.testing.assert_allclose(same, 1, atol=1e-12)


@given(either)
def test_dropped_dummies_can_be_restored(motion: Motion) -> None:
    restored = motion.drop_dummies().restore_dummies()
    assert restored.skeleton == motion.skeleton
    assert restored.layout == motion.layout
    assert restored.dropped is None
    close(places(restored), places(motion))
    close(restored.translations, motion.translations)


@given(symmetric_motions(), st.data())
def test_restored_dummies_bring_back_every_value_that_was_read(motion: Motion, data: st.DataObject) -> None:
    part = data.draw(st.slices(motion.frame_count))
    motion = motion.with_unit("m")
    lean = motion.drop_dummies()
    assert lean.restore_dummies() == motion
    assert lean[part].restore_dummies() == motion[part]
    assert lean.to_unit("cm").restore_dummies() == motion.to_unit("cm")
    assert concatenate([lean, lean]).restore_dummies() == concatenate([motion, motion])
    pair, dummies = pair_joints(motion.skeleton), find_dummies(motion)
    if set(pair[list(dummies)].tolist()) == set(dummies):
        assert lean.mirror().restore_dummies() == motion.mirror()


@given(either)
def test_a_post_rotation_file_gets_only_the_dummies_that_it_needs(motion: Motion) -> None:
    lean = motion.drop_dummies()
    ready = lean.to_post_rotation()
    assert set(lean.skeleton.names) <= set(ready.skeleton.names) <= set(motion.skeleton.names)
    again = Motion.from_rows(ready.skeleton, ready.layout, ready.rows, ready.frame_time)  # type: ignore[arg-type]
    close(places(again)[:, ready.skeleton.indices(lean.skeleton.names)], places(lean))
    for dummy in set(ready.skeleton.names) - set(lean.skeleton.names):
        joint = ready.skeleton.index(dummy)
        own = ready.layout.owned_slots[joint]  # type: ignore[union-attr]
        assert len(ready.skeleton.children[ready.skeleton.parents[joint]]) > 1
        assert np.abs(ready.rotations[:, own, :3]).max() > 0


@given(motions())
def test_slots_in_another_order_are_renumbered_for_a_file(motion: Motion) -> None:
    backwards = motion.skeleton.slot_count - 1
    shuffled = replace(
        motion,
        skeleton=replace(
            motion.skeleton, slots=np.where(motion.skeleton.slots >= 0, backwards - motion.skeleton.slots, -1)
        ),
        source=replace(motion.pose, rotations=motion.rotations[:, ::-1], layout=None),
    )
    ready = shuffled.to_post_rotation()
    again = Motion.from_rows(ready.skeleton, ready.layout, ready.rows, ready.frame_time)  # type: ignore[arg-type]
    close(places(again), places(motion))


def test_siblings_that_turn_on_their_own_are_rows_through_a_dummy_joint() -> None:
    skeleton = Skeleton(
        ("Hips", "Left", "Right"), np.array([-1, 0, 0], np.int32), np.ones((3, 3)),
        np.array([-1, 0, 1], np.int32), 2, np.zeros(3, np.uint8),
    )  # fmt: skip
    still = np.tile([0.0, 0.0, 0.0, 1.0], (1, 2, 1))
    motion = Motion.from_pose(skeleton, still, np.zeros((1, 1, 3)), 0.1)
    assert motion.to_post_rotation().skeleton.names == ("Hips", "Left", "Right", "Hips_to_Right")
    with pytest.raises(SkeletonError, match="independently of their siblings"):
        motion.rows  # noqa: B018


@given(either, st.sampled_from(["m", "mm", "in"]))
def test_another_unit_scales_positions_and_comes_back(motion: Motion, unit: str) -> None:
    motion = motion.with_unit("cm")
    scaled = motion.to_unit(unit)
    assert motion.unit is not None
    assert scaled.unit is not None
    close(places(scaled) * scaled.unit, places(motion) * motion.unit)
    assert motion.to_unit("cm") is motion


@given(motions())
def test_a_motion_of_unknown_unit_is_not_converted(motion: Motion) -> None:
    with pytest.raises(GmrError, match="with_unit"):
        motion.with_unit(None).to_unit("m")


@given(either)
def test_resampling_to_the_same_rate_is_the_motion_itself(motion: Motion) -> None:
    assert motion.resample(motion.fps) is motion


@given(either, st.integers(2, 4))
def test_every_nth_frame_of_a_finer_motion_is_the_motion(motion: Motion, times: int) -> None:
    fine = motion.resample(motion.fps * times)
    assert fine.frame_count == (motion.frame_count - 1) * times + 1
    close(places(fine)[::times], places(motion))
    close(places(fine.resample(motion.fps)), places(motion))


@given(poses(min_frames=2), st.integers(2, 4))
def test_resampling_backwards_is_resampling_read_backwards(motion: Motion, times: int) -> None:
    dots = np.abs((motion.rotations[1:] * motion.rotations[:-1]).sum(axis=-1))
    assume((dots > 1e-6).all())  # a half turn may go either way
    fps = motion.fps * times
    close(places(motion[::-1].resample(fps)), places(motion.resample(fps)[::-1]))


@given(motions(), st.integers(2, 4))
def test_a_resampled_file_can_be_written_as_rows(motion: Motion, times: int) -> None:
    fine = motion.resample(motion.fps * times)
    assert fine.layout is not None
    again = Motion.from_rows(fine.skeleton, fine.layout, fine.rows, fine.frame_time)
    close(places(again), places(fine))


def one_joint(turns: tuple[str, ...], rotation: tuple[float, float, float, float]) -> Motion:
    """Two frames of a root with these channels: at rest, then turned."""
    skeleton = Skeleton.post_rotation(["Hips", "Tip"], [-1, 0], [[0, 0, 0], [0, 1, 0]])
    layout = ChannelLayout.of(skeleton, [("Xposition", "Yposition", "Zposition", *turns), ()])
    turned = [[(0.0, 0.0, 0.0, 1.0)], [rotation]]
    return Motion.from_pose(skeleton, turned, np.zeros((2, 1, 3)), 0.1, layout=layout)


@pytest.mark.parametrize("turns", [(), ("Zrotation",), ("Zrotation", "Xrotation"), ("Zrotation",) * 3])
def test_a_turn_that_the_channels_cannot_say_is_refused(turns: tuple[str, ...]) -> None:
    about_y = (0.0, 0.5**0.5, 0.0, 0.5**0.5)
    motion = one_joint(turns, about_y)
    with pytest.raises(SkeletonError, match=r"joint 'Hips' turns in frame 1 .*layout=None"):
        _ = motion.rows
    freed = replace(motion, source=replace(motion.pose, layout=None))
    assert freed.rows[1].tolist() == pytest.approx([0, 0, 0, 0, 0, 90])


def test_a_turn_that_fewer_channels_can_say_is_written() -> None:
    about_z = (0.0, 0.0, np.sin(0.3), np.cos(0.3))
    for turns in (("Zrotation",), ("Zrotation", "Xrotation"), ("Zrotation",) * 3):
        rounded = tuple(np.float32(value).item() for value in about_z)
        written = one_joint(turns, rounded).rows[1, 3:]  # type: ignore[arg-type]
        assert written.sum() == pytest.approx(np.degrees(0.6), abs=1e-5)


def test_a_frame_time_cut_off_in_print_counts_as_the_rate_that_was_meant() -> None:
    motion = motions_of(121, 0.0083333)
    assert motion.resample(120) is motion
    half = motion.resample(60)
    assert half.frame_count == 61
    assert half.frame_time == 1 / 60
    assert np.array_equal(half.rows, motion.rows[::2])


@pytest.mark.parametrize("fps", [0.0, -30.0, float("nan"), float("inf")])
def test_a_rate_is_above_zero(fps: float) -> None:
    with pytest.raises(GmrError, match="above 0"):
        motions_of(3, 0.1).resample(fps)


def test_motions_that_are_not_alike_are_not_concatenated() -> None:
    motion = motions_of(3, 0.1)
    with pytest.raises(GmrError, match=r"resample\(10\)"):
        concatenate([motion, motions_of(3, 0.2)])
    with pytest.raises(GmrError, match="to_unit"):
        concatenate([motion, motion.with_unit("m")])
    with pytest.raises(GmrError, match="at least one"):
        concatenate([])


def motions_of(frames: int, frame_time: float) -> Motion:
    """One joint that goes along x."""
    skeleton = Skeleton.post_rotation(["Hips"], [-1], [[0, 0, 0]], turning=[0])
    layout = ChannelLayout.of(skeleton, [("Xposition",)])
    return Motion.from_rows(skeleton, layout, np.arange(float(frames))[:, None], frame_time)
