"""The header and the parameter section of a C3D file, read within their bounds.

Every count is checked against the bytes that are there before anything is made of it.
Source: the C3D file format user guide (Motion Lab Systems), c3d.org.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError

__all__ = ["BLOCK", "Header", "Parameter", "Parameters", "Processor", "read_header", "read_parameters"]

BLOCK: Final = 512
"""Bytes of a block, the unit in which C3D counts places."""

_MAGIC: Final = 0x50
_KINDS: Final = {-1: 1, 1: 1, 2: 2, 4: 4}
"""Bytes of a value of each type: characters, bytes, 16-bit integers, 32-bit floats."""


class Processor:
    """How the computer that wrote the file put numbers into bytes.

    Args:
        code: 84 Intel, 85 DEC, 86 MIPS.
    """

    NAMES: Final = {84: "Intel", 85: "DEC", 86: "MIPS"}

    def __init__(self, code: int) -> None:
        self.name = self.NAMES[code]
        self.order = ">" if self.name == "MIPS" else "<"

    def integers(self, data: bytes) -> NDArray[np.int16]:
        """16-bit integers."""
        return np.frombuffer(data, f"{self.order}i2").astype(np.int16)

    def floats(self, data: bytes) -> NDArray[np.float64]:
        """32-bit floats. DEC's have their 16-bit halves exchanged and an exponent that is greater by 2."""
        if self.name != "DEC":
            return np.frombuffer(data, f"{self.order}f4").astype(np.float64)
        halves = np.frombuffer(data, "<u2").reshape(-1, 2)
        swapped = np.ascontiguousarray(halves[:, ::-1]).view("<f4")[:, 0].astype(np.float64)
        return swapped / 4


@dataclass(frozen=True, slots=True)
class Header:
    """The first block of the file.

    Args:
        parameters_at: byte at which the parameter section begins.
        points: values a frame that are points: three coordinates and a residual each.
        analog: analog values a frame.
        first, last: frames as numbered by the recorder; 16 bits, so that long recordings overflow them.
        scale: file units of an integer coordinate; negative where coordinates are floats.
        data_at: byte at which the frames begin; 0 where the header does not say.
        rate: frames a second.
        processor: how numbers are written.
    """

    parameters_at: int
    points: int
    analog: int
    first: int
    last: int
    scale: float
    data_at: int
    rate: float
    processor: Processor


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value of the parameter section.

    Args:
        dimensions: the first varies fastest.
        values: numbers, or text where it holds characters: one string for all but the first dimension.
    """

    dimensions: tuple[int, ...]
    values: NDArray[Any] | tuple[str, ...]

    @property
    def texts(self) -> tuple[str, ...]:
        """Its strings; none where it holds numbers."""
        return self.values if isinstance(self.values, tuple) else ()

    @property
    def numbers(self) -> list[float]:
        """Its numbers; none where it holds text."""
        return [] if isinstance(self.values, tuple) else [float(value) for value in self.values]


Parameters = Mapping[str, Mapping[str, Parameter]]
"""Group -> name -> value, all in upper case."""


def read_header(data: bytes, file: str | None) -> Header:
    """The header of a C3D file.

    Raises:
        FormatError: this is no C3D file, or it ends in its header.
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
    code = data[at + 3]
    if code not in Processor.NAMES:
        what = f"the file says that processor {code} wrote it; there are 84 (Intel), 85 (DEC) and 86 (MIPS)"
        raise FormatError(f"{what}. It is damaged; export it again.", file=file)
    processor = Processor(code)
    words = processor.integers(data[:24]).view(np.uint16)
    scale, rate = processor.floats(data[12:16])[0], processor.floats(data[20:24])[0]
    return Header(
        parameters_at=at,
        points=int(words[1]),
        analog=int(words[2]),
        first=int(words[3]),
        last=int(words[4]),
        scale=float(scale),
        data_at=max(0, (int(words[8]) - 1) * BLOCK),
        rate=float(rate),
        processor=processor,
    )


def read_parameters(data: bytes, header: Header, file: str | None) -> Parameters:
    """All parameters of a C3D file.

    Raises:
        FormatError: the section is cut off or its entries do not hang together.
    """
    groups: dict[int, str] = {}
    held: list[tuple[int, str, Parameter]] = []
    at = header.parameters_at + 4
    while at + 2 <= len(data) and data[at] != 0:
        length = abs(_signed(data[at]))
        group = _signed(data[at + 1])
        name = data[at + 2 : at + 2 + length].decode("latin-1").strip().upper()
        link = at + 2 + length
        if group == 0 or link + 2 > len(data):
            raise _damaged(f"an entry at byte {at:,} is none", file)
        step = int(header.processor.integers(data[link : link + 2]).view(np.uint16)[0])
        end = link + step if step else len(data)
        if end > len(data):
            raise _cut(f"the parameter '{name[:40]}' ends at byte {end:,}", len(data), file)
        if group < 0:
            groups[-group] = name
        else:
            held.append((group, name, _parameter(data[link + 2 : end], header.processor, name, file)))
        if step == 0:
            break
        at = end
    found: dict[str, dict[str, Parameter]] = {name: {} for name in groups.values()}
    for group, name, parameter in held:
        if group in groups:
            found[groups[group]][name] = parameter
    return found


def _parameter(data: bytes, processor: Processor, name: str, file: str | None) -> Parameter:
    """One parameter from the bytes after its link to the next."""
    if len(data) < 2 or _signed(data[0]) not in _KINDS:
        raise _damaged(f"the parameter '{name[:40]}' has no known type", file)
    kind, count = _signed(data[0]), data[1]
    dimensions = tuple(data[2 : 2 + count])
    size = prod(dimensions) * _KINDS[kind]
    values = data[2 + count : 2 + count + size]
    if len(dimensions) < count or len(values) < size:
        raise _damaged(f"the parameter '{name[:40]}' needs {size:,} bytes and has {len(values):,}", file)
    if kind == -1:
        width = dimensions[0] if dimensions else 1
        rows = prod(dimensions[1:]) if width else 0
        texts = (values[row * width : (row + 1) * width] for row in range(rows))
        return Parameter(dimensions, tuple(_text(text) for text in texts))
    if kind == 1:
        return Parameter(dimensions, np.frombuffer(values, np.int8))
    return Parameter(dimensions, processor.integers(values) if kind == 2 else processor.floats(values))


def _text(raw: bytes) -> str:
    raw = raw.split(b"\0")[0]
    try:
        return raw.decode().strip()
    except UnicodeDecodeError:
        return raw.decode("latin-1").strip()


def _signed(byte: int) -> int:
    return byte - 256 if byte > 127 else byte


def _cut(what: str, length: int, file: str | None) -> FormatError:
    return FormatError(f"the file is cut off: {what}, but it has {length:,} bytes. Copy it again.", file=file)


def _damaged(what: str, file: str | None) -> FormatError:
    return FormatError(f"the parameters are damaged: {what}. Export the file again.", file=file)
