"""A tuning in words: whether the weights should be changed, and what stands behind that."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from gmr.evaluation.intervals import Interval
from gmr.evaluation.tuning.descent import FARTHEST
from gmr.evaluation.tuning.weights import HELD_OUT, TRAINING, WORTHWHILE, Tuning
from gmr.evaluation.words import capital, count, hold, listing, number, percent
from gmr.matching.schema import LOCOMOTION

__all__ = ["headline", "sentences"]

_NOTHING: Final = 1e-6
"""Metres: less than any recording tells."""


def headline(tuning: Tuning) -> str:
    """The one sentence to remember."""
    if tuning.improves:
        return (
            f"Weigh the features anew: {_weights(tuning)}. Trials that were not tuned on do better with it."
        )
    if tuning.beyond_chance and tuning.loses_trials:
        before, after = tuning.holding(HELD_OUT)
        do = "none does" if after == 0 else f"only {after} {'does' if after == 1 else 'do'}"
        return (
            "The weights of the features stay as they are: others lower offset and jumping by "
            f"{number(tuning.gain.mean)} m on trials that were not tuned on, but of the "
            f"{int((tuning.trials['set'] == HELD_OUT).sum())} {do} what "
            f"{'it is' if after <= 1 else 'they are'} asked, where {before} did."
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
    yield _held(tuning)
    yield from _bounds(tuning)
    if tuning.improves:
        yield from _options(tuning)
    else:
        yield f"What the search found, and {_why_not(tuning)}: {_weights(tuning)}."


def _why_not(tuning: Tuning) -> str:
    if not tuning.beyond_chance:
        return "what is not to be trusted"
    return "what loses trials" if tuning.loses_trials else "what is not worth it"


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


def _held(tuning: Tuning) -> str:
    """How many trials hold before and after."""
    parts = []
    for which, what in ((TRAINING, "tuned on"), (HELD_OUT, "held out")):
        chosen = tuning.trials["set"] == which
        before, after = tuning.holding(which)
        holding = f"{after} {hold(after)}" if after else "none holds"
        than = ", as before" if after == before else f" where {before or 'none'} did"
        parts.append(f"of the {count(int(chosen.sum()), 'trial')} {what} {holding}{than}")
    return f"{capital('; '.join(parts))}."


def _bounds(tuning: Tuning) -> Iterator[str]:
    """The weights that may not be the best, for the search goes no farther."""
    for name, (was, found) in tuning.named.items():
        for bound, to, other in (
            (1 / FARTHEST, f"a {FARTHEST:g}th of", "smaller"),
            (FARTHEST, f"{FARTHEST:g} times", "larger"),
        ):
            if was and math.isclose(found, bound * was, rel_tol=1e-4):
                yield (
                    f"The weight of {name} lies at the bound of the search, {to} what it was: a {other} one "
                    "may do better."
                )


def _options(tuning: Tuning) -> Iterator[str]:
    """The tuned weights for the command line, which knows those of the usual features."""
    known = {group.name for group in LOCOMOTION.groups} == set(tuning.weights)
    if not known or LOCOMOTION.weighed(tuning.weights) != tuning.schema.weighed(tuning.weights):
        return
    # Beside the usual weights, for those of this evaluation may have been others already.
    options = [
        f'--weight "{name}={weight:.6g}"'
        for name, (_, weight) in tuning.named.items()
        if LOCOMOTION.weighed({name: weight}) != LOCOMOTION
    ]
    yield f"To evaluate with these weights: {' '.join(options) or 'no --weight'}"


def _weights(tuning: Tuning) -> str:
    """Those that change, the names of the search."""
    changed = [
        f"{name} {number(found)} (was {number(was)})"
        for name, (was, found) in tuning.named.items()
        if found != was
    ]
    return listing(changed) or "no others than before"
