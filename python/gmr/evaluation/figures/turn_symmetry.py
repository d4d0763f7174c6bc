"""Left turns against right turns, at every speed and turn rate of the clips."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gmr.evaluation.coverage_symmetry import SYMMETRY_CELLS, symmetry_of
from gmr.evaluation.figures.axes import cell_axes, not_drawn, widest_turn
from gmr.evaluation.figures.classes import two_sided
from gmr.evaluation.figures.coverage_density import seconds_near_pairs
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import duration
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["turn_symmetry"]

_MORE: Final = two_sided((20.0, 50.0, 80.0))


def turn_symmetry(evaluation: Evaluation) -> Figure:
    """Which side has more of each movement: its seconds less the other side's, in per cent of both."""
    sides = evaluation.measured.coverage_symmetry
    limit = widest_turn(
        evaluation.measured.coverage["turn_rate_deg"], seconds_near_pairs(evaluation)["turn_rate_deg"]
    )
    inside = sides.take(sides["turn_rate_deg"] <= limit)
    outside = _seconds(sides) - _seconds(inside)
    return Figure(
        name="turn_symmetry",
        title="Seconds of turning left less those of turning right, in per cent of both",
        sentence=" ".join(filter(None, (_sentence(sides), not_drawn(outside, limit)))),
        chart=_chart(),
        data={"cells": _cells(inside)},
    )


def _cells(sides: Table) -> Table:
    left, right = sides["left_seconds"], sides["right_seconds"]
    more = 100 * (left - right) / (left + right)
    return Table(
        {
            **{name: sides[name] for name in ("speed", "turn_rate_deg", "left_seconds", "right_seconds")},
            "symmetry": sides["symmetry"],
            "speed_from": sides["speed"] - SYMMETRY_CELLS.speed / 2,
            "speed_to": sides["speed"] + SYMMETRY_CELLS.speed / 2,
            "turn_from": sides["turn_rate_deg"] - SYMMETRY_CELLS.turn_rate_deg / 2,
            "turn_to": sides["turn_rate_deg"] + SYMMETRY_CELLS.turn_rate_deg / 2,
            "more": more,
            "class": _MORE.of(more),
        }
    )


def _seconds(sides: Table) -> float:
    return float((sides["left_seconds"] + sides["right_seconds"]).sum())


def _sentence(sides: Table) -> str:
    if len(sides) == 0:
        return "No clip turns by more than 5 degrees/s."
    left, right = sides["left_seconds"], sides["right_seconds"]
    said = (
        f"Left and right are alike to {symmetry_of(sides):.2f} (1: the same seconds at every speed and turn "
        f"rate, 0: never both): {duration(float(left.sum()))} of turning left, "
        f"{duration(float(right.sum()))} of turning right"
    )
    worst = int(np.argmax(np.abs(left - right)))
    if abs(left[worst] - right[worst]) < 1:
        return f"{said}; no cell differs by a second."
    more, less = ("left", "right") if left[worst] > right[worst] else ("right", "left")
    return (
        f"{said}; they differ most at {sides['speed'][worst]:.1f} m/s and "
        f"{sides['turn_rate_deg'][worst]:.0f} degrees/s: {duration(float(max(left[worst], right[worst])))} "
        f"to the {more}, {duration(float(min(left[worst], right[worst])))} to the {less}."
    )


def _chart() -> dict[str, Any]:
    return {
        "width": "container",
        "height": 300,
        "data": {"name": "cells"},
        "mark": {"type": "rect", "aria": False, "stroke": "var(--page)", "strokeWidth": 0.5},
        "encoding": {
            **cell_axes("Turn rate to either side, deg/s", {"tickCount": 8}),
            "color": _MORE.colour("Per cent more to the left (to the right: minus)", columns=4),
            "tooltip": [
                {"field": "speed", "title": "Speed, m/s", "format": ".2f"},
                {"field": "turn_rate_deg", "title": "Turn rate, deg/s", "format": ".0f"},
                {"field": "left_seconds", "title": "Seconds to the left", "format": ".1f"},
                {"field": "right_seconds", "title": "Seconds to the right", "format": ".1f"},
                {"field": "symmetry", "title": "Symmetry, 1 is alike", "format": ".2f"},
            ],
        },
    }
