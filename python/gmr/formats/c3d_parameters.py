"""The parameter section of a C3D file, followed entry by entry before ezc3d follows it.

An entry: length of the name (below 0: locked), number of the group (below 0: this is the group), the name,
bytes to the next entry, and for a parameter its type, the number of its dimensions, these, its values; then
the length of its description and that. Source: the C3D file format user guide (Motion Lab Systems), c3d.org.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Final

from gmr.errors import FormatError
from gmr.listing import quoted

__all__ = ["DEC", "Entries", "Value", "float_of", "read_entries"]

DEC: Final = 85
"""What a file says of its processor where its floats are those of DEC."""

_TEXT, _BYTE, _WORD, _FLOAT = -1, 1, 2, 4
_BYTES: Final = {_TEXT: 1, _BYTE: 1, _WORD: 2, _FLOAT: 4}
_DIMENSIONS: Final = 7
_MOST_STEPS: Final = 2**18
"""Values of a section, those of dimension 0 counted as one: twice as many as its 255 blocks have bytes."""


@dataclass(frozen=True, slots=True)
class Value:
    """The value of a parameter: its type (-1 text, 1, 2 or 4 bytes a number) and its bytes."""

    kind: int
    raw: bytes

    def wholes(self) -> list[int] | None:
        """Integers as ezc3d takes them, which are signed; None where the type is another."""
        if self.kind not in (_BYTE, _WORD):
            return None
        return list(
            struct.unpack(f"<{len(self.raw) // self.kind}{'b' if self.kind == _BYTE else 'h'}", self.raw)
        )

    def floats(self, processor: int) -> list[float] | None:
        """Floats as ezc3d takes them; None where the type is another."""
        if self.kind != _FLOAT:
            return None
        return [float_of(self.raw[k : k + 4], processor) for k in range(0, len(self.raw), 4)]


Entries = Mapping[str, Mapping[str, Value]]
"""Group -> name -> value, names as the file has them."""


def float_of(raw: bytes, processor: int) -> float:
    """A 32-bit float; DEC has its halves exchanged and counts its exponent from 2 more."""
    if processor == DEC:
        raw = bytes((raw[2], raw[3], raw[0], (raw[1] - 1) % 256 if raw[1] else 0))
    return float(struct.unpack("<f", raw)[0])


def read_entries(data: bytes, begin: int, end: int, file: str | None) -> tuple[Entries, int]:
    """The parameters between two bytes, and the byte behind the last.

    Of groups that share a name the one of the least number, of parameters the last, as ezc3d has them.

    Raises:
        FormatError: an entry does not lie there, has no known type, or has dimensions that no file can fill.
    """
    groups: dict[int, str] = {}
    held: dict[int, dict[str, Value]] = {}
    steps, last = 0, begin
    for group, name, value, count, last in _entries(data, begin, end, file):  # noqa: B007
        parameters = held.setdefault(abs(group), {})
        if value is None:
            groups[-group] = name
        else:
            parameters[name] = value
        steps += count
        if steps > _MOST_STEPS:
            what = f"the dimensions up to those of {quoted([name], 1)} call for {steps:,} values or more"
            raise _damaged(f"{what}, no file holds more than {_MOST_STEPS // 2:,}", file)
    found: dict[str, dict[str, Value]] = {}
    for number in sorted(held):
        found.setdefault(groups.get(number, ""), held[number])
    return found, last


def _entries(
    data: bytes, at: int, end: int, file: str | None
) -> Iterator[tuple[int, str, Value | None, int, int]]:
    """Group, name, value (None: a group), values to walk, and the byte behind, of each entry."""
    while data[at]:
        length, group = abs(_signed(data[at])), _signed(data[at + 1])
        link = at + 2 + length
        if group == 0 or link + 3 > end:
            raise _damaged(f"the entry at byte {at:,} is none", file)
        name = data[at + 2 : link].split(b"\0")[0].decode("latin-1")
        step = struct.unpack_from("<H", data, link)[0]
        value, count, size = _value(data[link + 2 : end], name, file) if group > 0 else (None, 0, 0)
        used = link + 2 + size
        # ezc3d takes the length of the description for signed, and one below 0 for one without end.
        if used >= end or data[used] > 127 or used + 1 + data[used] > end:
            raise _damaged(f"the description of {quoted([name], 1)} does not end within them", file)
        behind = used + 1 + data[used]
        yield group, name, value, count, behind
        if step == 0:
            return
        if link + step != behind or behind >= end - 1:
            what = f"{quoted([name], 1)} ends at byte {behind:,} and the section at byte {end:,}"
            raise _damaged(f"{what}, but the next entry is said to begin at byte {link + step:,}", file)
        at = link + step


def _value(data: bytes, name: str, file: str | None) -> tuple[Value, int, int]:
    """A value, how many ezc3d walks for it, and the bytes of its type, dimensions and values."""
    kind = _signed(data[0])
    if len(data) < 2 or kind not in _BYTES:
        raise _damaged(f"the parameter {quoted([name], 1)} has no known type", file)
    count = data[1]
    least = 1 if kind == _TEXT else 0  # ezc3d reads text without a dimension into nowhere
    if not least <= count <= _DIMENSIONS:
        what = f"the parameter {quoted([name], 1)} has {count} dimensions, not {least} to {_DIMENSIONS}"
        raise _damaged(what, file)
    dimensions = data[2 : 2 + count]
    size = prod(dimensions) * _BYTES[kind]
    raw = data[2 + count : 2 + count + size]
    if len(raw) < size:
        what = f"the parameter {quoted([name], 1)} needs {size:,} bytes, which are not there"
        raise _damaged(what, file)
    return Value(kind, raw), prod(max(1, dimension) for dimension in dimensions), 2 + count + size


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte


def _damaged(what: str, file: str | None) -> FormatError:
    return FormatError(f"the parameters are damaged: {what}. Export the file again.", file=file)
