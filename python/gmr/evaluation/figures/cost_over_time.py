"""What a search costs over the time of a trial: more where clips lack what is asked (paper's Figure 7)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.single_trials import choice, numbered, of_set, pairs_of, set_drawn, whose
from gmr.evaluation.result import Evaluation
from gmr.evaluation.timeline import QUARTER
from gmr.evaluation.words import number
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["cost_over_time"]

_SHOWN: Final = (1.5, -50.0)
"""Speed and turn rate of the trial in the paper's figure."""


def cost_over_time(evaluation: Evaluation) -> Figure:
    """The cost of every trial over time, one as a line and eight of ten as a band."""
    rows = of_set(evaluation.measured.timeline, *set_drawn(evaluation))
    rows = rows.take(np.isfinite(rows["search_cost"]))
    pairs = pairs_of(rows)
    lines = Table(
        {
            "trial": numbered(rows, pairs),
            "seconds": rows["seconds"] + QUARTER / 2,
            "cost": rows["search_cost"],
        }
    )
    shaded = _switched(rows)
    data = {"lines": lines, "band": _band(lines)}
    return Figure(
        name="cost_over_time",
        title="Cost of a search over the time of a trial, one (line) among all (band: eight of ten)",
        sentence=_sentence(rows, pairs, lines["trial"]),
        chart=_chart(choice(pairs, *_SHOWN), shaded=len(shaded) > 0),
        data=data | ({"switched": shaded} if len(shaded) else {}),
    )


def _band(lines: Table) -> Table:
    """A tenth, the middle and nine tenths of the costs of all trials at each time."""
    seconds, place = np.unique(lines["seconds"], return_inverse=True)
    parts = [lines["cost"][place == each] for each in range(len(seconds))]
    low, middle, high = (
        np.array([np.quantile(part, share) for part in parts], np.float64) for share in (0.1, 0.5, 0.9)
    )
    return Table({"seconds": seconds, "low": low, "median": middle, "high": high})


def _switched(rows: Table) -> Table:
    """The stretches in which the other speed is asked for."""
    other = _is_switched(rows)
    seconds = np.unique(rows["seconds"][other])
    edge = np.flatnonzero(np.diff(seconds) > 1.5 * QUARTER) + 1
    parts = np.split(seconds, edge) if len(seconds) else []
    return Table(
        {
            "from": np.array([part[0] for part in parts], np.float64),
            "to": np.array([part[-1] + QUARTER for part in parts], np.float64),
        }
    )


def _is_switched(rows: Table) -> NDArray[np.bool_]:
    return np.asarray(np.abs(rows["asked_speed"] - rows["speed"]) > 1e-9)


def _sentence(rows: Table, pairs: list[tuple[float, float]], trial: NDArray[np.int64]) -> str:
    if len(rows) == 0:
        return "No trial was searched for."
    cost, switched = rows["search_cost"], _is_switched(rows)
    count = np.bincount(trial, minlength=len(pairs))
    mean = np.bincount(trial, cost, len(pairs)) / np.maximum(count, 1)
    worst = int(np.argmax(mean))
    dearest = f"The dearest trial is {whose(pairs, worst)}, with {number(float(mean[worst]))} on average."
    if not switched.any():
        return f"A search costs {number(float(cost.mean()))} on average. {dearest}"
    asked = float(np.median(rows["asked_speed"][switched]))
    high, usual = float(cost[switched].mean()), float(cost[~switched].mean())
    compared = "dearer" if high > usual else "cheaper"
    times = max(high, usual) / max(min(high, usual), 1e-9)
    return (
        f"While {asked:g} m/s is asked for (shaded), a search costs {number(high)} on average, against "
        f"{number(usual)} at the trial's own speed: {number(times)} times {compared}. {dearest}"
    )


def _chart(trial: dict[str, Any], *, shaded: bool) -> dict[str, Any]:
    x = {"field": "seconds", "type": "quantitative", "title": "Seconds recorded", "axis": {"grid": False}}
    y = {"type": "quantitative", "title": "Cost of a search", "axis": {"tickCount": 5}}
    shade = {
        "data": {"name": "switched"},
        "mark": {"type": "rect", "color": "var(--line)", "opacity": 0.6, "aria": False},
        "encoding": {
            "x": {"field": "from", "type": "quantitative", "title": x["title"]},
            "x2": {"field": "to"},
        },
    }
    return {
        "width": "container",
        "height": 280,
        "params": [trial],
        "layer": [
            *([shade] if shaded else []),
            {
                "data": {"name": "band"},
                "mark": {"type": "area", "color": "var(--bar-second)", "opacity": 0.6, "aria": False},
                "encoding": {"x": x, "y": {**y, "field": "low"}, "y2": {"field": "high"}},
            },
            {
                "data": {"name": "lines"},
                "transform": [{"filter": "datum.trial == trial"}],
                "mark": {"type": "line", "color": "var(--bar)", "strokeWidth": 2, "aria": False},
                "encoding": {"x": x, "y": {**y, "field": "cost"}},
            },
            {
                "data": {"name": "lines"},
                "transform": [{"filter": "datum.trial == trial"}],
                "mark": {"type": "point", "size": 60, "opacity": 0, "aria": False},
                "encoding": {
                    "x": x,
                    "y": {**y, "field": "cost"},
                    "tooltip": [
                        {"field": "seconds", "title": "Second", "format": ".1f"},
                        {"field": "cost", "title": "Cost of a search", "format": ".2f"},
                    ],
                },
            },
        ],
    }
