"""The errors of a trial and the normal distributions that fit them (paper's Figure 8)."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from gmr.evaluation.distributions import BIN_WIDTHS
from gmr.evaluation.figures.single_trials import choice, numbered, of_set, pairs_of, set_drawn
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, number
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["error_distributions"]

_SHOWN: Final = (1.0, -100.0)
"""Speed and turn rate of the trial in the paper's figure."""

_POINTS: Final = 46
"""Of a curve, half of them from three and a half deviations below each centre to as many above it."""

_REACH: Final = 3.5

_NAMES: Final = {
    "speed": ("error_distribution_speed", "speed", "m/s"),
    "turn_rate_deg": ("error_distribution_turn_rate", "turn rate", "degrees/s"),
}


def error_distributions(evaluation: Evaluation) -> list[Figure]:
    """The errors of speed and of turn rate, a figure each: one trial as bars, its fit as a line."""
    scenario, tracking = set_drawn(evaluation)
    bins = of_set(evaluation.measured.error_bins, scenario, tracking)
    fits = of_set(evaluation.measured.error_fits, scenario, tracking)
    return [_figure(bins, fits, quantity, scenario) for quantity in _NAMES]


def _figure(bins: Table, fits: Table, quantity: str, scenario: str) -> Figure:
    name, words, unit = _NAMES[quantity]
    bins, fits = (table.take(table["error_of"] == quantity) for table in (bins, fits))
    pairs = pairs_of(fits)
    bars = {column: bins[column] for column in ("from", "to", "share")}
    return Figure(
        name=name,
        title=f"Error of the {words} in a trial, and the normal distributions that fit it",
        sentence=_sentence(fits, words, unit, switching=scenario == "switching"),
        chart=_chart(choice(pairs, *_SHOWN), f"Played minus asked for, {unit}"),
        data={
            "bars": Table({"trial": numbered(bins, pairs), **bars}),
            "curve": _curves(fits, BIN_WIDTHS[quantity]),
        },
    )


def _curves(fits: Table, width: float) -> Table:
    """Share of the steps that each fit puts into a bin of the histogram, along the axis."""
    means, deviations, shares = (
        np.nan_to_num(np.stack([fits[f"{name}_1"], fits[f"{name}_2"]], axis=1))
        for name in ("mean", "deviation", "share")
    )
    two = fits["components"] == 2
    wide = np.maximum(deviations, width / 3)
    rows = np.arange(len(fits))
    centres, reach = np.where(two[:, None], means, means[:, :1]), np.where(two[:, None], wide, wide[:, :1])
    along = np.linspace(-_REACH, _REACH, _POINTS // 2)
    error = np.sort((centres[..., None] + reach[..., None] * along).reshape(len(fits), _POINTS), axis=1)
    apart = (error[..., None] - means[:, None]) / wide[:, None]
    density = shares[:, None] * np.exp(-0.5 * apart**2) / (np.sqrt(2 * np.pi) * wide[:, None])
    return Table(
        {
            "trial": np.repeat(rows, _POINTS),
            "error": error.ravel(),
            "share": width * density.sum(axis=2).ravel(),
        }
    )


def _sentence(fits: Table, words: str, unit: str, *, switching: bool) -> str:
    two = fits.take(fits["components"] == 2)
    trials = count(len(fits), "switching trial" if switching else "trial")
    told = f"In {len(two)} of {trials} the errors of the {words} have two centres"
    if len(two) == 0:
        centre = float(np.nanmean(fits["mean_1"])) if np.isfinite(fits["mean_1"]).any() else 0.0
        return f"{told}; elsewhere one, {_signed(centre)} {unit} in the mean of the trials."
    low, high = float(np.median(two["mean_1"])), float(np.median(two["mean_2"]))
    share = float(np.median(two["share_2"]))
    return (
        f"{told}, {_signed(low)} and {_signed(high)} {unit} in the median trial, the second with "
        f"{100 * share:.0f}% of the time. Bars are shares of the steps; the line is the fit."
    )


def _signed(value: float) -> str:
    return f"{'−' if value < 0 else '+'}{number(abs(value))}"


def _chart(trial: dict[str, Any], title: str) -> dict[str, Any]:
    y = {
        "field": "share",
        "type": "quantitative",
        "title": "Share of the steps",
        "axis": {"format": "~%", "tickCount": 4},
    }
    chosen = [{"filter": "datum.trial == trial"}]
    return {
        "width": "container",
        "height": 240,
        "params": [trial],
        "layer": [
            {
                "data": {"name": "bars"},
                "transform": chosen,
                "mark": {"type": "bar", "color": "var(--bar-second)", "binSpacing": 1, "aria": False},
                "encoding": {
                    "x": {
                        "field": "from",
                        "type": "quantitative",
                        "title": title,
                        "bin": {"binned": True},
                        "axis": {"grid": False},
                    },
                    "x2": {"field": "to"},
                    "y": {**y, "stack": None},
                    "tooltip": [
                        {"field": "from", "title": "From", "format": ".2f"},
                        {"field": "to", "title": "To", "format": ".2f"},
                        {"field": "share", "title": "Share of the steps", "format": ".1%"},
                    ],
                },
            },
            {
                "data": {"name": "curve"},
                "transform": chosen,
                "mark": {"type": "line", "color": "var(--reference)", "strokeWidth": 2, "aria": False},
                "encoding": {"x": {"field": "error", "type": "quantitative"}, "y": y},
            },
        ],
    }
