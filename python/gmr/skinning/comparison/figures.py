"""The comparison's figures, each a chart with a computed sentence that reads it (the paper's Figs. 5, 6)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from gmr.pages.figure import Figure
from gmr.skinning.comparison.measured import METHODS, Comparison
from gmr.table import Table

__all__ = ["capsule_figures", "clip_figures"]

_LINEAR, _DUAL, _CENTERS = METHODS.values()
_LEGEND: Final = {
    "symbolType": "stroke",
    "symbolStrokeWidth": 3,
    "columns": {"expr": "windowSize()[0] < 600 ? 2 : 3"},
}
_COLOURS: Final = {
    "field": "method",
    "type": "nominal",
    "title": None,
    "scale": {"domain": list(METHODS.values()), "range": ["var(--kind-1)", "var(--kind-0)", "var(--kind-2)"]},
    "legend": _LEGEND,
}
_HEIGHT: Final = 230


_CAPSULE: Final = (
    (
        "bend_volume",
        "Volume in a bend",
        ("bend", "volume", "Volume over that at rest"),
        "Bent by 150°, linear blending keeps {:.1%} of the volume, dual quaternions {:.1%}, centres of "
        "rotation {:.1%}.",
    ),
    (
        "twist_volume",
        "Volume in a twist",
        ("twist", "volume", "Volume over that at rest"),
        "Twisted by 180°, linear blending keeps {:.1%}, dual quaternions {:.1%}, centres of rotation {:.1%}.",
    ),
    (
        "bend_bulge",
        "The bulge of a bend",
        ("bend", "bulge", "Outermost vertex beyond the radius"),
        "Bent by 150° the outside stands farther from the bones than at rest: by {:.0%} of the radius under "
        "linear blending, {:.0%} under dual quaternions, which pay so for the volume, {:.0%} about "
        "centres of rotation.",
    ),
    (
        "twist_section",
        "The candy wrapper of a twist",
        ("twist", "section_least", "Least radius over that at rest"),
        "Twisted by 180° the ring round the joint keeps {:.0%} of its radius under linear blending: at 0 it "
        "is a point. Dual quaternions keep {:.0%}, centres of rotation {:.0%}.",
    ),
    (
        "bend_edges",
        "Stretch in a bend",
        ("bend", "edge", "Change of edge lengths"),
        "Root mean square change of edge lengths, bent by 150°: {:.0%}, {:.0%} and {:.0%}.",
    ),
    (
        "twist_edges",
        "Stretch in a twist",
        ("twist", "edge", "Change of edge lengths"),
        "The same, twisted by 180°: {:.0%}, {:.0%} and {:.0%}. A twist must stretch it.",
    ),
)
"""Name, title, what is drawn (movement, column, axis), and a sentence for the values at its end."""


def capsule_figures(of: Comparison) -> Iterator[Figure]:
    """Volume, cross-section, bulge and stretch of the capsule, over the angle of a bend or of a twist."""
    for name, title, (movement, column, axis), sentence in _CAPSULE:
        table = of.capsule.take(of.capsule["movement"] == movement)
        ends = [float(_column(table, method, column)[-1]) for method in METHODS.values()]
        chart = _lines("capsule", "degrees", "Degrees", column, axis)
        yield Figure(name, title, sentence.format(*ends), chart, {"capsule": table})


def clip_figures(of: Comparison) -> Iterator[Figure]:
    """Volume and stretch of the character over the clip, and how far the methods are apart."""
    least = {method: _column(of.frames, method, "volume").min() for method in METHODS.values()}
    holes = "" if of.is_closed else " The mesh has holes, which are taken as closed flat."
    yield _over_time(
        "clip_volume",
        "Volume of the character over the clip",
        f"At its worst linear blending keeps {least[_LINEAR]:.1%} of the volume at rest, dual quaternions "
        f"{least[_DUAL]:.1%}, centres of rotation {least[_CENTERS]:.1%}.{holes}",
        of.frames,
        "volume",
        "Volume over that at rest",
    )
    worst = {method: _column(of.frames, method, "edge_worst").max() for method in METHODS.values()}
    yield _over_time(
        "clip_edges",
        "The edges that stretch most",
        "Change of length that the worst hundredth of the edges exceeds; at its worst "
        f"{worst[_LINEAR]:.0%} for linear blending, {worst[_DUAL]:.0%} for dual quaternions, "
        f"{worst[_CENTERS]:.0%} about centres of rotation.",
        of.frames,
        "edge_worst",
        "Change of edge lengths, worst hundredth",
    )
    yield _apart(of)


def _apart(of: Comparison) -> Figure:
    apart = of.apart["apart_max_mm"]
    frame = int(apart.argmax())
    table = Table(
        {
            "seconds": np.tile(of.apart["seconds"], 2),
            "millimetres": np.concatenate([apart, of.apart["apart_mean_mm"]]),
            "which": ["the farthest vertex"] * len(apart) + ["the mean vertex"] * len(apart),
        }
    )
    colour = {
        "field": "which",
        "type": "nominal",
        "title": None,
        "scale": {
            "domain": ["the farthest vertex", "the mean vertex"],
            "range": ["var(--bar)", "var(--bar-second)"],
        },
        "legend": _LEGEND,
    }
    return Figure(
        name="clip_apart",
        title="How far linear and dual quaternion blending are apart",
        sentence=f"Most in frame {frame} ({of.apart['seconds'][frame]:.2f} s): {apart[frame]:.0f} mm, at a "
        f"vertex that follows {of.apart['joint'][frame]} most. Over the clip a vertex is "
        f"{of.apart['apart_mean_mm'].mean():.1f} mm apart on average.",
        chart={
            "width": "container",
            "height": _HEIGHT,
            "data": {"name": "apart"},
            "mark": {"type": "line", "strokeWidth": 1.8},
            "encoding": {
                "x": {"field": "seconds", "type": "quantitative", "title": "Seconds"},
                "y": {"field": "millimetres", "type": "quantitative", "title": "Millimetres"},
                "color": colour,
            },
        },
        data={"apart": table},
    )


def _over_time(name: str, title: str, sentence: str, table: Table, column: str, axis: str) -> Figure:
    return Figure(
        name, title, sentence, _lines("frames", "seconds", "Seconds", column, axis), {"frames": table}
    )


def _lines(data: str, x: str, x_title: str, y: str, y_title: str) -> dict[str, Any]:
    """A line for each method, in per cent."""
    return {
        "width": "container",
        "height": _HEIGHT,
        "data": {"name": data},
        "mark": {"type": "line", "strokeWidth": 2},
        "encoding": {
            "x": {
                "field": x,
                "type": "quantitative",
                "title": x_title,
                "axis": {"tickCount": 6, "grid": False},
            },
            "y": {
                "field": y,
                "type": "quantitative",
                "title": y_title,
                "axis": {"format": "~%", "tickCount": 5},
                "scale": {"zero": False},
            },
            "color": _COLOURS,
        },
    }


def _column(table: Table, method: str, column: str) -> Any:
    return table[column][table["method"] == method]
