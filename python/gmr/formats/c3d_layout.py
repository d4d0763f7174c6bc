"""What ezc3d will count, index and allocate for a C3D file, worked out first and held against its size.

ezc3d (1.7) believes the parameters before the header, and holds neither against the file: analog data at
10^9 Hz has it make 10^7 values for each frame, a parameter without values has it read what is not there. Some
of its errors end the process. So all that it counts by is derived here as it derives it, and what contradicts
itself or the file is refused.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np

from gmr.errors import FormatError
from gmr.formats.c3d_parameters import Entries

__all__ = ["BLOCK", "Header", "check_layout", "cut_off"]

BLOCK: Final = 512
"""Bytes of a block, the unit in which C3D counts places."""

Number = TypeVar("Number", int, float)

_MOST_RATE: Final = 200_000.0
"""Frames a second; from 214,748 on ezc3d compares the rates of header and parameters by no number."""
_ROTATION: Final = 17 * 4
"""Bytes of a rotation: a matrix of 4 x 4 floats, and how reliable it is."""
_EMPTY: Final = 4
"""Subframes without a value that ezc3d may make for each byte of the file."""


@dataclass(frozen=True, slots=True)
class Header:
    """What the first block says of the frames.

    Args:
        processor: 84 (Intel) or 85 (DEC).
        points: points a frame.
        analog: analog values a frame.
        first: number of the first frame, usually counted from 1.
        last: number of the last one; 16 bits, so that long recordings overflow them.
        scale: file units of a step of whole numbers; below 0: values are floats.
        start: byte at which the frames begin.
        ratio: analog values of a channel a frame.
        rate: frames a second.
    """

    processor: int
    points: int
    analog: int
    first: int
    last: int
    scale: float
    start: int
    ratio: int
    rate: float

    @property
    def frames(self) -> int:
        """How many frames it counts."""
        return max(0, self.last - self.first + 1)

    @property
    def row(self) -> int:
        """Bytes of a frame, points and analog values."""
        return (4 * self.points + self.analog) * (4 if self.scale < 0 else 2)


def check_layout(data: bytes, header: Header, held: Entries, behind: int, file: str | None) -> None:
    """See that the file holds all that ezc3d will look for.

    Args:
        data: the file.
        header: its header.
        held: its parameters.
        behind: the byte behind the last of them.
        file: the file's name, for errors.

    Raises:
        FormatError: it does not, or header and parameters contradict each other; says what was expected.
    """
    told = _Told(held, header.processor, file)
    if header.row and header.start < behind:
        where = f"byte {header.start:,}, which is not behind the parameters, that end at byte {behind:,}"
        raise told.refused(f"the header does not say where its frames begin: {where}")
    points = told.whole("POINT", "USED", 0)
    if points != header.points:
        what = f"the header counts {header.points:,} points, the parameters {points:,} (POINT:USED)"
        raise told.refused(what)
    _check_scale(header, told)
    rate = _rate(header, told)
    ratio = _check_analog(header, told, rate)
    if header.row and header.start + header.row > len(data):
        holds = f"{header.points:,} points and {header.analog:,} analog values"
        what = f"its first frame, of {holds}, ends at byte {header.start + header.row:,}"
        raise cut_off(what, len(data), file)
    frames = _check_frames(header, told)
    whole = (len(data) - header.start) // header.row if header.row else frames
    if "ROTATION" in held:
        _check_rotations(data, header, told, frames, whole)
    elif not header.row:
        return
    # ezc3d reads a frame more than there is, to find that it is not there.
    if not header.analog and (whole + 1) * ratio > _EMPTY * len(data):
        what = f"there are {ratio:,} analog values of each channel a frame (ANALOG:RATE over POINT:RATE)"
        raise told.refused(f"{what}, but no channel, and the file has only {len(data):,} bytes")


@dataclass(frozen=True, slots=True)
class _Told:
    """The parameters, with what ezc3d takes where there is none."""

    held: Entries
    processor: int
    file: str | None

    def has(self, group: str, name: str) -> bool:
        return name in self.held.get(group, {})

    def wholes(self, group: str, name: str, default: Sequence[int]) -> Sequence[int]:
        """The integers of a parameter."""
        value = self.held.get(group, {}).get(name)
        found = default if value is None else value.wholes()
        if found is None:
            raise self.refused(f"{group}:{name} is not of whole numbers, which it must be")
        return found

    def floats(self, group: str, name: str, default: Sequence[float]) -> Sequence[float]:
        """The floats of a parameter."""
        value = self.held.get(group, {}).get(name)
        found = default if value is None else value.floats(self.processor)
        if found is None:
            raise self.refused(f"{group}:{name} is not of 32-bit floats, which it must be")
        return found

    def whole(self, group: str, name: str, default: int | None) -> int:
        """The first integer of a parameter; without a default there must be one."""
        return self.some(group, name, self.wholes(group, name, [] if default is None else [default]))[0]

    def number(self, group: str, name: str, default: float | None) -> float:
        """The first float of a parameter, 0 or more; without a default there must be one."""
        number = self.some(group, name, self.floats(group, name, [] if default is None else [default]))[0]
        if not 0 <= number < math.inf:
            raise self.refused(f"{group}:{name} is {number:g}; it must be 0 or more")
        return number

    def some(self, group: str, name: str, found: Sequence[Number]) -> Sequence[Number]:
        """The numbers of a parameter of which ezc3d takes the first, whether it is there or not."""
        if not found:
            raise self.refused(f"{group}:{name} holds no number; it must hold one")
        return found

    def refused(self, what: str) -> FormatError:
        mend = "The file is damaged; export it again, or correct it with an editor for C3D files"
        return FormatError(f"{what}. {mend}.", file=self.file)


def _check_scale(header: Header, told: _Told) -> None:
    """ezc3d takes the width of a point's numbers from its own scale, that of analog ones from the header."""
    if not header.points:
        return
    scales = [*told.floats("POINT", "SCALE", [-1.0])]
    told.some("POINT", "SCALE", scales)
    number = 2
    while told.has("POINT", f"SCALE{number}"):
        scales += told.floats("POINT", f"SCALE{number}", [])
        number += 1
    for scale in scales[: header.points]:
        if not 0 < abs(scale) < math.inf:
            raise told.refused(f"the scale of the points is {scale:g}; it must be a number other than 0")
        if (scale < 0) != (header.scale < 0):
            kinds = ("whole numbers", "floats")
            what = f"coordinates are {kinds[header.scale < 0]} by the header (scale {header.scale:g})"
            raise told.refused(f"{what}, {kinds[scale < 0]} by POINT:SCALE ({scale:g})")


def _rate(header: Header, told: _Told) -> float:
    """Frames a second as ezc3d divides by it: of the parameters, or of the header where that is 0."""
    rate = told.number("POINT", "RATE", 0.0)
    for where, found in (("POINT:RATE is", rate), ("the header's rate is", header.rate)):
        if not 0 <= found < _MOST_RATE:
            what = f"{where} {found:g} frames a second; it must be 0 or more and below {_MOST_RATE:,.0f}"
            raise told.refused(what)
    return rate or (header.rate if header.points else 0.0)


def _check_analog(header: Header, told: _Told, rate: float) -> int:
    """How many analog values a channel has in a frame."""
    channels = told.whole("ANALOG", "USED", 0)
    analog_rate = told.number("ANALOG", "RATE", 0.0)
    told.some("ANALOG", "GEN_SCALE", told.floats("ANALOG", "GEN_SCALE", [1.0]))
    if channels < 0:
        raise told.refused(f"ANALOG:USED is {channels:,}; it must be 0 or more")
    shadow = "SHADOW" in told.held  # that maker writes no rate
    ratio = header.ratio if int(rate) == 0 or (shadow and header.ratio == 1) else int(analog_rate / rate)
    if channels * ratio != header.analog:
        where = f"ANALOG:USED, {channels:,}, times the {ratio:,} that go into ANALOG:RATE over POINT:RATE"
        what = (
            f"the header counts {header.analog:,} analog values a frame, the parameters {channels * ratio:,}"
        )
        raise told.refused(f"{what} ({where})")
    if header.analog:
        _check_channels(told, channels, shadow)
    return ratio


def _check_channels(told: _Told, channels: int, shadow: bool) -> None:
    """ezc3d takes a scale and an offset of each channel whether it is there or not."""
    counts = {
        "SCALE": len(told.floats("ANALOG", "SCALE", [])),
        "OFFSET": len(told.wholes("ANALOG", "OFFSET", [])),
    }
    for name, count in counts.items():
        number = 2
        while told.has("ANALOG", f"{name}{number}"):
            read = told.floats if name == "SCALE" else told.wholes
            count += len(read("ANALOG", f"{name}{number}", []))
            number += 1
        if count < channels and not (shadow and count == 0):
            what = (
                f"ANALOG:{name} holds {count:,} numbers for {channels:,} channels; it must hold one for each"
            )
            raise told.refused(what)


def _check_frames(header: Header, told: _Told) -> int:
    """How many frames ezc3d will look for."""
    stated = told.whole("POINT", "FRAMES", 0) % 65536
    # Frames are counted from 1; where the first is 0, from 0.
    first, last = (header.first - 1, max(0, header.last - 1)) if header.first else (0, header.last)
    counted = last - first + 1
    if stated or counted > 0 or not (header.row or "ROTATION" in told.held):
        return stated or max(0, counted)
    what = f"the header counts frames from {header.first:,} to {header.last:,}, POINT:FRAMES none"
    raise told.refused(f"{what}; one of them must count those that are there")


def _check_rotations(data: bytes, header: Header, told: _Told, frames: int, whole: int) -> None:
    """Rotations lie behind all frames; ezc3d looks for those of each frame that is counted."""
    used, block = (told.whole("ROTATION", name, None) for name in ("USED", "DATA_START"))
    ratio = _rotation_ratio(header, told)
    if whole < frames and (used or block < 1):
        end = header.start + frames * header.row
        what = f"its {frames:,} frames, which rotations follow, end at byte {end:,}"
        raise cut_off(what, len(data), told.file)
    if used < 0 or not 0 <= ratio < math.inf:
        what = f"there are {used:,} rotations (ROTATION:USED), {ratio:g} times a frame (RATIO, or RATE)"
        raise told.refused(f"{what}; both must be 0 or more")
    size = frames * int(ratio) * used * _ROTATION
    start = (block - 1) * BLOCK
    if size and start < header.start:
        what = f"rotations begin at byte {start:,}, before the frames, which begin at byte {header.start:,}"
        raise told.refused(f"{what} (ROTATION:DATA_START)")
    if size and start + size > len(data):
        raise cut_off(f"its rotations end at byte {start + size:,}", len(data), told.file)
    if not used and frames * int(ratio) > _EMPTY * len(data):
        what = f"there are {ratio:,.0f} rotations of each segment a frame (RATIO, or RATE), but no segment"
        raise told.refused(f"{what}, and the file has only {len(data):,} bytes")


def _rotation_ratio(header: Header, told: _Told) -> float:
    """How often a frame has each rotation."""
    if told.has("ROTATION", "RATIO"):
        return told.whole("ROTATION", "RATIO", None)
    rate = told.number("POINT", "RATE", 0.0)
    # ezc3d compares in steps of 0.0001, the header's in single precision, and keeps that if it is equal.
    kept = int(rate * 10_000) == int(np.float32(header.rate) * np.float32(10_000))
    divisor = header.rate if kept or (rate == 0 and header.points) else rate
    return told.number("ROTATION", "RATE", None) / divisor if divisor else math.inf


def cut_off(what: str, length: int, file: str | None) -> FormatError:
    """The error of a file that ends before what is told of."""
    return FormatError(f"the file is cut off: {what}, but it has {length:,} bytes. Copy it again.", file=file)
