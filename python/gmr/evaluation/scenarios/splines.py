"""Random smooth paths: speed and turn rate wander along splines.

Source: a uniform cubic B-spline lies within the bounds of its control values and has a continuous second
derivative (de Boor, "A Practical Guide to Splines", 1978).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.scenario import RUN_UP, Segment, Trial

__all__ = ["Splines"]

STEP: Final = 0.1
"""Seconds of a segment: as often as the character looks for a better frame."""


@dataclass(frozen=True, slots=True)
class Splines:
    """Paths whose speed and turn rate follow cubic B-splines of evenly distributed random values.

    The paths are a sample of what may be asked for: means over them have a confidence interval.

    Attributes:
        count: how many paths.
        seed: of all chance; the same one gives the same bits.
        speeds: lowest and highest speed, metres per second.
        turn_rates_deg: lowest and highest turn rate, degrees per second.
        every: seconds from one random value to the next.
        record: seconds recorded.
        name: in tables and sentences.
    """

    count: int = 20
    seed: int = 0
    speeds: tuple[float, float] = (1.0, 3.0)
    turn_rates_deg: tuple[float, float] = (-100.0, 100.0)
    every: float = 2.0
    record: float = 30.0
    name: str = "splines"

    def trials(self) -> tuple[Trial, ...]:
        """One a path; each is made of segments of 0.1 s."""
        if not (self.every >= 0.1 and STEP <= self.record <= 3600 and 1 <= self.count <= 500):
            raise ValueError(
                f"{self.count} splines of {self.record:g} s with a value every {self.every:g} s cannot be; "
                "give 1 to 500 of them, of 0.1 to 3,600 s, and values 0.1 s apart or more"
            )
        return tuple(
            Trial.along(self.name, f"path {number + 1}", self._segments(number))
            for number in range(self.count)
        )

    def _segments(self, number: int) -> tuple[Segment, ...]:
        # Each path has chance of its own: the first ten of twenty are those of ten.
        random = np.random.Generator(np.random.PCG64([self.seed, number]))
        time = np.asarray((np.arange(round(self.record / STEP)) + 0.5) * (STEP / self.every), np.float64)
        knots = int(time[-1]) + 4
        speed, rate = (
            low + (high - low) * _spline(random.random(knots), time)
            for low, high in (self.speeds, self.turn_rates_deg)
        )
        asked = zip(speed.tolist(), rate.tolist(), strict=True)
        return (
            Segment(RUN_UP, float(speed[0]), 0.0),
            *(Segment(STEP, speed, rate) for speed, rate in asked),
        )


def _spline(values: NDArray[np.float64], time: NDArray[np.float64]) -> NDArray[np.float64]:
    """The uniform cubic B-spline of control values (K,) at times (T,) from 0 to below K - 3."""
    whole = time.astype(np.int64)
    u = time - whole
    weights = (
        (1 - u) ** 3 / 6,
        (3 * u**3 - 6 * u**2 + 4) / 6,
        (-3 * u**3 + 3 * u**2 + 3 * u + 1) / 6,
        u**3 / 6,
    )
    return np.asarray(sum(weight * values[whole + place] for place, weight in enumerate(weights)))
