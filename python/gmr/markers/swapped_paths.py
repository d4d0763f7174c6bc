"""Exchanged labels told by paths: at one frame each of two markers appears where the other was going."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["swaps_by_paths"]

Array = NDArray[np.float64]

_REACH: Final = 0.1
"""Seconds of not being seen over which a path is carried on."""
_ASTRAY: Final = 0.010
"""Metres off its path at which a marker may have another's label ..."""
_ACCELERATION: Final = 30.0
"""... and metres a second squared by which it may turn off its path by itself."""
_NEARER: Final = 0.3
"""How much nearer to the other's path than to its own it must be."""
_AT_ONCE: Final = 8
"""Markers that may be off their paths in one frame."""


def swaps_by_paths(
    metres: Array, seen: NDArray[np.bool_], frame_time: float
) -> Iterator[tuple[tuple[int, int], int, int]]:
    """Exchanges as pairs of markers, the first frame, and how many.

    Between two events that are the same pair's, the labels are exchanged, or they are outside; of the two
    the one with fewer frames is taken.

    Args:
        metres: (F, M, 3), NaN where not seen.
        seen: (F, M).
        frame_time: seconds, above 0.
    """
    frames = len(metres)
    events = _events(metres, seen, frame_time)
    # Backwards in time the first frames have a past too.
    for pair, backwards in _events(metres[::-1], seen[::-1], frame_time).items():
        forwards = events.setdefault(pair, [])
        both = np.asarray(seen[:, pair].all(axis=1), np.bool_)
        forwards += [
            frames - frame
            for frame in reversed(backwards)
            if not any(_one_event(frames - frame, other, both) for other in forwards)
        ]
    for pair, held in events.items():
        for first, length in _minority(sorted(held), frames):
            yield pair, first, length


def _events(metres: Array, seen: NDArray[np.bool_], frame_time: float) -> dict[tuple[int, int], list[int]]:
    """Pair -> the frames from which on each goes on where the other was, in time order."""
    reach = max(1, int(_REACH / frame_time))
    expected, age = _carried_on(metres, seen, reach)
    off = np.linalg.norm(metres - expected, axis=2)
    limit = _ASTRAY + _ACCELERATION / 2 * (age * frame_time) ** 2
    stray = np.nan_to_num(off) > limit
    # Where most of the markers leave their paths at once, it is not labels that changed.
    stray[stray.sum(axis=1) > max(_AT_ONCE, metres.shape[1] // 4)] = False
    frames, indices = np.nonzero(stray)
    astray = [
        _Astray(frame, index, float(off[frame, index]), metres[frame, index], expected[frame, index])
        for frame, index in zip(frames.tolist(), indices.tolist(), strict=True)
    ]
    events: dict[tuple[int, int], list[int]] = {}
    for one, other in _close_in_time(astray, reach):
        if _exchanged(one, other):
            held = events.setdefault((min(one.index, other.index), max(one.index, other.index)), [])
            frame = min(one.frame, other.frame)
            if not held or frame > held[-1]:
                held.append(frame)
    return events


def _one_event(one: int, other: int, both: NDArray[np.bool_]) -> bool:
    """Whether two frames are the ends of one gap, or the same: nothing between shows both markers."""
    return not both[min(one, other) : max(one, other)].any()


@dataclass(frozen=True, slots=True)
class _Astray:
    """A marker that appears off its path: where, and where its path went on."""

    frame: int
    index: int
    off: float
    place: Array
    expected: Array


def _carried_on(metres: Array, seen: NDArray[np.bool_], reach: int) -> tuple[Array, NDArray[np.int_]]:
    """(F, M, 3) where each marker would be if it went on as it was last seen, and (F, M) how long ago that
    was in frames; NaN where that is more than ``reach``."""
    frames = np.arange(len(seen))[:, None]
    last = np.maximum.accumulate(np.where(seen, frames, -1), axis=0)
    last = np.concatenate([np.full((1, seen.shape[1]), -1), last[:-1]])
    age = frames - last
    columns = np.arange(seen.shape[1])[None, :]
    place = metres[last, columns]
    expected = place + _steps(metres)[last, columns] * age[..., None]
    expected[(last < 0) | (age > reach)] = np.nan
    return expected, age


def _steps(metres: Array) -> Array:
    """(F, M, 3) how far each marker goes in a frame: the shortest of the last three steps, for one into
    another's place tells nothing; 0 where none is seen, and before there are three."""
    found = np.zeros_like(metres)
    found[1:] = np.nan_to_num(np.diff(metres, axis=0), nan=np.inf)
    sizes = np.linalg.norm(found, axis=2)
    frames = np.arange(len(metres))
    ways = np.maximum(frames - np.arange(3)[:, None], 0)
    best = sizes[ways].argmin(axis=0)
    columns = np.arange(metres.shape[1])[None, :]
    chosen = found[np.take_along_axis(ways[..., None].repeat(metres.shape[1], 2), best[None], 0)[0], columns]
    return np.where(np.isfinite(chosen), chosen, 0.0)


def _close_in_time(astray: list[_Astray], reach: int) -> Iterator[tuple[_Astray, _Astray]]:
    """Pairs of different markers that are off their paths within ``reach`` frames, in time order."""
    start = 0
    for k, later in enumerate(astray):
        while astray[start].frame < later.frame - reach:
            start += 1
        for earlier in astray[start:k]:
            if earlier.index != later.index:
                yield earlier, later


def _exchanged(one: _Astray, other: _Astray) -> bool:
    """Whether each is where the other's path went, much nearer than to its own."""
    crossed = np.linalg.norm(one.place - other.expected) + np.linalg.norm(other.place - one.expected)
    return bool(crossed < _NEARER * (one.off + other.off))


def _minority(events: list[int], frames: int) -> list[tuple[int, int]]:
    """The stretches between every other event: of the two ways to take them, the one with fewer frames."""
    edges = [0, *events, frames]
    spans = list(pairwise(edges))
    ways = [spans[0::2], spans[1::2]]
    fewer = min(ways, key=lambda way: sum(stop - start for start, stop in way))
    return [(start, stop - start) for start, stop in fewer if stop > start]
