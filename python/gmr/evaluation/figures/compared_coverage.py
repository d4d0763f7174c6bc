"""What the datasets hold, laid over each other: one point a window, coloured by dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from gmr.evaluation.figures.axes import at_the_edge, point_axes, widest_turn
from gmr.evaluation.figures.time_shares import turning_share, usual_speeds
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import listing, percent
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["compared_coverage"]

_MOST_POINTS: Final = 18_000
_COLOURS: Final = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a6fd1")
"""After Okabe and Ito: told apart by colour-blind readers too, on white and on black."""
_SHAPES: Final = ("circle", "square", "triangle-up", "diamond", "cross")


def compared_coverage(evaluations: Sequence[Evaluation]) -> Figure:
    """Speed and turn rate of every 1-s window of every dataset; of many windows, every n-th.

    Points are drawn in an order that mixes the datasets, so that none covers the others.
    """
    names = [evaluation.dataset for evaluation in evaluations]
    windows = [evaluation.measured.coverage for evaluation in evaluations]
    step = max(1, -(-sum(map(len, windows)) // _MOST_POINTS))
    asked = np.concatenate([evaluation.measured.trials["turn_rate_deg"] for evaluation in evaluations])
    limit = widest_turn(np.concatenate([table["turn_rate_deg"] for table in windows]), asked)
    shown = [table.take(np.arange(0, len(table), step)) for table in windows]
    order = np.argsort(np.concatenate([np.arange(len(t)) / max(len(t), 1) for t in shown]), kind="stable")
    points = Table(
        {
            "dataset": np.concatenate(
                [np.full(len(t), name, object) for t, name in zip(shown, names, strict=True)]
            ),
            **{name: np.concatenate([t[name] for t in shown]) for name in ("speed", "turn_rate_deg")},
        }
    ).take(order)
    return Figure(
        name="compared_coverage",
        title="Speed and turn rate of every second of motion, by dataset",
        sentence=_sentence(names, windows, step, limit),
        chart=_chart(points, names, limit),
        data={"windows": points},
    )


def _sentence(names: Sequence[str], windows: Sequence[Table], step: int, limit: float) -> str:
    held = [(name, table) for name, table in zip(names, windows, strict=True) if len(table)]
    if not held:
        return "No clip is long enough for a single window of one second."
    speeds: list[str] = []
    turning: list[str] = []
    for name, table in held:
        low, high = usual_speeds(table)
        speeds.append(f"of {name}{'' if speeds else ' lie'} between {low:.1f} and {high:.1f} m/s")
        turning.append(f"{percent(turning_share(table, 25))} of {name}")
    parts = [
        f"Nine tenths {listing(speeds)}; {listing(turning)} turn faster than 25 degrees/s.",
        at_the_edge(np.concatenate([table["turn_rate_deg"] for _, table in held]), limit),
        f"One window in {step} is drawn." if step > 1 else "",
    ]
    return " ".join(filter(None, parts))


def _chart(points: Table, names: Sequence[str], turn: float) -> dict[str, Any]:
    speed = float(points["speed"].max(initial=1.0))
    return {
        "width": "container",
        "height": 420,
        # Pixels, for thousands of SVG elements are slow; the axes take a grey that reads on white and black.
        "usermeta": {"renderer": "canvas"},
        "data": {"name": "windows"},
        "mark": {"type": "point", "filled": True, "size": 11, "opacity": 0.5, "aria": False},
        "encoding": {
            **point_axes(turn, speed),
            "color": {
                "field": "dataset",
                "type": "nominal",
                "scale": {
                    "domain": list(names),
                    "range": [_COLOURS[place % len(_COLOURS)] for place in range(len(names))],
                },
                "legend": {"title": None},
            },
            "shape": {
                "field": "dataset",
                "type": "nominal",
                "scale": {
                    "domain": list(names),
                    "range": [_SHAPES[place % len(_SHAPES)] for place in range(len(names))],
                },
                "legend": {"title": None, "symbolOpacity": 1},
            },
        },
        "config": {
            "axis": {"labelColor": "#7a828b", "titleColor": "#7a828b", "gridColor": "rgba(128,136,144,0.25)"},
            "legend": {"labelColor": "#7a828b"},
        },
    }
