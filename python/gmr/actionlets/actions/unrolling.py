"""An action becomes a score: every extreme of every cycle at its time, with the parameters of that time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.timeline import Moments, Timeline
from gmr.actionlets.actions.variation import Variation
from gmr.actionlets.actions.written import Span, Written
from gmr.actionlets.score import Score

__all__ = ["Unrolled", "scored", "united"]

Floats = NDArray[np.float64]

_SHORTEST: Final = 0.01
"""Seconds that an actionlet lasts at least; two extremes that are closer because a parameter changes fast
become one."""

_INSTANT: Final = 1e-9
"""Seconds of a label that are none: rounding."""

_SKEWS: Final = (0.05, 0.95)
"""Skews that a variation does not leave."""


@dataclass(frozen=True, eq=False)
class Unrolled:
    """An action over a whole timeline.

    Args:
        change: how somebody does it; it goes no further than the ranges of motion.
    """

    written: Written
    change: Variation
    timeline: Timeline

    def knots(self) -> dict[str, Floats]:
        """By degree of freedom (n, 3) the extremes: seconds, angle, skew, by time."""
        written, change, values = self.written, self.change, self.timeline.values
        count = int(self._moments.bounds[len(written.angles)])
        which, times = self._moments.owner[:count], self._moments.seconds[:count]
        own, other = (values(written.angles, k, times) for k in (which, change.neighbour[which]))
        angles = np.clip(own + change.towards[which] * (other - own), written.low[which], written.high[which])
        skews = np.clip(values(written.skews, which, times) + change.tilt[which], *_SKEWS)
        rows = np.stack([times, angles * written.factor[which], skews], axis=1)
        bounds = self._moments.bounds[written.first]
        dof = np.repeat(np.arange(len(written.dofs)), np.diff(bounds))
        rows = rows[np.lexsort((times, dof))]
        spans = zip(written.dofs, bounds[:-1].tolist(), bounds[1:].tolist(), strict=True)
        return {name: rows[first:end] for name, first, end in spans}

    def contacts(self) -> dict[str, Floats]:
        """By side (n, 2) the seconds between which the foot is on the ground."""
        return {side: self._intervals(spans) for side, spans in self.written.contacts.items()}

    def labels(self, seconds: float) -> tuple[tuple[str, float, float], ...]:
        """The labels, those parts of them that lie between 0 and ``seconds``, by their beginning."""
        rows = [
            (name, max(float(begin), 0.0), min(float(end), seconds))
            for name, span in self.written.labels.items()
            for begin, end in self._intervals([span])
            if end > _INSTANT and begin < seconds - _INSTANT
        ]
        return tuple(sorted(rows, key=lambda row: row[1:]))

    @cached_property
    def _moments(self) -> Moments:
        return self.timeline.moments(self.written.phases, self.change.shift)

    def _intervals(self, spans: Sequence[Span]) -> Floats:
        """(n, 2) seconds between which phases lie that may follow the parameters; those that touch are one.

        What begins before the timeline or ends after it does so a second beyond.
        """
        phases, shift = self.written.phases, self.change.shift
        first, last = self.timeline.times[0] - 1, self.timeline.times[-1] + 1
        found: list[tuple[float, float]] = []
        for begin, end in spans:
            begins, ends = self._moments.of(begin), self._moments.of(end)
            if not self.timeline.is_cyclic:  # What holds at the ends held before and goes on after.
                begins = begins if phases.highest[begin] + shift[begin] > 0 else {}
                ends = ends if phases.lowest[end] + shift[end] < 1 else {}
                found.append((begins.get(0, first), ends.get(0, last)))
                continue
            found += [(begins.get(k, first), ends.get(k, last)) for k in sorted({*begins, *ends})]
        return united(sorted(span for span in found if span[0] < span[1]))


def united(spans: Sequence[tuple[float, float]]) -> Floats:
    """(n, 2) intervals, given by their beginnings, with those that touch made one."""
    joined: list[tuple[float, float]] = []
    for begin, end in spans:
        if joined and begin <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((begin, end))
    return np.array(joined).reshape(-1, 2)


def scored(knots_of: Mapping[str, Floats], seconds: float) -> Score:
    """The score through the extremes of all degrees of freedom, from 0 to ``seconds``."""
    if knots_of and not _are_apart([*knots_of.values()]):
        knots_of = {dof: rows if _are_apart([rows]) else _apart(rows) for dof, rows in knots_of.items()}
    return Score.through(knots_of, seconds)


def _are_apart(knots: Sequence[Floats]) -> bool:
    """Whether there are two extremes at least in each of these, and none comes too soon after another."""
    counts = np.array([len(rows) for rows in knots], np.intp)
    steps = np.diff(np.concatenate([rows[:, 0] for rows in knots]))
    steps[np.cumsum(counts)[:-1] - 1] = np.inf
    return bool((counts > 1).all() and (steps >= _SHORTEST).all())


def _apart(rows: Floats) -> Floats:
    """The extremes without those that come too soon after another; two at least."""
    kept = [rows[0]]
    for row in rows[1:]:
        if row[0] - kept[-1][0] >= _SHORTEST:
            kept.append(row)
    if len(kept) == 1:
        kept.append(kept[0] + [1.0, 0.0, 0.0])
    return np.array(kept)
