"""Which datasets do what they are asked: one map for all of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from gmr.evaluation.comparison_words import all_of, grids_of
from gmr.evaluation.figures.trial_maps import cells_of_trials
from gmr.evaluation.regions import judged
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import count, listing
from gmr.pages.figure import Figure
from gmr.pages.theme import STEPS
from gmr.table import Table

__all__ = ["compared_trials"]

_MARKED: Final = 6
"""With more datasets than this their numbers do not fit into a cell, which then says how many."""


def compared_trials(evaluations: Sequence[Evaluation]) -> Figure:
    """Every trial with the numbers of the datasets that do it as asked, coloured by how many they are."""
    grids = grids_of(evaluations)
    usual = evaluations[0].measured.trials
    rows = np.flatnonzero(judged(usual))
    trials = usual.take(rows)
    row = np.searchsorted(grids[0].speeds, trials["speed"])
    column = np.searchsorted(grids[0].turn_rates_deg, trials["turn_rate_deg"])
    held = np.stack([grid.held[row, column] for grid in grids], axis=1)
    names = [evaluation.dataset for evaluation in evaluations]
    number = held.sum(axis=1)
    offsets = {
        f"offset_{place}": evaluation.measured.trials["offset_mean"][rows]
        for place, evaluation in enumerate(evaluations)
    }
    drawn = Table(
        {
            "trial": rows,
            "speed": trials["speed"],
            "turn_rate_deg": trials["turn_rate_deg"],
            "number": number,
            "who": np.array([listing(_chosen(names, which)) or "none" for which in held], object),
            "mark": np.array([_mark(which) for which in held], object),
            **offsets,
        }
    )
    hover = {"who": ("Done as asked by", "")} | {
        f"offset_{place}": (f"Mean offset of {name}, m", ".2f") for place, name in enumerate(names)
    }
    return Figure(
        name="compared_trials",
        title="Which of them does what is asked",
        sentence=_sentence(names, number),
        chart=_chart(len(grids[0].speeds), len(names), hover),
        data={"trials": drawn},
    )


def _chosen(names: Sequence[str], which: Any) -> list[str]:
    return [name for name, does in zip(names, which.tolist(), strict=True) if does]


def _mark(which: Any) -> str:
    """The numbers of the datasets that do it, from 1 on."""
    if len(which) > _MARKED:
        return str(int(which.sum()) or "")
    return " ".join(str(place + 1) for place in np.flatnonzero(which).tolist())


def _sentence(names: Sequence[str], number: Any) -> str:
    key = listing([f"{place + 1} is {name}" for place, name in enumerate(names)])
    everyone, nobody = int((number == len(names)).sum()), int((number == 0).sum())
    return (
        f"{key}. Of {count(len(number), 'trial')}, {all_of(len(names))} do {everyone} as asked; "
        f"{nobody} {'is' if nobody == 1 else 'are'} done by none."
    )


def _chart(rows: int, datasets: int, hover: dict[str, tuple[str, str]]) -> dict[str, Any]:
    steps = [f"amount-{round(number * (STEPS - 1) / datasets)}" for number in range(1, datasets + 1)]
    grounds = ["var(--panel)", *(f"var(--{step})" for step in steps)]
    inks = ["var(--ink)", *(f"var(--on-{step})" for step in steps)]

    def colour(colours: list[str], legend: dict[str, Any] | None) -> dict[str, Any]:
        return {
            "field": "number",
            "type": "ordinal",
            "scale": {"domain": list(range(datasets + 1)), "range": colours},
            "legend": legend,
        }

    labels = ["none", *(f"{number} of {datasets}" for number in range(1, datasets)), all_of(datasets)]
    legend = {
        "title": "Done as asked by",
        "labelExpr": f"{labels}[datum.value]",
        "columns": {"expr": f"windowSize()[0] < 600 ? 2 : {datasets + 1}"},
    }
    marks = {
        "mark": {"type": "text", "fontSize": {"expr": "windowSize()[0] < 600 ? 9 : 13"}, "aria": False},
        "encoding": {"text": {"field": "mark", "type": "nominal"}, "color": colour(inks, None)},
    }
    chart = cells_of_trials(rows, colour(grounds, legend), marks)
    tooltip = [one for one in chart["encoding"]["tooltip"] if one["field"] in ("speed", "turn_rate_deg")]
    told = [
        {"field": name, "title": title, **({"format": form} if form else {})}
        for name, (title, form) in hover.items()
    ]
    return {**chart, "encoding": {**chart["encoding"], "tooltip": [*tooltip, *told]}}
