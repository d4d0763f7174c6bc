"""A motion that is written as GMR and read again is the same motion, bit by bit, in either form."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import gmr
import gmr_reference
import strategies
from gmr import ChannelLayout, FormatError, Motion, Skeleton
from gmr.formats.bvh import read_bvh, write_bvh
from gmr.formats.gmr import gmr_chunks, gmrb_pieces, read_gmr, write_gmr, write_gmrb
from gmr.formats.gmr_content import kept
from gmr.frames import Pose, Rows
from gmr.skeleton import End
from walks import walks_of

any_float = st.floats(allow_nan=False, allow_infinity=False, width=64)
names = st.one_of(
    st.sampled_from(
        ["", "Hips", "left leg", "#1", '"', "{}", "OFFSET", "a\nb", "End", "\ud800", "Füße", "\u2028"]
    ),
    st.text(max_size=6),
)
WRITERS = {"text": write_gmr, "binary": write_gmrb}


def assert_same_bits(found: Motion, motion: Motion) -> None:
    assert found == motion
    assert found.skeleton == motion.skeleton
    assert found.layout == motion.layout
    assert type(found.source) is type(motion.source)
    for one, other in zip(found.source.numbers, motion.source.numbers, strict=True):
        assert one.tobytes() == other.tobytes()
    for a, b in ((found.skeleton, motion.skeleton), (found.skeleton.home, motion.skeleton.home)):
        if a is not None and b is not None:
            assert a.offsets.tobytes() == b.offsets.tobytes()


def in_both_forms(motion: Motion) -> Motion:
    """What reading gives; text and binary give the same."""
    text, binary = read_gmr(write_gmr(motion)), read_gmr(write_gmrb(motion))
    assert_same_bits(text, binary)
    return text


@st.composite
def skeletons(draw: st.DrawFn) -> Skeleton:
    """Any forest with any slots: joints in any order, siblings that share, slots that turn no bone."""
    count = draw(st.integers(1, 6))
    above = [draw(st.integers(-1, joint - 1)) for joint in range(count)]
    place = draw(st.permutations(range(count)))
    parents, slots, used = [-1] * count, [-1] * count, draw(st.integers(0, 1))
    shared: dict[int, list[int]] = {}
    for joint, parent in enumerate(above):
        parents[place[joint]] = place[parent] if parent >= 0 else -1
        known = shared.setdefault(parent, [])
        new = [used] if parent < 0 or draw(st.booleans()) else [used, *known]
        slot = draw(st.sampled_from([*new, -1]))
        used += slot == used
        if slot >= 0:
            known.append(slot)
        slots[place[joint]] = slot
    shape = (count, 3)
    return Skeleton(
        tuple(draw(st.lists(names, min_size=count, max_size=count))),
        np.array(parents, np.int32),
        draw(arrays(np.float64, shape, elements=st.floats(-1e100, 1e100, width=64) | st.just(-0.0))),
        np.array(slots, np.int32),
        used + draw(st.integers(0, 1)),
        draw(arrays(np.uint8, count, elements=st.sampled_from([int(end) for end in End]))),
    )


@st.composite
def strange(draw: st.DrawFn) -> Motion:
    """A motion of such a skeleton, its joints translated in any order."""
    skeleton = draw(skeletons())
    others = [joint for joint in range(skeleton.joint_count) if skeleton.parents[joint] >= 0]
    also = draw(st.lists(st.sampled_from(others), unique=True)) if others else []
    translated = draw(st.permutations([*skeleton.roots, *also]))
    frames = draw(st.integers(0, 3))
    rotations = draw(arrays(np.float64, (frames, skeleton.slot_count, 4), elements=strategies.angles_deg))
    lengths = np.linalg.norm(rotations, axis=2, keepdims=True)
    rotations = np.where(lengths > 0, rotations / np.where(lengths > 0, lengths, 1), [0.0, 0.0, 0.0, 1.0])
    return Motion.from_pose(
        skeleton,
        rotations,
        draw(arrays(np.float64, (frames, len(translated), 3), elements=strategies.lengths)),
        draw(st.floats(1e-4, 10)),
        translated=translated,
        unit=draw(st.none() | st.floats(1e-6, 10)),
    )


read_from_files = strategies.motions(max_joints=8, min_frames=0) | strategies.poses(
    max_joints=8, min_frames=0
)


@given(walks_of(read_from_files))
def test_what_was_read_comes_back_in_any_configuration(walk: tuple[Motion, Motion]) -> None:
    for motion in walk:
        assert_same_bits(in_both_forms(motion), motion)


@given(walks_of(strange()))
def test_any_motion_comes_back_without_the_slots_that_turn_no_bone(walk: tuple[Motion, Motion]) -> None:
    for motion in walk:
        found = in_both_forms(motion)
        assert_same_bits(found, kept(motion))
        assert found.skeleton.names == motion.skeleton.names
        np.testing.assert_array_equal(found.positions(dtype=float), motion.positions(dtype=float))
        turns = found.bone_rotations(dtype=float), motion.bone_rotations(dtype=float)
        np.testing.assert_array_equal(*turns)
        if len(np.setdiff1d(np.arange(motion.skeleton.slot_count), motion.skeleton.slots)) == 0:
            assert_same_bits(found, motion)


@given(walks_of(read_from_files.map(Motion.drop_dummies)))
def test_what_dropped_dummies_leave_behind_is_all_that_is_lost(walk: tuple[Motion, Motion]) -> None:
    _, motion = walk
    found = in_both_forms(motion)
    assert_same_bits(found, kept(motion))
    assert found.dropped is None
    np.testing.assert_array_equal(found.positions(dtype=float), motion.positions(dtype=float))


@given(st.data(), strategies.motions(min_frames=0))
def test_a_bvh_file_goes_through_unchanged(data: st.DataObject, motion: Motion) -> None:
    rows = data.draw(arrays(np.float64, motion.rows.shape, elements=any_float))
    assert isinstance(motion.source, Rows)
    motion = replace(motion, source=Rows(rows, motion.source.layout))
    assert write_bvh(in_both_forms(motion)) == write_bvh(motion)


def test_real_bvh_files_go_through_unchanged(data: Path) -> None:
    for file in sorted(data.glob("*.bvh")):
        motion = read_bvh(file.read_bytes())
        assert_same_bits(in_both_forms(motion), motion)
        assert write_bvh(in_both_forms(motion)) == write_bvh(motion)
        moved = motion.with_roots([7, 20])
        assert_same_bits(in_both_forms(moved), moved)


@given(walks_of(read_from_files))
def test_what_is_written_again_is_the_same_file(walk: tuple[Motion, Motion]) -> None:
    for write in (write_gmr, write_gmrb):
        first = write(walk[1])
        assert write(read_gmr(first)) == first


@given(walks_of(read_from_files), st.data())
def test_what_was_read_back_can_go_on_as_the_motion_would(
    walk: tuple[Motion, Motion], data: st.DataObject
) -> None:
    _, moved = walk
    joint = data.draw(st.integers(0, moved.skeleton.joint_count - 1))
    found = in_both_forms(moved).shift_root(joint)
    wanted = moved.shift_root(joint)
    assert found.skeleton == wanted.skeleton
    np.testing.assert_array_equal(found.translated, wanted.translated)


def test_rows_without_a_column_are_kept_as_a_pose() -> None:
    skeleton = Skeleton.post_rotation(["a"], [-1], [[1, 2, 3]])
    motion = Motion.from_rows(skeleton, ChannelLayout.of(skeleton, [()]), np.empty((4, 0)), 0.1)
    found = in_both_forms(motion)
    assert isinstance(found.source, Pose)
    assert found == motion
    assert found.layout == motion.layout


def test_angles_of_a_joint_on_which_nothing_hangs_are_kept() -> None:
    turn = ("Zrotation", "Xrotation", "Yrotation")
    skeleton = Skeleton.post_rotation(["a", "b"], [-1, 0], [[0, 0, 0], [1, 0, 0]], turning=[0, 1])
    layout = ChannelLayout.of(skeleton, [("Xposition", *turn), turn])
    motion = Motion.from_rows(skeleton, layout, np.arange(14.0).reshape(2, 7), 0.1)
    assert b"Idle Idle Idle" in write_gmr(motion)
    assert_same_bits(in_both_forms(motion), motion)
    pose = replace(motion, source=motion.pose)
    assert_same_bits(in_both_forms(pose), kept(pose))


def test_a_layout_that_does_not_fit_is_left_out(data: Path) -> None:
    motion = gmr.read(data / "cmu_07_01.bvh").split("Head")
    other = ChannelLayout.standard(motion.skeleton)
    pose = motion.pose
    odd = replace(motion, source=Pose(pose.rotations, pose.translated, pose.translations, other))
    assert in_both_forms(odd).layout is None


def test_a_long_motion_comes_in_pieces(data: Path) -> None:
    motion = gmr.read(data / "cmu_07_01.bvh").split("Head")
    pose = motion.pose
    long = replace(
        motion,
        source=Pose(
            np.tile(pose.rotations, (99, 1, 1)), pose.translated, np.tile(pose.translations, (99, 1, 1))
        ),
    )
    assert len(list(gmr_chunks(long))) > 3
    assert_same_bits(in_both_forms(long), long)


@pytest.mark.parametrize("suffix", ["gmr", "gmrb"])
def test_files_are_told_by_their_bytes_whatever_they_are_called(
    suffix: str, data: Path, tmp_path: Path
) -> None:
    motion = gmr.read(data / "cmu_12_01.bvh").shift_root("Head")
    for written in ("gmr", "gmrb"):
        gmr.write(motion, tmp_path / "x.file.gmr", format=written)
        raw = (tmp_path / "x.file.gmr").read_bytes()
        (tmp_path / f"y.{suffix}").write_bytes(raw)
        assert gmr.read(tmp_path / f"y.{suffix}") == motion
        assert gmr.read(raw) == motion
        assert gmr.read(io.BytesIO(raw)) == motion
        assert gmr.read(memoryview(b"#" + raw)[1:]) == motion
    assert gmr.read_folder(tmp_path, threads=1)[f"y.{suffix}"] == motion


def test_binary_is_not_written_as_text() -> None:
    motion = gmr.read(
        write_bvh(gmr.read(b"HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION Frames: 0 Frame Time: 1"))
    )
    with pytest.raises(gmr.GmrError, match="open the file for bytes"):
        gmr.write(motion, io.StringIO(), format="gmrb")
    text = io.StringIO()
    gmr.write(motion, text, format="gmr")
    assert text.getvalue().startswith("GMR 1\n")


@pytest.mark.parametrize("pieces", [gmr_chunks, gmrb_pieces])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_no_number_is_refused_before_anything_is_written(
    pieces: object, value: float, data: Path
) -> None:
    assert callable(pieces)
    motion = gmr.read(data / "cmu_07_01.bvh")
    rows = motion.rows.copy()
    rows[7, 10] = value
    assert motion.layout is not None
    broken = Motion.from_rows(motion.skeleton, motion.layout, rows, 1)
    with pytest.raises(FormatError, match=f"joint 'LeftUpLeg', Yrotation is {value} in frame 7"):
        pieces(broken)
    moved = motion.split("Head")
    rotations, translations = moved.rotations.copy(), moved.translations.copy()
    rotations[3, moved.skeleton.slots[moved.skeleton.index("LeftFoot")], 2] = value
    with pytest.raises(FormatError, match=f"joint 'LeftFoot', Zquaternion is {value} in frame 3"):
        pieces(replace(moved, source=Pose(rotations, moved.translated, translations)))
    translations[5, 1, 1] = value
    with pytest.raises(FormatError, match=f"joint 'Head', Yposition is {value} in frame 5"):
        pieces(replace(moved, source=Pose(moved.rotations, moved.translated, translations)))
    offsets = motion.skeleton.offsets.copy()
    offsets[3, 1] = value
    with pytest.raises(FormatError, match=f"offset of joint '{motion.skeleton.names[3]}'"):
        pieces(replace(motion, skeleton=replace(motion.skeleton, offsets=offsets)))


def test_a_motion_without_joints_is_refused() -> None:
    none = np.zeros(0, np.int32)
    skeleton = Skeleton((), none, np.zeros((0, 3)), none, 0, np.zeros(0, np.uint8))
    motion = Motion.from_pose(skeleton, np.zeros((1, 0, 4)), np.zeros((1, 0, 3)), 1)
    for write in (write_gmr, write_gmrb):
        with pytest.raises(FormatError, match="a motion without joints"):
            write(motion)


@given(walks_of(strange()))
def test_slots_of_a_configuration_are_those_that_the_document_derives(walk: tuple[Motion, Motion]) -> None:
    motion = kept(walk[1])
    skeleton, home = motion.skeleton, motion.skeleton.home or motion.skeleton
    slots, count = gmr_reference.configured_slots(
        home.parents.tolist(), home.slots.tolist(), skeleton.parents.tolist()
    )
    assert skeleton.slots.tolist() == slots
    assert skeleton.slot_count == count
