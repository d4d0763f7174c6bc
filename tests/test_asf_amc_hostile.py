"""No file makes the readers of ASF and AMC crash, hang or take memory beyond what it could mean."""

from __future__ import annotations

import warnings

import pytest
from hypothesis import given
from hypothesis import strategies as st

from amc_text import AMC, ASF, amc, asf, read_back
from gmr import FormatError, FormatWarning, Motion
from gmr.dof_rows import DofRows
from gmr.formats.asf_amc import parse_asf, read_amc, read_asf
from hostile import Change, changed, changes, cut_anywhere, peak_of, refused_or_read

MANY = 50_000


def attempt(frames: bytes, skeleton: bytes) -> Motion | None:
    return refused_or_read(lambda: read_amc(frames, asf=skeleton))


def test_an_amc_cut_anywhere_is_refused_or_read_as_far_as_it_goes() -> None:
    whole = read_amc(amc(), asf=asf()).source.numbers[0]
    for text in (AMC, AMC.replace("\n", "\r\n")):
        for motion, is_said in cut_anywhere(text.encode(), lambda data: read_amc(data, asf=asf())):
            found = motion.source.numbers[0]
            if len(found) == 2:
                # A last number may have lost digits, which nobody can see.
                assert found[:, :-1].tolist() == whole[:, :-1].tolist()
            elif len(found) == 1 and not is_said:
                assert found[0, :-1].tolist() == whole[0, :-1].tolist()


def test_an_asf_cut_anywhere_is_refused_or_whole() -> None:
    whole = parse_asf(asf())
    for length in range(len(ASF) - 1):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                found = parse_asf(ASF[:length].encode())
            except FormatError:
                continue
        assert found == whole, length


WORDS = [
    b"begin", b"end", b"\n", b"nan", b"1e400", b"-", b"\0", b"#", b":root", b"name", b"9" * 40, b"(",
]  # fmt: skip


@given(changes(WORDS, least=0, most=3), changes(WORDS, least=0, most=3))
def test_files_with_anything_in_them_are_refused_or_read_back_as_they_were_read(
    of_asf: list[Change], of_amc: list[Change]
) -> None:
    motion = attempt(changed(AMC.encode(), of_amc), changed(ASF.encode(), of_asf))
    if motion is None:
        return
    found = read_back(motion)
    assert found == motion
    assert isinstance(motion.source, DofRows)
    assert found.source.numbers[0].tobytes() == motion.source.values.tobytes()


@given(st.binary(max_size=300))
def test_any_bytes_are_refused_or_read(data: bytes) -> None:
    attempt(data, asf())
    attempt(b":DEGREES\n1\n" + data, asf())
    attempt(amc(), data)
    attempt(amc(), b":root\n:bonedata\nbegin\n" + data)
    attempt(amc(), b":root\n:hierarchy\nbegin\n" + data)


def chain(count: int) -> bytes:
    """The ASF of bones that hang on one another."""
    bones = "".join(
        f"begin\nname b{k}\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\ndof rx\nend\n" for k in range(count)
    )
    above = "".join(f"{'root' if k == 0 else f'b{k - 1}'} b{k}\n" for k in range(count))
    return f":root\norder TX TY TZ\n:bonedata\n{bones}:hierarchy\nbegin\n{above}end\n".encode()


def test_bones_may_hang_on_one_another_as_deeply_as_memory_allows() -> None:
    skeleton = chain(MANY // 5)
    frame = "1\nroot 0 0 0\n" + "".join(f"b{k} 90\n" for k in range(MANY // 5))
    motion = read_amc(frame.encode(), asf=skeleton)
    assert motion.skeleton.joint_count == MANY // 5 + 1
    assert motion.positions()[0, 2].tolist() == pytest.approx([0, -1, 1], abs=1e-6)
    assert read_back(motion) == motion


@pytest.mark.parametrize(
    "text",
    [
        ":name\n" * MANY,
        ":bonedata\n" + "begin\n" * MANY,
        ":bonedata\nbegin\nname a\n" + "limits (1 2)\n" * MANY,
        ":bonedata\nbegin\nname a\nlimits " + "(" * MANY,
        ":bonedata\nbegin\nname a\nlimits " + "(1 " * MANY,
        ":bonedata\nbegin\nname a\ndof " + "rx " * MANY,
        ":bonedata\nbegin\nname " + "a" * MANY,
        ":root\norder " + "TX " * MANY,
        ":root\n:hierarchy\nbegin\nroot " + "root " * MANY,
        ":version" * MANY,
        "#" * MANY,
        "#\n" * MANY,
        "\r" * MANY,
    ],
)
def test_endless_repetition_is_refused(text: str) -> None:
    assert attempt(amc(), text.encode()) is None
    attempt(text.encode(), asf())


@pytest.mark.parametrize("number", ["1000000000000000000", "9" * 19, "9" * 5000])
def test_a_frame_number_costs_no_memory(number: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = read_amc(amc(("\n1\n", f"\n{number}\n")), asf=asf())
    assert motion.frame_count == 2


def test_frames_without_bones_take_memory_in_proportion_to_the_file() -> None:
    frames = b":DEGREES\n" + b"1\nb0 1\n" * MANY
    skeleton = chain(1000)
    parse_asf(skeleton)  # which is shared from then on, and so is not counted

    def refused() -> None:
        with pytest.raises(FormatError, match="nearly all bones are missing"):
            read_amc(frames, asf=skeleton)

    assert peak_of(refused) < 40 * len(frames)


def test_many_odd_places_are_said_once() -> None:
    frames = b"".join(b"%d\nroot 1 2 3 4 5 6\n" % (k * k) for k in range(2000))
    with pytest.warns(FormatWarning) as caught:
        motion = read_amc(frames, asf=asf())
    assert motion.frame_count == 2000
    assert len(caught) == 2  # missing bones, and numbers that skip


def test_a_skeleton_without_degrees_of_freedom_has_frames_all_the_same() -> None:
    bone = b":bonedata\nbegin\nname a\ndirection 1 0 0\nlength 2\nend\n"
    still = b":root\norder RX\n" + bone + b":hierarchy\nbegin\nroot a\nend\n"
    motion = read_amc(b"1\nroot 90\n2\nroot 0\na\n", asf=still)
    assert motion.positions()[:, 1].tolist() == [[2, 0, 0], [2, 0, 0]]
    assert read_asf(still).skeleton.slots.tolist() == [0, -1]


def test_a_motion_whose_frame_numbers_cannot_be_counted_on_is_written_all_the_same() -> None:
    with pytest.warns(FormatWarning):
        motion = read_amc(amc(("\n1\n", f"\n{'9' * 30}\n")), asf=asf())
    assert read_back(motion) == motion
    assert read_back(motion[1:]) == motion[1:]
