"""How well it goes sideways and backwards, direction by direction, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gmr.evaluation.scenarios.strafe import way_in_words
from gmr.evaluation.words import listing, number
from gmr.table import Table

__all__ = ["drift_sentence"]


def drift_sentence(trials: Table) -> Iterator[str]:
    """One sentence where the trials of a scenario, on a timed path, go other ways than ahead: the mean offset
    and facing error of each direction, those nearest to what was asked first."""
    drift = trials["drift_deg"]
    ways = np.unique(drift[np.isfinite(drift)])
    if not np.any(ways != 0):
        return
    parts = {float(way): trials.take(drift == way) for way in ways}
    nearest = sorted(parts, key=lambda way: float(parts[way]["offset_mean"].mean()))
    told = [
        f"{way_in_words(way)} {number(float(parts[way]['offset_mean'].mean()))} m and "
        f"{float(parts[way]['facing_error_deg'].mean()):.0f} degrees"
        for way in nearest
    ]
    yield f"By direction it is off from path and facing by: {listing(told)}."
