"""What the trials show that the verdict does not judge by: switching speeds, and the other tracking."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.regions import Grid, Limits, judged
from gmr.evaluation.scenarios.on_grid import on_grid
from gmr.evaluation.words import count, duration, listing, number
from gmr.table import Table

__all__ = ["scenario_sentences", "taken_up"]


def scenario_sentences(
    trials: Table, coverage: Table, segments: Table | None, limits: Limits
) -> Iterator[str]:
    """One sentence for every further scenario of the grid, and one more on how new speeds are taken up."""
    trials = trials.take(on_grid(trials))
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
        done = f"it does so in {int(held.sum())} of {count(held.size, 'trial')}"
        yield f"{_asked(part)}, {done}{away}{beside}."
        if segments is not None:
            own_segments = segments["scenario"] == part["scenario"][0]
            stretches = segments.take(own_segments & (segments["tracking"] == part["tracking"][0]))
            if len(stretches):
                yield taken_up(stretches)


def taken_up(segments: Table) -> str:
    """How often and how soon a new speed is taken up, faster and slower, from a table of segments."""
    change = segments["to_speed"] - segments["from_speed"]
    ways = [
        _way(segments.take(chosen), what)
        for what, chosen in (("speeding up", change > 0), ("slowing down", change < 0))
        if chosen.any()
    ]
    if not ways:
        return "No speed is asked for that differs from the one before."
    return f"A new speed is taken up, to within the limit and before the next switch, {listing(ways)}."


def _way(switches: Table, what: str) -> str:
    settled = switches["settling_time"]
    taken = settled[np.isfinite(settled)]
    soon = f" ({_how_soon(taken)})" if len(taken) else ""
    return f"in {len(taken)} of {count(len(settled), 'switch', 'switches')} when {what}{soon}"


def _how_soon(taken: NDArray[np.float64]) -> str:
    """How long new speeds take that are taken up; those that were there already would hide it."""
    later = taken[taken > 0]
    median = f"{duration(float(np.median(later)))} in the median" if len(later) else ""
    already = len(taken) - len(later)
    if not already:
        return f"in {median}"
    if len(taken) == 1:
        return "it was at that speed already"
    at = f"at {already if len(later) else 'all'} of these it was at that speed already"
    return f"{at}; at the others it takes {median}" if len(later) else at


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
