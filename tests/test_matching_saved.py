"""A saved database opens with the bits of the one that was saved; what is none is refused in a sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from gmr.errors import FormatError
from gmr.matching import Database, Group, Profile, Schema, run_trials
from walkers import walker

WALKS = [walker(3.0, 1.2, 0.4, name="curve"), walker(2.0, 2.5, -0.2, swing=0.8, name="r\u00fcn")]
SHORT = Schema(
    (
        Group("left toe position", "position", "left_toe"),
        Group("trajectory position", "root_position", times=(-0.1, 0.1)),
        Group("trajectory facing", "root_facing", times=(0.1,), weight=0.0),
    )
)


@pytest.mark.parametrize("schema", [None, SHORT], ids=["usual", "own"])
def test_what_is_opened_is_what_was_saved(tmp_path: Path, schema: Schema | None) -> None:
    asked = {} if schema is None else {"schema": schema}
    walks = [*WALKS, WALKS[1].with_name("once again")]
    saved = Database.build(walks, mirror=True, tags={"curve": 5}, unit="cm", **asked)  # type: ignore[arg-type]
    assert saved.duplicates == {"once again": WALKS[1].name}
    saved.save(tmp_path / "walks.gmrm")
    opened = Database.open(tmp_path / "walks.gmrm")
    for name in (
        "features",
        "positions",
        "candidates",
        "tags",
        "ground",
        "headings",
        "displacements",
        "turns",
    ):
        np.testing.assert_array_equal(getattr(opened, name), getattr(saved, name), err_msg=name)
    for name in ("clips", "frames", "seconds", "mirrored", "starts"):
        np.testing.assert_array_equal(getattr(opened, name), getattr(saved, name), err_msg=name)
    told = ("schema", "skeleton", "joints", "clip_names", "units", "notes", "excluded", "duplicates", "rate")
    for name in told:
        assert getattr(opened, name) == getattr(saved, name), name
    queries = saved.features[::17] + np.float32(0.1)
    for one, other in zip(opened.search(queries, 3), saved.search(queries, 3), strict=True):
        np.testing.assert_array_equal(one, other)
    profile = [Profile.constant(1.4, 0.3, run_up=1.0, settle=0.0, record=4.0)]
    logs = [run_trials(database, profile) for database in (opened, saved)]
    np.testing.assert_array_equal(logs[0].row, logs[1].row)
    np.testing.assert_array_equal(logs[0].x, logs[1].x)


def test_poses_are_mapped_and_outlive_the_database(tmp_path: Path) -> None:
    saved = Database.build(WALKS)
    saved.save(tmp_path / "walks.gmrm")
    positions = Database.open(tmp_path / "walks.gmrm").positions
    assert not positions.flags.owndata
    assert not positions.flags.writeable
    saved.save(tmp_path / "walks.gmrm")
    np.testing.assert_array_equal(positions, saved.positions)


def test_an_independent_reader_finds_the_arrays(tmp_path: Path) -> None:
    saved = Database.build(WALKS)
    saved.save(tmp_path / "walks.gmrm")
    arrays = load_file(tmp_path / "walks.gmrm")
    np.testing.assert_array_equal(arrays["features"], saved.features)
    np.testing.assert_array_equal(arrays["positions"], saved.positions)
    found = np.sort(arrays["index_frames"].ravel())[: saved.candidates.sum()]
    np.testing.assert_array_equal(found, np.flatnonzero(saved.candidates))
    np.testing.assert_array_equal(arrays["steps"][:, :2], saved.displacements)


def test_an_independent_reader_decodes_rows_and_boxes_within_their_rounding(tmp_path: Path) -> None:
    saved = Database.build(WALKS)
    saved.save(tmp_path / "walks.gmrm")
    arrays = load_file(tmp_path / "walks.gmrm")
    dims = saved.features.shape[1]
    frames = arrays["index_frames"]
    axes = arrays["index_axes"].transpose(1, 0, 2).reshape(dims, -1)[:, :dims]
    np.testing.assert_allclose(axes.T @ axes, np.eye(dims), atol=1e-12)
    # Rows by leaf, NaN where a lane holds none.
    is_held = frames != 2**32 - 1
    rows = np.full((*frames.shape, dims), np.nan)
    rows[is_held] = (saved.features[frames[is_held]] - arrays["index_mean"]) @ axes

    grids = arrays["index_grids"].astype(np.float64)
    parents = np.arange(len(frames)) // 8
    steps = 4 / grids[:, -2]
    codes = np.moveaxis(arrays["index_row_codes"], 1, 2).reshape(*frames.shape, -1)[..., :dims]
    decoded = grids[parents, None, :dims] + codes * steps[parents, None, None]
    off = np.abs(decoded - rows) / steps[parents, None, None]
    assert np.nanmax(off) < 0.52

    level = slice(0, -(-len(frames) // 8))
    edges = np.moveaxis(arrays["index_box_codes"][level], 1, 3).reshape(-1, 2, 8, codes.shape[-1] + dims % 2)
    edges = grids[level, None, None, :dims] + edges[..., :dims] * steps[level, None, None, None]
    lower, upper = (edges[:, side].reshape(-1, dims)[: len(frames)] for side in (0, 1))
    slack = 0.02 * steps[parents, None]
    assert (lower - slack <= np.nanmin(rows, axis=1)).all()
    assert (upper + slack >= np.nanmax(rows, axis=1)).all()
    assert (upper - lower).max() < 40 * (np.nanmax(rows, axis=1) - np.nanmin(rows, axis=1)).max()


def test_what_is_no_saved_database_is_refused_in_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "walks.gmrm"
    with pytest.raises(FileNotFoundError):
        Database.open(path)
    path.write_bytes(b"")
    with pytest.raises(FormatError, match=r"walks.gmrm: header too small; a saved motion database begins"):
        Database.open(path)
    save_file({"features": np.zeros((3, 27), np.float32)}, path)
    with pytest.raises(FormatError, match="it is no saved motion database"):
        Database.open(path)


def test_damage_is_told_where_a_search_meets_it_and_by_the_whole_check(tmp_path: Path) -> None:
    path = tmp_path / "walks.gmrm"
    saved = Database.build(WALKS)
    saved.save(path)
    assert len(Database.open(path, check=True)) == len(saved)
    data = bytearray(path.read_bytes())
    start = 8 + int.from_bytes(data[:8], "little")
    begin, _ = json.loads(data[8:start])["index_rows"]["data_offsets"]
    data[start + begin + 7] ^= 1
    path.write_bytes(data)
    told = r"^[^:]*walks.gmrm: leaf 0 of its index is damaged; save the database again"
    with pytest.raises(FormatError, match=told):
        Database.open(path, check=True)
    with pytest.raises(ValueError, match=told):
        Database.open(path).search(saved.features[saved.candidates])


def test_an_index_of_other_rows_is_found_by_the_whole_check(tmp_path: Path) -> None:
    path = tmp_path / "walks.gmrm"
    saved = Database.build(WALKS)
    saved.save(path)
    data = bytearray(path.read_bytes())
    start = 8 + int.from_bytes(data[:8], "little")
    begin, _ = json.loads(data[8:start])["features"]["data_offsets"]
    row = int(np.flatnonzero(saved.candidates)[0])
    data[start + begin + 4 * row * saved.features.shape[1]] ^= 1
    path.write_bytes(data)
    with pytest.raises(FormatError, match=rf"walks.gmrm: .*holds other numbers than row {row}"):
        Database.open(path, check=True)


def test_a_file_of_an_older_version_says_how_to_make_it_anew(tmp_path: Path) -> None:
    path = tmp_path / "walks.gmrm"
    Database.build(WALKS).save(path)
    path.write_bytes(path.read_bytes().replace(rb"\"version\":3", rb"\"version\":1", 1))
    with pytest.raises(
        FormatError, match=r"of version 1, .* version 3; build the database of its clips again"
    ):
        Database.open(path)


def test_a_database_saved_without_python_says_so(tmp_path: Path) -> None:
    path = tmp_path / "walks.gmrm"
    Database.build(WALKS).save(path)
    data = path.read_bytes()
    path.write_bytes(data.replace(rb"\"python\"", rb"\"pythan\"", 1))
    with pytest.raises(FormatError, match="Save it again from Python; from Rust it can be opened as it is"):
        Database.open(path)


def test_what_python_knows_must_fit_the_arrays(tmp_path: Path) -> None:
    path = tmp_path / "walks.gmrm"
    Database.build(WALKS).save(path)
    data = path.read_bytes()
    length = int.from_bytes(data[:8], "little")
    header = json.loads(data[8 : 8 + length])
    told = json.loads(header["__metadata__"]["gmr_matching"])
    known = json.loads(told["notes"]["python"])
    known["mirrored"] = known["mirrored"][1:]
    told["notes"]["python"] = json.dumps(known)
    header["__metadata__"]["gmr_matching"] = json.dumps(told)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(len(text).to_bytes(8, "little") + text + data[8 + length :])
    with pytest.raises(FormatError, match="1 clips mirrored are told of, where there are 2"):
        Database.open(path)
