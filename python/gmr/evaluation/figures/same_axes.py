"""The same figure of several datasets on the same axes, so that lengths and places can be compared by eye."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.pages.figure import Figure

__all__ = ["on_same_axes"]

_AXES: Final = ("x", "y")


def on_same_axes(figures: Sequence[Figure]) -> list[Figure]:
    """The figures with each axis of numbers reaching as far as the farthest of them needs.

    Args:
        figures: one chart drawn from several datasets.
    """
    charts = [copy.deepcopy(dict(figure.chart)) for figure in figures]
    for axis in _AXES:
        found = [_Axis(axis, chart, figure) for chart, figure in zip(charts, figures, strict=True)]
        reaches = np.array([one.reach() for one in found if one.encodings])
        if len(reaches) == 0:
            continue
        low, high = float(reaches[:, 0].min()), float(reaches[:, 1].max())
        ticks = max((one.ticks() for one in found), key=len)
        for one in found:
            one.set(low, high, ticks)
    return [replace(figure, chart=chart) for figure, chart in zip(figures, charts, strict=True)]


class _Axis:
    """The encodings of one axis of a chart that hold numbers, each with the data that it draws."""

    def __init__(self, axis: str, chart: dict[str, Any], figure: Figure) -> None:
        self.axis = axis
        self.encodings: list[tuple[dict[str, Any], dict[str, Any], Mapping[str, Any]]] = [
            (layer, encoding, dict(figure.data[data]) if data in figure.data else {})
            for layer, encoding, data in _layers(chart)
            if encoding.get(axis, {}).get("type") == "quantitative"
        ]

    def reach(self) -> tuple[float, float]:
        """The least and the greatest number on the axis."""
        lows, highs = [], []
        for layer, encoding, data in self.encodings:
            scale = encoding[self.axis].get("scale", {})
            values = _drawn(self.axis, layer, encoding, data)
            if scale.get("zero", "domain" not in scale):
                values = np.append(values, 0.0)
            values = np.append(values, scale.get("domain", []))
            values = values[np.isfinite(values)]
            if len(values):
                lows.append(values.min())
                highs.append(values.max())
        return (float(min(lows)), float(max(highs))) if lows else (0.0, 0.0)

    def ticks(self) -> list[float]:
        """Where the axis is labelled, where the chart says so."""
        named = [encoding[self.axis].get("axis") or {} for _, encoding, _ in self.encodings]
        return max((list(axis.get("values", [])) for axis in named), key=len, default=[])

    def set(self, low: float, high: float, ticks: list[float]) -> None:
        """Let the axis reach from ``low`` to ``high``."""
        if high <= low:
            return
        for _, encoding, _ in self.encodings:
            channel = encoding[self.axis]
            channel["scale"] = {**channel.get("scale", {}), "domain": [low, high]}
            channel["scale"].pop("zero", None)
            if ticks and channel.get("axis"):
                channel["axis"] = {**channel["axis"], "values": ticks}


def _layers(chart: dict[str, Any]) -> Iterator[tuple[dict[str, Any], dict[str, Any], str]]:
    """Every mark of a chart with its encoding, in part its layers' common one, and the name of its data."""
    shared = chart.get("encoding", {})
    data = chart.get("data", {}).get("name", "")
    if "layer" not in chart:
        yield chart, shared, data
        return
    for layer in chart["layer"]:
        own = layer.setdefault("encoding", {})
        for axis in _AXES:
            if axis in shared and axis not in own:
                own[axis] = shared[axis]
        yield layer, own, layer.get("data", {}).get("name", data)


def _drawn(
    axis: str, layer: Mapping[str, Any], encoding: Mapping[str, Any], data: Any
) -> NDArray[np.float64]:
    """The numbers on an axis: those of its field, of where marks end, and the heights of stacked bars."""
    fields = [encoding[channel].get("field") for channel in (axis, f"{axis}2") if channel in encoding]
    columns = [np.asarray(data[field], np.float64) for field in fields if field is not None and field in data]
    if not columns:
        return np.zeros(0)
    mark = layer.get("mark", {})
    kind = mark if isinstance(mark, str) else mark.get("type")
    across = encoding.get("y" if axis == "x" else "x", {}).get("field")
    if (
        kind in ("bar", "area")
        and "color" in encoding
        and across in data
        and encoding[axis].get("stack", True)
    ):
        _, place = np.unique(np.asarray(data[across]).astype(str), return_inverse=True)
        columns.append(np.bincount(place.reshape(-1), columns[0]).astype(np.float64))
    return np.concatenate(columns)
