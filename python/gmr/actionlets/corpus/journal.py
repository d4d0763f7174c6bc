"""The labels of a corpus, a line a take (JSON Lines): written as takes are done, put in order at the end."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gmr.replacing import replacing

__all__ = ["Journal", "Record", "journal", "put_in_order", "records_in"]

Record = dict[str, Any]
"""The labels of a take: its number as "take", its "file", how many "bytes" that has, and more."""


def records_in(path: Path) -> Iterator[tuple[int, Record]]:
    """What was written down, and at which byte of the file; a line that is not whole, as a kill leaves it, is
    passed over."""
    try:
        file = path.open("rb")
    except FileNotFoundError:
        return
    with file:
        at = 0
        for line in file:
            if (record := _record(line)) is not None:
                yield at, record
            at += len(line)


@contextmanager
def journal(path: Path) -> Iterator[Journal]:
    """A file to which records are added; whole lines that are there stay."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        yield Journal(descriptor, _end_of_lines(descriptor))
    finally:
        os.close(descriptor)


class Journal:
    """An open journal: what was added is in the file, whatever becomes of this process."""

    def __init__(self, descriptor: int, size: int) -> None:
        self._descriptor = descriptor
        self._size = size
        os.ftruncate(descriptor, size)

    def add(self, records: Iterable[Record]) -> dict[int, int]:
        """Writes records down, all or none.

        Returns:
            At which byte each is, by the take's number.

        Raises:
            OSError: the disk is full, or the like; the file is as it was.
        """
        places, text = {}, b""
        for record in records:
            places[record["take"]] = self._size + len(text)
            text += _line(record)
        os.lseek(self._descriptor, self._size, os.SEEK_SET)
        try:
            rest = memoryview(text)
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError:
            os.ftruncate(self._descriptor, self._size)
            raise
        self._size += len(text)
        return places


def put_in_order(path: Path, places: Mapping[int, int]) -> None:
    """Each take once, by its number; a journal that is so already is left alone.

    Args:
        path: of the journal.
        places: at which byte each take's line is.
    """
    order = [places[number] for number in sorted(places)]
    if not path.exists():
        path.touch()
    with path.open("rb") as file:
        ends = 0
        for at in order:
            file.seek(at)
            if at != ends:
                break
            ends += len(file.readline())
        else:
            if ends == path.stat().st_size:
                return
        with replacing(path) as (ordered,):
            for at in order:
                file.seek(at)
                ordered.write(file.readline())


def _line(record: Record) -> bytes:
    return json.dumps(record, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode() + b"\n"


def _record(line: bytes) -> Record | None:
    if not line.endswith(b"\n"):
        return None
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        return None
    whole = isinstance(found, dict) and all(
        isinstance(found.get(key), kind) for key, kind in (("take", int), ("file", str), ("bytes", int))
    )
    return found if whole else None


def _end_of_lines(descriptor: int) -> int:
    """Bytes up to the end of the last whole line."""
    size = os.fstat(descriptor).st_size
    step = 1 << 16
    for start in range(size - size % step, -1, -step):
        piece = os.pread(descriptor, step, start)
        if (at := piece.rfind(b"\n")) >= 0:
            return start + at + 1
    return 0
