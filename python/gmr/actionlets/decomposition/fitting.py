"""Curves become tracks of actionlets: cuts, angles and skews chosen together.

The best track over a lattice of instants and angles is found, then moved off the lattice to where the squared
error is least, then weighed again: an instant of rest that does not earn its price goes. What hardly travels
becomes a silence.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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

_TRIAL: Final = 12
_FINAL: Final = 40
"""Steps of refinement, at most: of what may be replaced, and of what is given back."""

_BATCH: Final = 400_000
"""Samples that are refined at once: bounds the memory."""


def decompose_curve(times: ArrayLike, angles: ArrayLike, tolerance_deg: float = TOLERANCE_DEG) -> Track:
    """The track of actionlets that a sampled curve is.

    A piece is spent where it takes away as much squared error as ``tolerance_deg`` all through half a second;
    among all tracks the one is looked for that has the least squared error plus what its pieces cost.

    Args:
        times: (N,) seconds, rising; the track begins at the first.
        angles: (N,) radians, continuous: unwrapped, without gaps.
        tolerance_deg: degrees, above 0, 180 at most.

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
        tolerance_deg: degrees, above 0, 180 at most.
    """
    t, values = _checked(times, angles)
    tolerance = math.radians(checked_number(tolerance_deg, "the tolerance", "give degrees above 0"))
    if not 0 < tolerance <= math.pi:
        raise ActionletError(f"the tolerance is {tolerance_deg:g} degrees; give degrees above 0, 180 at most")
    at_once = max(1, _BATCH // len(t))
    curves = list(values.T)
    found: list[Track] = []
    for first in range(0, len(curves), at_once):
        outlines = _fitted(_Task(t, curves[first : first + at_once], tolerance))
        found += [outline.track() for outline in outlines]
    return found


@dataclass(frozen=True, slots=True)
class _Task:
    """What is to be fitted, and what is asked of it: radians and seconds."""

    times: Floats
    curves: Sequence[Floats]
    tolerance: float

    @property
    def price(self) -> float:
        return _WORTH * self.tolerance**2

    @property
    def shortest(self) -> float:
        return min(_SHORTEST, float(self.times[-1] - self.times[0]) / 4)

    def cost(self, n: int, outline: Outline) -> float:
        """Of an outline of curve ``n``: its squared error over time, and the price of its pieces."""
        squares = (outline.at(self.times - self.times[0] + outline.times[0]) - self.curves[n]) ** 2
        error = np.sum(np.diff(self.times) * (squares[1:] + squares[:-1]) / 2)
        return float(error) + self.price * len(outline.skews)

    def settled(self, outlines: Mapping[int, Outline]) -> dict[int, Outline]:
        """Outlines by the numbers of their curves, refined. What hardly travels is known only then; that it
        stands still leaves its neighbours room for more."""
        for _ in range(2):
            curves = [self.curves[n] for n in outlines]
            found = refined(self.times, curves, list(outlines.values()), self.shortest, _TRIAL)
            still = [_with_silences(outline, _STILL * self.tolerance) for outline in found]
            outlines = dict(zip(outlines, still, strict=True))
        return dict(outlines)


def _fitted(task: _Task) -> list[Outline]:
    found = task.settled({n: _on_lattice(task, n) for n in range(len(task.curves))})
    costs = {n: task.cost(n, outline) for n, outline in found.items()}

    def weighed_again(n: int) -> Outline:
        return _weighed_again(task, n, found[n])

    def calmer(n: int) -> Outline:
        return _calmer(found[n], len(found[n].skews))

    def without_hastiest(n: int) -> Outline:
        return _calmer(found[n], 1)

    for proposal in (weighed_again, calmer, weighed_again, without_hastiest):
        proposed = {n: proposal(n) for n in found}
        changed = {n: one for n, one in proposed.items() if len(one.skews) != len(found[n].skews)}
        for n, outline in task.settled(changed).items():
            cost = task.cost(n, outline)
            if cost < costs[n]:
                found[n], costs[n] = outline, cost
    outlines = list(found.values())
    return refined(task.times, task.curves, outlines, task.shortest, _FINAL)


def _on_lattice(task: _Task, n: int) -> Outline:
    t, curve = task.times, task.curves[n]
    count = max(1, round((t[-1] - t[0]) / max(_LATTICE, float(np.diff(t).mean()))))
    instants = np.linspace(t[0], t[-1], count + 1)
    reach = max(_REACH * float(np.ptp(curve)), 0.4 * task.tolerance)
    levels = np.interp(instants, t, curve)[:, None] + reach * _LEVELS
    return cheapest(t, curve, Candidates(instants, levels), task.price, task.shortest, _LONGEST)


def _weighed_again(task: _Task, n: int, outline: Outline) -> Outline:
    """The cheapest track over the instants of this one, and some near them."""
    inner = outline.times[1:-1]
    beside = np.minimum(0.25 * np.diff(outline.times)[:-1], _LATTICE)
    after = np.minimum(0.25 * np.diff(outline.times)[1:], _LATTICE)
    middles = (outline.times[:-1] + outline.times[1:])[np.diff(outline.times) < _HASTY] / 2
    instants = np.unique(np.concatenate([outline.times, inner - beside, inner + after, middles]))
    levels = outline.at(instants)[:, None] + 0.3 * task.tolerance * _LEVELS
    candidates = Candidates(instants, levels)
    return cheapest(task.times, task.curves[n], candidates, task.price, task.shortest, _LONGEST, FINE)


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
