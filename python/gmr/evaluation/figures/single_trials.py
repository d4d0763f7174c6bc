"""Figures of one trial at a time, to be chosen from all of a set: the paper's show one each."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.trial_maps import trial_sets
from gmr.evaluation.figures.wording import asked
from gmr.evaluation.result import Evaluation
from gmr.table import Table

__all__ = ["choice", "numbered", "of_set", "pairs_of", "set_drawn", "whose"]


def set_drawn(evaluation: Evaluation) -> tuple[str, str]:
    """Scenario and tracking of the trials that are drawn one by one: switching ones where there are any."""
    sets = trial_sets(evaluation)
    return next((each for each in sets if each[0] == "switching"), sets[0])


def of_set(table: Table, scenario: str, tracking: str) -> Table:
    """The rows of a table that belong to a scenario and a tracking."""
    return table.take((table["scenario"] == scenario) & (table["tracking"] == tracking))


def pairs_of(table: Table) -> list[tuple[float, float]]:
    """Speed and turn rate of every trial of a set, in order."""
    return list(dict.fromkeys(zip(table["speed"].tolist(), table["turn_rate_deg"].tolist(), strict=True)))


def numbered(table: Table, pairs: list[tuple[float, float]]) -> NDArray[np.int64]:
    """(N,) the place of every row's trial among ``pairs``."""
    place = {pair: number for number, pair in enumerate(pairs)}
    found = zip(table["speed"].tolist(), table["turn_rate_deg"].tolist(), strict=True)
    return np.fromiter((place[pair] for pair in found), np.int64, len(table))


def choice(pairs: list[tuple[float, float]], speed: float, turn_rate_deg: float) -> dict[str, Any]:
    """The Vega-Lite parameter ``trial``: a list to choose from, at first the trial nearest to a pair."""
    apart = [abs(v - speed) + abs(w - turn_rate_deg) / 25 for v, w in pairs]
    return {
        "name": "trial",
        "value": int(np.argmin(apart)) if apart else 0,
        "bind": {
            "input": "select",
            "name": "Trial ",
            "options": list(range(len(pairs))),
            "labels": [f"{v:g} m/s, {w:+g} deg/s" if w else f"{v:g} m/s, straight" for v, w in pairs],
        },
    }


def whose(pairs: list[tuple[float, float]], number: int) -> str:
    """A trial in words."""
    return asked(*pairs[number])
