"""No file makes the GMR readers crash, hang or take memory beyond its own size."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gmr import FormatError, FormatWarning, Motion
from gmr.formats.gmr import read_gmr, write_gmr, write_gmrb
from hostile import Change, changed, changes, cut_anywhere, overwritten, peak_of, refused_or_read

VALID = Path(__file__).parent / "data" / "gmr" / "valid"
TEXTS = [(VALID / f"{name}.gmr").read_bytes() for name in ("arm", "rows", "cut_and_turned_over", "names")]
BINARIES = [(VALID / f"{name}.gmrb").read_bytes() for name in ("arm", "rows", "cut_and_turned_over", "names")]
DEEP = 100_000
ROOT = "GMR 1 ROOT a { OFFSET 0 0 0 CHANNELS 3 Xposition Yposition Zposition "
MOTION = " MOTION Frames: 1 Frame Time: 1\n"


def attempt(data: bytes) -> Motion | None:
    return refused_or_read(lambda: read_gmr(data, name="some.gmr"), "some.gmr")


@pytest.mark.parametrize("data", TEXTS)
def test_a_text_cut_anywhere_is_refused_or_read_as_far_as_it_goes(data: bytes) -> None:
    whole = read_gmr(data)
    for motion, is_said in cut_anywhere(data, read_gmr):
        assert motion.skeleton == whole.skeleton
        assert motion.frame_count <= whole.frame_count
        assert is_said or motion.frame_count == whole.frame_count


@pytest.mark.parametrize("data", BINARIES)
def test_a_binary_file_cut_anywhere_is_refused(data: bytes) -> None:
    for length in range(len(data)):
        assert attempt(data[:length]) is None


WORDS = [
    b"{", b"}", b"nan", b"1e400", b"-", b"\0", b"\r", b"MOTION", b'"', b"#2", b"TURN 1", b"TOP 0 0 0",
    b"LINK Elbow 25 0 0", b"NUMBER 1", b"ROOT a {", b"End Site {", b"CHANNELS 1 Idle",
    b"POST replace", b"TRANSLATED 2 0 1", b"KIND Site",
    b"9" * 40, b"\\ud800", b"[", b"null", b"-1", b"true",
]  # fmt: skip


@given(changes(WORDS), st.sampled_from(TEXTS + BINARIES), st.booleans())
def test_a_file_with_anything_in_it_is_refused_or_reads_back_as_it_was_read(
    some: list[Change], data: bytes, keeps_length: bool
) -> None:
    motion = attempt(overwritten(data, some) if keeps_length else changed(data, some))
    if motion is None:
        return
    try:
        text, binary = write_gmr(motion), write_gmrb(motion)
    except FormatError as error:
        assert "cannot say" in str(error)  # noqa: PT017  binary files may hold NaN
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        assert read_gmr(text) == read_gmr(binary) == motion


@given(st.binary(max_size=300))
def test_any_bytes_after_the_beginning_are_refused_or_read(data: bytes) -> None:
    attempt(b"GMR 1 ROOT " + data)
    attempt(ROOT.encode() + b"}" + MOTION.encode() + data)
    attempt(len(data).to_bytes(8, "little") + b"{" + data)


def test_joints_may_be_nested_as_deeply_as_memory_allows() -> None:
    chain = "JOINT b { OFFSET 0 1 0 " * DEEP + "}" * (DEEP + 1)
    motion = read_gmr(f"{ROOT}{chain}{MOTION}1 2 3\n".encode())
    assert motion.skeleton.joint_count == DEEP + 1
    written = write_gmr(motion)
    assert len(written) < 100 * DEEP * 3
    assert read_gmr(written) == motion
    part = motion.select(range(DEEP // 10))
    turned = part.shift_root(DEEP // 10 - 1).split(DEEP // 20)
    assert read_gmr(write_gmr(turned)) == turned
    assert read_gmr(write_gmrb(turned)) == turned


@pytest.mark.parametrize(
    "text",
    [
        "{" * DEEP,
        "GMR 1 ROOT " + "{" * DEEP,
        ROOT + "End Site { OFFSET 0 0 0 " * DEEP,
        "GMR 1 ROOT a { CHANNELS 3 " + "Xrotation " * DEEP,
        "GMR 1 ROOT a { POST 3 " + "Idle " * DEEP,
        "GMR 1" + " \n" * DEEP,
        "GMR " + "1" * DEEP,
        "GMR 1 TRANSLATED " + "1 " * DEEP,
        "GMR 1 ROOT " + "a" * DEEP,
        'GMR 1 ROOT "' + "a" * DEEP,
        'GMR 1 ROOT "' + "\\" * DEEP,
        "GMR 1 ROOT #" + "9" * DEEP,
        ROOT + "LINK #" + "9" * DEEP,
        ROOT + "TURN " + "9" * DEEP,
        ROOT + "TURN 1 " * DEEP,
        ROOT + "}" + MOTION + "1 " * DEEP,
        ROOT + "}" + MOTION + "9" * DEEP,
        f"GMR 1 ROOT {'a' * DEEP} {{ OFFSET 0 0 0 " + "End Site { OFFSET 0 0 0 } " * DEEP + "}" + MOTION,
        ROOT + "JOINT b { OFFSET 0 0 0 TOP 0 0 0 " * DEEP + "}" * (DEEP + 1) + MOTION,
    ],
)
def test_endless_repetition_is_refused(text: str) -> None:
    assert attempt(text.encode()) is None


def test_trees_that_hang_on_each_other_in_a_long_circle_are_refused() -> None:
    count = 20_000
    trees = "".join(
        f"ROOT j{k} {{ OFFSET 0 0 0 LINK j{(k + 1) % count} 0 0 0 "
        "CHANNELS 3 Xposition Yposition Zposition }\n"
        for k in range(count)
    )
    with pytest.raises(FormatError, match="hangs on 'j1', which hangs on it in turn"):
        read_gmr(f"GMR 1\n{trees}{MOTION}".encode())


def test_as_many_roots_as_one_likes_are_read_written_and_joined() -> None:
    block = "{ OFFSET 0 1 0 LINK r0 0 1 0 CHANNELS 3 Xposition Yposition Zposition }\n"
    roots = "".join(f"ROOT r{k} {block}" for k in range(1, DEEP // 5))
    motion = read_gmr(f"{ROOT.replace(' a ', ' r0 ')}}}\n{roots}{MOTION}{'0 1 0 ' * (DEEP // 5)}\n".encode())
    assert len(motion.roots) == DEEP // 5
    assert read_gmr(write_gmr(motion)) == motion
    assert motion.with_roots(["r0"]).roots == ("r0",)
    assert motion.select(range(1, DEEP // 5)).roots == motion.roots[1:]


@pytest.mark.parametrize("count", ["1000000000000000000", "9" * 19, "9" * 5000, "0" * 5000 + "3"])
def test_a_declared_count_costs_no_memory(count: str) -> None:
    data = TEXTS[0].replace(b"Frames: 2", f"Frames: {count}".encode())
    with pytest.warns(FormatWarning, match="are declared, but 2 are there"):
        assert peak_of(lambda: read_gmr(data)) < 300_000


@pytest.mark.parametrize(
    ("blocks", "said"),
    [
        ("} ROOT b { OFFSET 0 0 0 " * 5000, "a root without position channels"),
        ("JOINT b { OFFSET 0 0 0 TURN 9 } " * 5000, "lower numbers turn no bone|no rotation channels"),
        ("JOINT b { OFFSET 0 0 0 TURN 0 } " * 5000, "no rotation channels"),
    ],
)
def test_numbers_that_no_column_gives_take_no_memory(blocks: str, said: str) -> None:
    """5,000 joints in 20,000 frames of 60 kB would be 3 GB of rotations."""
    data = (ROOT + blocks + "}" + MOTION.replace("1 Frame", "20000 Frame") + "0 0 0\n" * 20_000).encode()

    def refused() -> None:
        with pytest.raises(FormatError, match=said):
            read_gmr(data)

    assert peak_of(refused) < 100 * len(data)


def header_of(data: bytes) -> dict[str, dict[str, object]]:
    found: dict[str, dict[str, object]] = json.loads(data[8 : 8 + int.from_bytes(data[:8], "little")])
    return found


def container(header: object, rest: bytes = b"") -> bytes:
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return len(text).to_bytes(8, "little") + text + rest


@pytest.mark.parametrize("claimed", [1 << 60, 1 << 63, (1 << 64) - 1, 1 << 24, 101])
def test_a_claimed_header_costs_no_memory(claimed: int) -> None:
    data = claimed.to_bytes(8, "little") + b"{" + b" " * 99
    assert peak_of(lambda: attempt(data)) < 100_000
    assert attempt(data) is None


def test_a_header_that_is_too_long_is_refused_unread() -> None:
    length = (1 << 24) + 8
    data = length.to_bytes(8, "little") + b"{" + b" " * length
    assert peak_of(lambda: attempt(data)) < 100_000
    with pytest.raises(FormatError, match="more than 16,777,216 are not read"):
        read_gmr(data)


@pytest.mark.parametrize("shape", [[10**18, 0, 4], [0, 10**18, 4], [2**40, 2**40, 4], [10**18]])
@pytest.mark.parametrize("key", ["rotations", "translations", "offsets", "translated"])
def test_a_claimed_shape_costs_no_memory(shape: list[int], key: str) -> None:
    header = header_of(BINARIES[0])
    data = BINARIES[0][8 + int.from_bytes(BINARIES[0][:8], "little") :]
    header[key]["shape"] = shape
    assert attempt(container(header, data)) is None
    header[key]["data_offsets"] = [0, 0]
    assert attempt(container(header, data)) is None
    for entry in header.values():
        entry["data_offsets"] = [0, 0]
    assert peak_of(lambda: attempt(container(header))) < 200_000


@pytest.mark.parametrize(
    "header",
    [
        b"{" + b'"a":{' * 50_000,
        b'{"a":' + b"[" * 50_000,
        b'{"a":' + b"9" * 50_000 + b"}",
        b'{"a":NaN}',
        b'{"a":{"dtype":"F64","shape":[true],"data_offsets":[0,8]}}',
        b'{"a":{"dtype":"F64","shape":[1.0],"data_offsets":[0,8]}}',
        b'{"a":{"dtype":"F64","shape":[-1],"data_offsets":[8,0]}}',
        b'{"a":{"dtype":["F64"],"shape":[],"data_offsets":[0,8]}}',
        b'{"a":{"dtype":"F64","shape":[1,1,1,1,1,1,1,1,1],"data_offsets":[0,8]}}',
        b'{"__metadata__":[]}',
        b'{"__metadata__":{"format":1}}',
        b'{"__metadata__":{"format":"gmr","version":"1","names":"' + b"[" * 50_000 + b'"}}',
        b'{"__metadata__":{"format":"gmr","version":"1","names":"[\\"a\\"]","post":"{}"}}',
        b"{}",
        b'{"\\ud800":{}}',
    ],
)
def test_headers_that_are_none_are_refused(header: bytes) -> None:
    assert attempt(container(header)) is None


@pytest.mark.parametrize(("blank", "line"), [("", 16), ("\n \n", 18)])
def test_a_quaternion_of_another_length_is_told_with_its_line(data: Path, blank: str, line: int) -> None:
    text = (data / "gmr" / "valid" / "angles_and_quaternions.gmr").read_text()
    changed = text.replace("-0.5 90", "-0.6 90").replace("\n1 2 3 10", f"\n{blank}1 2 3 10").encode()
    said = f"arm.gmr:{line}: 1 quaternion is not of length 1, the first in frame 1"
    with pytest.warns(FormatWarning, match=said):
        read_gmr(changed, name="arm.gmr")
    with pytest.raises(FormatError, match=said):
        read_gmr(changed, name="arm.gmr", strict=True)
