"""The tuning as a section of a report."""

from __future__ import annotations

from typing import Any

import numpy as np

from gmr.evaluation.figures.wording import asked
from gmr.evaluation.report.parts import shown_figure
from gmr.evaluation.tuning.weights import HELD_OUT, TRAINING, Tuning
from gmr.evaluation.tuning.words import headline, sentences
from gmr.evaluation.words import count
from gmr.pages.document import element, items, section
from gmr.pages.figure import Figure
from gmr.pages.section import Section
from gmr.table import Table

__all__ = ["tuning_figure", "tuning_section"]


def tuning_section(tuning: Tuning) -> Section:
    """What tuning found, in words, and every cell before and after."""
    figure = tuning_figure(tuning)
    save = "".join(
        element("button", f"Save {name}.csv", type="button", data_save=name)
        for name in ("tuning", "tuning_search")
    )
    content = (
        element("ul", items(list(sentences(tuning))))
        + shown_figure(figure)
        + element("div", save, class_="controls")
    )
    return Section(
        name="tuning",
        title="Weights",
        html=section("tuning", "Other weights", headline(tuning), content),
        figures=(figure,),
        tables={"tuning": tuning.trials, "tuning_search": tuning.search},
    )


def tuning_figure(tuning: Tuning) -> Figure:
    """Every cell: the objective with the weights as they were, across, and tuned, up."""
    trials = tuning.trials
    cells = Table(
        {
            "before": trials["objective"],
            "after": trials["objective_tuned"],
            "set": trials["set"],
            "asked": np.array([asked(row["speed"], row["turn_rate_deg"]) for row in trials.rows()], object),
        }
    )
    most = float(max(cells["before"].max(), cells["after"].max()))
    told = [_better(cells, name, what) for name, what in ((TRAINING, "tuned on"), (HELD_OUT, "held out"))]
    return Figure(
        name="tuning_cells",
        title="Offset and jumping of every trial, m: with the weights as they were, and tuned",
        sentence=f"Tuned weights are better below the line: in {told[0]}, and in {told[1]}.",
        chart=_chart(most),
        data={"cells": cells, "line": Table({"at": np.array([0.0, most])})},
    )


def _better(cells: Table, name: str, what: str) -> str:
    chosen = cells["set"] == name
    better = int((cells["after"] < cells["before"])[chosen].sum())
    return f"{better} of {count(int(chosen.sum()), 'trial')} {what}"


def _chart(most: float) -> dict[str, Any]:
    def axis(field: str, title: str) -> dict[str, Any]:
        return {
            "field": field,
            "type": "quantitative",
            "title": title,
            "scale": {"domain": [0, most], "nice": True},
            "axis": {"tickCount": 5},
        }

    x, y = axis("before", "As they were, m"), axis("after", "Tuned, m")
    return {
        "width": "container",
        "height": 360,
        "layer": [
            {
                "data": {"name": "line"},
                "mark": {"type": "line", "color": "var(--ink-soft)", "strokeWidth": 1, "aria": False},
                "encoding": {"x": {**x, "field": "at"}, "y": {**y, "field": "at"}},
            },
            {
                "data": {"name": "cells"},
                "mark": {"type": "point", "filled": True, "size": 60, "opacity": 0.85, "aria": False},
                "encoding": {
                    "x": x,
                    "y": y,
                    "color": {
                        "field": "set",
                        "type": "nominal",
                        "scale": {
                            "domain": [TRAINING, HELD_OUT],
                            "range": ["var(--bar-second)", "var(--reference)"],
                        },
                        "title": None,
                    },
                    "shape": {
                        "field": "set",
                        "type": "nominal",
                        "scale": {"domain": [TRAINING, HELD_OUT], "range": ["circle", "diamond"]},
                        "title": None,
                    },
                    "tooltip": [
                        {"field": "asked", "title": "Asked for"},
                        {"field": "set", "title": "Trial"},
                        {"field": "before", "title": "As they were, m", "format": ".2f"},
                        {"field": "after", "title": "Tuned, m", "format": ".2f"},
                    ],
                },
            },
        ],
    }
