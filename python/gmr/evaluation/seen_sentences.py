"""Sliding feet and jerking bodies in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.regions import judged
from gmr.evaluation.words import count, number
from gmr.table import Table

__all__ = ["seen_sentences"]

SKATES: Final = 200.0
"""Millimetres a stance from which on a foot that is down plainly skates: most of a foot's length."""

JERKS: Final = 1.2
"""Times as hard as between jumps from which on the jerk at jumps is told; below it nobody would notice."""


def seen_sentences(trials: Table) -> Iterator[str]:
    """How far feet slide while they are down, and how hard jumps jerk, in the trials that are judged."""
    if "foot_slide_mm" not in trials:
        return
    trials = trials.take(judged(trials))
    slide, own = trials["foot_slide_mm"], trials["foot_slide_own_mm"]
    known = np.isfinite(slide) & np.isfinite(own)
    if not known.any():
        yield "No foot is ever seen to stand on the ground, so nothing is said of feet that slide."
        return
    skating = int(np.sum(slide[known] > SKATES))
    skates = f"; it skates, by over {SKATES:g} mm, in {count(skating, 'trial')}" if skating else ""
    yield (
        f"A foot slides {_millimetres(slide[known])} while it is down in the median trial, "
        f"where the clips' own frames slide {_millimetres(own[known])}{skates}."
    )
    jerk = trials["jerk_at_jumps"] / trials["jerk_between_jumps"]
    times = float(np.median(jerk[np.isfinite(jerk)])) if np.isfinite(jerk).any() else 1.0
    if times >= JERKS:
        yield f"At a jump the joints jerk {number(times)} times as hard as between jumps in the median trial."


def _millimetres(values: NDArray[np.float64]) -> str:
    """The median; tenths of a millimetre are less than any recording tells."""
    return f"{number(round(float(np.median(values)), 1))} mm"
