"""C3D files that are well formed and say what cannot be: refused before ezc3d sees them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from c3d_files import Change, changes_of_c3d, parameters_of, with_everything, with_value
from gmr.formats.c3d import read_c3d
from gmr.formats.c3d_bytes import read_header

pytest.importorskip("ezc3d")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return with_everything(tmp_path_factory.mktemp("c3d") / "whole.c3d").read_bytes()


def with_word(data: bytes, place: int, value: int) -> bytes:
    """The file with another word in its header, counted from 1 as the user guide does."""
    at = 2 * (place - 1)
    return data[:at] + value.to_bytes(2, "little") + data[at + 2 :]


def emptied(data: bytes, group: str, name: str) -> bytes:
    """The file with a parameter of one dimension, 0, and a description where its values were."""
    at = next(entry.at for entry in parameters_of(data) if (entry.group, entry.name) == (group, name))
    room = int.from_bytes(data[at - 2 : at], "little") - 6
    return data[: at + 1] + bytes([1, 0, room]) + b" " * room + data[at + 4 + room :]


def test_points_are_read_and_what_is_beside_them_is_named(whole: bytes) -> None:
    markers = read_c3d(whole)
    np.testing.assert_array_equal(markers.positions, np.full((7, 3, 3), 7.0))
    assert markers.ignored == ("rotations of 2 segments", "2 analog channels (A1, A2)")


@pytest.mark.parametrize(
    ("group", "name", "value", "said"),
    [
        (
            "ANALOG",
            "RATE",
            1e9,
            "counts 20 analog values a frame, the parameters 20,000,000 .*ANALOG:USED, 2,",
        ),
        ("ANALOG", "RATE", 900.0, "counts 20 analog values a frame, the parameters 18"),
        ("ANALOG", "RATE", np.nan, "ANALOG:RATE is nan; it must be 0 or more"),
        ("ANALOG", "RATE", -1000.0, "ANALOG:RATE is -1000; it must be 0 or more"),
        ("ANALOG", "USED", 32767, "counts 20 analog values a frame, the parameters 327,670"),
        ("ANALOG", "USED", -2, "ANALOG:USED is -2; it must be 0 or more"),
        (
            "POINT",
            "RATE",
            1e30,
            "POINT:RATE is 1e\\+30 frames a second; it must be 0 or more and below 200,000",
        ),
        ("POINT", "RATE", np.inf, "POINT:RATE is inf; it must be 0 or more"),
        ("POINT", "USED", 32767, "the header counts 3 points, the parameters 32,767"),
        ("POINT", "USED", -1, "the header counts 3 points, the parameters -1"),
        ("POINT", "SCALE", 0.0, "the scale of the points is 0; it must be a number other than 0"),
        ("POINT", "SCALE", np.nan, "the scale of the points is nan"),
        ("POINT", "SCALE", 0.1, "coordinates are floats by the header .* whole numbers by POINT:SCALE"),
        ("POINT", "FRAMES", 32767, "cut off: its 32,767 frames, which rotations follow, end at byte"),
        ("ROTATION", "USED", 32767, "cut off: its rotations end at byte"),
        ("ROTATION", "USED", -1, "there are -1 rotations .* must be 0 or more"),
        ("ROTATION", "RATIO", 32767, "cut off: its rotations end at byte"),
        ("ROTATION", "RATIO", -1, "there are 2 rotations .*, -1 times a frame"),
        ("ROTATION", "DATA_START", 32767, "cut off: its rotations end at byte"),
        ("ROTATION", "DATA_START", -1, "rotations begin at byte -1,024, before the frames"),
    ],
)
def test_a_count_that_the_file_cannot_hold_is_refused(
    whole: bytes, group: str, name: str, value: float, said: str
) -> None:
    with pytest.raises(gmr.FormatError, match=said) as caught:
        read_header(with_value(whole, group, name, value), "walk.c3d")
    assert caught.value.file == "walk.c3d"
    assert str(caught.value).endswith(("editor for C3D files.", "Copy it again."))


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (2, 4, "the header counts 4 points, the parameters 3"),
        (3, 21, "the header counts 21 analog values a frame, the parameters 20"),
        (9, 0, "does not say where its frames begin"),
        (9, 2, "does not say where its frames begin: byte 512, which is not behind the parameters"),
        (9, 65535, "cut off: its first frame, of 3 points and 20 analog values, ends at byte"),
    ],
)
def test_a_header_that_contradicts_the_rest_is_refused(
    whole: bytes, place: int, value: int, said: str
) -> None:
    with pytest.raises(gmr.FormatError, match=said):
        read_header(with_word(whole, place, value), None)


def test_frames_that_nobody_counts_are_refused(whole: bytes) -> None:
    """ezc3d takes 3 - 9 for a count without sign, and reads until memory ends."""
    data = with_word(with_word(with_value(whole, "POINT", "FRAMES", 0), 4, 9), 5, 3)
    with pytest.raises(gmr.FormatError, match="counts frames from 9 to 3, POINT:FRAMES none"):
        read_header(data, None)


@pytest.mark.parametrize(
    ("group", "name", "said"),
    [
        ("POINT", "USED", "POINT:USED holds no number; it must hold one"),
        ("POINT", "FRAMES", "POINT:FRAMES holds no number"),
        ("POINT", "RATE", "POINT:RATE holds no number"),
        ("POINT", "SCALE", "POINT:SCALE holds no number"),
        ("ANALOG", "USED", "ANALOG:USED holds no number"),
        ("ANALOG", "RATE", "ANALOG:RATE holds no number"),
        ("ANALOG", "GEN_SCALE", "ANALOG:GEN_SCALE holds no number"),
        ("ANALOG", "SCALE", "ANALOG:SCALE holds 0 numbers for 2 channels; it must hold one for each"),
        ("ANALOG", "OFFSET", "ANALOG:OFFSET holds 0 numbers for 2 channels"),
        ("ROTATION", "USED", "ROTATION:USED holds no number"),
        ("ROTATION", "RATIO", "ROTATION:RATIO holds no number"),
        ("ROTATION", "DATA_START", "ROTATION:DATA_START holds no number"),
    ],
)
def test_what_ezc3d_takes_the_first_value_of_must_have_one(
    whole: bytes, group: str, name: str, said: str
) -> None:
    with pytest.raises(gmr.FormatError, match=said):
        read_header(emptied(whole, group, name), None)


@pytest.mark.parametrize("rate", [1e-30, 0.0])
def test_rotations_at_a_rate_beyond_all_reason_are_refused(whole: bytes, rate: float) -> None:
    """Without ROTATION:RATIO it is ROTATION:RATE over the rate of the points."""
    data = with_value(whole.replace(b"RATIO", b"OTHER"), "POINT", "RATE", rate)
    read_header(whole.replace(b"RATIO", b"OTHER"), None)
    data = with_word(with_word(data, 11, 0), 12, 0)
    with pytest.raises(
        gmr.FormatError, match=r"cut off: its rotations end at|2 rotations .*, inf times a frame"
    ):
        read_header(data, None)


def test_subframes_without_a_value_are_bounded_by_the_file(whole: bytes) -> None:
    """ezc3d makes a list for each, though no channel is there to be in it."""
    data = with_value(with_word(with_word(whole, 3, 0), 10, 0), "ANALOG", "USED", 0)
    read_header(data, None)
    with pytest.raises(
        gmr.FormatError, match=r"10,000,000 analog values of each channel a frame .* but no channel"
    ):
        read_header(with_value(data, "ANALOG", "RATE", 1e9), None)
    data = with_value(with_value(whole, "ROTATION", "USED", 0), "ROTATION", "RATIO", 32767)
    with pytest.raises(gmr.FormatError, match=r"32,767 rotations of each segment a frame .* but no segment"):
        read_header(data, None)


def test_dimensions_that_no_value_fills_are_not_walked(whole: bytes) -> None:
    """255 x 255 x 255 x 255 x 255 strings of no letters take no room in a file."""
    found = next(entry for entry in parameters_of(whole) if (entry.group, entry.name) == ("POINT", "LABELS"))
    dimensions = bytes([6, 0, 255, 255, 255, 255, 255])
    room = int.from_bytes(whole[found.at - 2 : found.at], "little") - 3
    data = whole[: found.at + 1] + dimensions + bytes([room - 8]) + whole[found.at + 9 :]
    with pytest.raises(gmr.FormatError, match=r"the dimensions up to those of 'LABELS' call for .* or more"):
        read_header(data, None)


def test_a_place_of_the_frames_that_the_parameters_contradict_is_said(whole: bytes) -> None:
    data = with_value(whole, "POINT", "DATA_START", 9)
    with pytest.warns(gmr.FormatWarning, match="block 4 by the header, block 9 by POINT:DATA_START"):
        read_c3d(data)
    with pytest.raises(gmr.FormatError, match="POINT:DATA_START"):
        read_c3d(data, strict=True)


@given(changes=st.lists(changes_of_c3d(), min_size=1, max_size=4))
def test_what_passes_has_room_for_all_that_ezc3d_makes(whole: bytes, changes: list[Change]) -> None:
    """fuzz/c3d_parameters.py lets ezc3d read the same changes, in processes of their own."""
    data = whole
    for change in changes:
        data = change(data)
    assert len(data) == len(whole)
    try:
        header = read_header(data, "walk.c3d")
    except gmr.FormatError:
        return
    assert header.row == 0 or 512 <= header.start <= len(data) - header.row
