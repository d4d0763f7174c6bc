"""An action becomes a score: every extreme of every cycle at its time, with the parameters of that time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.parts import Courses
from gmr.actionlets.actions.timeline import Timeline
from gmr.actionlets.actions.units import Extreme
from gmr.actionlets.actions.values import Value
from gmr.actionlets.score import Score

__all__ = ["all_knots", "intervals", "labelled", "scored", "united"]

Floats = NDArray[np.float64]

_SHORTEST: Final = 0.01
"""Seconds that an actionlet lasts at least; two extremes that are closer because a parameter changes fast
become one."""

_SKEWS: Final = (0.05, 0.95)
"""Skews that a variation does not leave."""


def all_knots(
    courses: Courses,
    timeline: Timeline,
    ranges: Mapping[str, tuple[float, float]],
    factors: Mapping[str, float],
) -> dict[str, Floats]:
    """The extremes of all degrees of freedom over a whole timeline.

    Args:
        ranges: by degree of freedom, in the file's units; a variation goes no further.
        factors: by degree of freedom, radians or metres in one of the file's units.

    Returns:
        By degree of freedom (n, 3) seconds, angle, skew, by time.
    """
    return {dof: _knots(course, timeline, ranges[dof], factors[dof]) for dof, course in courses.items()}


def _knots(
    course: Sequence[Extreme], timeline: Timeline, range_: tuple[float, float], factor: float
) -> Floats:
    rows = []
    for extreme in course:
        _, times = timeline.moments(extreme.phase)
        angles, skews = timeline.values((extreme.angle, extreme.skew), times)
        rows.append(np.column_stack([times, np.clip(angles, *range_) * factor, np.clip(skews, *_SKEWS)]))
    found = np.concatenate(rows)
    return found[np.argsort(found[:, 0], kind="stable")]


def scored(knots_of: Mapping[str, Floats], seconds: float) -> Score:
    """The score through the extremes of all degrees of freedom, from 0 to ``seconds``."""
    return Score.through({dof: _apart(rows) for dof, rows in knots_of.items()}, seconds)


def _apart(rows: Floats) -> Floats:
    """The extremes without those that come too soon after another; two at least."""
    if len(rows) > 1 and (np.diff(rows[:, 0]) >= _SHORTEST).all():
        return rows
    kept = [rows[0]]
    for row in rows[1:]:
        if row[0] - kept[-1][0] >= _SHORTEST:
            kept.append(row)
    if len(kept) == 1:
        kept.append(kept[0] + [1.0, 0.0, 0.0])
    return np.array(kept)


def intervals(spans: Sequence[tuple[Value, Value]], timeline: Timeline) -> Floats:
    """(n, 2) seconds between which phases lie that may follow the parameters; those that touch are one.

    What begins before the timeline or ends after it does so a second beyond.
    """
    first, last = timeline.times[0] - 1, timeline.times[-1] + 1
    found: list[tuple[float, float]] = []
    for begin, end in spans:
        begins, ends = (dict(zip(*timeline.moments(phase), strict=True)) for phase in (begin, end))
        if not timeline.is_cyclic:  # What holds at the ends held before and goes on after.
            begins = begins if begin.highest > 0 else {}
            ends = ends if end.lowest < 1 else {}
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


def labelled(
    labels: Mapping[str, tuple[Value, Value]], timeline: Timeline, seconds: float
) -> tuple[tuple[str, float, float], ...]:
    """The labels of a performance, those parts of them that lie within it, by their beginning."""
    rows = [
        (name, max(float(begin), 0.0), min(float(end), seconds))
        for name, span in labels.items()
        for begin, end in intervals([span], timeline)
        if end > 0 and begin < seconds
    ]
    return tuple(sorted(rows, key=lambda row: row[1:]))
