"""The figures of a pruning: quality for size, and what each clip is worth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np

from gmr.evaluation.figures.wording import short_names
from gmr.pages.figure import Figure
from gmr.pages.theme import NAMES_AXIS, NAMES_CONFIG, ROW
from gmr.pruning.prune import Pruning
from gmr.pruning.words import curve_sentence, held_sentence, importance_sentence
from gmr.table import Table

__all__ = ["figures"]

MOST_BARS: Final = 25

_BAR_ORDER: Final = (
    "Bars are sorted by the mean offset alone; what is missed most counts trials that no longer hold, too."
)


def figures(of: Pruning) -> Iterator[Figure]:
    """All of them, in the order in which they are shown."""
    curve = _curve_table(of)
    if not np.isnan(curve["offset_mean"]).all():
        yield Figure(
            name="pruning_offset",
            title="Mean distance from the path, m, by what is left of the dataset",
            sentence=curve_sentence(of),
            chart=_curve_chart({"field": "offset_mean", "title": "Mean offset, m", "axis": {"tickCount": 5}}),
            data={"points": curve},
        )
    yield Figure(
        name="pruning_held",
        title="Trials that hold, by what is left of the dataset",
        sentence=held_sentence(of),
        chart=_curve_chart(
            {
                "field": "held",
                "title": f"Trials that hold, of {of.outcomes.score.runs}",
                "axis": {"tickCount": 5, "tickMinStep": 1},
                "scale": {"domainMin": 0},
            }
        ),
        data={"points": curve},
    )
    bars = _bars(of)
    if len(bars):
        yield Figure(
            name="pruning_importance",
            title="What it costs to leave out a clip, alone: the mean offset grows by, m",
            sentence=f"{importance_sentence(of)} {_BAR_ORDER}",
            chart=_bar_chart(len(bars)),
            data={"clips": bars},
        )


def _curve_table(of: Pruning) -> Table:
    curve = of.curve.table
    kind = np.where(curve["lossless"], _KINDS[0], _KINDS[1]).astype(object)
    kind[of.curve.points.index(of.chosen)] = _KINDS[2]
    return Table({**dict(curve), "kind": kind})


_KINDS: Final = ("no trial changes", "some trials change", "written")


def _curve_chart(y: Mapping[str, Any]) -> dict[str, Any]:
    x = {
        "field": "share_kept",
        "type": "quantitative",
        "title": "Seconds of the dataset that are left",
        "sort": "descending",
        "axis": {"format": "~%", "tickCount": 6},
        "scale": {"zero": False},
    }
    line = {"mark": {"type": "line", "color": "var(--bar-second)", "strokeWidth": 2, "aria": False}}
    colours = ["var(--bar)", "var(--reference)", "var(--ink)"]
    dots = {
        "mark": {"type": "point", "filled": True, "opacity": 1, "size": 70, "aria": False},
        "encoding": {
            "color": {
                "field": "kind",
                "type": "nominal",
                "scale": {"domain": list(_KINDS), "range": colours},
                "legend": {"title": None},
            },
            "shape": {
                "field": "kind",
                "type": "nominal",
                "scale": {"domain": list(_KINDS), "range": ["circle", "circle", "diamond"]},
                "legend": {"title": None},
            },
            "tooltip": [
                {"field": "kind", "title": "Without the rest"},
                {"field": "seconds", "title": "Seconds left", "format": ".1f"},
                {"field": "share_kept", "title": "Of all", "format": ".0%"},
                {"field": "clips", "title": "Clips left"},
                {"field": "offset_mean", "title": "Mean offset, m", "format": ".3f"},
                {"field": "held", "title": "Trials that hold"},
            ],
        },
    }
    return {
        "width": "container",
        "height": 260,
        "data": {"name": "points"},
        "encoding": {"x": x, "y": {"type": "quantitative", **y}},
        "layer": [line, dots],
    }


def _bars(of: Pruning) -> Table:
    """The clips whose bars are longest, the longest first, of those that can be left out at all."""
    timed = ~np.isnan(of.importance["offset_change"]) & (of.importance["runs"] > 0)
    rows = of.importance.take(timed)
    rows = rows.take(np.argsort(-rows["offset_change"], kind="stable")[:MOST_BARS])
    label = np.array(short_names(rows["clip"].tolist()), object)
    return Table({"label": label, **dict(rows)})


def _bar_chart(bars: int) -> dict[str, Any]:
    return {
        "width": "container",
        "config": NAMES_CONFIG,
        "height": ROW * max(bars, 1),
        "data": {"name": "clips"},
        "mark": {"type": "bar", "height": {"band": 0.72}, "color": "var(--bar)", "aria": False},
        "encoding": {
            "y": {"field": "label", "type": "nominal", "sort": None, "title": None, "axis": NAMES_AXIS},
            "x": {
                "field": "offset_change",
                "type": "quantitative",
                "title": "Change of the mean offset without it, m",
                "axis": {"tickCount": 5},
            },
            "tooltip": [
                {"field": "clip", "title": "Clip"},
                {"field": "seconds", "title": "Its seconds", "format": ".1f"},
                {"field": "runs", "title": "Trials that need it"},
                {"field": "offset_change", "title": "Change of the mean offset, m", "format": "+.4f"},
                {"field": "held_change", "title": "Change of the trials that hold", "format": "+d"},
            ],
        },
    }
