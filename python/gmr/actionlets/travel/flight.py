"""Flight: while no foot is on the ground the centre of mass follows its parabola, and stance takes it up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.swinging import slope

__all__ = ["GRAVITY", "Flight", "ballistic", "falling", "flights", "taken_up"]

Floats = NDArray[np.float64]

GRAVITY = 9.81
"""m/s^2"""

_TAKEN_UP = 0.35
"""Seconds within which a stance takes up the speed of a flight."""


@dataclass(frozen=True, slots=True)
class Flight:
    """The body in the air after frame ``off`` and before frame ``down``."""

    off: int
    down: int

    @property
    def frames(self) -> slice:
        """The frames, with the one before and the one after."""
        return slice(self.off, self.down + 1)


def flights(on_ground: NDArray[np.bool_]) -> list[Flight]:
    """The flights of (F,) frames that tell whether a foot is on the ground."""
    edges = np.diff(on_ground.astype(np.int8))
    offs, downs = np.flatnonzero(edges == -1).tolist(), (np.flatnonzero(edges == 1) + 1).tolist()
    if not on_ground[0]:
        offs = [0, *offs]
    if not on_ground[-1]:
        downs = [*downs, len(on_ground) - 1]
    return [Flight(off, down) for off, down in zip(offs, downs, strict=True) if down > off]


def ballistic(root: Floats, centre: Floats, fps: float) -> Floats:
    """(n, 3) places of a pelvis whose body's centre of mass falls freely from the first to the last.

    ``c(t) = c0 + (c1 - c0) t/T + g t (T - t) / 2``: the parabola through both ends.

    Args:
        root: (n, 3) the pelvis, whose first and last place are kept.
        centre: (n, 3) the centre of mass from the pelvis, in the world.
        fps: frames a second.
    """
    time = np.arange(len(root)) / fps
    whole = time[-1]
    begin, end = root[0] + centre[0], root[-1] + centre[-1]
    path = begin + (time / whole)[:, None] * (end - begin)
    path[:, 1] += GRAVITY / 2 * time * (whole - time)
    return np.asarray(path - centre, np.float64)


def falling(root: Floats, found: Sequence[Flight], centre: Floats, fps: float) -> Floats:
    """(F, 3) the pelvis with its flights made ballistic; see :func:`taken_up`."""
    moved = root.copy()
    first = 0
    for flight in found:
        count = flight.down - flight.off + 1
        moved[flight.frames] = ballistic(root[flight.frames], centre[first : first + count], fps)
        first += count
    return moved


def taken_up(root: Floats, found: Sequence[Flight], centre: Floats, fps: float) -> Floats:
    """(F, 3) the pelvis with its flights made ballistic, and the stances between them led to their speeds,
    C1.

    Args:
        root: (F, 3) the pelvis, held up in stance.
        found: the flights.
        centre: (n, 3) the centre of mass from the pelvis, in the world, of the flights' frames one after the
            other.
        fps: frames a second.
    """
    moved = falling(root, found, centre, fps)
    begins = [0, *(flight.down for flight in found)]
    ends = [*(flight.off for flight in found), len(root) - 1]
    for k, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        window = min(end - begin, _TAKEN_UP * fps)
        if window < 1:
            continue
        frames = np.arange(begin, end + 1)
        stood = root[begin : end + 1]
        if k > 0:
            short = slope(moved[found[k - 1].frames], -1) - slope(stood, 0)
            moved[frames] += _ramp(frames - begin, window)[:, None] * short
        if k < len(found):
            short = slope(moved[found[k].frames], 0) - slope(stood, -1)
            moved[frames] -= _ramp(end - frames, window)[:, None] * short
    return moved


def _ramp(frames: NDArray[np.intp], window: float) -> Floats:
    """(n,) 0 with slope 1, back to 0 with slope 0 after the window."""
    x = np.minimum(frames / window, 1)
    return np.asarray(window * x * (1 - x) ** 2, np.float64)
