"""What the trials off the grid show, a sentence a scenario, with how far its mean may be trusted."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from gmr.evaluation.drift_sentences import drift_sentence
from gmr.evaluation.intervals import Interval, mean_interval
from gmr.evaluation.paths import held_paths
from gmr.evaluation.regions import Limits
from gmr.evaluation.scenarios.on_grid import on_grid
from gmr.evaluation.words import count, duration, number
from gmr.table import Table

__all__ = ["between", "path_sentences", "path_sets"]

STANDING: Final = 0.1
"""Metres per second, at most, of a request that is one to stand, and of clips that stand."""


def path_sentences(trials: Table, coverage: Table, limits: Limits) -> Iterator[str]:
    """One sentence for every scenario and tracking off the grid; one more where the clips lack standing."""
    sets = path_sets(trials)
    for scenario, tracking in sets:
        part = trials.take((trials["scenario"] == scenario) & (trials["tracking"] == tracking))
        yield _sentence(scenario, tracking, part, limits)
        if tracking == "time":
            yield from drift_sentence(part)
    off_grid = trials.take(~on_grid(trials))
    if np.any(off_grid["slowest_speed"] < STANDING):
        stood = float(coverage["weight"][coverage["speed"] < STANDING].sum())
        if stood < limits.covered:
            yield (
                f"Standing is asked for, but the clips stand (below {STANDING:g} m/s) for only "
                f"{duration(stood)}: capture standing, and starts and stops from it."
            )


def path_sets(trials: Table) -> list[tuple[str, str]]:
    """The pairs of scenario and tracking off the grid, in their order."""
    part = trials.take(~on_grid(trials))
    return list(dict.fromkeys(zip(part["scenario"].tolist(), part["tracking"].tolist(), strict=True)))


def between(interval: Interval, unit: str) -> str:
    """The mean with its unit, and the interval where there is one."""
    if np.isnan(interval.low):
        return f"{number(interval.mean)} {unit}"
    low, high = number(interval.low), number(interval.high)
    return f"{number(interval.mean)} {unit} (95% confidence interval {low} to {high} {unit})"


def _sentence(scenario: str, tracking: str, part: Table, limits: Limits) -> str:
    held = int(held_paths(part, limits).sum())
    done = f"In scenario '{scenario}' it does what is asked in {held} of {count(len(part), 'trial')}"
    if tracking == "time":
        away = between(mean_interval(part["offset_mean"]), "m")
        return f"{done}, {away} from its path on average."
    error = between(mean_interval(np.abs(part["speed_error_share"]) * part["speed"]), "m/s")
    return f"{done}, asked for speed and turn rate only; its mean speed is off by {error}."
