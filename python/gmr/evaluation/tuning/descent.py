"""Coordinate descent over factors: one is made larger or smaller at a time, by less and less.

No chance is in it: the same function gives the same steps. Source: Hooke and Jeeves, "Direct search solution
of numerical and statistical problems", Journal of the ACM 8 (1961), its exploratory moves, in the logarithm.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

__all__ = ["Descent", "Step", "descend"]

FIRST: Final = 2.0
"""The factor of the first moves."""

LAST: Final = 1.1
"""Smaller factors are not tried."""

FARTHEST: Final = 16.0
"""From where it began no coordinate goes farther than this factor, up or down."""

Factors: TypeAlias = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Step:
    """One evaluation: the factors tried, what they gave, and whether that was better than all before."""

    factors: Factors
    value: float
    better: bool


@dataclass(frozen=True, slots=True)
class Descent:
    """Where it ended, and every step on the way; the first one is the beginning."""

    factors: Factors
    value: float
    steps: tuple[Step, ...]


def descend(
    objective: Callable[[Factors], float], count: int, free: Sequence[int], most: int = 100
) -> Descent:
    """Lower an objective by moves of one factor at a time, from all 1.

    Args:
        objective: of ``count`` factors above 0.
        count: how many factors there are.
        free: which of them may move.
        most: evaluations, at most.
    """
    known: dict[Factors, float] = {}
    steps: list[Step] = []

    def value_of(factors: Factors, best: float) -> float:
        if factors not in known:
            known[factors] = objective(factors)
            steps.append(Step(factors, known[factors], known[factors] < best))
        return known[factors]

    here = (1.0,) * count
    lowest = value_of(here, float("inf"))
    by = FIRST
    while by >= LAST and len(steps) < most:
        before = lowest
        for place in free:
            for move in (by, 1 / by):
                moved = _moved(here, place, move)
                # On in the same direction for as long as that helps.
                while moved and len(steps) < most and value_of(moved, lowest) < lowest:
                    here, lowest = moved, known[moved]
                    moved = _moved(here, place, move)
        if lowest == before:
            by = by**0.5
    return Descent(here, lowest, tuple(steps))


def _moved(here: Factors, place: int, move: float) -> Factors | None:
    """The factors after a move; None where that goes too far."""
    # Rounded, so that a way there and back is the same place.
    factor = round(here[place] * move, 9)
    if not 1 / FARTHEST - 1e-6 <= factor <= FARTHEST + 1e-6:
        return None
    return (*here[:place], factor, *here[place + 1 :])
