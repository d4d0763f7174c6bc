"""A tuning in words: whether the weights should be changed, and what stands behind that."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from gmr.evaluation.intervals import Interval
from gmr.evaluation.tuning.weights import HELD_OUT, TRAINING, WORTHWHILE, Tuning
from gmr.evaluation.words import count, listing, number, percent

__all__ = ["headline", "sentences"]

_NOTHING: Final = 1e-6
"""Metres: less than any recording tells."""


def headline(tuning: Tuning) -> str:
    """The one sentence to remember."""
    if tuning.improves:
        return (
            f"Weigh the features anew: {_weights(tuning)}. Trials that were not tuned on do better with it."
        )
    if tuning.beyond_chance:
        return (
            "The weights of the features stay as they are: no worthwhile gain. Others do better on trials "
            f"that were not tuned on, but by {number(tuning.gain.mean)} m, less than {percent(WORTHWHILE)} "
            f"of their offset and jumping ({number(tuning.worthwhile)} m)."
        )
    return (
        "The weights of the features stay as they are: others do no better on trials that were not tuned on."
    )


def sentences(tuning: Tuning) -> Iterator[str]:
    """What stands behind it, in reading order."""
    runs, cells = len(tuning.search), int((tuning.trials["set"] == TRAINING).sum())
    yield (
        f"Searched was on {count(cells, 'trial')} of the grid, in {count(runs, 'run')} of all of them, for "
        f"what lowers the mean offset plus {tuning.smoothness:g} s times the jumping of the joints."
    )
    yield _of_set(tuning, TRAINING, "On these trials")
    gain = tuning.gain
    held_out = _of_set(tuning, HELD_OUT, "On those held out").removesuffix(".")
    if max(map(abs, (gain.low, gain.mean, gain.high))) < _NOTHING:
        yield f"{held_out}: nothing changes."
    else:
        yield f"{held_out}: {_change(gain)}."
    if not tuning.improves:
        why = "what is not worth it" if tuning.beyond_chance else "what is not to be trusted"
        yield f"What the search found, and {why}: {_weights(tuning)}."


def _change(gain: Interval) -> str:
    """How much better the tuned weights do, and how sure that is."""
    falls = "falls" if gain.mean > 0 else "rises"
    bounds = sorted((abs(gain.low), abs(gain.high))) if gain.low * gain.high > 0 else None
    between = (
        f"{number(bounds[0])} to {number(bounds[1])}"
        if bounds
        else f"from {number(max(-gain.low, 0.0))} worse to {number(max(gain.high, 0.0))} better"
    )
    return f"it {falls} by {number(abs(gain.mean))} m (95% confidence interval {between})"


def _of_set(tuning: Tuning, which: str, where: str) -> str:
    def change(column: str, unit: str) -> str:
        before, after = tuning.mean(which, column), tuning.mean(which, f"{column}_tuned")
        return f"from {round(before, 6):.3g} to {round(after, 6):.3g} {unit}"

    return (
        f"{where} the offset goes {change('offset_mean', 'm')}, the jumping "
        f"{change('discontinuity_per_second', 'm/s')}, and both together {change('objective', 'm')}."
    )


def _weights(tuning: Tuning) -> str:
    """Those that change, the names of the search."""
    names = [name for name in tuning.search.column_names if name not in ("objective", "best")]
    best = int(np.flatnonzero(tuning.search["best"])[-1])
    changed = [
        f"{name} {number(float(tuning.search[name][best]))} (was {number(float(tuning.search[name][0]))})"
        for name in names
        if tuning.search[name][best] != tuning.search[name][0]
    ]
    return listing(changed) or "no others than before"
