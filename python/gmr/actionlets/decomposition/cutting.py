"""Where a curve is best cut: dynamic programming over candidate instants, a few angles at each.

The cost of a track is its squared error, integrated over time, plus a price for each piece. Among all tracks
that rest at candidate instants, at one of the candidate angles there, the cheapest is found exactly: that up
to instant j at level k is the best over instants i < j and levels of the one up to there and one piece more.
Source: Bellman, "On the approximation of curves by line segments using dynamic programming", Comm. ACM 4,
1961, with actionlets for the segments and free ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.bell import share
from gmr.actionlets.decomposition.outline import Outline

__all__ = ["COARSE", "FINE", "Candidates", "cheapest"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

COARSE: Final = np.linspace(0.1, 0.9, 9)
FINE: Final = np.linspace(0.06, 0.94, 45)
"""Skews among which each piece is given one."""

_POINTS: Final = 24
"""Of a piece at which its error is taken, whatever its duration."""

_U: Final = (np.arange(_POINTS) + 0.5) / _POINTS
_GROWTH: Final = 1.15
"""From one length of a piece to the next, as counted in candidates, once they are too many to try all."""

_BLOCK: Final = 512
"""Candidates whose pieces are weighed at once: bounds the memory."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """Where a track may rest.

    Attributes:
        times: (M,) seconds, rising; the track begins at the first and ends at the last.
        angles: (M, K) radians.
    """

    times: Floats
    angles: Floats


def cheapest(
    times: Floats,
    curve: Floats,
    candidates: Candidates,
    price: float,
    shortest: float,
    longest: float,
    skews: Floats = COARSE,
) -> Outline:
    """The track of least cost.

    Args:
        times: (N,) seconds of the samples.
        curve: (N,) radians.
        candidates: where it may rest.
        price: of a piece, in radians squared times seconds.
        shortest: seconds that a piece must last, where another way is left.
        longest: seconds that a piece may last.
        skews: those from which a piece may have one.
    """
    shares = share(_U[None], skews[:, None])
    count, levels = candidates.angles.shape
    steps = _steps(candidates.times, longest)
    best = np.full((count, levels), np.inf)
    best[0] = 0.0
    before = np.zeros((count, levels, 3), np.int32)  # candidate, level and skew of the piece that leads here
    for first in range(1, count, _BLOCK):
        ends = np.arange(first, min(first + _BLOCK, count))
        costs, tilts = _pieces(times, curve, candidates, ends, steps, shares)
        for row, end in enumerate(ends.tolist()):
            reach = steps[steps <= end]
            weighed = costs[row, : len(reach)]
            hasty = candidates.times[end] - candidates.times[end - reach] < shortest
            if not hasty.all() or end < count - 1:
                weighed = np.where(hasty[:, None, None], np.inf, weighed)
            total = best[end - reach][:, :, None] + weighed
            flat = total.reshape(-1, levels)
            chosen = flat.argmin(axis=0)
            best[end] = flat[chosen, np.arange(levels)] + price
            place, level = np.divmod(chosen, levels)
            before[end] = np.stack([end - reach[place], level, tilts[row, place]], axis=-1)
    return _traced(candidates, skews, before, int(best[-1].argmin()))


def _traced(candidates: Candidates, skews: Floats, before: NDArray[np.int32], level: int) -> Outline:
    """The way back from the end, at which the best level is known."""
    at = len(candidates.times) - 1
    knots, chosen_skews = [(at, level)], []
    while at:
        at, level, skew = before[at, level].tolist()
        knots.append((at, level))
        chosen_skews.append(skew)
    places, chosen = np.array(knots[::-1]).T
    return Outline(candidates.times[places], candidates.angles[places, chosen], skews[chosen_skews[::-1]])


def _pieces(
    times: Floats, curve: Floats, candidates: Candidates, ends: Ints, steps: Ints, shares: Floats
) -> tuple[Floats, Ints]:
    """(E, L, K, K) squared error of the pieces that end at ``ends``, begun each of ``steps`` candidates
    before, by levels at both; and (E, L) numbers of their skews.

    With shares s and angles a and b at the ends, the residual of x is ``(x - a) - (b - a) s``. Of the skews
    the one is taken that fits best with both ends free.
    """
    starts = np.maximum(ends[:, None] - steps, 0)
    t0, t1 = candidates.times[starts], candidates.times[ends][:, None]
    x = np.interp(t0[..., None] + (t1 - t0)[..., None] * _U, times, curve)
    mean = x.mean(axis=-1)
    x = x - mean[..., None]
    spread = shares - shares.mean(axis=1, keepdims=True)
    explained = (x @ spread.T) ** 2 / (spread**2).sum(axis=1)
    skew = explained.argmax(axis=-1)
    s = shares[skew]
    one = candidates.angles[starts] - mean[..., None]
    way = candidates.angles[ends][:, None, None, :] - mean[..., None, None] - one[..., None]
    xx, xs = (x * x).sum(axis=-1), (x * s).sum(axis=-1)
    s_sum, ss = s.sum(axis=-1), (s * s).sum(axis=-1)
    error = (xx[..., None] + _POINTS * one**2)[..., None] + way * (
        2 * (one * s_sum[..., None] - xs[..., None])[..., None] + way * ss[..., None, None]
    )
    error *= ((t1 - t0) / _POINTS)[..., None, None]
    return np.maximum(error, 0.0), skew


def _steps(times: Floats, longest: float) -> Ints:
    """Lengths of pieces that are tried, in candidates: all short ones, then ever farther apart."""
    most = len(times) - 1
    limit = min(most, max(1, int(np.ceil(longest / np.diff(times).mean()))))
    found, step = [], 1
    while step <= limit:
        found.append(step)
        step = max(step + 1, int(step * _GROWTH))
    return np.array(found)
