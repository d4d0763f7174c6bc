"""Every trial in quarters of a second: what was asked for, what was done, what it cost (paper's Figure 7)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.log import Log
from gmr.evaluation.scenario import Trial
from gmr.evaluation.transitions import Transitions
from gmr.table import Table

__all__ = ["QUARTER", "timeline_table"]

QUARTER: Final = 0.25
"""Seconds of a row: two or three searches."""


def timeline_table(
    dataset: str, trials: Sequence[Trial], tracking: str, log: Log, transitions: Transitions
) -> Table:
    """One row a quarter of a second of every trial while it is recorded; see :class:`Tables` for the columns.

    A value is the mean over the row's steps, and for the costs over its searches; NaN without any.
    """
    trial, step = np.nonzero(log.moving)
    since = step - np.argmax(log.recorded, axis=1)[trial]
    rows = np.ceil(log.moving.sum(axis=1) / (QUARTER * log.rate) - 1e-9).astype(np.int64)
    first = np.concatenate([[0], np.cumsum(rows)])
    row = first[trial] + (since / (QUARTER * log.rate) + 1e-9).astype(np.int64)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        here = values[trial, step]
        known = ~np.isnan(here)
        count = np.bincount(row[known], minlength=first[-1])
        total = np.bincount(row[known], here[known], first[-1])
        return np.asarray(np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0))

    jumps = np.zeros(log.row.shape)
    jumps[transitions.trial, transitions.step] = 1.0
    owner = np.repeat(np.arange(len(trials)), rows)
    return Table(
        {
            "dataset": np.full(len(owner), dataset, object),
            "scenario": np.array([each.scenario for each in trials], object)[owner],
            "tracking": np.full(len(owner), tracking, object),
            "speed": np.array([each.speed for each in trials])[owner],
            "turn_rate_deg": np.array([each.turn_rate_deg for each in trials])[owner],
            "seconds": (np.arange(len(owner)) - first[owner]) * QUARTER,
            "asked_speed": mean(log.ref_speed),
            "played_speed": mean(metrics.path_speed(log)),
            "played_turn_rate_deg": np.degrees(mean(metrics.turn_rate(log))),
            "offset": mean(metrics.offset(log)),
            "search_cost": mean(log.cost_pose + log.cost_trajectory),
            "search_cost_pose": mean(log.cost_pose),
            "search_cost_trajectory": mean(log.cost_trajectory),
            "jumps": np.bincount(row, jumps[trial, step], first[-1]).astype(np.int64),
        }
    )
