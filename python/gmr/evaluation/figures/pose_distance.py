"""How near the poses of each cell of the coverage map are to those of other clips."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from gmr.evaluation.coverage_cells import Bins
from gmr.evaluation.figures.axes import TURN_RATE, cell_axes, not_drawn, widest_turn
from gmr.evaluation.figures.classes import Classes
from gmr.evaluation.figures.coverage_density import seconds_near_pairs
from gmr.evaluation.pose_coverage import ALONE, BLENDABLE, REDUNDANT, THIN, UNBLENDABLE, BlendLimits
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import duration, percent
from gmr.pages.figure import Figure
from gmr.pages.theme import turn_ticks
from gmr.table import Table

__all__ = ["pose_distance"]

_CELL: Final = Bins()
_CENTIMETRES: Final = Classes("error", (2.0, 3.0, 5.0, 10.0, 15.0, 25.0))


def pose_distance(evaluation: Evaluation) -> Figure:
    """Centimetres from the poses of each cell to the nearest ones of other clips; thin cells are faint."""
    poses = evaluation.measured.pose_coverage
    limit = widest_turn(
        evaluation.measured.coverage["turn_rate_deg"], seconds_near_pairs(evaluation)["turn_rate_deg"]
    )
    inside = poses.take(np.abs(poses["turn_rate_deg"]) <= limit)
    outside = float(poses["seconds"].sum() - inside["seconds"].sum())
    alone = ~np.isfinite(inside["nearest_mean"])
    cells = _cells(inside)
    return Figure(
        name="pose_distance",
        title="Centimetres to the nearest pose of another clip that goes alike",
        sentence=" ".join(filter(None, (*_sentences(poses), not_drawn(outside, limit)))),
        chart=_chart(limit),
        data={"cells": cells.take(~alone), "alone": cells.take(alone)},
    )


def _cells(poses: Table) -> Table:
    return Table(
        {
            **{
                name: poses[name]
                for name in ("speed", "turn_rate_deg", "seconds", "clips", "entropy", "kind")
            },
            "speed_from": poses["speed"] - _CELL.speed / 2,
            "speed_to": poses["speed"] + _CELL.speed / 2,
            "turn_from": poses["turn_rate_deg"] - _CELL.turn_rate_deg / 2,
            "turn_to": poses["turn_rate_deg"] + _CELL.turn_rate_deg / 2,
            "nearest": 100 * poses["nearest_mean"],
            "p95": 100 * poses["nearest_p95"],
            "class": _CENTIMETRES.of(100 * poses["nearest_mean"]),
        }
    )


def _sentences(poses: Table) -> Iterator[str]:
    limits = BlendLimits()
    total = float(poses["seconds"].sum())
    if total == 0:
        yield "No clip is long enough for a single window of one second."
        return

    def share(kind: str) -> str:
        seconds = float(poses["seconds"][poses["kind"] == kind].sum())
        return f"{duration(seconds)} ({percent(seconds / total)})"

    yield (
        f"Of {duration(total)} of motion, {share(REDUNDANT)} are dense and redundant (another clip has the "
        f"pose within {limits.redundant * 100:g} cm), {share(BLENDABLE)} dense and blendable, "
        f"{share(UNBLENDABLE)} dense but unblendable ({limits.unblendable * 100:g} cm and more)"
        f"{_lonely(poses)}; {share(THIN)} lie in cells of less than {duration(limits.dense)}, drawn faintly."
    )
    varied = float(np.average(poses["entropy"], weights=poses["seconds"]))
    yield f"The poses of a cell are spread as over {2**varied:.0f} clusters of 32, all alike, on average."


def _lonely(poses: Table) -> str:
    seconds = float(poses["seconds"][poses["kind"] == ALONE].sum())
    return f", {duration(seconds)} from a single clip (empty squares)" if seconds else ""


def _chart(limit: float) -> dict[str, Any]:
    place = cell_axes(TURN_RATE, {"values": turn_ticks(limit)})
    tooltip = [
        {"field": "kind", "title": "The cell is"},
        {"field": "speed", "title": "Speed, m/s", "format": ".2f"},
        {"field": "turn_rate_deg", "title": "Turn rate, deg/s", "format": ".1f"},
        {"field": "seconds", "title": "Seconds", "format": ".1f"},
        {"field": "clips", "title": "Clips"},
    ]
    distances = [
        {"field": "nearest", "title": "Nearest pose, mean, cm", "format": ".1f"},
        {"field": "p95", "title": "Nearest pose, 95th percentile, cm", "format": ".1f"},
        {"field": "entropy", "title": "Entropy of its poses, bits", "format": ".1f"},
    ]
    thin = {"test": f"datum.kind === '{THIN}'", "value": 0.35}
    return {
        "width": "container",
        "height": 420,
        "layer": [
            {
                "data": {"name": "cells"},
                "mark": {"type": "rect", "aria": False, "stroke": "var(--page)", "strokeWidth": 0.5},
                "encoding": {
                    **place,
                    "color": _CENTIMETRES.colour("Centimetres to the nearest pose"),
                    "opacity": {"condition": thin, "value": 1},
                    "tooltip": [*tooltip, *distances],
                },
            },
            {
                "data": {"name": "alone"},
                "mark": {
                    "type": "rect",
                    "aria": False,
                    "fill": "transparent",
                    "stroke": "var(--line)",
                    "strokeWidth": 1,
                },
                "encoding": {**place, "tooltip": tooltip},
            },
        ],
    }
