"""The bytes of a C3D file, checked within their bounds and then read by ezc3d.

ezc3d believes what a file says of itself: a parameter that ends behind the file sends it into memory that is
not its own, or into a loop without end. So every length and count that it follows is checked first; that is
all that is read here. Source of the layout: the C3D file format user guide (Motion Lab Systems), c3d.org.
"""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from gmr.errors import FormatError, MissingExtraError
from gmr.formats.c3d_layout import BLOCK, Header, check_layout, cut_off
from gmr.formats.c3d_parameters import DEC, float_of, read_entries

__all__ = ["by_ezc3d", "read_header"]

_MAGIC: Final = 0x50
_INTEL, _MIPS = 84, 86


def read_header(data: bytes, file: str | None) -> Header:
    """The header of a C3D file, after a check of every length and count in it and in the parameters.

    Raises:
        FormatError: this is no C3D file, it is damaged, contradicts itself, ends before its frames, or is of
            a MIPS computer.
    """
    if len(data) < 2 or data[1] != _MAGIC:
        found = data[:2].hex(" ") or "nothing"
        what = f"this is no C3D file: its second byte must be 50 (hexadecimal), it begins with {found}"
        raise FormatError(f"{what}. Export it again as C3D.", file=file)
    if len(data) < BLOCK:
        raise cut_off(f"its header has {BLOCK} bytes", len(data), file)
    at = (data[0] - 1) * BLOCK
    if data[0] < 2 or at + 4 > len(data):
        raise cut_off(f"its parameters begin in block {data[0]}", len(data), file)
    _check_processor(data[at + 3], file)
    end = at + max(1, data[at + 2]) * BLOCK
    if end > len(data):
        raise cut_off(f"its parameters end at byte {end:,}", len(data), file)
    points, analog, first, last = struct.unpack_from("<4H", data, 2)
    block, ratio = struct.unpack_from("<2H", data, 16)
    header = Header(
        processor=data[at + 3],
        points=points,
        analog=analog,
        first=first,
        last=last,
        scale=float_of(data[12:16], data[at + 3]),
        start=(block - 1) * BLOCK,
        ratio=ratio,
        rate=float_of(data[20:24], data[at + 3]),
    )
    entries, behind = read_entries(data, at + 4, end, file)
    check_layout(data, header, entries, behind, file)
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


def _check_processor(found: int, file: str | None) -> None:
    if found == _MIPS:
        what = "a MIPS computer wrote this file, which ezc3d, by which gmr reads C3D, does not read"
        mend = "Convert it to Intel numbers: docs/markers.md tells how, with the package c3d"
        raise FormatError(f"{what}. {mend}.", file=file)
    if found not in (_INTEL, DEC):
        what = f"the file says that processor {found} wrote it; gmr reads those of 84 (Intel) and 85 (DEC)"
        raise FormatError(f"{what}. It is damaged; export it again.", file=file)
