"""How a new speed is taken up: the speed played over the time since the switch, mean over the turn rates."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from gmr.evaluation.figures.single_trials import of_set
from gmr.evaluation.figures.trial_maps import set_suffix, set_words, trial_sets
from gmr.evaluation.result import Evaluation
from gmr.evaluation.scenario_sentences import taken_up
from gmr.evaluation.timeline import QUARTER
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["speed_switches"]

_MOST_LINES: Final = 5
_COLOURS: Final = ("amount-2", "amount-3", "amount-4", "amount-5", "amount-6")
_LEAD: Final = 1.0
"""Seconds before the switch that are drawn."""


def speed_switches(evaluation: Evaluation) -> Iterator[Figure]:
    """A figure for every tracking of the switching trials; none where no trial switches."""
    for scenario, tracking in trial_sets(evaluation):
        segments = of_set(evaluation.measured.segments, scenario, tracking)
        if len(segments) == 0:
            continue
        trials = of_set(evaluation.measured.trials, scenario, tracking)
        every = float(trials["switch_every"][0])
        lines = _lines(of_set(evaluation.measured.timeline, scenario, tracking), every)
        words = set_words("constant", tracking)
        yield Figure(
            name=f"speed_switches{set_suffix('constant', tracking)}",
            title=f"Speed after a switch to {trials['switched_speed'][0]:g} m/s and back{words}",
            sentence=f"{taken_up(segments)} Lines are means over the turn rates, dashes what is asked for.",
            chart=_chart(list(dict.fromkeys(lines["own"].tolist()))),
            data={"lines": lines},
        )


def _lines(timeline: Table, every: float) -> Table:
    """Mean speed of some rows of the grid, from before a switch there to before the next switch there."""
    speeds = np.unique(timeline["speed"])
    drawn = speeds[np.unique(np.linspace(0, len(speeds) - 1, _MOST_LINES).round().astype(np.int64))]
    rows = timeline.take(np.isin(timeline["speed"], drawn))
    since = (rows["seconds"] - every) % (2 * every)
    since = np.where(since >= 2 * every - _LEAD, since - 2 * every, since)
    place = np.searchsorted(drawn, rows["speed"])
    step = np.rint((since + _LEAD) / QUARTER).astype(np.int64)
    steps = int(step.max(initial=0)) + 1
    cell = place * steps + step
    number = np.bincount(cell, minlength=len(drawn) * steps)
    there = np.flatnonzero(number)

    def mean(column: str) -> Any:
        return np.bincount(cell, rows[column], len(drawn) * steps)[there] / number[there]

    labels = np.array([f"{speed:g} m/s" for speed in drawn], object)
    return Table(
        {
            "own": labels[there // steps],
            "since": there % steps * QUARTER - _LEAD,
            "played": mean("played_speed"),
            "asked": mean("asked_speed"),
        }
    )


def _chart(labels: list[str]) -> dict[str, Any]:
    x = {
        "field": "since",
        "type": "quantitative",
        "title": "Seconds since the switch",
        "axis": {"grid": False},
    }
    y = {"type": "quantitative", "title": "Speed, m/s", "axis": {"tickCount": 5}}
    colour = {
        "field": "own",
        "type": "nominal",
        "scale": {"domain": labels, "range": [f"var(--{name})" for name in _spread(len(labels))]},
        "legend": {
            "title": "Own speed of the trial",
            "columns": {"expr": "windowSize()[0] < 600 ? 3 : 5"},
            "symbolType": "stroke",
            "symbolStrokeWidth": 3,
        },
        "sort": labels,
    }
    return {
        "width": "container",
        "height": 300,
        "data": {"name": "lines"},
        "layer": [
            {
                "mark": {
                    "type": "line",
                    "interpolate": "step-after",
                    "strokeDash": [4, 4],
                    "strokeWidth": 1,
                    "aria": False,
                },
                "encoding": {"x": x, "y": {**y, "field": "asked"}, "color": colour},
            },
            {
                "mark": {"type": "line", "strokeWidth": 2.5, "aria": False},
                "encoding": {"x": x, "y": {**y, "field": "played"}, "color": colour},
            },
            {
                "mark": {"type": "point", "size": 60, "opacity": 0, "aria": False},
                "encoding": {
                    "x": x,
                    "y": {**y, "field": "played"},
                    "tooltip": [
                        {"field": "own", "title": "Own speed of the trial"},
                        {"field": "since", "title": "Seconds since the switch", "format": ".2f"},
                        {"field": "asked", "title": "Asked for, m/s", "format": ".2f"},
                        {"field": "played", "title": "Played, m/s", "format": ".2f"},
                    ],
                },
            },
        ],
    }


def _spread(lines: int) -> list[str]:
    """Colours as far apart as there are few lines."""
    return [
        _COLOURS[place] for place in np.linspace(0, len(_COLOURS) - 1, lines).round().astype(int).tolist()
    ]
