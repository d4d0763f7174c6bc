"""What is to be done when: extremes of each degree of freedom, contacts, path and labels, over some seconds.

Where one plan follows another, each degree of freedom goes on from its last extreme in the one to its first
in the other: the actionlet between them is the transition, and the angle and its velocity are continuous.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise, product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.performance import Performance
from gmr.actionlets.actions.timeline import Profile
from gmr.actionlets.actions.unrolling import scored, united
from gmr.actionlets.travel.plan import Travel, kinds

__all__ = ["Plan", "in_turn", "performed"]

Floats = NDArray[np.float64]

_HASTE: Final = 0.7
_REST: Final = 1.25
"""Shares of the time that a way takes in two movements: one that leads over takes that at least, at most."""


@dataclass(frozen=True)
class Plan:
    """A performance before its extremes are joined by actionlets.

    Args:
        seconds: how long it lasts; what it has before 0 and after that is the movement's own past and future.
        knots: by degree of freedom (n, 3) seconds, angle, skew.
        contacts, speed, turn_rate, travel, labels: as in :class:`Performance`.
        phase: in which it ends, for what goes on with the same step; None for what is done once.
    """

    seconds: float
    knots: Mapping[str, Floats]
    contacts: Mapping[str, Floats]
    speed: Floats
    turn_rate: Floats
    travel: Travel
    labels: tuple[tuple[str, float, float], ...]
    phase: float | None = None


def performed(
    plan: Plan, action: str, parameters: Mapping[str, Profile], seed: int, variation: float
) -> Performance:
    """The plan as a score."""
    return Performance(
        action=action,
        score=scored(plan.knots, plan.seconds),
        contacts={side: _shown(spans, plan.seconds) for side, spans in plan.contacts.items()},
        speed=plan.speed,
        turn_rate=plan.turn_rate,
        travel=plan.travel,
        phases=plan.labels,
        parameters=parameters,
        seed=seed,
        variation=variation,
    )


def _shown(spans: Floats, seconds: float) -> Floats:
    """The intervals that are at least partly within the performance."""
    return spans[(spans[:, 1] > 0) & (spans[:, 0] < seconds)]


def in_turn(plans: Sequence[Plan], join: float) -> Plan:
    """Plans one after the other.

    Args:
        join: seconds that each transition lasts at least; extremes of the plan before give way to that.
    """
    return reduce(lambda one, other: _followed(one, other, join), plans)


def _followed(one: Plan, other: Plan, join: float) -> Plan:
    begin = one.seconds
    dofs = dict.fromkeys((*one.knots, *other.knots))
    return Plan(
        seconds=begin + other.seconds,
        knots={dof: _joined(one.knots.get(dof), other.knots.get(dof), begin, join) for dof in dofs},
        contacts={
            side: united([*_cut(one.contacts[side], -np.inf, begin), *_cut(later, begin, np.inf)])
            for side, later in ((side, spans + begin) for side, spans in other.contacts.items())
        },
        speed=_ramped(one.speed, _later(other.speed, begin), begin, join),
        turn_rate=_ramped(one.turn_rate, _later(other.turn_rate, begin), begin, join),
        travel=_travelled(one.travel, other.travel, begin),
        labels=(*one.labels, *((name, start + begin, end + begin) for name, start, end in other.labels)),
        phase=other.phase,
    )


def _travelled(one: Travel, other: Travel, begin: float) -> Travel:
    """How a body travels that does the one, and the other from ``begin`` on."""
    rows = [*kinds(one), *((seconds + begin, kind) for seconds, kind in kinds(other))]
    changes = [rows[0], *(later for before, later in pairwise(rows) if later[1] != before[1])]
    return tuple(changes) if len(changes) > 1 else changes[0][1]


def _joined(one: Floats | None, other: Floats | None, begin: float, join: float) -> Floats:
    """One degree of freedom's extremes; 0, from the change on, in a plan that does not move it."""
    if other is None:
        other = np.array([[join, 0.0, 0.5]])
    later = _later(other, begin)
    after = later[later[:, 0] >= begin]
    if not len(after):
        after = np.array([[begin, *other[-1, 1:]]])
    if one is None:
        one = np.array([[after[0, 0] - join, 0.0, 0.5]])
    cuts = _cuts(one, later, begin, join)
    for cut in cuts:
        if _is_taken_by_both(one, later, cut) and _has_time(one, later, cut, cut):
            return _cut_over(one, later, cut, cut)
    pairs = [pair for pair in product(cuts, cuts) if pair[0] <= pair[1] and _has_time(one, later, *pair)]
    if pairs:
        return max((_cut_over(one, later, *pair) for pair in pairs), key=_way)
    return np.concatenate([one[one[:, 0] <= after[0, 0] - join], after])


def _cuts(one: Floats, later: Floats, begin: float, join: float) -> list[float]:
    """Seconds at which one movement may give way to another: at the change, or at an extreme of either that
    is no further from it than ``join``; the nearest first."""
    times = np.concatenate([[begin], one[:, 0], later[:, 0]])
    near = times[np.abs(times - begin) <= join]
    return [float(time) for time in near[np.argsort(np.abs(near - begin), kind="stable")]]


def _cut_over(one: Floats, later: Floats, off: float, on: float) -> Floats:
    """The extremes of the one until ``off`` and those of the other after ``on``."""
    return np.concatenate([one[one[:, 0] <= off], later[later[:, 0] > on]])


def _is_taken_by_both(one: Floats, later: Floats, cut: float) -> bool:
    """Whether the way from the last extreme before the cut to the first after it leads up where it does in
    both movements, or down: then no extreme is left out."""
    k, n = int((one[:, 0] <= cut).sum()), int((later[:, 0] <= cut).sum())
    if not (0 < k < len(one) and 0 < n < len(later)):
        return False
    own, its, between = one[k] - one[k - 1], later[n] - later[n - 1], later[n] - one[k - 1]
    return bool(own[1] * its[1] > 0 and own[1] * between[1] > 0)


def _has_time(one: Floats, later: Floats, off: float, on: float) -> bool:
    """Whether the way between takes about as long as in both movements."""
    k, n = int((one[:, 0] <= off).sum()), int((later[:, 0] <= on).sum())
    if not (0 < k < len(one) and 0 < n < len(later)):
        return False
    usual = sorted((one[k, 0] - one[k - 1, 0], later[n, 0] - later[n - 1, 0]))
    return bool(_HASTE * usual[0] <= later[n, 0] - one[k - 1, 0] <= _REST * usual[1])


def _way(rows: Floats) -> float:
    """How far a degree of freedom goes, up and down."""
    return float(np.abs(np.diff(rows[:, 1])).sum())


def _ramped(one: Floats, other: Floats, begin: float, join: float) -> Floats:
    """Two profiles, the one led over to the other from ``join`` before the change to ``join`` after it."""
    first, last = max(begin - join, one[0, 0]), min(begin + join, other[-1, 0])
    return np.concatenate(
        [
            one[one[:, 0] < first],
            [
                [first, np.interp(first, one[:, 0], one[:, 1])],
                [last, np.interp(last, other[:, 0], other[:, 1])],
            ],
            other[other[:, 0] > last],
        ]
    )


def _later(rows: Floats, seconds: float) -> Floats:
    """Rows that begin with a time, put off."""
    moved = rows.copy()
    moved[:, 0] += seconds
    return moved


def _cut(spans: Floats, begin: float, end: float) -> list[tuple[float, float]]:
    return [(max(a, begin), min(b, end)) for a, b in spans.tolist() if max(a, begin) < min(b, end)]
