"""Mutation: variations of an action that keep what makes it that action.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 4: "One is to choose same type of
actionlets but with different velocity functions from the actionlet database. Another is to perturb the
parameters of the velocity functions". The first is :func:`substituted`, the second :func:`mutate`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import islice, pairwise

import numpy as np

from gmr.actionlets.actionlet import Actionlet, checked_number
from gmr.actionlets.choices import Choices
from gmr.actionlets.mutable import Mutable, Mutant
from gmr.actionlets.score import Score
from gmr.actionlets.track import MEETING, Piece, Track
from gmr.errors import ActionletError

__all__ = ["mutate", "substituted", "variation"]


def variation(
    score: Score,
    index: int,
    seed: int = 0,
    amount: float = 0.2,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    groups: Sequence[Collection[str]] | None = None,
) -> Score:
    """The variation number ``index`` of a score; the same whatever others are made before it or at all.

    Otherwise as :func:`mutate`.
    """
    for name, value in (("index", index), ("seed", seed)):
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 0:
            raise ActionletError(f"the {name} of a variation is {value!r}; give a whole number from 0 on")
    return mutate(score, np.random.default_rng([seed, index]), amount, ranges, groups)


def mutate(
    score: Score,
    rng: np.random.Generator,
    amount: float = 0.2,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    groups: Sequence[Collection[str]] | None = None,
) -> Score:
    """A score whose extremes, times and skews are a little different, each within the given amount.

    The ways keep their directions, silences stay silences, what is periodic stays so, and every degree of
    freedom stays in its range. The degrees of freedom of a group are hastened and slowed together: their
    extremes keep their order and their share of the period, so what was synchronised stays synchronised.

    Args:
        score: what is varied.
        rng: where chance comes from.
        amount: from 0 (nothing changes) to 1 (an extreme moves by up to 45 % of the way to its nearer
            neighbour, the duration changes by up to 35 %).
        ranges: radians (low, high) by DOF name; a DOF that it does not name is free.
        groups: names of degrees of freedom that keep their common times; None: all of them together.
            One that no group names is timed alone.

    Returns:
        A score of the same degrees of freedom, with the same number of pieces in each.

    Raises:
        ActionletError: an amount outside [0, 1], a group with a DOF that the score has not or that another
            group has, or an extreme of the score itself outside its range.
    """
    size = checked_number(amount, "the amount of a mutation", "give a number from 0 to 1")
    if not 0 <= size <= 1:
        raise ActionletError(f"the amount of a mutation is {size:g}; give a number from 0 to 1")
    together = _groups(score, groups)
    _check_ranges(score, ranges or {})
    material = Mutable.of(score, ranges or {}, together)
    return _made(score, material, material.changed(rng, size))


def substituted(score: Score, others: Mapping[str, Sequence[Piece]], rng: np.random.Generator) -> Score:
    """The score with the velocity function of each of its pieces taken from another of the same type.

    Args:
        score: what is varied.
        others: by DOF name, pieces to choose from. Those that move the same way (up or down) are of one type;
            a piece of which there is no other of its type stays, and so does a silence.
        rng: where chance comes from.

    Returns:
        The same extremes at the same times.
    """
    choices = Choices.of(score, others)
    drawn = iter(choices.drawn(rng).tolist())
    found = {}
    for name, track in score.tracks.items():
        own = zip(track.pieces, islice(drawn, len(track.pieces)), strict=True)
        pieces = tuple(
            piece if k < 0 else choices.others[k].lasting(piece.duration).between(piece.start, piece.end)
            for piece, k in own
        )
        found[name] = replace(track, pieces=pieces)
    return Score(found)


def _made(score: Score, before: Mutable, after: Mutant) -> Score:
    """The score that a mutation made of another."""
    duration = after.tempo * score.duration
    found = {}
    for number, dof in enumerate(before.dofs):
        track, first, last = score[dof], int(before.first[number]), int(before.first[number + 1])
        times = duration * after.times[first + number : last + number + 1]
        extremes = after.extremes[first + number : last + number + 1].tolist()
        pieces = tuple(
            _bent(piece, skew).lasting(seconds).between(start, end)
            for piece, skew, seconds, (start, end) in zip(
                track.pieces,
                after.skews[first:last].tolist(),
                np.diff(times).tolist(),
                pairwise(extremes),
                strict=True,
            )
        )
        lead, trail = max(-float(times[0]), 0.0), max(float(times[-1]) - duration, 0.0)
        found[dof] = Track(pieces, lead if track.lead else 0.0, trail if track.trail else 0.0)
    return Score({dof: found[dof] for dof in score.dofs})


def _bent(piece: Piece, skew: float) -> Piece:
    return replace(piece, skew=skew) if isinstance(piece, Actionlet) else piece


def _groups(score: Score, groups: Sequence[Collection[str]] | None) -> list[list[str]]:
    if groups is None:
        return [list(score.dofs)]
    placed: set[str] = set()
    found = []
    for group in groups:
        for name in group:
            score[name]
            if name in placed:
                raise ActionletError(f"'{name}' is in two groups of a mutation; it can keep one's times only")
            placed.add(name)
        found.append(list(group))
    return found + [[name] for name in score.dofs if name not in placed]


def _check_ranges(score: Score, ranges: Mapping[str, tuple[float, float]]) -> None:
    for name, track in score.tracks.items():
        low, high = ranges.get(name, (-np.inf, np.inf))
        wrong = np.flatnonzero((track.extremes < low - MEETING) | (track.extremes > high + MEETING))
        if len(wrong):
            angle, at = np.degrees(track.extremes[wrong[0]]), track.times[wrong[0]]
            raise ActionletError(
                f"'{name}' is at {angle:.6g} degrees after {at:g} s, its range is {np.degrees(low):.6g} to"
                f" {np.degrees(high):.6g}; a mutation starts from an action within its ranges"
            )
