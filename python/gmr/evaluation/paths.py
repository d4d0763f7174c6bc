"""Trials that are no cells of the grid: whether they hold, and where they went and should have gone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.log import Log
from gmr.evaluation.regions import Limits
from gmr.evaluation.scenario import Trial
from gmr.table import Table

__all__ = ["held_paths", "paths_table"]

EVERY: Final = 0.25
"""Seconds from row to row."""


def held_paths(trials: Table, limits: Limits) -> NDArray[np.bool_]:
    """Which trials hold: on average within the limits of offset (on a timed path), speed and turn rate, and
    of the facing where another way is asked for than ahead.

    The speed error is that of the whole trial, as a share of the mean speed asked for: a trial of many
    speeds, or of standing, has none at each speed that would say something.
    """
    timed = trials["tracking"].astype(str) == "time"
    facing = np.where(trials["drift_deg"] == 0, 0.0, trials["facing_error_deg"])
    return limits.held(
        trials["speed_error_share"], trials["turn_rate_error_deg"], trials["offset_mean"], timed, facing
    )


def paths_table(dataset: str, trials: Sequence[Trial], tracking: str, log: Log) -> Table:
    """Planned and walked places, four a second, of the recorded steps of trials that are no grid cells.

    Args:
        dataset: its name.
        trials: what was asked for.
        tracking: "time" or "velocity".
        log: what happened.
    """
    step = max(round(log.rate * EVERY), 1)
    rows = [
        (number, np.flatnonzero(log.recorded[number])[::step])
        for number, trial in enumerate(trials)
        if trial.path
    ]
    trial = np.repeat([number for number, _ in rows], [len(steps) for _, steps in rows]).astype(np.int64)
    at = np.concatenate([np.zeros(0, np.int64), *(steps for _, steps in rows)])
    first = np.array([steps[0] if len(steps) else 0 for _, steps in rows], np.int64)
    begun = np.repeat(first, [len(steps) for _, steps in rows])

    def said(values: Sequence[Any]) -> NDArray[np.object_]:
        return np.array([*values, None], object)[:-1][trial]

    return Table(
        {
            "dataset": np.full(len(trial), dataset, object),
            "scenario": said([trial.scenario for trial in trials]),
            "tracking": np.full(len(trial), tracking, object),
            "path": said([trial.path for trial in trials]),
            "seconds": (at - begun) / log.rate,
            **{
                name: column[trial, at]
                for name, column in (
                    ("planned_x", log.ref_x),
                    ("planned_z", log.ref_z),
                    ("walked_x", log.x),
                    ("walked_z", log.z),
                )
            },
        }
    )
