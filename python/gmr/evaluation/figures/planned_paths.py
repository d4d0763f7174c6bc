"""Planned and walked paths from above, one small picture for each trial that is no cell of the grid."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.axes import WIDE, bare_axes
from gmr.evaluation.figures.trial_maps import set_suffix, set_words
from gmr.evaluation.intervals import mean_interval
from gmr.evaluation.path_sentences import between
from gmr.evaluation.paths import held_paths
from gmr.evaluation.regions import Limits
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import number
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["planned_paths"]

_MOST: Final = 12
_FILLED: Final = 0.86
"""Share of its cell that a path may fill across; above it stands its name."""


def planned_paths(evaluation: Evaluation, scenario: str, tracking: str) -> Figure:
    """The paths of one scenario and one tracking, each to a scale of its own."""
    trials, paths = (
        table.take((table["scenario"] == scenario) & (table["tracking"] == tracking))
        for table in (evaluation.measured.trials, evaluation.measured.paths)
    )
    drawn = _drawn(trials["offset_mean"])
    columns, rows = _cells(len(drawn))
    lines, names = [], []
    for place, trial in enumerate(drawn):
        name = trials["path"][trial]
        part = paths.take(paths["path"] == name)
        middle = ((place % columns + 0.5) / columns, (place // columns + 0.5) / rows)
        centre = np.array([(2 * middle[0] - 1) * WIDE, 1 - 2 * middle[1]])
        lines += _lines(part, centre, (2 * WIDE / columns, 2 / rows))
        away = f"{number(float(trials['offset_mean'][trial]))} m off"
        names.append({"x": centre[0], "y": centre[1] + 0.93 / rows, "name": name, "away": away})
    return Figure(
        name=f"planned_paths_{_file_name(scenario)}{set_suffix('constant', tracking)}",
        title=f"Planned and walked paths of {scenario}{set_words('', tracking)}, from above",
        sentence=_sentence(trials, len(drawn), timed=tracking == "time"),
        chart=_chart(),
        data={"lines": Table.joined(lines), "names": _table(names)},
    )


def _file_name(scenario: str) -> str:
    return "".join(letter if letter.isalnum() else "_" for letter in scenario)


def _drawn(offset: NDArray[np.float64]) -> list[int]:
    """All trials in their order; of too many some, from the closest to its path to the farthest."""
    if len(offset) <= _MOST:
        return list(range(len(offset)))
    rank = np.argsort(offset, kind="stable")
    return [int(rank[round(place)]) for place in np.linspace(0, len(offset) - 1, _MOST).tolist()]


def _cells(pictures: int) -> tuple[int, int]:
    """Columns and rows, the cells about as wide as high."""
    columns = min(pictures, max(1, math.ceil(math.sqrt(pictures * WIDE) - 0.25)))
    return columns, math.ceil(pictures / columns)


def _lines(part: Table, centre: NDArray[np.float64], cell: tuple[float, float]) -> list[Table]:
    """The two ways of a trial in its cell: forward is up, and left is left."""
    ways = {
        "planned": np.stack([-part["planned_x"], part["planned_z"]], axis=1),
        "walked": np.stack([-part["walked_x"], part["walked_z"]], axis=1),
    }
    both = np.concatenate(list(ways.values()))
    low, high = both.min(axis=0), both.max(axis=0)
    room = np.array([_FILLED * cell[0], 0.7 * cell[1]])
    scale = float(np.min(room / np.maximum(high - low, 1e-3)))
    down = np.array([0.0, 0.1 * cell[1]])
    return [
        Table(
            {
                "way": np.full(len(part), what, object),
                "path": part["path"],
                "seconds": part["seconds"],
                "x": (centre - down + scale * (way - (low + high) / 2))[:, 0],
                "y": (centre - down + scale * (way - (low + high) / 2))[:, 1],
            }
        )
        for what, way in ways.items()
    ]


def _table(rows: list[dict[str, Any]]) -> Table:
    return Table(
        {
            name: np.array([row[name] for row in rows], float if name in "xy" else object)
            for name in ("x", "y", "name", "away")
        }
    )


def _sentence(trials: Table, drawn: int, *, timed: bool) -> str:
    offset = trials["offset_mean"]
    worst = int(np.argmax(offset))
    held = int(held_paths(trials, Limits()).sum())
    away = between(mean_interval(offset), "m")
    shown = (
        f" Drawn are {drawn} of them, from the closest to its path to the farthest."
        if drawn < len(trials)
        else ""
    )
    farthest = (
        f", farthest on {trials['path'][worst]} ({number(float(offset[worst]))} m)" if len(trials) > 1 else ""
    )
    plan = "where the plan has it at that time" if timed else "a plan that it is not steered to"
    return (
        f"{_go(held, len(trials))} as asked; the character is {away} from {plan}{farthest}."
        f"{shown} Every picture has a scale of its own."
    )


def _go(held: int, every: int) -> str:
    if every == 1:
        return "The trial goes" if held else "The trial does not go"
    return f"{held or 'None'} of {every} trials {'go' if held > 1 else 'goes'}"


def _chart() -> dict[str, Any]:
    x, y = bare_axes()
    name = {"type": "text", "baseline": "top", "aria": False}
    return {
        "width": "container",
        "height": "container",
        "layer": [
            {
                "data": {"name": "lines"},
                "mark": {"type": "line", "aria": False},
                "encoding": {
                    "x": x,
                    "y": y,
                    "detail": {"field": "path"},
                    "order": {"field": "seconds", "type": "quantitative"},
                    "color": {
                        "field": "way",
                        "type": "nominal",
                        "scale": {
                            "domain": ["planned", "walked"],
                            "range": ["var(--reference)", "var(--bar)"],
                        },
                        "legend": {"title": None, "symbolType": "stroke", "symbolStrokeWidth": 3},
                    },
                    "strokeWidth": {
                        "condition": {"test": "datum.way === 'planned'", "value": 4},
                        "value": 1.5,
                    },
                    "opacity": {"condition": {"test": "datum.way === 'planned'", "value": 0.55}, "value": 1},
                },
            },
            {
                "data": {"name": "names"},
                "mark": {**name, "fontSize": {"expr": "windowSize()[0] < 600 ? 8 : 12"}},
                "encoding": {"x": x, "y": y, "text": {"field": "name", "type": "nominal"}},
            },
            {
                "data": {"name": "names"},
                "mark": {
                    **name,
                    "color": "var(--ink-soft)",
                    "fontSize": {"expr": "windowSize()[0] < 600 ? 7 : 11"},
                    "dy": {"expr": "windowSize()[0] < 600 ? 9 : 14"},
                },
                "encoding": {"x": x, "y": y, "text": {"field": "away", "type": "nominal"}},
            },
        ],
    }
