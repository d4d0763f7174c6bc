"""Insertion: a piece of one action is cut out and pasted into another.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 3, Tables 1 and 2.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gmr.actionlets.actionlet import Actionlet, checked_number
from gmr.actionlets.operations.both import Played, on_scores, paired
from gmr.actionlets.score import Score
from gmr.actionlets.track import Piece, Track
from gmr.errors import ActionletError

__all__ = ["insert"]


def insert(target: Played, source: Played, cut: tuple[float, float], at: float) -> Played:
    """What ``source`` does in the interval ``cut``, pasted into ``target`` at the time ``at``.

    The interval [t_begin, t_end] holds the instant t_s2 at which the source's actionlet sa1 gives way to sa2;
    ``at`` lies in the target's actionlet ta1 = [t_t1, t_t2]. Then ta1 becomes two:

    =====  ================================  ================================  ==================
    piece  begins                            ends                              velocity function
    =====  ================================  ================================  ==================
    ta1'   t_t1                              at + (t_s2 - t_begin)             that of ta1
    ta2'   at + (t_s2 - t_begin)             t_t2 + (t_end - t_begin)          that of sa2
    =====  ================================  ================================  ==================

    A velocity function spreads over its new interval and keeps its speeds, so that the travel grows or
    shrinks with the time; angles go on from the beginning of ta1, and what follows in the target keeps its
    travels. Where more instants of rest lie in the cut, the actionlets between them are pasted as they are,
    between ta1' and the last, which has the velocity function of the actionlet in which the cut ends. Where
    none does, as may be in some degrees of freedom of a score, ta1 travels as far in the longer time.

    Args:
        target: a track or a score.
        source: one of the same kind; in a score, degrees of freedom that it does not name rest at 0.
        cut: seconds of the source, in rising order.
        at: seconds of the target; at an instant of rest, ta1 is the actionlet that ends there.

    Returns:
        One that lasts ``cut[1] - cut[0]`` longer than ``target``.

    Raises:
        ActionletError: the cut is empty or reaches out of the source, or ``at`` lies outside the target.
    """
    if isinstance(target, Score) != isinstance(source, Score):
        raise ActionletError("a track and a score do not fit into each other; name the track in a Score")
    begin, end = (checked_number(t, "a time of the cut", "give seconds of the source") for t in cut)
    if not 0 <= begin < end <= source.duration * (1 + 1e-9):
        raise ActionletError(
            f"the cut from {begin:g} to {end:g} s is no part of a source of {source.duration:g} s; choose a"
            " beginning before the end, both within the source"
        )
    time = checked_number(at, "the time of the insertion", "give seconds of the target")
    if not 0 <= time <= target.duration * (1 + 1e-9):
        raise ActionletError(
            f"nothing can be inserted at {time:g} s of a target of {target.duration:g} s; choose a time in it"
        )
    return on_scores(lambda one, other: _inserted(one, other, begin, end, time), target, source)


def _inserted(target: Score, source: Score, begin: float, end: float, at: float) -> Score:
    targets, sources = paired(target, source)
    return Score({name: _pasted(targets[name], sources[name], begin, end, at) for name in targets})


def _pasted(target: Track, source: Track, begin: float, end: float, at: float) -> Track:
    place = int(np.searchsorted(target.times, at, side="left")) - 1
    place = min(max(place, 0), len(target.pieces) - 1)
    t_t1, t_t2 = (float(t) for t in target.times[place : place + 2])
    changed = target.pieces[place]
    turns = np.flatnonzero((source.times > begin) & (source.times < min(end, source.duration)))
    if not len(turns):
        made = [changed.lasting(t_t2 - t_t1 + end - begin)]
    else:
        first, last = float(source.times[turns[0]]), float(source.times[turns[-1]])
        made = [
            _keeping_its_speeds(changed, at + (first - begin) - t_t1),
            *source.pieces[turns[0] : turns[-1]],
            _keeping_its_speeds(source.pieces[turns[-1]], (t_t2 - at) + (end - last)),
        ]
    pieces = (*target.pieces[:place], *made, *target.pieces[place + 1 :])
    return replace(target, pieces=_one_after_the_other(pieces))


def _keeping_its_speeds(piece: Piece, duration: float) -> Piece:
    """The piece in another time, as fast in every share of it: the travel is that much greater or less."""
    factor = duration / piece.duration
    if isinstance(piece, Actionlet):
        return replace(piece, end=piece.start + piece.travel * factor, duration=duration)
    return replace(piece, angles=piece.start + (piece.angles - piece.start) * factor, duration=duration)


def _one_after_the_other(pieces: tuple[Piece, ...]) -> tuple[Piece, ...]:
    """The same travels, each from where the one before ends."""
    found: list[Piece] = [pieces[0]]
    for piece in pieces[1:]:
        found.append(_moved(piece, found[-1].end))
    return tuple(found)


def _moved(piece: Piece, start: float) -> Piece:
    if piece.start == start:
        return piece
    if isinstance(piece, Actionlet):
        return replace(piece, start=start, end=start + piece.travel)
    return replace(piece, angles=piece.angles + (start - piece.start))
