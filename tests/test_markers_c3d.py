"""C3D files: what ezc3d reads against what was written, what is odd, what is refused."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
from c3d_files import as_written_by, written
from gmr.formats.c3d import read_c3d

Array = NDArray[np.float64]

DATA = os.environ.get("GMR_DATA")
REAL = ("C3DRotationExample", "Optotrak", "Qualisys", "Vicon")

pytest.importorskip("ezc3d")


def positions(frames: int = 7, markers: int = 3, seed: int = 0) -> Array:
    """Places in millimetres, with a gap, that single precision holds."""
    found = np.random.default_rng(seed).uniform(5, 1500, (frames, markers, 3)).round(1)
    found[2:4, 0] = np.nan
    return found.astype(np.float32).astype(np.float64)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("c3d") / "plain.c3d"
    return written(path, positions(), ("LASI", "RASI", "C7")).read_bytes()


def by_ezc3d(path: Path) -> tuple[Array, Array, Any]:
    """(F, M, 3) places, (F, M) whether seen, and the labels, as ezc3d reads them."""
    import ezc3d

    file = ezc3d.c3d(str(path))
    places = file["data"]["points"][:3].transpose(2, 1, 0)
    seen = file["data"]["meta_points"]["residuals"][0].T >= 0
    return places, seen, tuple(file["parameters"]["POINT"]["LABELS"]["value"])


def test_what_ezc3d_writes_is_read_with_its_gaps(plain: bytes) -> None:
    markers = read_c3d(plain, name="plain.c3d")
    assert markers.labels == ("LASI", "RASI", "C7")
    assert (markers.fps, markers.unit, markers.name) == (100.0, 0.001, "plain.c3d")
    np.testing.assert_array_equal(markers.positions, positions())
    assert not markers.visible[2:4, 0].any()


@pytest.mark.parametrize("processor", ["Intel", "DEC"])
@pytest.mark.parametrize("integers", [False, True])
def test_intel_and_dec_write_the_same_places(plain: bytes, processor: str, integers: bool) -> None:
    data = as_written_by(plain, processor, integers=integers)
    markers = read_c3d(data)
    np.testing.assert_allclose(markers.positions, positions(), atol=1e-3)
    assert markers.labels == ("LASI", "RASI", "C7")
    assert markers.fps == 100.0
    assert markers.visible.tolist() == np.isfinite(positions()).all(axis=2).tolist()


@pytest.mark.parametrize("integers", [False, True])
def test_numbers_of_mips_are_refused_in_a_sentence(plain: bytes, integers: bool) -> None:
    data = as_written_by(plain, "MIPS", integers=integers)
    said = (
        r"mips\.c3d: a MIPS computer wrote this file, which ezc3d.* Convert it to Intel numbers: docs/markers"
    )
    with pytest.raises(gmr.FormatError, match=said):
        read_c3d(data, name="mips.c3d")


def test_without_ezc3d_the_extra_is_named(plain: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ezc3d", None)
    with pytest.raises(gmr.MissingExtraError, match=r"pip install 'gmr-motion\[markers\]'"):
        read_c3d(plain)


def test_labels_go_on_in_a_second_list(tmp_path: Path) -> None:
    labels = [f"M{k:03}" for k in range(300)]
    path = written(tmp_path / "many.c3d", np.full((2, 300, 3), 7.0), labels)
    assert gmr.read_markers(path).labels == tuple(labels)


@pytest.mark.parametrize(
    "extra",
    [
        {"POINT": {"LONG_FRAMES": [70_000.0]}},
        {"TRIAL": {"ACTUAL_START_FIELD": [1, 0], "ACTUAL_END_FIELD": [70_000 - 65_536, 1]}},
    ],
)
def test_more_frames_than_the_header_can_count(tmp_path: Path, extra: dict[str, dict[str, Any]]) -> None:
    places = np.ones((70_000, 1, 3))
    places[:, 0, 0] = np.arange(70_000)
    markers = gmr.read_markers(written(tmp_path / "long.c3d", places, ["A"], extra=extra))
    np.testing.assert_array_equal(markers.positions, places)


def test_more_frames_than_anything_counts(tmp_path: Path) -> None:
    places = np.ones((70_000, 1, 3))
    path = written(tmp_path / "long.c3d", places, ["A"])
    with pytest.warns(gmr.FormatWarning, match="counts 65,535 frames, the most it can; 70,000 are there"):
        markers = gmr.read_markers(path)
    np.testing.assert_array_equal(markers.positions, places)


def test_zeros_in_place_of_a_marker_are_a_gap(tmp_path: Path) -> None:
    places = np.full((3, 2, 3), 5.0)
    places[1, 0] = 0.0
    markers = gmr.read_markers(written(tmp_path / "zeros.c3d", places, ["A", "B"]))
    assert markers.visible.tolist() == [[True, True], [False, True], [True, True]]


def test_a_blank_and_a_repeated_label_are_named(tmp_path: Path) -> None:
    path = written(tmp_path / "odd.c3d", np.full((2, 4, 3), 5.0), ["A", "", "B", "A"])
    with pytest.warns(gmr.FormatWarning) as caught:
        markers = gmr.read_markers(path)
    said = " ".join(str(warning.message) for warning in caught)
    assert "1 of 4 points have no label" in said
    assert "share a label: 'A'" in said
    assert markers.labels == ("A", "unnamed 2", "B", "A")
    with pytest.raises(gmr.GmrError, match="2 markers are labelled 'A': say which by index, 0, 3"):
        markers.index("A")


def test_what_a_model_computed_is_named_and_is_no_marker(tmp_path: Path) -> None:
    extra = {"POINT": {"ANGLES": ["LKneeAngles"], "FORCES": ["LHipForce"]}}
    places = np.full((2, 3, 3), 5.0)
    path = written(tmp_path / "model.c3d", places, ["LASI", "LKneeAngles", "LHipForce"], extra=extra)
    markers = gmr.read_markers(path)
    assert markers.labels == ("LASI",)
    assert markers.ignored == ("1 angles of a model", "1 forces of a model")


def test_events_have_their_times(tmp_path: Path) -> None:
    extra = {"EVENT": {"LABELS": ["Foot Strike"], "CONTEXTS": ["Left"], "TIMES": np.array([[1.0], [2.5]])}}
    path = written(tmp_path / "events.c3d", np.full((2, 1, 3), 5.0), ["A"], extra=extra)
    assert gmr.read_markers(path).events == (gmr.markers.Event("Foot Strike", "Left", 62.5),)


@pytest.mark.parametrize(("first", "seconds"), [(0, 62.5), (1, 62.5), (705, 55.46)])
def test_events_are_told_from_the_first_frame_that_is_there(
    tmp_path: Path, first: int, seconds: float
) -> None:
    """The file's clock begins with frame 1, or with frame 0."""
    extra = {"EVENT": {"LABELS": ["Foot Strike"], "CONTEXTS": ["Left"], "TIMES": np.array([[1.0], [2.5]])}}
    path = written(tmp_path / "events.c3d", np.full((2, 1, 3), 5.0), ["A"], extra=extra)
    data = bytearray(path.read_bytes())
    data[6:10] = first.to_bytes(2, "little") + (first + 1).to_bytes(2, "little")
    (event,) = read_c3d(bytes(data)).events
    assert event.seconds == pytest.approx(seconds, abs=1e-6)


@pytest.mark.parametrize(("unit", "metres"), [("mm", 0.001), ("m", 1.0), ("cm", 0.01), ("in", 0.0254)])
def test_the_unit_is_that_of_the_file(tmp_path: Path, unit: str, metres: float) -> None:
    path = written(tmp_path / "unit.c3d", np.full((2, 1, 3), 5.0), ["A"], unit=unit)
    assert gmr.read_markers(path).unit == metres


def test_a_unit_that_nobody_knows_is_said(tmp_path: Path) -> None:
    path = written(tmp_path / "unit.c3d", np.full((2, 1, 3), 5.0), ["A"], unit="furlong")
    with pytest.warns(gmr.FormatWarning, match="lengths are in 'furlong', which is no unit that gmr knows"):
        assert gmr.read_markers(path).unit is None


def standing(up: int, frames: int = 4) -> Array:
    """Markers above the floor along one axis, on both sides of 0 along the others."""
    places = np.random.default_rng(1).uniform(-900, 900, (frames, 6, 3))
    places[..., up] = np.abs(places[..., up]) + 20
    return places


@pytest.mark.parametrize("up", range(3))
def test_the_floor_tells_which_way_is_up(tmp_path: Path, up: int) -> None:
    path = written(tmp_path / "up.c3d", standing(up), list("ABCDEF"))
    found = gmr.read_markers(path).up
    assert found is not None
    assert found.axis == f"+{'XYZ'[up]}"


def test_the_file_tells_which_way_is_up_and_markers_may_contradict(tmp_path: Path) -> None:
    extra = {"POINT": {"X_SCREEN": ["+X"], "Y_SCREEN": ["-Z"]}}
    path = written(tmp_path / "up.c3d", standing(2), list("ABCDEF"), extra=extra)
    with pytest.warns(gmr.FormatWarning, match="the file says that -Z points up"):
        found = gmr.read_markers(path).up
    assert found is not None
    assert found.axis == "+Z"


def test_a_file_without_markers_is_read_and_said(tmp_path: Path) -> None:
    path = written(tmp_path / "none.c3d", np.empty((3, 0, 3)), [])
    with pytest.warns(gmr.FormatWarning, match="the file holds no markers"):
        assert gmr.read_markers(path).labels == ()


def test_frames_that_are_cut_off_are_said_and_refused_when_strict(plain: bytes) -> None:
    start = (int.from_bytes(plain[16:18], "little") - 1) * 512
    cut = plain[: start + 3 * 3 * 16 + 5]
    with pytest.warns(gmr.FormatWarning, match="cut off: .* counts 7 frames of 48 bytes, but 3 are there"):
        markers = read_c3d(cut, name="cut.c3d")
    np.testing.assert_array_equal(markers.positions, positions()[:3])
    with pytest.raises(gmr.FormatError, match=r"cut\.c3d: the file is cut off"):
        read_c3d(cut, name="cut.c3d", strict=True)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"\x02", "no C3D file: its second byte must be 50"),
        (b"HIERARCHY", "no C3D file"),
        (b"\x02\x50" + bytes(100), "cut off: its header has 512 bytes"),
        (b"\x02\x50" + bytes(510), "cut off: its parameters begin in block 2"),
        (b"\x02\x50" + bytes(510) + b"\x00\x50\x02\x01" + bytes(508), "processor 1 wrote it"),
        (b"\x02\x50" + bytes(510) + b"\x00\x50\x02\x54" + bytes(508), "its parameters end at byte 1,536"),
        (
            b"\x02\x50\x01" + bytes(509) + b"\x00\x50\x01\x54" + bytes(508),
            "does not say where its frames begin",
        ),
    ],
)
def test_what_is_no_c3d_file_is_refused_in_a_sentence(data: bytes, said: str) -> None:
    with pytest.raises(gmr.FormatError, match=said) as caught:
        read_c3d(data, name="walk.c3d")
    assert caught.value.file == "walk.c3d"


@settings(derandomize=True)  # what ezc3d does with damage is not ours to find out in a test run
@given(places=st.lists(st.tuples(st.integers(0, 4000), st.integers(0, 255)), min_size=1, max_size=20))
def test_damaged_bytes_are_read_or_refused_and_nothing_else(
    plain: bytes, places: list[tuple[int, int]]
) -> None:
    data = bytearray(plain)
    for at, value in places:
        data[at % len(data)] = value
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        try:
            markers = read_c3d(bytes(data))
        except gmr.FormatError:
            return
    assert markers.positions.nbytes <= 8 * len(data)


@given(st.data())
def test_a_file_cut_anywhere_is_read_or_refused(plain: bytes, data: st.DataObject) -> None:
    length = data.draw(st.integers(0, len(plain) - 1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        try:
            markers = read_c3d(plain[:length])
        except gmr.FormatError:
            return
    count = markers.frame_count
    np.testing.assert_array_equal(markers.positions, positions()[:count])


@pytest.mark.parametrize("name", [b"FRAMES", b"SCALE", b"DESCRIPTIONS"])
def test_a_description_that_does_not_end_never_reaches_ezc3d(plain: bytes, name: bytes) -> None:
    """ezc3d 1.7.2 takes a length of 255 for -1 and reads without end."""
    at = plain.index(name) + len(name)
    data = bytearray(plain)
    end = at + int.from_bytes(data[at : at + 2], "little")
    data[end - 1] = 255
    with pytest.raises(gmr.FormatError, match=f"the description of '{name.decode()}' does not end"):
        read_c3d(bytes(data))


def test_a_count_of_frames_beyond_all_reason_is_no_allocation(plain: bytes) -> None:
    at = plain.index(b"FRAMES") + 6
    data = bytearray(plain)
    kind = data[at + 2]
    size = {2: 2, 4: 4}[kind]
    data[at + 4 : at + 4 + size] = b"\xff\x7f" if size == 2 else b"\xff\xff\x7f\x7f"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        assert read_c3d(bytes(data)).frame_count == 7


def test_bytes_and_streams_are_known_as_c3d(plain: bytes, tmp_path: Path) -> None:
    path = tmp_path / "WALK.C3D"
    path.write_bytes(plain)
    with path.open("rb") as stream:
        assert gmr.read_markers(stream) == gmr.read_markers(plain) == gmr.read_markers(path)


def test_a_motion_is_no_recording_of_markers(walk_path: Path) -> None:
    with pytest.raises(gmr.FormatError, match=r"holds a motion, not markers; read it with gmr\.read"):
        gmr.read_markers(str(walk_path))


def test_c3d_is_not_written(walk_path: Path, tmp_path: Path) -> None:
    with pytest.raises(
        gmr.FormatError, match=r"out\.c3d: gmr reads C3D but does not write it; write one of: \.bvh"
    ):
        gmr.write(gmr.read(walk_path), tmp_path / "out.c3d")
    assert not (tmp_path / "out.c3d").exists()


def test_folders_of_motions_leave_recordings_of_markers_out(
    plain: bytes, tmp_path: Path, walk_path: Path
) -> None:
    (tmp_path / "a.c3d").write_bytes(plain)
    (tmp_path / "b.bvh").write_bytes(walk_path.read_bytes())
    with pytest.warns(gmr.FormatWarning, match=r"a\.c3d is left out: it holds markers, not a motion"):
        assert list(gmr.read_folder(tmp_path)) == ["b.bvh"]


@pytest.mark.skipif(DATA is None, reason="GMR_DATA is not set")
@pytest.mark.parametrize("name", REAL)
def test_real_files_hold_what_ezc3d_reads(name: str) -> None:
    path = Path(DATA or "") / "c3d" / f"{name}.c3d"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        markers = gmr.read_markers(path)
    places, seen, labels = by_ezc3d(path)
    assert markers.labels == labels
    np.testing.assert_array_equal(markers.visible, seen)
    np.testing.assert_array_equal(markers.positions[seen], places[seen])


@pytest.mark.skipif(DATA is None, reason="GMR_DATA is not set")
def test_events_of_a_take_that_begins_late_are_within_it() -> None:
    with pytest.warns(gmr.FormatWarning, match="points up"):
        markers = gmr.read_markers(Path(DATA or "") / "c3d" / "Qualisys.c3d")
    assert markers.events[0].seconds == pytest.approx(3.59 - 704 / 200, abs=1e-6)
    assert all(0 <= event.seconds < markers.duration for event in markers.events)
