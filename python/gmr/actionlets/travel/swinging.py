"""Feet in the air: nominal paths, led from the footprint that is left to the footprint that is met."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.plan import Stance
from gmr.actionlets.travel.slopes import slopes, spread
from gmr.actionlets.travel.turns import picked

__all__ = ["Air", "Edge", "cleared", "in_air", "led_over"]

Floats = NDArray[np.float64]
Frames = NDArray[np.intp]

_HELD = 0.5
"""Seconds within which a correction fades in the air."""

_CARRIED = 0.3
"""Seconds within which the speed of a correction fades."""

_OVERSHOOT = np.radians(8.0)
"""Radians that the speed of a correction may add to it: a faster one fades sooner."""

_RISEN = 0.2
"""Seconds in which a foot has risen so far, where the motion does not show the whole swing."""

_CLEARANCE = 0.012
"""Metres between ground and foot in the middle of a swing, at least."""


@dataclass(frozen=True, eq=False, slots=True)
class Edge:
    """Where the stances on one side of some gaps end.

    Args:
        frames: (g,) the nearest frame on the ground of each gap.
        inward: -1 where the stances end there, 1 where they begin.
        lengths: (g,) frames of each stance less one; -1: there is none.
        away: (m,) how many frames each one in the air is away from the ground.
        fade: (m,) share of an offset that is left there; 0 where there is no stance.
    """

    frames: Frames
    inward: int
    lengths: Frames
    away: Frames
    fade: Floats


@dataclass(frozen=True, eq=False, slots=True)
class Air:
    """A foot in the air: g gaps between its stances, m frames together.

    Args:
        frames: (m,) the frames.
        counts: (g,) frames of each gap.
        held: (g,) frames within which a correction fades.
        edges: towards the stances before and after.
        rise: (m,) share of its clearance that the foot has: up and down by ``x^2 (3 - 2x)`` in the first and
            the second half of a gap, or over 0.2 s at the ends of the motion.
    """

    frames: Frames
    counts: Frames
    held: Floats
    edges: tuple[Edge, Edge]
    rise: Floats


def in_air(stances: Sequence[Stance], frame_count: int, fps: float) -> Air:
    """Where a foot is in the air, from its stances in time."""
    lasts = np.array([-1, *(stance.last for stance in stances)], np.intp)
    firsts = np.array([*(stance.first for stance in stances), frame_count], np.intp)
    some = firsts - lasts > 1
    lengths = np.array([stance.last - stance.first for stance in stances], np.intp)
    before, after = np.concatenate([[-1], lengths])[some], np.concatenate([lengths, [-1]])[some]
    off, down = lasts[some], firsts[some]
    counts = down - off - 1
    since = spread(counts) + 1
    whole = (before >= 0) & (after >= 0)
    held = np.where(whole, np.minimum(_HELD * fps, counts + 1), _HELD * fps)
    half = np.repeat(np.where(whole, (counts + 1) / 2, _RISEN * fps), counts)
    rise = np.ones(len(since))
    edges = []
    sides = ((since, before, off, -1), (np.repeat(counts, counts) + 1 - since, after, down, 1))
    for away, length, frames, inward in sides:
        stands = np.repeat(length >= 0, counts)
        x = np.minimum(away / half, 1)
        rise = rise * np.where(stands, x * x * (3 - 2 * x), 1)
        x = np.minimum(away / np.repeat(held, counts), 1)
        fade = np.where(stands, (1 + 2 * x) * (1 - x) ** 2, 0)
        edges.append(Edge(np.clip(frames, 0, frame_count - 1), inward, length, away, fade))
    return Air(np.repeat(off, counts) + since, counts, held, (edges[0], edges[1]), rise)


def led_over(offsets: Floats, air: Air, fps: float) -> None:
    """Writes what a foot is moved by in the air, from what it is moved by on the ground, C1.

    The offset at the end of a stance fades as ``(1 + 2x)(1 - x)^2``, its speed as ``x (1 - x)^2``, both of
    which end without speed; the same goes backwards from the next stance. Source: cubic Hermite
    interpolation.

    Args:
        offsets: (F, K), known where the foot stands; the rest is written.
        air: of this foot.
        fps: frames a second.
    """
    found = np.zeros((len(air.frames), offsets.shape[1]), order="F")
    gap = np.repeat(np.arange(len(air.counts)), air.counts)
    for edge in air.edges:
        speed = -edge.inward * slopes(offsets, edge.frames, edge.inward, edge.lengths)
        most = np.minimum(air.held, _CARRIED * fps)[:, None]
        window = np.minimum(most, _OVERSHOOT / (4 / 27) / np.maximum(np.abs(speed), 1e-9))
        y = np.minimum(edge.away[:, None] / picked(window, gap), 1)
        found += edge.fade[:, None] * picked(offsets[edge.frames], gap)
        found += y * (1 - y) ** 2 * picked(window * speed, gap)
    offsets[air.frames] = found


def cleared(heel: Floats, toe: Floats, rise: Floats) -> Floats:
    """(n,) metres by which a foot in the air has to be lifted to clear the ground.

    A foot at height ``c`` that should be at ``r`` is lifted by 0 if ``c > r + w``, by ``r - c`` if ``c < r -
    w`` and by ``(r - c + w)^2 / 4w`` between; ``r = w`` is 0 with level slope where the foot leaves and meets
    the ground, so that nothing changes there. ``c`` is the lower of heel and toe, rounded where they change
    over: ``(a + b)/2 - sqrt((a - b)^2/4 + w^2)``.

    Args:
        heel: (n,) height of the heel over the ground.
        toe: (n,) the same of the tip of the toes.
        rise: (n,) how far it is to have risen, of 1; see :class:`Air`.
    """
    w = _CLEARANCE * rise
    short = w - (heel + toe) / 2 + np.hypot((heel - toe) / 2, w)
    return np.asarray(np.where(short <= -w, 0, np.where(short >= w, short, (short + w) ** 2 / (4 * w))))
