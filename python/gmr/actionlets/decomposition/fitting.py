"""Curves become tracks of actionlets: cuts, angles and skews chosen together.

The best track over a lattice of instants and angles is found, then moved off the lattice to where the squared
error is least, then weighed again: an instant of rest that does not earn its price goes. What hardly travels
becomes a silence.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.actionlet import SYMMETRIC, checked_number
from gmr.actionlets.decomposition.cutting import FINE, Candidates, cheapest
from gmr.actionlets.decomposition.outline import Outline
from gmr.actionlets.decomposition.refining import refined
from gmr.actionlets.track import Track
from gmr.errors import ActionletError

__all__ = ["TOLERANCE_DEG", "decompose_curve", "decompose_curves"]

Floats = NDArray[np.float64]

TOLERANCE_DEG: Final = 1.0
"""Degrees; with it, walks are met within about 0.7 degrees."""

_WORTH: Final = 0.5
"""Seconds over which a piece must take an error of the tolerance away."""

_LATTICE: Final = 1 / 30
"""Seconds between the instants of the first lattice."""

_LEVELS: Final = np.array([-2.5, -1.0, 0.0, 1.0, 2.5])
"""Of the lattice's angles about the curve: bells are flatter at rest than limbs, so they reach beyond."""

_REACH: Final = 0.03
"""From one level to the next, as a share of the range of the curve."""

_LONGEST: Final = 12.0
"""Seconds of the longest piece that is looked for; longer silences are put together afterwards."""

_SHORTEST: Final = 0.05
"""Seconds: no human movement is over sooner."""

_HASTY: Final = 0.15
"""Seconds: a piece that is over sooner may be an artefact; it is weighed against an instant in its middle."""

_STILL: Final = 0.25
"""Share of the tolerance: what travels less is a silence."""

_BATCH: Final = 400_000
"""Samples that are refined at once: bounds the memory."""


def decompose_curve(times: ArrayLike, angles: ArrayLike, tolerance_deg: float = TOLERANCE_DEG) -> Track:
    """The track of actionlets that a sampled curve is.

    A piece is spent where it takes away as much squared error as ``tolerance_deg`` all through half a second;
    among all tracks the one is looked for that has the least squared error plus what its pieces cost.

    Args:
        times: (N,) seconds, rising; the track begins at the first.
        angles: (N,) radians, continuous: unwrapped, without gaps.
        tolerance_deg: degrees, above 0.

    Raises:
        ActionletError: fewer than two samples, times that do not rise, an angle that is no finite number, or
            such a tolerance.
    """
    return decompose_curves(times, np.asarray(angles, np.float64)[:, None], tolerance_deg)[0]


def decompose_curves(
    times: ArrayLike, angles: ArrayLike, tolerance_deg: float = TOLERANCE_DEG
) -> list[Track]:
    """A track for each of several curves over the same times; otherwise as :func:`decompose_curve`.

    Args:
        times: (N,) seconds, rising.
        angles: (N, D) radians.
        tolerance_deg: degrees, above 0.
    """
    t, values = _checked(times, angles)
    tolerance = math.radians(checked_number(tolerance_deg, "the tolerance", "give degrees above 0"))
    if tolerance <= 0:
        raise ActionletError(f"the tolerance is {tolerance_deg:g} degrees; give degrees above 0")
    at_once = max(1, _BATCH // len(t))
    curves = list(values.T)
    found: list[Track] = []
    for first in range(0, len(curves), at_once):
        outlines = _fitted(t, curves[first : first + at_once], tolerance)
        found += [outline.track() for outline in outlines]
    return found


def _fitted(t: Floats, curves: Sequence[Floats], tolerance: float) -> list[Outline]:
    price = _WORTH * tolerance**2
    shortest = min(_SHORTEST, float(t[-1] - t[0]) / 4)
    still = _STILL * tolerance
    found = [_on_lattice(t, curve, tolerance, price, shortest) for curve in curves]
    found = [_with_silences(outline, still) for outline in refined(t, curves, found, shortest)]
    found = refined(t, curves, found, shortest)
    costs = [_cost(t, curve, outline, price) for curve, outline in zip(curves, found, strict=True)]

    def weighed_again(n: int) -> Outline:
        return _weighed_again(t, curves[n], found[n], tolerance, price, shortest)

    for propose in (
        weighed_again,
        lambda n: _calmer(found[n], 99),
        weighed_again,
        lambda n: _calmer(found[n], 1),
    ):
        proposed = {n: propose(n) for n in range(len(curves))}
        changed = [n for n, outline in proposed.items() if len(outline.skews) != len(found[n].skews)]
        these = [curves[n] for n in changed]
        for _ in range(
            2
        ):  # what hardly travels is known once it is refined, and makes room for its neighbours
            trial = refined(t, these, [proposed[n] for n in changed], shortest)
            proposed |= {n: _with_silences(outline, still) for n, outline in zip(changed, trial, strict=True)}
        for n in changed:
            cost = _cost(t, curves[n], proposed[n], price)
            if cost < costs[n]:
                found[n], costs[n] = proposed[n], cost
    return found


def _cost(t: Floats, curve: Floats, outline: Outline, price: float) -> float:
    squares = (outline.at(t - t[0] + outline.times[0]) - curve) ** 2
    return float(np.trapezoid(squares, t)) + price * len(outline.skews)


def _on_lattice(t: Floats, curve: Floats, tolerance: float, price: float, shortest: float) -> Outline:
    count = max(1, round((t[-1] - t[0]) / max(_LATTICE, float(np.diff(t).mean()))))
    instants = np.linspace(t[0], t[-1], count + 1)
    reach = max(_REACH * float(np.ptp(curve)), 0.4 * tolerance)
    levels = np.interp(instants, t, curve)[:, None] + reach * _LEVELS
    return cheapest(t, curve, Candidates(instants, levels), price, shortest, _LONGEST)


def _weighed_again(
    t: Floats, curve: Floats, outline: Outline, tolerance: float, price: float, shortest: float
) -> Outline:
    """The cheapest track over the instants of this one, and some near them."""
    inner = outline.times[1:-1]
    beside = np.minimum(0.25 * np.diff(outline.times)[:-1], _LATTICE)
    after = np.minimum(0.25 * np.diff(outline.times)[1:], _LATTICE)
    middles = (outline.times[:-1] + outline.times[1:])[np.diff(outline.times) < _HASTY] / 2
    instants = np.unique(np.concatenate([outline.times, inner - beside, inner + after, middles]))
    levels = outline.at(instants)[:, None] + 0.3 * tolerance * _LEVELS
    return cheapest(t, curve, Candidates(instants, levels), price, shortest, _LONGEST, FINE)


def _calmer(outline: Outline, most: int) -> Outline:
    """Without its hastiest pieces, at most so many: the instants at their ends become one in the middle."""
    times, angles = outline.times.copy(), outline.angles.copy()
    lengths = np.diff(times)
    kept = np.ones(len(times), bool)
    for place in np.argsort(lengths)[:most].tolist():
        if lengths[place] >= _HASTY or len(lengths) < 2:
            break
        if place in (0, len(lengths) - 1):
            kept[1 if place == 0 else place] = False
        elif kept[place] and kept[place + 1]:
            kept[place + 1] = False
            times[place] = (times[place] + times[place + 1]) / 2
            angles[place] = (angles[place] + angles[place + 1]) / 2
    firsts = np.flatnonzero(kept)[:-1]
    # A piece keeps its own skew: what begins at a middle is what began after the hasty piece.
    ahead = np.where(kept[firsts + 1], firsts, np.minimum(firsts + 1, len(lengths) - 1))
    return Outline(times[kept], angles[kept], outline.skews[ahead])


def _with_silences(outline: Outline, still: float) -> Outline:
    """Pieces that hardly travel made silences, and silences that follow each other one."""
    angles, times = outline.angles.copy(), outline.times
    hold = np.abs(np.diff(angles)) < still
    for place in np.flatnonzero(hold):
        angles[place + 1] = angles[place]
    hold = np.diff(angles) == 0
    kept = np.ones(len(times), bool)
    kept[1:-1] = ~(hold[:-1] & hold[1:])
    firsts = np.flatnonzero(kept)[:-1]
    return Outline(times[kept], angles[kept], np.where(hold[firsts], SYMMETRIC, outline.skews[firsts]))


def _checked(times: ArrayLike, angles: ArrayLike) -> tuple[Floats, Floats]:
    t, values = np.asarray(times, np.float64), np.asarray(angles, np.float64)
    if t.ndim != 1 or values.ndim != 2 or len(t) != len(values):
        raise ActionletError(
            f"times have the shape {t.shape}, angles {values.shape}; give one angle of each curve for each"
            " time"
        )
    if len(t) < 2:
        raise ActionletError(f"a curve of {len(t)} samples has no duration; give two or more")
    if not (np.isfinite(t).all() and (np.diff(t) > 0).all()):
        place = int(np.flatnonzero(~(np.diff(t) > 0))[0]) + 1 if len(t) > 1 else 0
        raise ActionletError(
            f"time {place} of a curve is {t[place]:g} s after {t[place - 1]:g} s; times must rise"
        )
    wrong = np.argwhere(~np.isfinite(values))
    if len(wrong):
        frame, column = wrong[0].tolist()
        raise ActionletError(
            f"angle {frame} of curve {column} is {values[frame, column]}; fill gaps before decomposing"
        )
    return t, values
