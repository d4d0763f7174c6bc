"""Weaving to the left and to the right."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

from gmr.evaluation.scenario import RUN_UP, Segment, Trial

__all__ = ["Slalom"]


@dataclass(frozen=True, slots=True)
class Slalom:
    """Turns to left and right in turn about a straight line, one speed and turn rate a trial.

    The first bend is half as long as the others, so that the heading swings as far to the one side as to the
    other and the path goes straight on the whole.

    Attributes:
        speeds: metres per second.
        turn_rates_deg: of the bends, degrees per second, above 0.
        every: seconds of a bend.
        record: seconds recorded; the last bend is as long as there is time for.
        name: in tables and sentences.
    """

    speeds: tuple[float, ...] = (1.0, 2.0, 3.0)
    turn_rates_deg: tuple[float, ...] = (25.0, 100.0)
    every: float = 2.0
    record: float = 30.0
    name: str = "slalom"

    def trials(self) -> tuple[Trial, ...]:
        """One for every speed and turn rate."""
        if not (0.1 <= self.every <= self.record <= 3600):
            raise ValueError(
                f"a slalom of {self.record:g} s, in bends of {self.every:g} s, cannot be; give bends of "
                "0.1 s or more, and a recording of at least one"
            )
        return tuple(
            Trial.along(
                self.name,
                f"{speed:g} m/s, ±{rate:g} deg/s",
                (Segment(RUN_UP, speed, 0.0), *self._bends(speed, rate)),
            )
            for speed, rate in product(self.speeds, self.turn_rates_deg)
        )

    def _bends(self, speed: float, rate: float) -> list[Segment]:
        ends = [self.every * (number + 0.5) for number in range(math.ceil(self.record / self.every + 0.5))]
        starts = [0.0, *ends[:-1]]
        return [
            Segment(min(end, self.record) - start, speed, -rate if number % 2 else rate)
            for number, (start, end) in enumerate(zip(starts, ends, strict=True))
            if start < self.record - 1e-9
        ]
