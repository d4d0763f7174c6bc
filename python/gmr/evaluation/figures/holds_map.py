"""Where on the grid the dataset holds, and what goes most wrong where it does not: the verdict as a map."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.trial_maps import HOVER, cells_of_trials, set_suffix, set_words, trials_of
from gmr.evaluation.regions import HOLDS, MISSES_SPEED, MISSES_TURN_RATE, STRAYS, Grid, Limits
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, listing, percent
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["holds_map"]

_OUTCOMES: Final = ("as asked", "strays from the path", "wrong speed", "wrong turn rate")
_COLOURS: Final = ("holds", "strays", "wrong-speed", "wrong-turn")
_MARKS: Final = ("✓", "path", "speed", "turn")


def holds_map(evaluation: Evaluation, scenario: str, tracking: str, *, columns: int = 4) -> Figure:
    """Every trial as held, or what it fails by (:attr:`Grid.outcomes`); the legend has ``columns``.

    Two columns are for a map that is half as wide as the page.
    """
    trials = trials_of(evaluation, scenario, tracking)
    grid = Grid.of(trials, evaluation.measured.coverage, Limits())
    row = np.searchsorted(grid.speeds, trials["speed"])
    column = np.searchsorted(grid.turn_rates_deg, trials["turn_rate_deg"])
    outcome = grid.outcomes[row, column]
    drawn = Table(
        {
            **{name: trials[name] for name in ("trial", "speed", "turn_rate_deg", *HOVER)},
            "outcome": np.array(_OUTCOMES, object)[outcome],
            "mark": np.array(_MARKS, object)[outcome],
        }
    )
    return Figure(
        name=f"trial_map_holds{set_suffix(scenario, tracking)}",
        title="Where it does what it is asked" + set_words(scenario, tracking),
        sentence=_sentence(outcome, grid, timed=tracking == "time"),
        chart=_chart(len(grid.speeds), columns),
        data={"trials": drawn},
    )


def _sentence(outcome: NDArray[np.int64], grid: Grid, *, timed: bool) -> str:
    number = np.bincount(outcome, minlength=len(_OUTCOMES))
    if not number[HOLDS]:
        return f"No trial goes as asked. {_failing(number)}"
    limits, speed = grid.limits, "the speed" if grid.switching is None else "each of the two speeds"
    path = [f"within {limits.offset:g} m of the plan"] if timed else []
    within = [
        *path,
        f"within {percent(limits.speed)} of {speed}",
        f"within {limits.turn_rate_deg:g} degrees/s of the turn rate",
    ]
    goes = f"{count(int(number[HOLDS]), 'trial goes', 'trials go')} as asked: on average {listing(within)}."
    return f"{goes} {_failing(number)}"


def _failing(number: NDArray[np.int64]) -> str:
    """By what how many trials fail; ``number`` is that of each outcome."""
    both = number[MISSES_SPEED] and number[MISSES_TURN_RATE]
    ways = {
        MISSES_SPEED: "by speed",
        MISSES_TURN_RATE: f"by turn rate{' (whichever is farther off)' if both else ''}",
        STRAYS: "by straying alone",
    }
    failing = {by: int(number[way]) for way, by in ways.items() if number[way]}
    others = sum(failing.values())
    if not others:
        return "No trial fails."
    one, many = ("other one", "The other") if number[HOLDS] else ("one trial", "All")
    who = f"The {one} fails" if others == 1 else f"{many} {others} fail"
    if len(failing) == 1:
        return f"{who} {next(iter(failing))}."
    return f"{who}: {listing([f'{some} {by}' for by, some in failing.items()])}."


def _chart(rows: int, columns: int) -> dict[str, Any]:
    def colour(prefix: str, legend: dict[str, Any] | None) -> dict[str, Any]:
        return {
            "field": "outcome",
            "type": "nominal",
            "scale": {
                "domain": list(_OUTCOMES),
                "range": [f"var(--{prefix}{colour}-0)" for colour in _COLOURS],
            },
            "legend": legend,
        }

    legend = {"title": None, "columns": {"expr": f"windowSize()[0] < 600 ? 2 : {columns}"}}
    marks = {
        "mark": {
            "type": "text",
            "fontSize": {"expr": f"windowSize()[0] < 600 ? 8 : {12 if columns > 2 else 10}"},
            "aria": False,
        },
        "encoding": {"text": {"field": "mark", "type": "nominal"}, "color": colour("on-", None)},
    }
    return cells_of_trials(rows, colour("", legend), marks)
