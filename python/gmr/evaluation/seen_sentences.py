"""Sliding feet and jerking bodies in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from gmr.evaluation.regions import judged
from gmr.evaluation.words import count, number
from gmr.table import Table

__all__ = ["seen_sentences"]

SKATES: Final = 200.0
"""Millimetres a stance from which on a foot that is down plainly skates: most of a foot's length."""


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
        f"A foot slides {number(float(np.median(slide[known])))} mm while it is down in the median trial, "
        f"where the clips' own frames slide {number(float(np.median(own[known])))} mm{skates}."
    )
    jerk = trials["jerk_at_jumps"] / trials["jerk_between_jumps"]
    if np.isfinite(jerk).any():
        times = number(float(np.median(jerk[np.isfinite(jerk)])))
        yield f"At a jump the joints jerk {times} times as hard as between jumps in the median trial."
