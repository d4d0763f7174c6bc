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
_LEGEND: Final = {"symbolType": "stroke", "symbolStrokeWidth": 3}
_COLOURS: Final = {
    "field": "method",
    "type": "nominal",
    "title": None,
    "scale": {"domain": list(METHODS.values()), "range": ["var(--kind-1)", "var(--kind-0)", "var(--kind-2)"]},
    "legend": _LEGEND,
}
_HEIGHT: Final = 230


def capsule_figures(of: Comparison) -> Iterator[Figure]:
    """Volume, cross-section, bulge and stretch of the capsule, over the angle of a bend or of a twist."""

    def last(movement: str, column: str) -> tuple[float, ...]:
        table = of.capsule.take(of.capsule["movement"] == movement)
        return tuple(float(_column(table, method, column)[-1]) for method in METHODS.values())

    linear, dual, centers = last("bend", "volume")
    yield _over_angle(
        "bend_volume",
        "Volume in a bend",
        f"Bent by 150°, linear blending keeps {linear:.1%} of the volume, dual quaternions {dual:.1%}, "
        f"centres of rotation {centers:.1%}.",
        of.capsule,
        ("bend", "volume", "Volume over that at rest"),
    )
    linear, dual, centers = last("twist", "volume")
    yield _over_angle(
        "twist_volume",
        "Volume in a twist",
        f"Twisted by 180°, linear blending keeps {linear:.1%} of the volume, dual quaternions {dual:.1%}, "
        f"centres of rotation {centers:.1%}.",
        of.capsule,
        ("twist", "volume", "Volume over that at rest"),
    )
    linear, dual, centers = last("bend", "bulge")
    yield _over_angle(
        "bend_bulge",
        "The bulge of a bend",
        f"What dual quaternions pay: bent by 150° the outside stands {dual:.0%} of the radius farther from "
        f"the bones than at rest; {linear:.0%} for linear blending, {centers:.0%} about centres of rotation.",
        of.capsule,
        ("bend", "bulge", "Outermost vertex beyond the radius"),
    )
    linear, dual, centers = last("twist", "section_least")
    yield _over_angle(
        "twist_section",
        "The candy wrapper of a twist",
        f"Twisted by 180° the ring round the joint keeps {linear:.0%} of its radius under linear blending: "
        f"at 0 it is a point. Dual quaternions keep {dual:.0%}, centres of rotation {centers:.0%}.",
        of.capsule,
        ("twist", "section_least", "Least radius over that at rest"),
    )
    linear, dual, centers = last("bend", "edge")
    yield _over_angle(
        "bend_edges",
        "Stretch in a bend",
        f"Root mean square change of edge lengths, bent by 150°: {linear:.0%}, {dual:.0%} and {centers:.0%}.",
        of.capsule,
        ("bend", "edge", "Change of edge lengths"),
    )
    linear, dual, centers = last("twist", "edge")
    yield _over_angle(
        "twist_edges",
        "Stretch in a twist",
        f"The same, twisted by 180°: {linear:.0%}, {dual:.0%} and {centers:.0%}. A twist must stretch it.",
        of.capsule,
        ("twist", "edge", "Change of edge lengths"),
    )


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


def _over_angle(name: str, title: str, sentence: str, capsule: Table, drawn: tuple[str, str, str]) -> Figure:
    movement, column, axis = drawn
    table = capsule.take(capsule["movement"] == movement)
    chart = _lines("capsule", "degrees", "Degrees", column, axis)
    return Figure(name, title, sentence, chart, {"capsule": table})


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
