"""BVH bytes to a motion: the hierarchy, then a block of numbers that the core reads."""

from __future__ import annotations

import re
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.channels import ChannelLayout
from gmr.errors import FormatError
from gmr.formats.bvh_hierarchy import Hierarchy, read_hierarchy
from gmr.formats.numerals import number, why_no_number
from gmr.formats.text import Text, shown
from gmr.motion import Motion
from gmr.skeleton import Skeleton

__all__ = ["read_bvh"]

_FRAMES = re.compile(rb"\s*+Frames\s*+:?[^\S\r\n]*+([^\r\n]*)", re.IGNORECASE)
_FRAME_TIME = re.compile(rb"\s*+Frame\s*+Time\s*+:?[^\S\r\n]*+(\S*)", re.IGNORECASE)


def read_bvh(
    data: bytes,
    *,
    name: str | None = None,
    positions: Literal["replace", "add"] = "replace",
    strict: bool = False,
) -> Motion:
    """Motion of a BVH file; its rows of numbers are kept as read, bit-exact.

    Args:
        data: the file's bytes: UTF-8, or UTF-16 with a byte order mark.
        name: the file's name, for errors and for the motion.
        positions: position channels "replace" a joint's OFFSET, as Blender reads them, or "add" to it, as
            three.js does.
        strict: raise where a warning would do: more or fewer rows than declared, a last row that is cut off,
            no MOTION, a frame time of zero, names that are no UTF-8.

    Returns:
        A motion with every joint of the file. A leaf that turns but has no End Site is given a zero-length
        tip, so that its rotation is kept. Errors count frames from 0, as the motion does.

    Raises:
        FormatError: the file cannot be read; the message says where, why, and what to do.
        ValueError: ``positions`` is neither "replace" nor "add".
    """
    if positions not in ("replace", "add"):
        raise ValueError(f"positions={positions!r} is not known; use 'replace' or 'add'")
    text = Text(bytes(data), name=name, strict=strict)
    hierarchy = read_hierarchy(text)
    columns = sum(len(channels) for channels in hierarchy.channels)
    timing = _read_timing(text)
    rows = _read_rows(text, hierarchy, columns, timing.frames)
    turning = [joint for joint, channels in enumerate(hierarchy.channels) if channels]
    skeleton = Skeleton.post_rotation(
        hierarchy.names, hierarchy.parents, hierarchy.offsets, ends=hierarchy.ends, turning=turning
    )
    layout = ChannelLayout.of(skeleton, hierarchy.channels, adds_offset=positions == "add")
    return Motion.from_rows(skeleton, layout, rows, timing.frame_time, name=name)


class _Timing(NamedTuple):
    frames: int
    frame_time: float


def _read_timing(text: Text) -> _Timing:
    """Reads from MOTION to the frame time."""
    word = text.peek()
    if not word:
        text.odd("the file has no MOTION; read as a skeleton without frames. Export it again for its frames.")
        return _Timing(0, 0.0)
    if word.upper() != b"MOTION":
        text.take()
        what = f"{shown(word)} follows the last joint. Write MOTION there, or ROOT for another tree."
        if word == b"}":
            what = "there is one '}' too many. Remove it, or write the '{' that is missing."
        raise text.failure(what, at=text.at - len(word), expected="MOTION", column=True)
    text.take()
    frames = _frame_count(text)
    frame_time = _frame_time(text)
    if frame_time == 0 and frames > 1:
        text.odd(
            "the frame time is 0, so that the frames have no duration. Write seconds after 'Frame Time:'."
        )
    return _Timing(frames, frame_time)


def _frame_count(text: Text) -> int:
    found = text.take_match(_FRAMES)
    if found is None:
        what = f"MOTION is followed by {_next(text)}. Write 'Frames:' and the number of frames."
        raise text.failure(what, expected="Frames: <count>")
    found = found.strip()
    if not found.isdigit():
        what = f"{shown(found)} after 'Frames:' is no count. Write a whole number of frames."
        raise text.failure(what, expected="a whole number")
    # No file holds more rows than bytes, and Python refuses to convert endless digits.
    return int(found) if len(found.lstrip(b"0")) <= 18 else 10**18


def _frame_time(text: Text) -> float:
    found = text.take_match(_FRAME_TIME)
    if not found:
        what = f"'Frames:' is followed by {_next(text)}. Write 'Frame Time:' and the seconds of a frame."
        raise text.failure(what, expected="Frame Time: <seconds>")
    value = number(found)
    if value is None or value < 0:
        why = (
            why_no_number(found)
            if value is None
            else f"{shown(found)} is negative. Write seconds, 0 or more."
        )
        raise text.failure(f"Frame Time: {why}", at=text.at - len(found), expected="seconds", column=True)
    return value


def _next(text: Text) -> str:
    return shown(text.peek()) if text.peek() else "the end of the file"


def _read_rows(text: Text, hierarchy: Hierarchy, columns: int, declared: int) -> NDArray[np.float64]:
    """(F, C) rows, read-only: those declared, or those that are there."""
    rows, end, fault = _core.parse_rows(text.data, text.at, columns, min(declared, len(text.data)))
    rows.flags.writeable = False
    if fault is not None and fault[0] != "cut":
        raise _row_failure(text, hierarchy, columns, _Fault(*fault))
    if fault is not None:
        what = f"the file ends inside frame {fault[1]}, after {fault[2]} of its {columns} numbers"
        text.odd(f"{what}; the frame is left out. Export the file again for the rest.", at=fault[4])
    elif len(rows) < declared:
        what = f"the file declares {declared:,} frames and holds {len(rows):,}, which are read"
        text.odd(f"{what}. Correct the count after 'Frames:', or export the file again.")
    elif more := _core.count_rows(text.data, end):
        what = (
            f"the file declares {declared:,} frames and holds {declared + more:,} rows; the last are left out"
        )
        text.odd(f"{what}. Correct the count after 'Frames:' to have them.")
    return rows


class _Fault(NamedTuple):
    kind: str
    row: int
    field: int
    line: int
    start: int
    end: int


def _row_failure(text: Text, hierarchy: Hierarchy, columns: int, fault: _Fault) -> FormatError:
    """The error for a row that is wrong: line, joint and channel in words."""
    if fault.kind == "row too short":
        what = f"frame {fault.row} has {fault.field} of {columns} numbers; the next is missing"
        mend = "Write each frame on a line of its own."
        return text.failure(f"{_channel(hierarchy, fault.field)}: {what}. {mend}", at=fault.start)
    if fault.kind == "row too long":
        found = columns + len(text.data[fault.start : fault.end].split())
        what = f"frame {fault.row} has {found} numbers, but the joints have {columns} channels"
        return text.failure(f"{what}. Remove those too many, or correct CHANNELS.", at=fault.start)
    why = why_no_number(text.data[fault.start : fault.end])
    return text.failure(f"{_channel(hierarchy, fault.field)}: {why}", at=fault.start, column=True)


def _channel(hierarchy: Hierarchy, column: int) -> str:
    """The joint and channel that a column belongs to."""
    for name, channels in zip(hierarchy.names, hierarchy.channels, strict=True):
        if column < len(channels):
            return f"joint '{name}', {channels[column]}"
        column -= len(channels)
    return "a number beyond the last channel"
