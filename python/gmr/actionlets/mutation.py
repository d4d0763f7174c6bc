"""Mutation: variations of an action that keep what makes it that action.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 4: "One is to choose same type of
actionlets but with different velocity functions from the actionlet database. Another is to perturb the
parameters of the velocity functions". The first is :func:`substituted`, the second :func:`mutate`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import Actionlet, checked_number
from gmr.actionlets.operations.timing import is_periodic
from gmr.actionlets.score import Score
from gmr.actionlets.track import MEETING, Piece, Track
from gmr.errors import ActionletError

__all__ = ["mutate", "substituted", "variation"]

Floats = NDArray[np.float64]

_TEMPO, _WARP, _TRAVEL, _SKEW = 0.3, 0.8, 0.45, 2.0
"""What an amount of 1 changes at most: the logarithm of the duration; the pace from moment to moment, as a
share; an extreme, as a share of the lesser way to its neighbours (below a half, so that no way is turned
round); the logarithm of ``T / (1 - T)``."""

_WAVES = 3
"""Slow waves of which a change of pace is made."""


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
    duration = score.duration * float(np.exp(size * _TEMPO * rng.uniform(-1, 1)))
    found: dict[str, Track] = {}
    for group in together:
        pace = _waves(rng, size)
        for name in group:
            low, high = (ranges or {}).get(name, (-np.inf, np.inf))
            track = score[name]
            times = duration * _warped(track.times / track.duration, pace)
            found[name] = _perturbed(track, times, duration, rng, size, low, high)
    return Score({name: found[name] for name in score.dofs})


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
    found = {}
    for name, track in score.tracks.items():
        chosen = [_another(piece, others.get(name, ()), rng) for piece in track.pieces]
        if not track.is_whole and is_periodic(track):
            chosen[-1] = chosen[0]
        found[name] = replace(track, pieces=tuple(chosen))
    return Score(found)


def _another(piece: Piece, others: Sequence[Piece], rng: np.random.Generator) -> Piece:
    alike = [other for other in others if other.travel * piece.travel > 0]
    if not alike:
        return piece
    chosen = alike[int(rng.integers(len(alike)))]
    return chosen.lasting(piece.duration).between(piece.start, piece.end)


def _perturbed(
    track: Track,
    times: Floats,
    duration: float,
    rng: np.random.Generator,
    size: float,
    low: float,
    high: float,
) -> Track:
    """The track with its pieces between the given times, a ``duration`` shown of it."""
    level = _levels(track)
    room = np.full(level.max() + 1, np.inf)
    for place, piece in enumerate(track.pieces):
        if level[place] != level[place + 1]:
            for one in level[place : place + 2]:
                room[one] = min(room[one], abs(piece.travel))
    room[~np.isfinite(room)] = 0.0
    shifts = size * _TRAVEL * room * rng.uniform(-1, 1, len(room))
    extremes = np.clip(track.extremes + shifts[level], low, high)
    tilts = size * _SKEW * rng.uniform(-1, 1, len(track.pieces))
    if not track.is_whole and is_periodic(track):
        tilts[-1] = tilts[0]
    pieces = tuple(
        _tilted(piece, tilt).lasting(seconds).between(float(start), float(end))
        for piece, tilt, seconds, start, end in zip(
            track.pieces, tilts.tolist(), np.diff(times).tolist(), extremes[:-1], extremes[1:], strict=True
        )
    )
    lead, trail = max(-float(times[0]), 0.0), max(float(times[-1]) - duration, 0.0)
    return Track(pieces, lead if track.lead else 0.0, trail if track.trail else 0.0)


def _tilted(piece: Piece, tilt: float) -> Piece:
    if not isinstance(piece, Actionlet) or piece.is_silence:
        return piece
    odds = piece.skew / (1 - piece.skew) * np.exp(tilt)
    return replace(piece, skew=float(np.clip(odds / (1 + odds), 1e-3, 1 - 1e-3)))


def _levels(track: Track) -> NDArray[np.int64]:
    """(N + 1,) numbers of the extremes; those that must stay at one angle have the same number: both ends of
    a silence, and what the end of a periodic track shares with its beginning."""
    count = len(track.pieces) + 1
    same = np.arange(count)

    def unite(one: int, other: int) -> None:
        low, high = sorted((int(same[one]), int(same[other])))
        same[same == high] = low

    for place, piece in enumerate(track.pieces):
        if piece.is_silence or abs(piece.travel) <= MEETING:
            unite(place, place + 1)
    if is_periodic(track):
        unite(0, count - 1 if track.is_whole else count - 2)
        if not track.is_whole:
            unite(1, count - 1)
    return np.unique(same, return_inverse=True)[1].astype(np.int64)


def _waves(rng: np.random.Generator, size: float) -> tuple[Floats, Floats]:
    """Sizes and phases of the waves of a change of pace; the sizes add up to less than 1."""
    return size * _WARP / _WAVES * rng.uniform(-1, 1, _WAVES), rng.uniform(0, 2 * np.pi, _WAVES)


def _warped(u: Floats, pace: tuple[Floats, Floats]) -> Floats:
    """Shares of the duration after the change: rising, 0 and 1 where they were, and g(u + 1) = g(u) + 1."""
    sizes, phases = pace
    waves = 2 * np.pi * np.arange(1, _WAVES + 1)
    swing = np.sin(np.multiply.outer(u, waves) + phases) - np.sin(phases)
    return np.asarray(u + swing @ (sizes / waves))


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
