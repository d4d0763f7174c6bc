"""C3D, the binary format of motion laboratories: points over frames, here read as markers.

Intel, DEC and MIPS numbers, integer and float coordinates. Analog channels, rotations and what a model
computed (angles, forces, moments, powers) are named, not read. Source: the C3D file format user guide,
c3d.org.
"""

from __future__ import annotations

import math
import warnings
from collections import Counter
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError, FormatWarning
from gmr.formats.c3d_parameters import BLOCK, Header, Parameters, read_header, read_parameters
from gmr.listing import quoted
from gmr.markers.axes import AXES, floor_axis
from gmr.markers.recording import Event, Markers, Up
from gmr.units import UNITS

__all__ = ["read_c3d"]

_NO_MARKERS: Final = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS")
"""Lists of the group POINT that name points which are no places of markers."""

_SATURATED: Final = 65535
"""The greatest count of 16 bits, where longer recordings stop counting."""
_MOST_FRAMES: Final = 1 << 31
"""A count beyond is damage, not a recording."""
_SHOWN: Final = 6


def read_c3d(data: bytes, *, name: str | None = None, strict: bool = False) -> Markers:
    """The markers of a C3D file.

    A point is not seen, and NaN, where its residual is negative, where a coordinate is not finite, and where
    all three are exactly 0, which some programs write instead.

    Args:
        data: the file's bytes.
        name: the file's name, for errors and for the recording.
        strict: raise where a warning would do.

    Raises:
        FormatError: this is no C3D file, it is damaged or cut off; says where and how to mend it.

    Warns:
        FormatWarning: frames that are cut off, points without a label or with the label of another, frame
            counts that contradict each other, no points, no unit, an up axis that the markers contradict.
    """
    odd = _Oddities(name, strict)
    header = read_header(data, name)
    parameters = read_parameters(data, header, name)
    scale = _number(parameters, "SCALE", header.scale)
    rate = _number(parameters, "RATE", header.rate)
    if not (math.isfinite(scale) and scale):
        raise FormatError(
            f"the scale of the points is {scale}; it must not be 0. Export it again.", file=name
        )
    if not (math.isfinite(rate) and rate > 0):
        odd.say(f"the rate is {rate} frames a second, so that the frames have no duration")
        rate = math.inf
    points, residuals = _points(data, header, parameters, scale, odd)
    kept, labels, ignored = _labels(parameters, points.shape[1], odd)
    positions = np.asarray(points[:, kept], np.float64)
    if header.analog:
        ignored = (*ignored, _analog(parameters))
    if not kept:
        odd.say("the file holds no markers" + (f", only {' and '.join(ignored)}" if ignored else ""))
    return Markers(
        labels=labels,
        positions=positions,
        frame_time=1 / rate,
        unit=_unit(parameters, odd),
        residuals=residuals[:, kept],
        up=_up(parameters, positions, odd),
        name=name,
        events=_events(parameters),
        ignored=ignored,
    )


class _Oddities:
    """What is odd about one file: warned of, or an error under ``strict``."""

    def __init__(self, file: str | None, strict: bool) -> None:
        self.file = file
        self.strict = strict

    def say(self, what: str) -> None:
        error = FormatError(f"{what}.", file=self.file)
        if self.strict:
            raise error
        warnings.warn(FormatWarning(str(error)), stacklevel=5)


def _points(
    data: bytes, header: Header, parameters: Parameters, scale: float, odd: _Oddities
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(F, P, 3) places and (F, P) residuals of all points, NaN where not seen."""
    points = int(_number(parameters, "USED", header.points)) % 65536
    if points != header.points:
        odd.say(f"the header counts {header.points:,} points, the parameters {points:,}; the header is taken")
        points = header.points
    size = 4 if scale < 0 else 2
    row = (4 * points + header.analog) * size
    start = int(_number(parameters, "DATA_START", 0) - 1) * BLOCK
    start = start if start > 0 else header.data_at
    if start < BLOCK and row:
        raise FormatError("the file does not say where its frames begin. Export it again.", file=odd.file)
    frames = _frame_count(parameters, header, row, len(data) - start, odd)
    if frames == _SATURATED and row:
        frames = _uncounted(data, start, row, odd)
    if not points or not frames:
        return np.empty((frames, points, 3)), np.empty((frames, points))
    raw = np.frombuffer(data, np.uint8, frames * row, start).reshape(frames, row)
    held = np.ascontiguousarray(raw[:, : 4 * points * size]).tobytes()
    if size == 4:
        with np.errstate(invalid="ignore"):
            values = header.processor.floats(held).reshape(frames, points, 4)
            last = np.nan_to_num(values[..., 3], nan=-1, posinf=-1, neginf=-1).clip(-32768, 32767)
            word = last.astype(np.int16)
        places = values[..., :3].copy()
    else:
        counts = header.processor.integers(held).reshape(frames, points, 4)
        word = counts[..., 3]
        places = counts[..., :3].astype(np.float64) * scale
    unseen = (word < 0) | ~np.isfinite(places).all(axis=2) | ~places.any(axis=2)
    places[unseen] = np.nan
    return places, np.where(unseen, np.nan, (word & 0xFF) * abs(scale))


def _frame_count(parameters: Parameters, header: Header, row: int, room: int, odd: _Oddities) -> int:
    """How many frames there are: as the parameters say, else as the header does; those that are there.

    The header counts in 16 bits, so that long recordings have parameters for it, each in its own way.
    """
    trial = parameters.get("TRIAL", {})
    start, end = (
        _long(trial[key].numbers) if key in trial else 0 for key in ("ACTUAL_START_FIELD", "ACTUAL_END_FIELD")
    )
    claims = {
        "POINT:LONG_FRAMES": int(_number(parameters, "LONG_FRAMES", 0)),
        "TRIAL:ACTUAL_END_FIELD": end - start + 1 if end else 0,
        "POINT:FRAMES": int(_number(parameters, "FRAMES", 0)) % 65536,
        "the header": header.last - header.first + 1 if header.last >= header.first else 0,
    }
    claims = {where: count for where, count in claims.items() if 0 < count < _MOST_FRAMES}
    fitting = {where: count for where, count in claims.items() if count * row <= room}
    if not fitting:
        if not claims:
            return 0
        where, count = next(iter(claims.items()))
        whole = max(0, room) // row if row else 0
        what = (
            f"the file is cut off: {where} counts {count:,} frames of {row:,} bytes, but {whole:,} are there"
        )
        if not whole:
            raise FormatError(f"{what}. Copy it again.", file=odd.file)
        odd.say(f"{what}, which are read. Copy it again for the rest")
        return whole
    where, count = next(iter(fitting.items()))
    for other, claimed in claims.items():
        if claimed != count and not (other in ("the header", "POINT:FRAMES") and count > 65534):
            odd.say(f"{where} counts {count:,} frames, {other} {claimed:,}; {count:,} are read")
            break
    return count


def _uncounted(data: bytes, start: int, row: int, odd: _Oddities) -> int:
    """How many frames there are where the count stands at its greatest: as many as the file has room for,
    without the zeros that fill its last block."""
    room = len(data) - start
    empty = len(data) - max(start, len(data.rstrip(b"\0")))
    whole = room // row - min(empty, BLOCK - 1) // row
    if whole > _SATURATED:
        odd.say(f"the file counts {_SATURATED:,} frames, the most it can; {whole:,} are there, and read")
    return max(_SATURATED, whole)


def _long(words: list[float]) -> int:
    """A 32-bit count from its two 16-bit halves, the lower first."""
    low, high = (int(word) % 65536 for word in (*words, 0, 0)[:2])
    return low + 65536 * high


def _labels(
    parameters: Parameters, count: int, odd: _Oddities
) -> tuple[list[int], tuple[str, ...], tuple[str, ...]]:
    """Which points are markers, their labels, and the other points in words."""
    point = parameters.get("POINT", {})
    labels = list(_listed(parameters, "POINT", "LABELS"))[:count]
    labels += [""] * (count - len(labels))
    if blank := sum(not label for label in labels):
        odd.say(
            f"{blank} of {count} points have no label; they are called by their place, 'unnamed 1' and so on"
        )
        labels = [label or f"unnamed {place}" for place, label in enumerate(labels, 1)]
    computed = {label: key for key in _NO_MARKERS if key in point for label in point[key].texts if label}
    kept = [place for place, label in enumerate(labels) if label not in computed]
    chosen = tuple(labels[place] for place in kept)
    if twice := [label for label, times in Counter(chosen).items() if times > 1]:
        odd.say(f"several markers share a label: {quoted(twice, _SHOWN)}")
    kinds = Counter(computed[label].lower() for label in labels if label in computed)
    ignored = [f"{times} {kind} of a model" for kind, times in kinds.items()]
    if rotations := int(next(iter(_numbers(parameters, "ROTATION", "USED")), 0)):
        ignored.append(f"rotations of {rotations} segments")
    return kept, chosen, tuple(ignored)


def _analog(parameters: Parameters) -> str:
    """The analog channels in words."""
    names = [label for label in _listed(parameters, "ANALOG", "LABELS") if label]
    count = int(next(iter(_numbers(parameters, "ANALOG", "USED")), len(names)))
    said = f" ({', '.join(names[:3])}{', ...' if len(names) > 3 else ''})" if names else ""
    return f"{count} analog channels{said}"


def _events(parameters: Parameters) -> tuple[Event, ...]:
    """The events; times are pairs of minutes and seconds."""
    labels = _listed(parameters, "EVENT", "LABELS")
    contexts = _listed(parameters, "EVENT", "CONTEXTS")
    times = _numbers(parameters, "EVENT", "TIMES")
    count = min(len(labels), len(times) // 2)
    return tuple(
        Event(labels[k], contexts[k] if k < len(contexts) else "", 60 * times[2 * k] + times[2 * k + 1])
        for k in range(count)
    )


def _unit(parameters: Parameters, odd: _Oddities) -> float | None:
    """Metres per file unit."""
    stated = next(iter(_listed(parameters, "POINT", "UNITS")), "")
    known = UNITS.get(stated.lower().rstrip("s") if stated.lower() != "cms" else "cm")
    if known is None:
        told = f"in '{stated}', which is no unit that gmr knows" if stated else "in no stated unit"
        odd.say(f"lengths are {told}; declare it: markers.with_unit('mm')")
    return known


def _up(parameters: Parameters, positions: NDArray[np.float64], odd: _Oddities) -> Up | None:
    """The axis that points up: as the file says, unless all markers lie on the other side of the floor."""
    stated = next(iter(_listed(parameters, "POINT", "Y_SCREEN")), "").upper()
    stated = f"+{stated}" if len(stated) == 1 else stated
    told = floor_axis(positions)
    if stated in AXES:
        if told is None or told == stated:
            return Up(stated, "the file says so (POINT:Y_SCREEN)")
        if told[1] == stated[1]:
            odd.say(
                f"the file says that {stated} points up, but all markers are above the floor along {told}, "
                f"which is taken"
            )
            return Up(told, "all markers are above 0 along it")
        return Up(stated, "the file says so (POINT:Y_SCREEN)")
    return None if told is None else Up(told, "all markers are above 0 along it alone")


def _listed(parameters: Parameters, group: str, key: str) -> tuple[str, ...]:
    """The strings of a parameter and of those that continue it: LABELS, LABELS2, LABELS3, ..."""
    held = parameters.get(group, {})
    found = list(held[key].texts) if key in held else []
    number = 2
    while f"{key}{number}" in held:
        found += held[f"{key}{number}"].texts
        number += 1
    return tuple(found)


def _numbers(parameters: Parameters, group: str, key: str) -> list[float]:
    held = parameters.get(group, {})
    return held[key].numbers if key in held else []


def _number(parameters: Parameters, key: str, default: float) -> float:
    """The first number of a parameter of the group POINT; the default where there is none, or no number."""
    found = next(iter(_numbers(parameters, "POINT", key)), default)
    return found if math.isfinite(found) else default
