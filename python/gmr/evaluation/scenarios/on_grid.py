"""The paper's scenarios: every cell of a grid of speeds and turn rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.scenario import (
    DEFAULT_SPEEDS,
    DEFAULT_TURN_RATES_DEG,
    SCENARIOS,
    Switching,
    Trial,
    planned_trials,
)
from gmr.table import Table

__all__ = ["OnGrid", "on_grid"]


@dataclass(frozen=True, slots=True)
class OnGrid:
    """The constant or the switching scenario; see :func:`gmr.evaluation.scenario.planned_trials`."""

    name: str = "constant"
    speeds: tuple[float, ...] = DEFAULT_SPEEDS
    turn_rates_deg: tuple[float, ...] = DEFAULT_TURN_RATES_DEG
    preset: str = "even"
    switching: Switching = Switching()  # noqa: RUF009, frozen

    def trials(self) -> tuple[Trial, ...]:
        """One for every pair of speed and turn rate."""
        return planned_trials((self.name,), self.speeds, self.turn_rates_deg, self.preset, self.switching)


def on_grid(trials: Table) -> NDArray[np.bool_]:
    """Which trials of a table are cells of the grid."""
    return np.isin(trials["scenario"].astype(str), list(SCENARIOS))
