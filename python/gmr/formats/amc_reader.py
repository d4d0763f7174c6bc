"""AMC bytes to a motion: the keywords, then the frames, which the core reads."""

from __future__ import annotations

import codecs
import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.acclaim import Acclaim
from gmr.dof_rows import DofRows
from gmr.errors import FormatError
from gmr.formats.asf_finder import asf_contents
from gmr.formats.asf_reader import parse_asf
from gmr.formats.lines import Line, failure, leading_comments, lines_of, numbers_of
from gmr.formats.numerals import why_no_number
from gmr.formats.text import Text, named, shown
from gmr.motion import Motion

__all__ = ["USUAL_FPS", "read_amc", "read_asf"]

USUAL_FPS = 120.0
"""Frames a second of a file that names no rate: that of the CMU database."""

_HIGHEST = 1 << 63
"""Number of a first frame at most, so that 64 bits can count on from it."""

_MOST_COUNTED = 1 << 16
"""Bytes of a line in which superfluous numbers are counted."""


def read_asf(data: bytes, *, name: str | None = None, strict: bool = False) -> Motion:
    """The skeleton of an ASF file as a motion without frames; see :func:`read_amc`."""
    acclaim = parse_asf(bytes(data), name=name, strict=strict)
    values = _core.parse_frames(b"", 0, *_bones(acclaim))[0]
    return _motion(acclaim, DofRows(values, acclaim), 1 / USUAL_FPS, name)


def read_amc(
    data: bytes,
    *,
    name: str | None = None,
    strict: bool = False,
    asf: str | os.PathLike[str] | bytes | None = None,
    fps: float | None = None,
) -> Motion:
    """Motion of an AMC file; its values are kept as read, bit-exact.

    Args:
        data: the file's bytes: UTF-8, or UTF-16 with a byte order mark.
        name: the file's path, for errors, for the motion, and to find the ASF beside.
        strict: raise where a warning would do: an ASF found for a stream, bones missing in a frame, frame
            numbers that skip, a last frame that is cut off, keywords that gmr does not know.
        asf: the skeleton, as a path or the bytes of a file; None: the file beside, see
            :func:`gmr.formats.asf_finder.find_asf`.
        fps: frames a second; None: as ``:SAMPLES-PER-SECOND`` says, else 120 as in the CMU database, for the
            format itself has no word for it.

    Raises:
        FormatError: a file cannot be read, or there is no ASF; the message says where, why, and what to do.
    """
    asf_name, asf_data = asf_contents(asf, name)
    acclaim = parse_asf(asf_data, name=asf_name, strict=strict)
    text = Text(_in_utf8(bytes(data)), name=name, strict=strict)
    if asf is None and name is not None and not Path(name).exists():
        # A stream has no place, so that what lies in the working folder may well be another's.
        text.odd(f"its skeleton is taken from {asf_name}, for none is named. Name it: asf=..., or --asf.")
    notes = leading_comments(text)
    head = _read_head(text, acclaim.radians)
    rows, listed, first = _read_frames(text, acclaim, asf_name)
    known = fps if fps is not None else head.fps
    source = DofRows(rows, acclaim, head.radians, listed, first, known is not None, notes)
    rate = USUAL_FPS if known is None else known
    if not _is_rate(rate):
        raise FormatError(f"a motion cannot have {rate} frames a second; give fps=120 or so", file=name)
    return _motion(acclaim, source, 1 / rate if rate else 0.0, name)


def _in_utf8(data: bytes) -> bytes:
    """The file as UTF-8 where it is Latin-1, as the names of its ASF are then; see :meth:`Text.decoded`."""
    if data.isascii() or data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data
    try:
        data.decode()
    except UnicodeDecodeError:
        return data.decode("latin-1").encode()
    return data


def _motion(acclaim: Acclaim, source: DofRows, frame_time: float, name: str | None) -> Motion:
    return Motion(acclaim.skeleton, frame_time, source, acclaim.unit, name)


class _Head(NamedTuple):
    """What stands before the first frame."""

    radians: bool
    fps: float | None


def _read_head(text: Text, radians: bool) -> _Head:
    """Reads the keywords and leaves ``text`` at the first frame's number."""
    fps = None
    for line in lines_of(text):
        match line.keyword:
            case ":fully-specified":
                pass
            case ":degrees":
                radians = False
            case ":radians":
                radians = True
            case ":samples-per-second":
                fps = _rate(text, line)
            case keyword if keyword.startswith(":"):
                what = f"gmr does not know the keyword {shown(line.words[0])}; passed over."
                text.odd(what, at=line.at, kind="keyword")
            case _:
                text.at = line.at
                break
    return _Head(radians, fps)


def _rate(text: Text, line: Line) -> float:
    (fps,) = numbers_of(text, line, "':SAMPLES-PER-SECOND'", 1)
    if not _is_rate(fps):
        raise failure(text, line, f"there are {shown(line.words[1])} frames a second. Write 120 or so.")
    return fps


def _is_rate(fps: float) -> bool:
    """Whether there can be so many frames a second; 0 stands for frames without duration."""
    return fps == 0 or (math.isfinite(fps) and 0 < 1 / fps < math.inf and fps > 0)


def _bones(acclaim: Acclaim) -> tuple[list[bytes], list[int]]:
    """Names and counts of values of all joints, as the core takes them."""
    names = [name.encode(errors="surrogateescape") for name in acclaim.skeleton.names]
    return names, [len(channels) for channels in acclaim.channels]


class _Fault(NamedTuple):
    """What ended the reading early, as the core tells it."""

    kind: str
    frame: int
    bone: int | None
    field: int
    start: int
    end: int


def _read_frames(
    text: Text, acclaim: Acclaim, asf: str | None
) -> tuple[NDArray[np.float64], tuple[int, ...], int]:
    """Reads (F, C) rows, read-only; the joints as listed; the first frame's number."""
    rows, first, listed, jumps, missing, bone, found = _core.parse_frames(
        text.data, text.at, *_bones(acclaim)
    )
    rows.flags.writeable = False
    names = acclaim.skeleton.names
    fault = _Fault(*found) if found else None
    if fault and fault.kind != "cut":
        raise _failure(text, acclaim, asf, fault)
    if missing[0]:
        others = f" and {missing[0] - 1:,} more have too few" if missing[0] > 1 else ""
        what = f"bone {named(names[bone])} is missing in a frame (number {missing[1] + first}{others})"
        text.odd(f"{what}; a bone keeps its last values there, and rests before its first.", at=missing[2])
    if jumps[0]:
        times = "once" if jumps[0] == 1 else f"{jumps[0]:,} times"
        what = (
            f"frame numbers skip or repeat {times}, here for the first time; the frames are read one by one"
        )
        text.odd(f"{what}, as if none were missing.", at=jumps[2])
    if fault:
        text.odd(
            "the file ends inside a frame, which is left out. Export it again for the rest.", at=fault.start
        )
    return rows, tuple(listed), min(first, _HIGHEST)


def _failure(text: Text, acclaim: Acclaim, asf: str | None, fault: _Fault) -> FormatError:
    names = acclaim.skeleton.names
    token = text.data[fault.start : fault.end]
    title = "" if fault.bone is None else f"bone {named(names[fault.bone])}"
    if fault.kind == "no number":
        begins = shown(token)
        what = f"the frames begin with {begins}. Write a line with the first frame's number before its bones."
        return text.failure(what, at=fault.start, expected="a frame's number")
    if fault.kind == "unknown bone":
        where = "the ASF" if asf is None else Path(asf).name
        what = (
            f"{shown(token)} is no bone of {where}. Give the ASF of this take (asf=...), or correct the name."
        )
        return text.failure(what, at=fault.start)
    if fault.kind == "bone twice":
        return text.failure(f"{title} is there twice in one frame. Remove one.", at=fault.start)
    if fault.kind == "too sparse":
        what = "nearly all bones are missing in these frames. Check that the ASF is that of this take."
        return text.failure(what, at=fault.start)
    assert fault.bone is not None
    channels = acclaim.channels[fault.bone]
    if fault.kind in ("row too short", "row too long"):
        count, has = len(channels), fault.field
        if fault.kind == "row too long":
            has += len(text.data[fault.start : min(fault.end, fault.start + _MOST_COUNTED)].split())
        freedom = " ".join(channels) or "no degrees of freedom"
        what = f"{title} has {has} numbers, but the ASF gives it {count} ({freedom})"
        return text.failure(f"{what}. Correct the line, or give the ASF of this take.", at=fault.start)
    return text.failure(
        f"{title}, {channels[fault.field]}: {why_no_number(token)}", at=fault.start, column=True
    )
