"""The figures of a completion: the trials before and after, and what changed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

import numpy as np

from gmr.completion.complete import Completion
from gmr.completion.words import change_sentence
from gmr.evaluation.figures.classes import two_sided
from gmr.evaluation.figures.holds_map import holds_map
from gmr.evaluation.figures.measures import MEASURES
from gmr.evaluation.figures.trial_maps import place_of_trial, trial_map, trial_sets
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = ["figures"]

_CHANGE: Final = two_sided((0.1, 0.25, 1.0))


def figures(of: Completion) -> Iterator[Figure]:
    """Every figure, in the order of the page: pairs of before and after, then what changed.

    The classes of a map do not depend on what is in it, so a colour means the same before and after.
    """
    both = {"before": of.before, "after": of.after}
    scenario, tracking = trial_sets(of.before)[0]
    for when, evaluation in both.items():
        yield _called(f"holds_{when}", when, holds_map(evaluation, scenario, tracking, columns=2))
    for when, evaluation in both.items():
        drawn = trial_map(evaluation, _OFFSET, scenario, tracking, columns=4)
        yield _called(f"offset_{when}", when, drawn)
    yield _change_map(of)


_OFFSET: Final = next(measure for measure in MEASURES if measure.column == "offset_mean")


def _called(name: str, when: str, figure: Figure) -> Figure:
    return replace(figure, name=name, title=f"{figure.title}, {when}")


def _change_map(of: Completion) -> Figure:
    trials = of.trials
    change = trials["offset_after"] - trials["offset_before"]
    drawn = Table(
        {
            **{name: trials[name] for name in ("speed", "turn_rate_deg", *_HOVER)},
            "change": change,
            "class": _CHANGE.of(change),
            "mark": np.where(
                trials["held_after"] & ~trials["held_before"],
                "filled",
                np.where(trials["held_before"] & ~trials["held_after"], "lost", ""),
            ).astype(object),
        }
    )
    return Figure(
        name="change",
        title="Change of the mean distance from the planned position, m",
        sentence=change_sentence(of),
        chart=_chart(len(np.unique(trials["speed"]))),
        data={"trials": drawn},
    )


_HOVER: Final = {
    "offset_before": ("Mean offset before, m", ".2f"),
    "offset_after": ("Mean offset after, m", ".2f"),
    "speed_error_before": ("Speed error before, m/s", "+.2f"),
    "speed_error_after": ("Speed error after, m/s", "+.2f"),
    "turn_rate_error_deg_before": ("Turn rate error before, deg/s", "+.1f"),
    "turn_rate_error_deg_after": ("Turn rate error after, deg/s", "+.1f"),
}


def _chart(rows: int) -> dict[str, Any]:
    ink = {"color": _CHANGE.ink()}
    number = {
        "transform": [{"calculate": "format(datum.change, '+.2f')", "as": "number"}],
        "mark": {
            "type": "text",
            "fontSize": {"expr": "windowSize()[0] < 600 ? 10 : 13"},
            "dy": -6,
            "aria": False,
        },
        "encoding": {"text": {"field": "number", "type": "nominal"}, **ink},
    }
    mark = {
        "mark": {
            "type": "text",
            "fontSize": {"expr": "windowSize()[0] < 600 ? 8 : 11"},
            "dy": 9,
            "aria": False,
        },
        "encoding": {"text": {"field": "mark", "type": "nominal"}, **ink},
    }
    cells = {
        "mark": {"type": "rect", "stroke": "var(--page)", "strokeWidth": 2, "aria": False},
        "encoding": {"color": _CHANGE.colour("Metres, minus is closer to the plan", columns=4, narrow=2)},
    }
    return {
        "width": "container",
        "height": max(44 * rows, 60),
        "data": {"name": "trials"},
        "resolve": {"scale": {"color": "independent"}},
        "encoding": place_of_trial(_HOVER),
        "layer": [cells, number, mark],
    }
