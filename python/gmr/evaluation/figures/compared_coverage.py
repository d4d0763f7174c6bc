"""What the datasets hold, laid over each other: one point a window, coloured by dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import listing, percent
from gmr.pages.figure import Figure
from gmr.pages.theme import turn_ticks
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
        sentence=_sentence(names, windows, step),
        chart=_chart(points, names),
        data={"windows": points},
        printable=False,
    )


def _sentence(names: Sequence[str], windows: Sequence[Table], step: int) -> str:
    parts = []
    for name, table in zip(names, windows, strict=True):
        if len(table) == 0:
            parts.append(f"{name} has no clip of a second")
            continue
        low, high = np.percentile(table["speed"], [5, 95])
        turning = percent(float(np.mean(np.abs(table["turn_rate_deg"]) > 25)))
        parts.append(
            f"{name} moves at {low:.1f} to {high:.1f} m/s and turns faster than 25 degrees/s {turning}"
        )
    drawn = f" One window in {step} is drawn." if step > 1 else ""
    return f"For nine tenths of its time, {listing(parts)} of the time.{drawn}"


def _chart(points: Table, names: Sequence[str]) -> dict[str, Any]:
    turn = float(np.abs(points["turn_rate_deg"]).max(initial=25.0))
    speed = float(points["speed"].max(initial=1.0))
    return {
        "width": "container",
        "height": 420,
        # Pixels, for thousands of SVG elements are slow; the axes take a grey that reads on white and black.
        "usermeta": {"renderer": "canvas"},
        "data": {"name": "windows"},
        "mark": {"type": "point", "filled": True, "size": 11, "opacity": 0.5, "aria": False},
        "encoding": {
            "x": {
                "field": "turn_rate_deg",
                "type": "quantitative",
                "title": "Turn rate, deg/s (left is positive)",
                "scale": {"domain": [-turn, turn], "nice": False, "padding": 4},
                "axis": {"values": turn_ticks(turn)},
            },
            "y": {
                "field": "speed",
                "type": "quantitative",
                "title": "Speed, m/s",
                "scale": {"domain": [0.0, speed], "nice": True},
            },
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
