"""The rows of numbers of a text file's frames, and what to say where they are wrong."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.errors import FormatError
from gmr.formats.numerals import why_no_number
from gmr.formats.text import Text
from gmr.formats.timing import Timing

__all__ = ["place_of_row", "read_rows"]

_SOMETHING = re.compile(rb"\S")
_MOST_COUNTED = 1 << 16
"""Bytes of a line in which superfluous numbers are counted."""


def read_rows(text: Text, columns: int, channel: Callable[[int], str], timing: Timing) -> NDArray[np.float64]:
    """Reads (F, C) rows, read-only: as many as are declared, or those that are there.

    Args:
        text: at the first row.
        columns: C.
        channel: what a column is, for errors: its joint and the channel's name.
        timing: how many rows the file says there are, and where.

    Raises:
        FormatError: a row is wrong; its line, joint and channel are named. Frames count from 0.
    """
    declared = timing.frames
    rows, end, found = _core.parse_rows(text.data, text.at, columns, min(declared, len(text.data)))
    rows.flags.writeable = False
    fault = _Fault(*found) if found else None
    if fault and fault.kind != "cut":
        raise _failure(text, columns, channel, fault)
    if fault:
        what = f"the file ends inside frame {fault.row}, after {fault.field} of its {columns} numbers"
        text.odd(f"{what}; the frame is left out. Export the file again for the rest.", at=fault.start)
    elif len(rows) < declared:
        what = f"{timing.said} declared, but {len(rows):,} are there"
        text.odd(f"{what}. Correct the count after 'Frames:', or export the file again.", at=timing.at)
    elif more := _core.count_rows(text.data, end):
        what = f"{timing.said} declared, but {declared + more:,} rows are there"
        text.odd(
            f"{what}. The last are left out; correct the count after 'Frames:' to read them.", at=timing.at
        )
    return rows


def place_of_row(text: Text, columns: int, row: int) -> int:
    """The byte at which a row begins that :func:`read_rows` would read; ``text`` is at the first."""
    _, end, _ = _core.parse_rows(text.data, text.at, columns, row)
    begin = _SOMETHING.search(text.data, end)
    return begin.start() if begin else end


class _Fault(NamedTuple):
    """What ended the reading early, as the core tells it."""

    kind: str
    row: int
    field: int
    start: int
    end: int


def _failure(text: Text, columns: int, channel: Callable[[int], str], fault: _Fault) -> FormatError:
    if fault.kind == "row too short":
        what = f"frame {fault.row} has {fault.field} of {columns} numbers; the next is missing"
        mend = "Write each frame on a line of its own."
        return text.failure(f"{channel(fault.field)}: {what}. {mend}", at=fault.start)
    if fault.kind == "row too long":
        end = min(fault.end, fault.start + _MOST_COUNTED)
        count = columns + len(text.data[fault.start : end].split())
        least = "at least " * (end < fault.end)
        what = f"frame {fault.row} has {least}{count} numbers, but the joints have {columns} channels"
        return text.failure(f"{what}. Remove those too many, or correct CHANNELS.", at=fault.start)
    why = why_no_number(text.data[fault.start : fault.end])
    who = f"{channel(fault.field)}, frame {fault.row}"
    return text.failure(f"{who}: {why}", at=fault.start, column=True)
