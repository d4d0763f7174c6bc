"""Coverage as density: seconds of motion in every cell of speed and turn rate (paper's Figure 6)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.coverage import Bins, Density, density
from gmr.evaluation.figures.axes import TURN_RATE, cell_axes, not_drawn, widest_turn
from gmr.evaluation.figures.classes import Classes
from gmr.evaluation.regions import Grid, Limits
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, going, listing, percent
from gmr.pages.figure import Figure
from gmr.pages.theme import turn_ticks
from gmr.table import Table

__all__ = ["coverage_density", "seconds_near_pairs"]

_CELLS: Final = Bins(speed=0.1, turn_rate_deg=5.0, blur=0.0)
_SECONDS: Final = Classes("amount", (0.1, 0.3, 1.0, 3.0, 10.0, 30.0))


def coverage_density(evaluation: Evaluation) -> Figure:
    """Seconds and number of clips in every cell of speed and turn rate, with the pairs asked for."""
    windows = evaluation.measured.coverage
    held = density(windows, _CELLS)
    pairs = seconds_near_pairs(evaluation)
    limit = widest_turn(windows["turn_rate_deg"], pairs["turn_rate_deg"])
    cells = _cells(held)
    inside = np.abs(cells["turn_rate_deg"]) <= limit
    return Figure(
        name="coverage_density",
        title="Seconds of motion at every speed and turn rate",
        sentence=_sentence(cells, pairs, float(cells["seconds"][~inside].sum()), limit),
        chart=_chart(limit),
        data={"cells": cells.take(inside), "asked": pairs},
    )


def seconds_near_pairs(evaluation: Evaluation) -> Table:
    """How long the clips go forward at about every pair of speed and turn rate that is asked for.

    Returns:
        One row a pair: ``speed``, ``turn_rate_deg``, and ``seconds`` within half a step of the grid.
    """
    grid = Grid.of(evaluation.measured.trials, evaluation.measured.coverage, Limits())
    speed, turn = np.meshgrid(grid.speeds, grid.turn_rates_deg, indexing="ij")
    return Table({"speed": speed.ravel(), "turn_rate_deg": turn.ravel(), "seconds": grid.seconds.ravel()})


def _cells(held: Density) -> Table:
    """One row a cell that is not empty: its borders, its centre, its seconds and its number of clips."""
    row, column = np.nonzero(held.seconds)
    bottom, left = held.speed_edges[row], held.turn_rate_edges_deg[column]
    return Table(
        {
            "speed": bottom + _CELLS.speed / 2,
            "turn_rate_deg": left + _CELLS.turn_rate_deg / 2,
            "speed_from": bottom,
            "speed_to": bottom + _CELLS.speed,
            "turn_from": left,
            "turn_to": left + _CELLS.turn_rate_deg,
            "seconds": held.seconds[row, column],
            "clips": held.clips[row, column],
            "class": _SECONDS.of(held.seconds[row, column]),
        }
    )


def _sentence(cells: Table, pairs: Table, outside: float, limit: float) -> str:
    if len(cells) == 0:
        return "No clip is long enough for a single window of one second."
    held = pairs["seconds"] >= 1.0
    best = int(np.argmax(cells["seconds"]))
    parts = [
        f"Of the {count(len(pairs), 'pair')} of speed and turn rate asked for (the crosses), "
        f"{int(held.sum())} have a second or more of motion, going forward, within half a step of the grid.",
        "" if held.all() else _gap(pairs, ~held),
        f"Most time is spent {going(float(cells['speed'][best]), float(cells['turn_rate_deg'][best]))}.",
        _balance(cells),
        not_drawn(outside, limit),
    ]
    return " ".join(filter(None, parts))


def _gap(pairs: Table, empty: NDArray[np.bool_]) -> str:
    """The speeds at which most of the pairs are empty, where that is true of a few only."""
    speeds, number = np.unique(pairs["speed"][empty], return_counts=True)
    worst = speeds[number == number.max()]
    if len(worst) > 3:
        return ""
    names = listing([f"{speed:g}" for speed in worst])
    return f"The gaps are widest at {names} m/s, where {count(int(number.max()), 'turn rate')} have less."


def _balance(cells: Table) -> str:
    turn, seconds = cells["turn_rate_deg"], cells["seconds"]
    left, right = float(seconds[turn > 0].sum()), float(seconds[turn < 0].sum())
    if left + right == 0:
        return "Nothing turns."
    share = left / (left + right)
    if abs(share - 0.5) < 0.02:
        return "Left and right turns balance."
    side, of = ("left", share) if share > 0.5 else ("right", 1 - share)
    return f"{percent(of)} of the turning is to the {side}."


def _chart(limit: float) -> dict[str, Any]:
    place = cell_axes(TURN_RATE, {"values": turn_ticks(limit)})
    return {
        "width": "container",
        "height": 420,
        "layer": [
            {
                "data": {"name": "cells"},
                "mark": {"type": "rect", "aria": False, "stroke": "var(--page)", "strokeWidth": 0.5},
                "encoding": {
                    **place,
                    "color": _SECONDS.colour("Seconds of motion in the cell"),
                    "tooltip": [
                        {"field": "speed", "title": "Speed, m/s", "format": ".2f"},
                        {"field": "turn_rate_deg", "title": "Turn rate, deg/s", "format": ".1f"},
                        {"field": "seconds", "title": "Seconds", "format": ".1f"},
                        {"field": "clips", "title": "Clips"},
                    ],
                },
            },
            {
                "data": {"name": "asked"},
                "mark": {
                    "type": "point",
                    "shape": "cross",
                    "size": 22,
                    "strokeWidth": 0,
                    "filled": True,
                    "color": "var(--reference)",
                    "aria": False,
                },
                "encoding": {
                    "x": {**place["x"], "field": "turn_rate_deg"},
                    "y": {**place["y"], "field": "speed"},
                    "tooltip": [
                        {"field": "speed", "title": "Asked for, m/s", "format": ".2f"},
                        {"field": "turn_rate_deg", "title": "Asked for, deg/s", "format": ".0f"},
                        {"field": "seconds", "title": "Seconds going forward near it", "format": ".1f"},
                    ],
                },
            },
        ],
    }
