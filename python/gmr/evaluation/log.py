"""What was written down at every step of every trial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.scenario import Trial

__all__ = ["FORCED", "JUMPED", "KEPT", "PLAYED_ON", "Log"]

PLAYED_ON: Final = 0
KEPT: Final = 1
JUMPED: Final = 2
FORCED: Final = 3


_DOUBLES: Final = (
    *("x", "z", "heading"),
    *("ref_x", "ref_z", "ref_heading", "ref_speed", "ref_turn_rate"),
    *("cost_pose", "cost_trajectory", "discontinuity"),
)


@dataclass(frozen=True, slots=True)
class Log:
    """T trials of at most S steps; a shorter trial ends where ``recorded`` does.

    Attributes:
        x, z: (T, S) root on the ground, metres.
        heading: (T, S) radians, forward = (sin, cos) in (x, z).
        ref_x, ref_z, ref_heading: (T, S) the planned path at the same time.
        ref_speed, ref_turn_rate: (T, S) what was asked for, m/s and radians/s.
        row: (T, S) row of the frames shown.
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
    row: NDArray[np.int64]
    status: NDArray[np.uint8]
    cost_pose: NDArray[np.float64]
    cost_trajectory: NDArray[np.float64]
    discontinuity: NDArray[np.float64]
    recorded: NDArray[np.bool_]
    rate: float

    @classmethod
    def of(cls, steps: Mapping[str, NDArray[Any]], trials: Sequence[Trial], rate: float) -> Log:
        """The log of ``trials`` from the (T, S) arrays of the simulation, in double precision."""
        return cls(
            **{name: np.asarray(steps[name], np.float64) for name in _DOUBLES},
            row=np.asarray(steps["row"], np.int64),
            status=np.asarray(steps["status"], np.uint8),
            recorded=recorded_steps(trials, steps["row"].shape[1], rate),
            rate=rate,
        )


def recorded_steps(trials: Sequence[Trial], steps: int, rate: float) -> NDArray[np.bool_]:
    """(T, steps) which steps are recorded: those in (recorded_from, seconds] of the trial.

    The step at the very start of the recording belongs to what was before, as the way to it does.
    """
    first = np.array([round(trial.recorded_from * rate) + 1 for trial in trials])[:, None]
    last = np.array([round(trial.seconds * rate) for trial in trials])[:, None]
    step = np.arange(steps)[None, :]
    return (first <= step) & (step <= last)
