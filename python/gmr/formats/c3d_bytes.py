"""The bytes of a C3D file, checked within their bounds and then read by ezc3d.

ezc3d believes what a file says of itself: a parameter that ends behind the file sends it into memory that is
not its own, or into a loop without end. So every length that it follows is checked first; that is all that is
read here. Source of the layout: the C3D file format user guide (Motion Lab Systems), c3d.org.
"""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, Final

from gmr.errors import FormatError, MissingExtraError

__all__ = ["BLOCK", "Header", "by_ezc3d", "read_header"]

BLOCK: Final = 512
"""Bytes of a block, the unit in which C3D counts places."""

_MAGIC: Final = 0x50
_INTEL, _DEC, _MIPS = 84, 85, 86
_KINDS: Final = {-1: 1, 1: 1, 2: 2, 4: 4}
"""Bytes of a value of each type: characters, bytes, 16-bit integers, 32-bit floats."""


@dataclass(frozen=True, slots=True)
class Header:
    """What the first block says of the frames.

    Args:
        points: values a frame that are points.
        frames: how many; 16 bits, so that long recordings overflow them.
        start: byte at which the frames begin.
        row: bytes of a frame, points and analog values.
        analog: whether there are analog values.
    """

    points: int
    frames: int
    start: int
    row: int
    analog: bool


def read_header(data: bytes, file: str | None) -> Header:
    """The header of a C3D file, after a check of every length in its parameters.

    Raises:
        FormatError: this is no C3D file, it is damaged, ends before its frames, or is of a MIPS computer.
    """
    if len(data) < 2 or data[1] != _MAGIC:
        found = data[:2].hex(" ") or "nothing"
        what = f"this is no C3D file: its second byte must be 50 (hexadecimal), it begins with {found}"
        raise FormatError(f"{what}. Export it again as C3D.", file=file)
    if len(data) < BLOCK:
        raise _cut(f"its header has {BLOCK} bytes", len(data), file)
    at = (data[0] - 1) * BLOCK
    if data[0] < 2 or at + 4 > len(data):
        raise _cut(f"its parameters begin in block {data[0]}", len(data), file)
    processor = data[at + 3]
    if processor == _MIPS:
        what = "a MIPS computer wrote this file, which ezc3d, by which gmr reads C3D, does not read"
        raise FormatError(f"{what}. Export it again with Intel numbers.", file=file)
    if processor not in (_INTEL, _DEC):
        what = (
            f"the file says that processor {processor} wrote it; gmr reads those of 84 (Intel) and 85 (DEC)"
        )
        raise FormatError(f"{what}. It is damaged; export it again.", file=file)
    _check_parameters(data, at, file)
    points, analog, first, last = struct.unpack_from("<4H", data, 2)
    # The sign of the scale, which tells floats from integers, is in the half that DEC puts first.
    size = 4 if data[15 if processor == _INTEL else 13] & 0x80 else 2
    header = Header(
        points=points,
        frames=max(0, last - first + 1),
        start=(struct.unpack_from("<H", data, 16)[0] - 1) * BLOCK,
        row=(4 * points + analog) * size,
        analog=analog > 0,
    )
    if header.row and header.start < BLOCK:
        raise FormatError("the file does not say where its frames begin. Export it again.", file=file)
    if header.row and header.frames and header.start + header.row > len(data):
        what = f"its first frame ends at byte {header.start + header.row:,}"
        raise _cut(what, len(data), file)
    return header


def by_ezc3d(data: bytes, file: str | None) -> Mapping[str, Any]:
    """What ezc3d makes of a file whose header and parameters have been checked: its own mapping.

    Raises:
        MissingExtraError: ezc3d is not installed.
        FormatError: ezc3d refuses the file; with its words.
    """
    try:
        import ezc3d
    except ImportError as error:
        raise MissingExtraError("ezc3d", "markers", "Reading C3D files") from error
    with tempfile.TemporaryDirectory(prefix="gmr-") as folder:
        path = Path(folder) / "recording.c3d"
        path.write_bytes(data)
        try:
            found: Mapping[str, Any] = ezc3d.c3d(str(path))
        except Exception as error:  # of any class that C++ is mapped to
            said = " ".join(str(error).split()).rstrip(".")
            raise FormatError(f"ezc3d cannot read it: {said}. Export it again.", file=file) from error
    return found


def _check_parameters(data: bytes, at: int, file: str | None) -> None:
    """Follow the entries of the parameter section as ezc3d will, and see that each lies in the file.

    An entry: length of the name, group, name, bytes to the next entry, and for a parameter its type, the
    number of its dimensions, these, its values, the length of its description and that.
    """
    end = at + max(1, data[at + 2]) * BLOCK
    if end > len(data):
        raise _cut(f"its parameters end at byte {end:,}", len(data), file)
    at += 4
    while data[at]:
        length, group = abs(_signed(data[at])), _signed(data[at + 1])
        link = at + 2 + length
        if group == 0 or link + 3 > end:
            raise _damaged(f"the entry at byte {at:,} is none", file)
        name = data[at + 2 : link].decode("latin-1")
        step = struct.unpack_from("<H", data, link)[0]
        used = link + 2 + (_parameter_size(data[link + 2 : end], name, file) if group > 0 else 0)
        # ezc3d takes the length of the description for signed, and one below 0 for one without end.
        if used >= end or data[used] > 127 or used + 1 + data[used] > end:
            raise _damaged(f"the description of '{name[:40]}' does not end within them", file)
        if step == 0:
            return
        if not used <= link + step < end - 1:
            raise _damaged(f"after '{name[:40]}' there is no next entry at byte {link + step:,}", file)
        at = link + step


def _parameter_size(data: bytes, name: str, file: str | None) -> int:
    """Bytes of a parameter's type, dimensions and values."""
    if len(data) < 2 or _signed(data[0]) not in _KINDS:
        raise _damaged(f"the parameter '{name[:40]}' has no known type", file)
    count = data[1]
    least = 1 if _signed(data[0]) == -1 else 0  # ezc3d reads text without a dimension into nowhere
    if not least <= count <= 7:
        raise _damaged(f"the parameter '{name[:40]}' has {count} dimensions, not {least} to 7", file)
    size = prod(data[2 : 2 + count]) * _KINDS[_signed(data[0])]
    if 2 + count + size > len(data):
        raise _damaged(f"the parameter '{name[:40]}' needs {size:,} bytes, which are not there", file)
    return 2 + count + size


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte


def _cut(what: str, length: int, file: str | None) -> FormatError:
    return FormatError(f"the file is cut off: {what}, but it has {length:,} bytes. Copy it again.", file=file)


def _damaged(what: str, file: str | None) -> FormatError:
    return FormatError(f"the parameters are damaged: {what}. Export the file again.", file=file)
