"""What the trials show that the verdict does not judge by: switching speeds, and the other tracking."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gmr.evaluation.regions import Grid, Limits, judged
from gmr.evaluation.words import count, number
from gmr.table import Table

__all__ = ["scenario_sentences"]


def scenario_sentences(trials: Table, coverage: Table, limits: Limits) -> Iterator[str]:
    """One sentence for every further scenario and tracking."""
    own = judged(trials)
    usual = _away(trials.take(own))
    for chosen in _sets(trials):
        if np.any(chosen & own):
            continue
        part = trials.take(chosen)
        held = Grid.of(part, coverage, limits).held
        timed = part["tracking"][0] == "time"
        away = f", {number(_away(part))} m from its path on average" if timed else ""
        beside = (
            f" ({number(usual)} m at one speed)"
            if timed and not np.isnan(trials["switched_speed"]).all()
            else ""
        )
        yield f"{_asked(part)}, it does so in {int(held.sum())} of {count(held.size, 'trial')}{away}{beside}."


def _sets(trials: Table) -> list[np.ndarray[tuple[int, ...], np.dtype[np.bool_]]]:
    """The rows of every scenario and tracking."""
    pairs = dict.fromkeys(zip(trials["scenario"].tolist(), trials["tracking"].tolist(), strict=True))
    return [
        (trials["scenario"] == scenario) & (trials["tracking"] == tracking) for scenario, tracking in pairs
    ]


def _asked(trials: Table) -> str:
    speed, every = float(trials["switched_speed"][0]), float(trials["switch_every"][0])
    only = "" if trials["tracking"][0] == "time" else " for speed and turn rate only"
    if np.isnan(speed):
        return f"Asked{only or ' to be in time on its path'}"
    return f"Asked{only} to switch to {speed:g} m/s and back every {every:g} s"


def _away(trials: Table) -> float:
    return float(trials["offset_mean"].mean())
