"""How the errors of speed and turn rate are spread in every trial, and the normal distributions that fit.

Source: the paper's Figure 8: where two speeds are asked for in turn, the errors have two centres.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.gaussians import fitted
from gmr.evaluation.log import Log
from gmr.evaluation.scenario import Trial
from gmr.table import Table

__all__ = ["BIN_WIDTHS", "error_bins_table", "error_fits_table"]

BIN_WIDTHS: Final = {"speed": 0.1, "turn_rate_deg": 5.0}
"""Width of a bin of each error, m/s and degrees/s; one is centred on 0."""

_INDEPENDENT_AFTER: Final = 0.5
"""Seconds, about one step, after which an error is taken to be a new one."""


def error_bins_table(dataset: str, trials: Sequence[Trial], tracking: str, log: Log) -> Table:
    """One row a bin that is not empty, of either error of every trial; columns: see :class:`Tables`."""
    parts = []
    for quantity, error in _errors(log).items():
        width = BIN_WIDTHS[quantity]
        trial, step = np.nonzero(log.moving)
        place = np.rint(error[trial, step] / width).astype(np.int64)
        least = int(place.min(initial=0))
        span = int(place.max(initial=0)) - least + 1
        pairs, count = np.unique(trial * span + place - least, return_counts=True)
        owner, bin_ = pairs // span, pairs % span + least
        share = count / np.bincount(trial, minlength=len(trials))[owner]
        bins = {"from": (bin_ - 0.5) * width, "to": (bin_ + 0.5) * width, "share": share}
        parts.append(Table(_named(dataset, trials, tracking, owner, quantity) | bins))
    return Table.joined(parts)


def error_fits_table(dataset: str, trials: Sequence[Trial], tracking: str, log: Log) -> Table:
    """One row for either error of every trial: the one or two normal distributions that fit it."""
    independent = log.moving.sum(axis=1) / log.rate / _INDEPENDENT_AFTER
    parts = []
    for quantity, error in _errors(log).items():
        fit = fitted(error, log.moving, independent)
        columns: dict[str, NDArray[Any]] = {"components": fit.components}
        for number in (0, 1):
            columns |= {
                f"share_{number + 1}": fit.shares[:, number],
                f"mean_{number + 1}": fit.means[:, number],
                f"deviation_{number + 1}": fit.deviations[:, number],
            }
        named = _named(dataset, trials, tracking, np.arange(len(trials)), quantity)
        parts.append(Table(named | columns))
    return Table.joined(parts)


def _errors(log: Log) -> dict[str, NDArray[np.float64]]:
    """(T, S) what was played minus what was asked for, m/s and degrees/s."""
    return {
        "speed": metrics.path_speed(log) - log.ref_speed,
        "turn_rate_deg": np.degrees(metrics.turn_rate(log) - log.ref_turn_rate),
    }


def _named(
    dataset: str, trials: Sequence[Trial], tracking: str, owner: NDArray[np.int64], quantity: str
) -> dict[str, NDArray[Any]]:
    return {
        "dataset": np.full(len(owner), dataset, object),
        "scenario": np.array([trial.scenario for trial in trials], object)[owner],
        "tracking": np.full(len(owner), tracking, object),
        "speed": np.array([trial.speed for trial in trials])[owner],
        "turn_rate_deg": np.array([trial.turn_rate_deg for trial in trials])[owner],
        "error_of": np.full(len(owner), quantity, object),
    }
