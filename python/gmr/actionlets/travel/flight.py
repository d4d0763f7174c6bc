"""Flight: while no foot is on the ground the centre of mass follows its parabola, and stance takes it up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.slopes import slopes, spread
from gmr.editing.easing import smooth_step

__all__ = ["GRAVITY", "Flights", "falling", "flights", "flying_soon", "taken_up"]

Floats = NDArray[np.float64]
Frames = NDArray[np.intp]

GRAVITY = 9.81
"""m/s^2"""

_TAKEN_UP = 0.35
"""Seconds within which a stance takes up the speed of a flight."""


@dataclass(frozen=True, eq=False, slots=True)
class Flights:
    """The body in the air.

    Args:
        off: (g,) the last frames on the ground.
        down: (g,) the next frames on the ground.
    """

    off: Frames
    down: Frames

    def __len__(self) -> int:
        return len(self.off)

    @property
    def counts(self) -> Frames:
        """(g,) frames of each flight with the one before and the one after."""
        return np.asarray(self.down - self.off + 1, np.intp)

    @property
    def frames(self) -> Frames:
        """(n,) these frames, flight after flight."""
        return np.asarray(np.repeat(self.off, self.counts) + spread(self.counts), np.intp)


def flights(on_ground: NDArray[np.bool_]) -> Flights:
    """The flights of (F,) frames that tell whether a foot is on the ground."""
    edges = np.diff(on_ground.astype(np.int8))
    off, down = np.flatnonzero(edges == -1), np.flatnonzero(edges == 1) + 1
    off = off if on_ground[0] else np.concatenate([[0], off])
    down = down if on_ground[-1] else np.concatenate([down, [len(on_ground) - 1]])
    some = down > off
    return Flights(np.asarray(off[some], np.intp), np.asarray(down[some], np.intp))


def flying_soon(air: Flights, frame_count: int, fps: float) -> Floats:
    """(F,) 1 in flight and as long as a stance takes up its speed, falling to 0 within as long again."""
    flying = np.zeros(frame_count, bool)
    flying[air.frames] = True
    near = np.flatnonzero(flying)
    if not len(near):
        return np.zeros(frame_count)
    frames = np.arange(frame_count)
    after = np.clip(np.searchsorted(near, frames), 0, len(near) - 1)
    away = np.minimum(np.abs(near[after] - frames), np.abs(frames - near[np.maximum(after - 1, 0)]))
    return smooth_step(2 - away / (_TAKEN_UP * fps))


def falling(root: Floats, air: Flights, centre: Floats, fps: float) -> Floats:
    """(F, 3) the pelvis of a body whose centre of mass falls freely in each flight, between its ends.

    ``c(t) = c0 + (c1 - c0) t/T + g t (T - t) / 2``: the parabola through both ends.

    Args:
        root: (F, 3) the pelvis.
        air: the flights.
        centre: (n, 3) the centre of mass from the pelvis, in the world, in ``air.frames``.
        fps: frames a second.
    """
    counts, frames = air.counts, air.frames
    at = root[frames] + centre
    ends = np.cumsum(counts)
    begin, end = (np.repeat(at[k], counts, axis=0) for k in (ends - counts, ends - 1))
    time, whole = spread(counts) / fps, np.repeat(counts - 1, counts) / fps
    path = begin + (time / whole)[:, None] * (end - begin)
    path[:, 1] += GRAVITY / 2 * time * (whole - time)
    moved = root.copy()
    moved[frames] = path - centre
    return moved


def taken_up(root: Floats, air: Flights, centre: Floats, fps: float) -> Floats:
    """(F, 3) the pelvis with its flights made ballistic, and the stances between them led to their speeds,
    C1.

    In a stance of ``w`` frames, or in 0.35 s, what its speed lacks at the landing is taken up as ``x (1 -
    x)^2``, and so is what it lacks when the body flies off, backwards. See :func:`falling` for the arguments.
    """
    moved = falling(root, air, centre, fps)
    begins = np.concatenate([[0], air.down])
    ends = np.concatenate([air.off, [len(root) - 1]])
    lengths = ends - begins
    flown = air.down - air.off
    lacks_down, lacks_off = np.zeros((len(begins), 3)), np.zeros((len(begins), 3))
    lacks_down[1:] = slopes(moved, air.down, -1, flown) - slopes(root, air.down, 1, lengths[1:])
    lacks_off[:-1] = slopes(moved, air.off, 1, flown) - slopes(root, air.off, -1, lengths[:-1])
    window = np.clip(lengths, 1, _TAKEN_UP * fps)
    counts = lengths + 1
    since = spread(counts)
    on, wide = np.repeat(begins, counts) + since, np.repeat(window, counts)
    until = np.repeat(lengths, counts) - since
    moved[on] += _ramp(since, wide)[:, None] * np.repeat(lacks_down, counts, axis=0)
    moved[on] -= _ramp(until, wide)[:, None] * np.repeat(lacks_off, counts, axis=0)
    return moved


def _ramp(frames: Frames, window: Floats) -> Floats:
    """(n,) 0 with slope 1, back to 0 with slope 0 after the window."""
    x = np.minimum(frames / window, 1)
    return np.asarray(window * x * (1 - x) ** 2, np.float64)
