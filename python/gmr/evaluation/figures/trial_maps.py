"""The trials as a map over speed and turn rate, one map a measure (paper's Figure 5 with its margins)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from gmr.evaluation.figures.measures import Measure
from gmr.evaluation.result import Evaluation
from gmr.evaluation.scenarios.on_grid import on_grid
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = [
    "HOVER",
    "cells_of_trials",
    "place_of_trial",
    "set_label",
    "set_suffix",
    "set_words",
    "trial_map",
    "trial_sets",
    "trials_of",
]


def trial_map(
    evaluation: Evaluation, measure: Measure, scenario: str, tracking: str, *, columns: int = 7
) -> Figure:
    """One measure of the trials of a scenario, over speed (up) and turn rate (across); the legend has at most
    ``columns``."""
    chosen = trials_of(evaluation, scenario, tracking)
    value = chosen[measure.column] * measure.factor
    spread = measure.spread(chosen) if measure.spread else np.full(len(chosen), np.nan)
    drawn = Table(
        {
            **{name: chosen[name] for name in ("trial", "speed", "turn_rate_deg", *HOVER)},
            "value": value,
            "spread": spread * measure.factor,
            "class": measure.classes.of(value),
        }
    )
    return Figure(
        name=f"trial_map_{measure.column}{set_suffix(scenario, tracking)}",
        title=measure.title + set_words(scenario, tracking),
        sentence=measure.sentence(chosen),
        chart=_chart(measure, len(np.unique(chosen["speed"])), columns),
        data={"trials": drawn},
    )


def trial_sets(evaluation: Evaluation) -> list[tuple[str, str]]:
    """The pairs of scenario and tracking in the trials of the grid, in their order."""
    trials = evaluation.measured.trials
    trials = trials.take(on_grid(trials))
    return list(dict.fromkeys(zip(trials["scenario"].tolist(), trials["tracking"].tolist(), strict=True)))


def set_label(scenario: str, tracking: str) -> str:
    """What a list of sets of trials calls one of them."""
    pace = {"constant": "one speed throughout", "switching": "two speeds in turn"}
    aim = {"time": "aims at the timed plan", "velocity": "asks for speed and turn rate only"}
    return f"{pace.get(scenario, scenario)}, {aim.get(tracking, tracking)}"


def trials_of(evaluation: Evaluation, scenario: str, tracking: str) -> Table:
    """The trials of one scenario and one tracking, with ``trial``: their rows in the table of all."""
    trials = evaluation.measured.trials
    rows = np.flatnonzero((trials["scenario"] == scenario) & (trials["tracking"] == tracking))
    return Table({**dict(trials.take(rows)), "trial": rows})


def set_suffix(scenario: str, tracking: str) -> str:
    """What the names of the figures of a set of trials end in: nothing for the usual set."""
    unusual = ("" if scenario == "constant" else scenario, "" if tracking == "time" else tracking)
    return "".join(f"_{name}" for name in unusual if name)


def set_words(scenario: str, tracking: str) -> str:
    """What the titles of the figures of a set of trials end in: nothing for the usual set."""
    unusual = {"switching": "while the speed switches", "velocity": "without a timed path"}
    return "".join(f", {unusual[name]}" for name in (scenario, tracking) if name in unusual)


HOVER: Final = {
    "offset_mean": ("Mean offset, m", ".2f"),
    "offset_p95": ("95% of the time below, m", ".2f"),
    "offset_max": ("Largest offset, m", ".2f"),
    "speed_error": ("Speed error, m/s", "+.2f"),
    "turn_rate_error_deg": ("Turn rate error, deg/s", "+.1f"),
    "speed_deviation": ("Speed, ± m/s", ".2f"),
    "turn_rate_deviation_deg": ("Turn rate, ± deg/s", ".1f"),
    "transitions_per_second": ("Jumps per second", ".1f"),
    "pose_discontinuity_mean": ("Pose gap at a jump, m", ".3f"),
}


def place_of_trial(hover: Mapping[str, tuple[str, str]]) -> dict[str, Any]:
    """Where a trial stands on a map, and what it tells when it is pointed at: title and format by column."""
    return {
        "x": {
            "field": "turn_rate_deg",
            "type": "ordinal",
            "title": "Turn rate asked for, deg/s (left is positive)",
            "axis": {
                "labelAngle": 0,
                "format": "~g",
                "labelFontSize": {"expr": "windowSize()[0] < 600 ? 10 : 12"},
            },
        },
        "y": {
            "field": "speed",
            "type": "ordinal",
            "sort": "descending",
            "title": "Speed asked for, m/s",
            "axis": {"format": "~g"},
        },
        "tooltip": [
            {"field": "speed", "title": "Asked for, m/s", "format": "~g"},
            {"field": "turn_rate_deg", "title": "Asked for, deg/s", "format": "~g"},
            *({"field": name, "title": title, "format": form} for name, (title, form) in hover.items()),
        ],
    }


def cells_of_trials(rows: int, colour: dict[str, Any], *layers: dict[str, Any]) -> dict[str, Any]:
    """A map of the trials: a cell for each in its ``colour``, and ``layers`` on top."""
    cells = {
        "mark": {"type": "rect", "stroke": "var(--page)", "strokeWidth": 2, "aria": False},
        "encoding": {"color": colour},
    }
    return {
        "width": "container",
        "height": max(44 * rows, 60),
        "data": {"name": "trials"},
        "resolve": {"scale": {"color": "independent"}},
        "encoding": place_of_trial(HOVER),
        "layer": [cells, *layers],
    }


def _chart(measure: Measure, rows: int, columns: int) -> dict[str, Any]:
    sign = "+" if measure.classes.palette == "signed" else ""
    number = f"format(datum.value, '{sign}.{measure.decimals}f')"
    ink = {"color": measure.classes.ink()}
    figures = {
        "transform": [{"calculate": number, "as": "number"}],
        "mark": {
            "type": "text",
            "fontSize": {"expr": "windowSize()[0] < 600 ? 10 : 13"},
            "dy": -6 if measure.spread else 0,
            "aria": False,
        },
        "encoding": {"text": {"field": "number", "type": "nominal"}, **ink},
    }
    colour = measure.classes.colour(measure.unit, columns=min(columns, 4) if sign else columns)
    return cells_of_trials(rows, colour, figures, *([_spread_layer(measure, ink)] if measure.spread else []))


def _spread_layer(measure: Measure, ink: dict[str, Any]) -> dict[str, Any]:
    return {
        "transform": [{"calculate": f"'±' + format(datum.spread, '.{measure.decimals}f')", "as": "margin"}],
        "mark": {
            "type": "text",
            "fontSize": {"expr": "windowSize()[0] < 600 ? 8 : 11"},
            "dy": 9,
            "opacity": 0.8,
            "aria": False,
        },
        "encoding": {"text": {"field": "margin", "type": "nominal"}, **ink},
    }
