"""The holes of a dataset: what it was asked and did not do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gmr.evaluation.regions import Grid, Limits
from gmr.evaluation.result import Evaluation

__all__ = ["Ask", "grid_of", "holes"]


@dataclass(frozen=True, order=True, slots=True)
class Ask:
    """A movement that is asked for: one speed and one turn rate.

    Attributes:
        speed: m/s.
        turn_rate_deg: degrees/s, positive to the left.
    """

    speed: float
    turn_rate_deg: float

    @property
    def name(self) -> str:
        """In letters that a file may have: ``1.25mps_left050``, ``2mps_straight``."""
        side = "left" if self.turn_rate_deg > 0 else "right"
        turn = "straight" if self.turn_rate_deg == 0 else f"{side}{abs(self.turn_rate_deg):03.0f}"
        return f"{self.speed:g}mps_{turn}"

    @property
    def straight(self) -> Ask:
        """The same speed straight ahead."""
        return Ask(self.speed, 0.0)


def grid_of(evaluation: Evaluation) -> Grid:
    """The trials of an evaluation over speed and turn rate, and which of them hold."""
    return Grid.of(evaluation.measured.trials, evaluation.measured.coverage, Limits())


def holes(evaluation: Evaluation) -> tuple[Ask, ...]:
    """The trials that do not hold, slowest first, from right to left."""
    grid = grid_of(evaluation)
    return tuple(
        Ask(float(grid.speeds[row]), float(grid.turn_rates_deg[column]))
        for row, column in np.argwhere(~grid.held).tolist()
    )
