"""The door: paths, bytes, streams and folders in; whole files out, or none."""

from __future__ import annotations

import io
import shutil
from pathlib import Path

import pytest
from hypothesis import given

import gmr
from gmr import FormatError, GmrError, Motion
from strategies import motions


def test_a_path_bytes_and_streams_give_the_same_motion(walk_path: Path) -> None:
    motion = gmr.read(walk_path)
    text = walk_path.read_text()
    with walk_path.open("rb") as binary, walk_path.open() as lines:
        for source in (
            str(walk_path),
            text.encode(),
            bytearray(text.encode()),
            io.StringIO(text),
            binary,
            lines,
        ):
            assert gmr.read(source) == motion
    assert motion.name == str(walk_path)
    assert gmr.read(b"\xef\xbb\xbf" + text.encode()) == motion
    assert gmr.read(text.encode("utf-16")) == motion


@given(motions())
def test_what_is_written_reads_back_the_same(motion: Motion) -> None:
    written = io.BytesIO()
    gmr.write(motion, written)
    text = io.StringIO()
    gmr.write(motion, text)
    assert text.getvalue().encode() == written.getvalue()
    positions = "add" if motion.layout is not None and motion.layout.adds_offset else "replace"
    again = gmr.read(written.getvalue(), positions=positions)  # type: ignore[arg-type]
    assert again == motion.with_unit(None)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("missing.bvh", "there is no such file"),
        ("wakl.bvh", "did you mean walk.bvh"),
        ("nowhere/walk.bvh", "no folder"),
        ("folder.bvh", "gmr.read_folder"),
        ("empty.bvh", "the file is empty"),
        ("walk.fbx", r"'.fbx' is none that gmr reads \(.bvh, .amc, .asf, .gmr, .gmrb, .c3d, .glb, .gltf\)"),
        ("walk", "a name without a suffix"),
    ],
)
def test_what_cannot_be_read_says_how_to_mend_it(
    name: str, said: str, walk_path: Path, tmp_path: Path
) -> None:
    (tmp_path / "folder.bvh").mkdir()
    (tmp_path / "empty.bvh").touch()
    for copy in ("walk.bvh", "walk.fbx", "walk"):
        shutil.copy(walk_path, tmp_path / copy)
    with pytest.raises(FormatError, match=said) as caught:
        gmr.read(tmp_path / name)
    assert caught.value.file == str(tmp_path / name)


def test_a_named_format_goes_before_the_suffix(walk_path: Path, tmp_path: Path) -> None:
    shutil.copy(walk_path, tmp_path / "walk.txt")
    assert gmr.read(tmp_path / "walk.txt", format="bvh") == gmr.read(walk_path)
    with pytest.raises(FormatError, match="no format 'fbx'; use one of: bvh"):
        gmr.read(walk_path, format="fbx")


def test_text_that_is_no_motion_is_refused() -> None:
    with pytest.raises(FormatError, match="begins like no format"):
        gmr.read(b"Kaydara FBX Binary")
    with pytest.raises(FormatError, match=r"text\.encode"):
        gmr.read("HIERARCHY\nROOT Hips\n")
    with pytest.raises(ValueError, match="'replace' or 'add'"):
        gmr.read(b"HIERARCHY", positions="multiply")  # type: ignore[arg-type]


@pytest.fixture
def takes(tmp_path: Path, data: Path) -> Path:
    """Motions in a folder and one below, a broken one, and what is not to be read."""
    (tmp_path / "b" / "deep").mkdir(parents=True)
    (tmp_path / ".cache").mkdir()
    shutil.copy(data / "cmu_07_01.bvh", tmp_path / "b" / "deep" / "walk.bvh")
    shutil.copy(data / "cmu_12_01.bvh", tmp_path / "b.BVH")
    shutil.copy(data / "cmu_12_01.bvh", tmp_path / "a.bvh")
    shutil.copy(data / "cmu_12_01.bvh", tmp_path / ".cache" / "hidden.bvh")
    (tmp_path / "broken.bvh").write_text("HIERARCHY\n")
    (tmp_path / "notes.txt").write_text("a note")
    (tmp_path / "b" / "again").symlink_to(tmp_path)
    return tmp_path


@pytest.mark.parametrize("threads", [1, 3, None])
def test_a_folder_is_read_in_name_order_whatever_the_threads(takes: Path, threads: int | None) -> None:
    seen: list[tuple[int, int]] = []
    found = gmr.read_folder(
        takes, threads=threads, errors="collect", progress=lambda done, all_: seen.append((done, all_))
    )
    assert list(found) == ["a.bvh", "b/deep/walk.bvh", "b.BVH"]
    assert list(found.failed) == ["broken.bvh"]
    assert found["a.bvh"] == gmr.read(takes / "a.bvh")
    assert seen == [(1, 4), (2, 4), (3, 4), (4, 4)]


def test_a_broken_file_of_a_folder_is_raised_or_collected(takes: Path) -> None:
    with pytest.raises(FormatError, match=r"broken\.bvh"):
        gmr.read_folder(takes)
    with pytest.raises(FormatError, match="no such folder"):
        gmr.read_folder(takes / "nowhere")
    with pytest.raises(FormatError, match="this is a file"):
        gmr.read_folder(takes / "a.bvh")


def test_recordings_of_markers_in_a_folder_are_said_to_be_left_out(takes: Path) -> None:
    for name in ("hop.c3d", "b/jump.C3D"):
        (takes / name).write_bytes(b"\x02P")
    with pytest.warns(gmr.FormatWarning, match=r"2 files are left out \(b/jump\.C3D, hop\.c3d\)"):
        found = gmr.read_folder(takes, errors="collect", strict=True)
    assert list(found) == ["a.bvh", "b/deep/walk.bvh", "b.BVH"]
    assert list(found.failed) == ["broken.bvh"]


def test_a_motion_that_cannot_be_written_leaves_nothing(walk_path: Path, tmp_path: Path) -> None:
    motion = gmr.read(walk_path)
    for place, said in (
        (tmp_path / "nowhere" / "walk.bvh", "make it first"),
        (tmp_path, "this is a folder; name a file in it"),
        (tmp_path / "walk.fbx", r"none that gmr writes \(\.bvh, \.amc, \.asf, \.gmr, \.gmrb, \.glb, \.x3d\)"),
    ):
        with pytest.raises(GmrError, match=said):
            gmr.write(motion, place)
    assert list(tmp_path.iterdir()) == []


def test_a_golden_walk(walk_path: Path) -> None:
    motion = gmr.read(walk_path)
    assert repr(motion.with_name("walk")) == (
        "Motion('walk', 60 frames at 120 fps = 0.500 s, 38 joints, roots: Hips, unit unknown)"
    )
    assert motion.skeleton.names[:4] == ("Hips", "LHipJoint", "LeftUpLeg", "LeftLeg")
    assert motion.rows[1, :6].tolist() == [8.8721, 15.7511, -31.7081, 3.7012, 4.9122, 5.5217]
