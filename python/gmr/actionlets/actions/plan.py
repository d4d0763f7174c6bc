"""What is to be done when: extremes of each degree of freedom, contacts, path and labels, over some seconds.

Where one plan follows another, each degree of freedom goes on from its last extreme in the one to its first
in the other: the actionlet between them is the transition, and the angle and its velocity are continuous.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.performance import Performance
from gmr.actionlets.actions.timeline import Profile
from gmr.actionlets.actions.unrolling import scored, united

__all__ = ["Plan", "in_turn", "performed"]

Floats = NDArray[np.float64]


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
    travel: str
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
        travel="path" if "path" in (one.travel, other.travel) else "feet",
        labels=(*one.labels, *((name, start + begin, end + begin) for name, start, end in other.labels)),
        phase=other.phase,
    )


def _joined(one: Floats | None, other: Floats | None, begin: float, join: float) -> Floats:
    """One degree of freedom's extremes; 0, from the change on, in a plan that does not move it."""
    if other is None:
        other = np.array([[join, 0.0, 0.5]])
    later = _later(other[other[:, 0] >= 0], begin)
    if not len(later):
        later = np.array([[begin, *other[-1, 1:]]])
    if one is None:
        one = np.array([[later[0, 0] - join, 0.0, 0.5]])
    return np.concatenate([one[one[:, 0] <= later[0, 0] - join], later])


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
