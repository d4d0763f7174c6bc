"""Tables: what is written reads back, and is written whole or not at all."""

from __future__ import annotations

import csv
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest

from gmr.evaluation import Table
from gmr.replacing import check_place, replacing

NAMES = ["walk.bvh", 'quick, "sharp" turn.bvh', "two\nlines.bvh", "Gänge/läuft.bvh"]


@pytest.fixture
def table() -> Table:
    return Table(
        {
            "clip": NAMES,
            "speed": np.array([0.1, np.nan, 1 / 3, -2.5e-9]),
            "cost": np.array([0.1, 2.0, np.inf, 1e-8], np.float32),
            "count": np.array([0, 3, -1, 2**31 - 1], np.int32),
            "mirrored": [True, False, True, False],
        }
    )


def test_csv_reads_back_to_the_same_numbers_and_names(table: Table, tmp_path: Path) -> None:
    table.to_csv(tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert tuple(header) == table.column_names
    assert [row[0] for row in rows] == NAMES
    assert [row[1] for row in rows] == ["0.1", "", repr(1 / 3), "-2.5e-09"]
    assert [row[2] for row in rows] == ["0.1", "2.0", "", "1e-08"]
    assert [row[3] for row in rows] == ["0", "3", "-1", "2147483647"]
    assert [row[4] for row in rows] == ["true", "false", "true", "false"]


def test_json_is_one_object_a_row_with_null_for_the_unknown(table: Table, tmp_path: Path) -> None:
    table.to_json(tmp_path / "t.json")
    text = (tmp_path / "t.json").read_text(encoding="utf-8")
    rows = json.loads(text)
    assert [row["clip"] for row in rows] == NAMES
    assert rows[1]["speed"] is None
    assert rows[0] == {"clip": "walk.bvh", "speed": 0.1, "cost": 0.1, "count": 0, "mirrored": True}
    assert len(text.splitlines()) == len(table) + 2


def test_parquet_reads_back_to_the_same_columns(table: Table, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table.to_parquet(tmp_path / "t.parquet")
    back = parquet.read_table(tmp_path / "t.parquet")
    assert Table({name: back[name].to_numpy() for name in back.column_names}) == table


def test_an_empty_table_keeps_its_columns_in_every_format(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    empty = Table({"clip": np.array([], object), "count": np.array([], np.int64)})
    empty.to_csv(tmp_path / "t.csv")
    empty.to_json(tmp_path / "t.json")
    empty.to_parquet(tmp_path / "t.parquet")
    assert (tmp_path / "t.csv").read_text() == "clip,count\n"
    assert json.loads((tmp_path / "t.json").read_text()) == []
    schema = parquet.read_schema(tmp_path / "t.parquet")
    assert [str(field.type) for field in schema] == ["string", "int64"]


def test_a_table_cannot_be_changed(table: Table) -> None:
    with pytest.raises(ValueError, match="read-only"):
        table["speed"][0] = 1.0


def test_columns_of_different_lengths_are_refused() -> None:
    with pytest.raises(ValueError, match="one length"):
        Table({"a": [1, 2], "b": [1]})


def test_rows_and_take_follow_the_order_asked_for(table: Table) -> None:
    chosen = table.take([2, 0])
    assert [row["clip"] for row in chosen.rows()] == [NAMES[2], NAMES[0]]
    assert len(table.take(table["count"] > 0)) == 2


def test_a_failure_while_writing_leaves_the_old_files_and_nothing_else(tmp_path: Path) -> None:
    old = tmp_path / "a.csv"
    old.write_text("old")

    def fail_half_way() -> None:
        with replacing(old, tmp_path / "b.csv") as (a, b):
            a.write(b"new")
            b.write(b"new")
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        fail_half_way()
    assert old.read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv"]


def test_a_written_file_has_the_permissions_of_an_ordinary_one(tmp_path: Path) -> None:
    (tmp_path / "usual").write_text("")
    with replacing(tmp_path / "ours") as (file,):
        file.write(b"x")
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_the_permissions_of_other_files_are_left_alone_while_one_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def changed(mask: int) -> int:
        raise AssertionError(f"the mask of every thread became {mask:o}")

    monkeypatch.setattr(os, "umask", changed)
    with replacing(tmp_path / "ours") as (file,):
        file.write(b"x")
    assert (tmp_path / "ours").read_bytes() == b"x"


def test_the_file_that_a_link_leads_to_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    link = tmp_path / "ours"
    link.symlink_to("there/ours")
    for content in (b"first", b"second"):
        with replacing(link) as (file,):
            file.write(content)
        assert link.is_symlink()
        assert (tmp_path / "there" / "ours").read_bytes() == content


def test_what_is_no_file_is_written_to_and_stays(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    check_place(pipe)
    with replacing(pipe) as (file,):
        file.write(b"x")
    assert os.read(reader, 10) == b"x"
    os.close(reader)
    assert pipe.is_fifo()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_a_device_stays_what_it_is() -> None:
    check_place("/dev/full")
    with pytest.raises(OSError, match="No space left"), replacing("/dev/full") as (file,):  # noqa: PT012
        file.write(b"x")
        file.flush()
    assert Path("/dev/full").is_char_device()


@pytest.mark.parametrize("place", ["file", "new", "missing/folders/new", "link"])
def test_a_place_that_can_be_written_to_is_left_as_it_was(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("old")
    (tmp_path / "link").symlink_to("nowhere")
    before = sorted(tmp_path.rglob("*"))
    check_place(tmp_path / place)
    assert sorted(tmp_path.rglob("*")) == before
    assert (tmp_path / "file").read_text() == "old"


@pytest.mark.parametrize("place", ["file/new", "file/folder/new", "n" * 300, "missing/" + "n" * 300])
def test_a_place_that_cannot_be_written_to_is_found_beforehand(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("old")
    with pytest.raises(OSError, match=r"Not a directory|File name too long"):
        check_place(tmp_path / place)
    assert list(tmp_path.iterdir()) == [tmp_path / "file"]


def test_the_same_table_gives_the_same_bytes(table: Table) -> None:
    def written() -> list[bytes]:
        files = [io.BytesIO(), io.BytesIO()]
        table.write_csv(files[0])
        table.write_json(files[1])
        return [file.getvalue() for file in files]

    assert written() == written()
