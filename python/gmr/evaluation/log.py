"""What was written down at every step of every trial."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["FORCED", "JUMPED", "KEPT", "PLAYED_ON", "Log"]

PLAYED_ON: Final = 0
KEPT: Final = 1
JUMPED: Final = 2
FORCED: Final = 3


_DOUBLES: Final = (
    *("x", "z", "heading"),
    *("ref_x", "ref_z", "ref_heading", "ref_speed", "ref_turn_rate", "ref_drift"),
    *("cost_pose", "cost_trajectory", "discontinuity"),
)


@dataclass(frozen=True, slots=True)
class Log:
    """T trials of at most S steps; what lies after the end of a shorter one is not ``recorded``.

    Attributes:
        x, z: (T, S) root on the ground, metres.
        heading: (T, S) radians, forward = (sin, cos) in (x, z).
        ref_x, ref_z, ref_heading: (T, S) the planned path at the same time.
        ref_speed, ref_turn_rate: (T, S) what is asked for from this step to the next, m/s and radians/s.
        ref_drift: (T, S) radians from the planned heading to the planned way.
        row: (T, S) row of the frame shown; it takes the root to the next step.
        status: (T, S) uint8: PLAYED_ON, KEPT (searched, and stayed), JUMPED, FORCED (jumped at a clip's end).
        cost_pose, cost_trajectory: (T, S) parts of the cost found by a search, NaN where there was none.
        discontinuity: (T, S) mean distance of the joints between the pose left and the pose entered, metres,
            NaN where there was no jump.
        recorded: (T, S) bool, the steps that count.
        rate: steps per second.
    """

    x: NDArray[np.float64]
    z: NDArray[np.float64]
    heading: NDArray[np.float64]
    ref_x: NDArray[np.float64]
    ref_z: NDArray[np.float64]
    ref_heading: NDArray[np.float64]
    ref_speed: NDArray[np.float64]
    ref_turn_rate: NDArray[np.float64]
    ref_drift: NDArray[np.float64]
    row: NDArray[np.int64]
    status: NDArray[np.uint8]
    cost_pose: NDArray[np.float64]
    cost_trajectory: NDArray[np.float64]
    discontinuity: NDArray[np.float64]
    recorded: NDArray[np.bool_]
    rate: float

    @classmethod
    def of(cls, columns: Mapping[str, NDArray[Any]], rate: float) -> Log:
        """The log from the columns of the simulation, in double precision.

        Args:
            columns: ``lengths`` and ``recorded_from`` (T,) in steps, and (T, S) arrays named as here.
            rate: steps per second.
        """
        step = np.arange(columns["x"].shape[1])[None, :]
        first, length = columns["recorded_from"][:, None], columns["lengths"][:, None]
        return cls(
            **{name: np.asarray(columns[name], np.float64) for name in _DOUBLES},
            row=np.asarray(columns["row"], np.int64),
            status=np.asarray(columns["status"], np.uint8),
            recorded=(first <= step) & (step < length),
            rate=rate,
        )

    def take(self, trials: NDArray[np.integer[Any]]) -> Log:
        """The log of some of the trials, by their indices."""
        columns = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "rate"}
        return Log(**{name: column[trials] for name, column in columns.items()}, rate=self.rate)

    @property
    def moving(self) -> NDArray[np.bool_]:
        """(T, S) the recorded steps but the last: those that lead on to another, and so have a speed."""
        moving = self.recorded.copy()
        moving[:, :-1] &= self.recorded[:, 1:]
        moving[:, -1] = False
        return moving
