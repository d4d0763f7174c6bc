"""No file makes the BVH reader crash, hang or take memory beyond its own size."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bvh_text import WALK, read_quietly, walk
from gmr import FormatError, FormatWarning, Motion
from gmr.formats.bvh import read_bvh, write_bvh
from hostile import Change, changed, changes, cut_anywhere, peak_of, refused_or_read

DEEP = 100_000


def attempt(data: bytes) -> Motion | None:
    return refused_or_read(lambda: read_bvh(data))


def test_a_file_cut_anywhere_is_refused_or_read_as_far_as_it_goes() -> None:
    whole = read_bvh(walk())
    for data in (walk(), WALK.replace("\n", "\r\n").encode(), WALK.encode("utf-16")):
        for motion, is_said in cut_anywhere(data, read_bvh):
            assert motion.skeleton == whole.skeleton
            full = motion.rows[:1] if len(motion.rows) == 2 else motion.rows
            assert full.tolist() == whole.rows[: len(full)].tolist()
            assert is_said or len(motion.rows) == 2


WORDS = [
    b"{", b"}", b"nan", b"1e400", b"-", b"\0", b"\r", b"MOTION", b"JOINT a {", b"End Site", b"9" * 40,
]  # fmt: skip


@given(changes(WORDS))
def test_a_file_with_anything_in_it_is_refused_or_reads_back_as_it_was_read(some: list[Change]) -> None:
    data = changed(WALK.encode(), some)
    motion = attempt(data)
    if motion is not None and motion.layout is not None:
        again = read_bvh(write_bvh(motion))
        assert again.skeleton == motion.skeleton
        assert again.rows.tobytes() == motion.rows.tobytes()


@given(st.binary(max_size=300))
def test_any_bytes_after_the_keyword_are_refused_or_read(data: bytes) -> None:
    attempt(b"HIERARCHY ROOT " + data)
    attempt(b"HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation } MOTION Frames: 9 Frame Time: 1\n" + data)


def test_joints_may_be_nested_as_deeply_as_memory_allows() -> None:
    head = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation "
    chain = "JOINT b { OFFSET 0 1 0 " * DEEP + "}" * (DEEP + 1)
    motion = read_bvh(f"{head}{chain} MOTION Frames: 1 Frame Time: 1\n90\n".encode())
    assert motion.skeleton.joint_count == DEEP + 1
    written = write_bvh(motion)
    assert len(written) < 100 * DEEP * 3
    assert read_bvh(written) == motion


@pytest.mark.parametrize(
    "text",
    [
        "{" * DEEP,
        "HIERARCHY " + "{" * DEEP,
        "HIERARCHY ROOT a { OFFSET 0 0 0 " + "End Site { OFFSET 0 0 0 } " * DEEP,
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 3 " + "Xrotation " * DEEP,
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation } MOTION Frames: 1 Frame Time: 1\n"
        + "1 " * DEEP,
        "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation } MOTION Frames: 1 Frame Time: 1\n"
        + "9" * DEEP,
        "HIERARCHY" + " \n" * DEEP,
        "HIERARCHY ROOT " + "a" * DEEP,
        "HIERARCHY " + "ROOT a { OFFSET 0 0 0 JOINT b { JOINT c { " * 9_999,
        "\r" * DEEP,
    ],
)
def test_endless_repetition_is_refused(text: str) -> None:
    with pytest.raises(FormatError):
        read_bvh(text.encode())


def test_many_odd_names_are_said_once() -> None:
    roots = b"ROOT \xe9 { OFFSET 0 0 0 }\n" * 20_000
    with pytest.warns(FormatWarning) as caught:
        motion = read_bvh(b"HIERARCHY " + roots)
    assert len(motion.skeleton.roots) == 20_000
    assert len(caught) == 2  # the names, and no MOTION


@pytest.mark.parametrize("count", ["1000000000000000000", "9" * 19, "9" * 5000, "0" * 5000 + "3"])
def test_a_declared_count_costs_no_memory(count: str) -> None:
    data = walk(("Frames: 2", f"Frames: {count}"))
    with pytest.warns(FormatWarning, match="frames are declared, but 2 are there"):
        assert peak_of(lambda: read_bvh(data)) < 200_000
    assert len(read_quietly(data).rows) == 2


def test_frames_without_channels_are_not_counted_on() -> None:
    data = b"HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION Frames: 1000000000000000 Frame Time: 1"
    with pytest.warns(FormatWarning, match="frames are declared, but 0 are there"):
        assert read_bvh(data).rows.shape == (0, 0)


def test_rows_take_no_more_memory_than_their_text_has_room_for(data: Path) -> None:
    text = (data / "cmu_07_01.bvh").read_bytes().replace(b"Frames: 60", b"Frames: 6000000")
    assert b"6000000" in text
    assert len(read_quietly(text).rows) == 60
    assert peak_of(lambda: read_quietly(text)) < 8 * len(text)
