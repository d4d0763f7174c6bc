"""Coverage, one point a window: which clip moves at which speed and turn rate (paper's Figure 1)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.axes import at_the_edge, point_axes, widest_turn
from gmr.evaluation.figures.time_shares import turning_share, usual_speeds
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, percent
from gmr.matching.naming import recording_of
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["coverage_scatter"]

_MOST_POINTS: Final = 24_000
"""More are slow to draw on a phone, and hide one another."""
_COLOURS: Final = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a6fd1"]
"""After Okabe and Ito: told apart by colour-blind readers too, on white and on black."""
_SHAPES: Final = ["circle", "square", "triangle-up", "diamond", "cross"]


def coverage_scatter(evaluation: Evaluation) -> Figure:
    """Every 1-s window of every clip, in speed and turn rate, coloured by clip.

    With more windows than can be drawn every n-th is, and the sentence says so. Few that turn much faster
    than all others are drawn at the edge, and are counted.
    """
    windows = evaluation.measured.coverage
    step = max(-(-len(windows) // _MOST_POINTS), 1)
    shown = windows.take(_every(step, windows["clip"]))
    clips, number = np.unique(shown["clip"].astype(str), return_inverse=True)
    points = Table(
        {
            "clip": shown["clip"],
            "time": shown["seconds"],
            "speed": shown["speed"],
            "turn_rate_deg": shown["turn_rate_deg"],
            "colour": number % len(_COLOURS),
            "shape": number // len(_COLOURS) % len(_SHAPES),
        }
    )
    limit = widest_turn(windows["turn_rate_deg"], evaluation.measured.trials["turn_rate_deg"])
    return Figure(
        name="coverage_scatter",
        title="Speed and turn rate of every second of motion, by clip",
        sentence=_sentence(windows, len({recording_of(clip) for clip in clips.tolist()}), step, limit),
        chart=_chart(points, limit),
        data={"windows": points, "chosen": points.take(np.arange(0))},
    )


def _every(step: int, clips: NDArray[Any]) -> NDArray[np.int64]:
    """Rows of every ``step``-th window of each clip, the first one among them, so that none is missing."""
    starts = np.flatnonzero(np.append(True, clips[1:] != clips[:-1])) if len(clips) else np.zeros(0, np.int64)
    within = np.arange(len(clips)) - np.repeat(starts, np.diff(np.append(starts, len(clips))))
    return np.flatnonzero(within % step == 0)


def _sentence(windows: Table, clip_count: int, step: int, limit: float) -> str:
    if len(windows) == 0:
        return "No clip is long enough for a single window of one second."
    usual = usual_speeds(windows)
    parts = [
        f"Nine tenths of the motion of {count(clip_count, 'clip')} lies between {usual[0]:.1f} and "
        f"{usual[1]:.1f} m/s; {percent(turning_share(windows, 25))} of it turns faster than 25 degrees/s, "
        f"{percent(turning_share(windows, 75))} faster than 75 degrees/s.",
    ]
    if outside := at_the_edge(windows["turn_rate_deg"], limit):
        parts.append(outside)
    if step > 1:
        parts.append(f"One window in {step} of the {len(windows):,} is drawn.")
    return " ".join(parts)


def _chart(points: Table, turn: float) -> dict[str, Any]:
    speed = float(points["speed"].max(initial=1.0))
    place = point_axes(turn, speed)
    by_clip = {
        "color": {
            "condition": {"test": "dimmed", "value": "#8b939c"},
            "field": "colour",
            "type": "nominal",
            "scale": {"domain": list(range(len(_COLOURS))), "range": _COLOURS},
            "legend": None,
        },
        "shape": {
            "field": "shape",
            "type": "nominal",
            "scale": {"domain": list(range(len(_SHAPES))), "range": _SHAPES},
            "legend": None,
        },
        "opacity": {"condition": {"test": "dimmed", "value": 0.12}, "value": 0.55},
    }
    return {
        "width": "container",
        "height": 420,
        "params": [{"name": "dimmed", "value": False}],
        # The points are pixels, for thousands of SVG elements are slow; pixels cannot follow CSS colours, so
        # the axes take a grey that reads on white and on black.
        "usermeta": {"renderer": "canvas", "hover": "windows"},
        "layer": [
            {
                "data": {"name": "windows"},
                "mark": {"type": "point", "filled": True, "size": 12, "aria": False},
                "encoding": {**place, **by_clip},
            },
            {
                "data": {"name": "chosen"},
                "mark": {
                    "type": "point",
                    "filled": True,
                    "size": 26,
                    "color": "#d55e00",
                    "opacity": 0.9,
                    "aria": False,
                },
                "encoding": place,
            },
        ],
        "config": {
            "axis": {"labelColor": "#7a828b", "titleColor": "#7a828b", "gridColor": "rgba(128,136,144,0.25)"}
        },
    }
