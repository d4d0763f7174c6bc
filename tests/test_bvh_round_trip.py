"""A motion that is written and read again is the same motion, bit by bit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gmr import ChannelLayout, FormatError, Motion, Skeleton
from gmr.formats.bvh import bvh_chunks, read_bvh, write_bvh
from gmr.skeleton import End
from strategies import motions, poses

any_float = st.floats(allow_nan=False, allow_infinity=False, width=64)
names = st.one_of(
    st.just(""),
    st.sampled_from(["Hips", "mixamorig:Hips", "left leg", "JOINT", "MOTION", "End Site", "Joint", "ROOT a"]),
    st.text(
        st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"], exclude_characters="{}"), max_size=8
    ).map(lambda name: name.encode().strip().decode()),
)


def assert_same(found: Motion, motion: Motion) -> None:
    assert found.skeleton == motion.skeleton
    assert found.skeleton.offsets.tobytes() == motion.skeleton.offsets.tobytes()
    assert found.rows.tobytes() == motion.rows.tobytes()
    assert found.frame_time == motion.frame_time
    assert layout_of(found).names == layout_of(motion).names


def layout_of(motion: Motion) -> ChannelLayout:
    assert motion.layout is not None
    return motion.layout


def read_back(motion: Motion) -> Motion:
    return read_bvh(write_bvh(motion), positions="add" if layout_of(motion).adds_offset else "replace")


def renamed(motion: Motion, labels: list[str]) -> Motion:
    """The motion with other names for its joints; the names of ends follow."""
    skeleton = motion.skeleton
    found: list[str] = []
    for joint, parent in enumerate(skeleton.parents.tolist()):
        end = skeleton.ends[joint] != End.JOINT
        found.append(f"{found[parent]}_end" if end else labels[joint % len(labels)])
    return replace(motion, skeleton=replace(skeleton, names=tuple(found)))


@given(st.data(), motions(min_frames=0), st.lists(names, min_size=1, max_size=4))
def test_names_hierarchy_channels_offsets_and_values_come_back_bit_identical(
    data: st.DataObject, motion: Motion, labels: list[str]
) -> None:
    motion = renamed(motion, labels)
    rows = data.draw(arrays(np.float64, motion.rows.shape, elements=any_float))
    tips = motion.skeleton.ends == End.TIP
    offsets = data.draw(arrays(np.float64, motion.skeleton.offsets.shape, elements=any_float))
    skeleton = replace(motion.skeleton, offsets=np.where(tips[:, None], 0.0, offsets))
    frame_time = data.draw(st.floats(0, 1e3, exclude_min=True))
    motion = Motion.from_rows(skeleton, layout_of(motion), rows, frame_time)
    assert_same(read_back(motion), motion)


@given(poses())
def test_a_pose_is_written_in_the_euler_orders_of_its_layout(motion: Motion) -> None:
    found = read_back(motion)
    assert found.layout == motion.layout
    reach = 1 + np.abs(motion.positions(dtype=np.float64)).max(initial=0)
    np.testing.assert_allclose(
        found.positions(dtype=np.float64), motion.positions(dtype=np.float64), rtol=0, atol=1e-9 * reach
    )


def test_a_real_file_comes_back_as_it_was(data: Path) -> None:
    files = sorted(data.glob("*.bvh"))
    assert len(files) >= 3
    for file in files:
        motion = read_bvh(file.read_bytes())
        assert_same(read_bvh(write_bvh(motion)), motion)


def test_values_are_written_in_their_shortest_form(data: Path) -> None:
    text = (data / "cmu_12_01.bvh").read_text()
    written = write_bvh(read_bvh(text.encode())).decode().splitlines()
    row = [float(token) for token in text.split("Frame Time:")[1].split("\n")[1].split()]
    start = next(k for k, line in enumerate(written) if line.startswith("Frame Time:")) + 1
    assert written[start].split() == [repr(value).removesuffix(".0") for value in row]


def test_joints_that_are_not_listed_as_files_nest_them_are_written_with_their_own_columns() -> None:
    turn = ("Zrotation", "Xrotation", "Yrotation")
    skeleton = Skeleton.post_rotation(
        ["hips", "left", "right", "left foot"],
        [-1, 0, 0, 1],
        [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, -1, 0]],
        turning=[0, 1, 2, 3],
    )
    layout = ChannelLayout.of(skeleton, [("Xposition", "Yposition", "Zposition", *turn), turn, turn, turn])
    motion = Motion.from_rows(skeleton, layout, np.arange(30.0).reshape(2, 15), 0.5)
    found = read_bvh(write_bvh(motion))
    assert found.skeleton.names == ("hips", "left", "left foot", "left foot_end", "right", "right_end")
    assert found.rows[0].tolist() == [*range(9), 12, 13, 14, 9, 10, 11]
    shown = found.positions(dtype=np.float64)[:, [0, 1, 4, 2]]
    np.testing.assert_array_equal(shown, motion.positions(dtype=np.float64))


def test_tips_that_reading_added_are_not_written() -> None:
    hierarchy = b"HIERARCHY\nROOT a\n{\n\tOFFSET 0 0 0\n\tCHANNELS 1 Xrotation\n}\n"
    text = hierarchy + b"MOTION\nFrames: 1\nFrame Time: 1\n5\n"
    motion = read_bvh(text)
    assert motion.skeleton.names == ("a", "a_end")
    assert write_bvh(motion) == text


def test_a_long_motion_comes_in_pieces(data: Path) -> None:
    motion = read_bvh((data / "cmu_07_01.bvh").read_bytes())
    long = Motion.from_rows(motion.skeleton, layout_of(motion), np.tile(motion.rows, (99, 1)), 1)
    pieces = list(bvh_chunks(long))
    assert len(pieces) > 3
    assert b"".join(pieces) == write_bvh(long)
    assert_same(read_bvh(write_bvh(long)), long)


@pytest.mark.parametrize("name", ["a\nb", "a{b", "a}", " a", "a\t", "a\x00", "a\ud800"])
def test_a_name_that_would_not_read_back_is_refused_before_anything_is_written(name: str) -> None:
    motion = read_bvh(b"HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION Frames: 0 Frame Time: 1")
    with pytest.raises(FormatError, match="cannot stand in a BVH file"):
        bvh_chunks(replace(motion, skeleton=replace(motion.skeleton, names=(name,))))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_no_number_is_refused_with_its_frame_joint_and_channel(
    data: Path, value: float
) -> None:
    motion = read_bvh((data / "cmu_07_01.bvh").read_bytes())
    rows = motion.rows.copy()
    rows[7, 10] = value
    broken = Motion.from_rows(motion.skeleton, layout_of(motion), rows, 1)
    with pytest.raises(FormatError, match=f"joint 'LeftUpLeg', Yrotation is {value} in frame 7"):
        bvh_chunks(broken)
    offsets = motion.skeleton.offsets.copy()
    offsets[3, 1] = value
    with pytest.raises(FormatError, match=f"offset of joint '{motion.skeleton.names[3]}'"):
        bvh_chunks(replace(motion, skeleton=replace(motion.skeleton, offsets=offsets)))
