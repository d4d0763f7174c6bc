"""C3D, the binary format of motion laboratories: points over frames, here read as markers.

The bytes are read by ezc3d (https://github.com/pyomeca/ezc3d); here is told what they mean. Analog channels,
rotations and what a model computed (angles, forces, moments, powers) are named, not read. Source: the C3D
file format user guide, c3d.org.
"""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError, FormatWarning
from gmr.formats.c3d_bytes import by_ezc3d, read_header
from gmr.formats.c3d_layout import BLOCK, Header
from gmr.formats.c3d_values import Parameters, number, numbers, parameters_of, texts
from gmr.listing import quoted
from gmr.markers.axes import AXES, floor_axis
from gmr.markers.recording import Event, Markers, Up
from gmr.units import UNITS

__all__ = ["read_c3d"]

_NO_MARKERS: Final = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS")
"""Lists of the group POINT that name points which are no places of markers."""

_SATURATED: Final = 65535
"""The greatest count of 16 bits, where longer recordings stop counting and ezc3d stops reading."""
_SHOWN: Final = 6


def read_c3d(data: bytes, *, name: str | None = None, strict: bool = False) -> Markers:
    """The markers of a C3D file.

    A point is not seen, and NaN, where its residual is negative, where a coordinate is not finite, and where
    all three are exactly 0, which some programs write instead.

    Every length and count that ezc3d, which is C++, would follow is held against the file's size and against
    the others before it sees the file, so that time and memory are in proportion to that size.

    Times of events are those of the file, which run from its frame 1, less the time from there to the first
    frame that the file holds.

    Args:
        data: the file's bytes.
        name: the file's name, for errors and for the recording.
        strict: raise where a warning would do.

    Raises:
        MissingExtraError: ezc3d is not installed (the extra ``markers``).
        FormatError: this is no C3D file, it is damaged, contradicts itself or is cut off before its first
            frame ends, a MIPS computer wrote it, or ezc3d refuses it; says where and how to mend it.

    Warns:
        FormatWarning: frames that are cut off, points without a label or with the label of another, frame
            counts or places of the frames that contradict each other, no points, no unit, an up axis that the
            markers contradict.
    """
    odd = _Oddities(name, strict)
    header = read_header(data, name)
    first = by_ezc3d(data, name)
    parameters = parameters_of(first)
    stated = int(number(parameters, "DATA_START", 0)) % (_SATURATED + 1)
    if header.row and stated and (stated - 1) * BLOCK != header.start:
        where = f"block {header.start // BLOCK + 1:,} by the header, block {stated:,} by POINT:DATA_START"
        odd.say(f"frames begin in {where}; the header's is taken")
    rate = number(parameters, "RATE", 0)
    if not rate > 0:
        odd.say(f"the rate is {rate} frames a second, so that the frames have no duration")
        rate = math.inf
    points, residuals = _points(data, header, first, parameters, odd)
    kept, labels, ignored = _labels(parameters, points.shape[1], odd)
    positions = points[:, kept]
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
        events=_events(parameters, max(0, header.first - 1) / rate),
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
    data: bytes, header: Header, first: Mapping[str, Any], parameters: Parameters, odd: _Oddities
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(F, P, 3) places and (F, P) residuals of all points, NaN where not seen."""
    places, residuals = _of_ezc3d(first)
    pieces = [(places, residuals)]
    got = len(places)
    count = _frame_count(data, header, parameters, got, odd)
    while got < count:
        # ezc3d counts in 16 bits: the same file again, without the frames that are already there.
        rest = data[: header.start] + data[header.start + got * header.row :]
        read_header(rest, odd.file)
        places, residuals = _of_ezc3d(by_ezc3d(rest, odd.file))
        pieces.append((places[: count - got], residuals[: count - got]))
        got += len(pieces[-1][0])
    places, residuals = (np.concatenate(parts)[:count] for parts in zip(*pieces, strict=True))
    unseen = ~(residuals >= 0) | ~np.isfinite(places).all(axis=2) | ~places.any(axis=2)
    places[unseen] = np.nan
    residuals[unseen] = np.nan
    return places, residuals


def _of_ezc3d(found: Mapping[str, Any]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(F, P, 3) places and (F, P) residuals as ezc3d has them."""
    places = np.asarray(found["data"]["points"], np.float64)[:3].transpose(2, 1, 0)
    residuals = np.asarray(found["data"]["meta_points"]["residuals"], np.float64)[0].T
    return np.array(places), np.array(residuals)


def _frame_count(data: bytes, header: Header, parameters: Parameters, read: int, odd: _Oddities) -> int:
    """How many frames there are, where ezc3d has read so many of them.

    The header counts in 16 bits, so that long recordings have parameters for it, each in its own way.
    """
    whole = (len(data) - header.start) // header.row if header.row else read
    start, end = (_long(numbers(parameters, "TRIAL", f"ACTUAL_{which}_FIELD")) for which in ("START", "END"))
    claims = {
        "POINT:LONG_FRAMES": int(number(parameters, "LONG_FRAMES", 0)),
        "TRIAL:ACTUAL_END_FIELD": end - start + 1 if end else 0,
        "the header": header.frames,
    }
    claims = {where: count for where, count in claims.items() if count > 0}
    turned = any(numbers(parameters, "ROTATION", "USED"))  # then what follows the frames are no frames
    if read == _SATURATED and header.row and not turned:
        fitting = (claims[key] for key in list(claims)[:-1] if read <= claims[key] <= whole)
        return next(fitting, None) or _uncounted(data, header, odd)
    if 0 < header.frames < read == whole:
        what = f"the header counts {header.frames:,} frames, POINT:FRAMES {read:,} or more"
        odd.say(f"{what}; {header.frames:,} are read")
        return header.frames
    for where, count in claims.items():
        if count > whole:
            what = f"the file is cut off: {where} counts {count:,} frames of {header.row:,} bytes"
            odd.say(f"{what}, but {read:,} are there, which are read. Copy it again for the rest")
            break
        if count != read:
            odd.say(f"{where} counts {count:,} frames, ezc3d reads {read:,}, which are taken")
            break
    return read


def _uncounted(data: bytes, header: Header, odd: _Oddities) -> int:
    """How many frames there are where the count stands at its greatest: as many as the file has room for,
    without the zeros that fill its last block."""
    empty = len(data) - max(header.start, len(data.rstrip(b"\0")))
    whole = (len(data) - header.start) // header.row - min(empty, BLOCK - 1) // header.row
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
    labels = list(texts(parameters, "POINT", "LABELS"))[:count]
    labels += [""] * (count - len(labels))
    if blank := sum(not label for label in labels):
        odd.say(
            f"{blank} of {count} points have no label; they are called by their place, 'unnamed 1' and so on"
        )
        labels = [label or f"unnamed {place}" for place, label in enumerate(labels, 1)]
    computed = {
        label: key
        for key in _NO_MARKERS
        if key in point
        for label in texts(parameters, "POINT", key)
        if label
    }
    kept = [place for place, label in enumerate(labels) if label not in computed]
    chosen = tuple(labels[place] for place in kept)
    if twice := [label for label, times in Counter(chosen).items() if times > 1]:
        odd.say(f"several markers share a label: {quoted(twice, _SHOWN)}")
    kinds = Counter(computed[label].lower() for label in labels if label in computed)
    ignored = [f"{times} {kind} of a model" for kind, times in kinds.items()]
    if rotations := int(next(iter(numbers(parameters, "ROTATION", "USED")), 0)):
        ignored.append(f"rotations of {rotations} segments")
    return kept, chosen, tuple(ignored)


def _analog(parameters: Parameters) -> str:
    """The analog channels in words."""
    names = [label for label in texts(parameters, "ANALOG", "LABELS") if label]
    count = int(next(iter(numbers(parameters, "ANALOG", "USED")), len(names)))
    said = f" ({', '.join(names[:3])}{', ...' if len(names) > 3 else ''})" if names else ""
    return f"{count} analog channels{said}"


def _events(parameters: Parameters, start: float) -> tuple[Event, ...]:
    """The events; times are pairs of minutes and seconds since frame 1, ``start`` seconds before ours."""
    labels = texts(parameters, "EVENT", "LABELS")
    contexts = texts(parameters, "EVENT", "CONTEXTS")
    times = numbers(parameters, "EVENT", "TIMES")
    count = min(len(labels), len(times) // 2)
    return tuple(
        Event(
            label=labels[k],
            context=contexts[k] if k < len(contexts) else "",
            seconds=60 * times[2 * k] + times[2 * k + 1] - start,
        )
        for k in range(count)
    )


def _unit(parameters: Parameters, odd: _Oddities) -> float | None:
    """Metres per file unit."""
    stated = next(iter(texts(parameters, "POINT", "UNITS")), "")
    known = UNITS.get(stated.lower().rstrip("s") if stated.lower() != "cms" else "cm")
    if known is None:
        told = f"in '{stated}', which is no unit that gmr knows" if stated else "in no stated unit"
        odd.say(f"lengths are {told}; declare it: markers.with_unit('mm')")
    return known


def _up(parameters: Parameters, positions: NDArray[np.float64], odd: _Oddities) -> Up | None:
    """The axis that points up: as the file says, unless all markers lie on the other side of the floor."""
    stated = next(iter(texts(parameters, "POINT", "Y_SCREEN")), "").upper()
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
