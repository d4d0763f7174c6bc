"""How a quantity takes a step: how fast it rises, how far it goes beyond, and when it stays where it should.

Source: the usual figures of control engineering, as in Ogata, "Modern Control Engineering", section 5.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["StepResponse", "step_response"]

LOW: Final = 0.1
HIGH: Final = 0.9
"""Shares of the step between which it rises."""


@dataclass(frozen=True, slots=True)
class StepResponse:
    """The figures of one step.

    Attributes:
        rise_time: seconds from a tenth of the step to nine tenths; NaN where it never gets so far.
        overshoot: how far it went beyond the target, in the unit of the values; 0 where it did not.
        settling_time: seconds from the step until it is near the target and stays there; 0 only where it is
            near from the first sample on, as what foresaw the step is; NaN where it is not near at the end.
    """

    rise_time: float
    overshoot: float
    settling_time: float


def step_response(
    values: NDArray[np.float64], start: float, target: float, rate: float, within: float
) -> StepResponse:
    """Measure the answer to a step from ``start`` to ``target`` at time 0.

    Args:
        values: (S,) samples, the k-th taken ``(k + 0.5) / rate`` seconds after the step, as a speed is that
            is measured from one position to the next; linear in between, and as the first before it.
        start: what was asked for before.
        target: what is asked for, not the same.
        rate: samples per second.
        within: how far from the target counts as near.
    """
    progress = (values - start) / (target - start)
    rise = _first(progress, HIGH, rate) - _first(progress, LOW, rate)
    beyond = float(np.max(progress, initial=1.0) - 1.0) * abs(target - start)
    return StepResponse(rise, beyond, _settled(np.abs(values - target), within, rate))


def _first(progress: NDArray[np.float64], level: float, rate: float) -> float:
    """Seconds until the progress first reaches a level; 0 where the first sample is beyond it."""
    reached = np.flatnonzero(progress >= level)
    return _crossing(progress, int(reached[0]), level, rate) if len(reached) else np.nan


def _settled(away: NDArray[np.float64], within: float, rate: float) -> float:
    """Seconds after which the distance from the target stays within a limit."""
    outside = np.flatnonzero(away > within)
    if len(outside) == 0:
        return 0.0 if len(away) else np.nan
    if outside[-1] == len(away) - 1:
        return np.nan
    return _crossing(away, int(outside[-1]) + 1, within, rate)


def _crossing(values: NDArray[np.float64], place: int, level: float, rate: float) -> float:
    """Seconds at which the line from the sample before ``place`` to that at it meets a level."""
    if place == 0:
        return 0.0
    before, after = float(values[place - 1]), float(values[place])
    return float((place - 0.5 + (level - before) / (after - before)) / rate)
