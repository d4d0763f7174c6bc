"""What a figure is: a Vega-Lite chart without its data, the data as columns, and a sentence that reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from gmr.pages.theme import LOOK, in_light_colours
from gmr.table import Table

__all__ = ["SCHEMA", "Figure"]

SCHEMA: Final = "https://vega.github.io/schema/vega-lite/v6.json"
_WIDTH: Final = 760
_HEIGHT: Final = 540
"""Of a figure that takes its height from what holds it."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One chart of the report.

    Attributes:
        name: its name, also that of its SVG file.
        title: what is drawn, with units.
        sentence: what it shows, computed from the data.
        chart: Vega-Lite description without ``data``: it names its data sets and CSS colours, and is as wide
            as what holds it. Its ``config`` adds to the look that all charts share.
        data: the data sets by the names that the chart uses.
        key: what the page tells beside the chart, such as the names behind numbers, in lines for below the
            title of an SVG file.
    """

    name: str
    title: str
    sentence: str
    chart: Mapping[str, Any]
    data: Mapping[str, Table] = field(default_factory=dict)
    key: tuple[str, ...] = ()

    def dressed(self) -> dict[str, Any]:
        """The chart in the common look, still without its data and with CSS colours: what the page embeds."""
        return {
            "$schema": SCHEMA,
            "description": f"{self.title}. {self.sentence}",
            "autosize": {
                "type": "fit" if self.chart["height"] == "container" else "fit-x",
                "contains": "padding",
            },
            **self.chart,
            "config": _merged(LOOK, self.chart.get("config", {})),
        }

    def description(self) -> dict[str, Any]:
        """The complete Vega-Lite description: data and light colours written in, of a fixed width."""
        complete: dict[str, Any] = in_light_colours(self.dressed())
        return {
            **complete,
            "width": _WIDTH,
            "height": _HEIGHT if complete["height"] == "container" else complete["height"],
            "background": "#ffffff",
            "title": {
                "text": self.title,
                "subtitle": list(self.key),
                "anchor": "start",
                "fontSize": 15,
                "offset": 12,
            },
            "padding": 12,
            "datasets": {name: list(table.rows()) for name, table in self.data.items()},
        }


def _merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, change in changes.items():
        both = isinstance(change, Mapping) and isinstance(base.get(key), Mapping)
        merged[key] = _merged(base[key], change) if both else change
    return merged
