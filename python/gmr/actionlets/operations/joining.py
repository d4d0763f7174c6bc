"""Concatenation: one track or score after another, angles and velocities without a jump.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 3: where two actionlets or actions
do not meet, "either the two actionlets or actions will be blended or a transition actionlet or action is
inserted between them".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from gmr.actionlets.actionlet import SYMMETRIC, Actionlet, checked_duration
from gmr.actionlets.bell import share
from gmr.actionlets.operations.both import Played, on_scores, paired
from gmr.actionlets.operations.seams import fits, joined
from gmr.actionlets.score import Score
from gmr.actionlets.track import MEETING, Track
from gmr.errors import ActionletError

__all__ = ["Join", "concatenate"]

Join: TypeAlias = Literal["insert", "blend"]

TRANSITION = 0.3
"""Seconds of a transition where none are asked for: about a quick human reach."""


def concatenate(first: Played, second: Played, join: Join = "insert", seconds: float = TRANSITION) -> Played:
    """``second`` after ``first``.

    Where every degree of freedom meets, in angle and at rest or in the middle of one piece that goes on,
    ``second`` simply follows. Otherwise pieces that were cut at the seam are done whole (the others wait),
    and then

    - ``"insert"``: a symmetric actionlet of ``seconds`` leads from one to the other, a silence where a
      degree of freedom is there already;
    - ``"blend"``: both are bent towards the middle between their angles at the seam, the extremes within
      ``seconds`` of it less the farther they are; nothing is inserted.

    Args:
        first: a track or a score.
        second: one of the same kind; in a score, degrees of freedom that it does not name rest at 0.
        join: what is done where they do not meet.
        seconds: of the transition, or how far a blend reaches into both.

    Returns:
        One as long as both together, plus ``seconds`` where a transition was inserted, plus what was not
        shown of pieces cut at the seam where these had to be done whole.

    Raises:
        ActionletError: an unknown way to join, or seconds that are not above 0.
    """
    if join not in ("insert", "blend"):
        raise ActionletError(f"'{join}' is no way to join; use 'insert' or 'blend'")
    if isinstance(first, Score) != isinstance(second, Score):
        raise ActionletError("a track and a score cannot be concatenated; name the track in a Score")
    span = checked_duration(seconds, "a transition")
    return on_scores(lambda one, other: _concatenated(one, other, join, span), first, second)


def _concatenated(first: Score, second: Score, join: Join, seconds: float) -> Score:
    before, after = paired(first, second)
    if all(fits(before[name], after[name]) for name in before):
        return Score({name: joined(before[name], after[name]) for name in before})
    before, after = _finished(before), _begun(after)
    if all(fits(before[name], after[name]) for name in before):
        return Score({name: joined(before[name], after[name]) for name in before})
    lead_over = _led if join == "insert" else _bent_together
    return Score({name: lead_over(before[name], after[name], seconds) for name in before})


def _finished(tracks: dict[str, Track]) -> dict[str, Track]:
    """Their last pieces done to the end; who is there first waits."""
    wait = max(track.trail for track in tracks.values())
    found = {}
    for name, track in tracks.items():
        pieces = track.pieces
        if wait - track.trail > MEETING:
            pieces = (*pieces, Actionlet.silence(pieces[-1].end, wait - track.trail))
        found[name] = replace(track, pieces=pieces, trail=0.0)
    return found


def _begun(tracks: dict[str, Track]) -> dict[str, Track]:
    """Their first pieces done from the beginning; who needs less time for that waits."""
    wait = max(track.lead for track in tracks.values())
    found = {}
    for name, track in tracks.items():
        pieces = track.pieces
        if wait - track.lead > MEETING:
            pieces = (Actionlet.silence(pieces[0].start, wait - track.lead), *pieces)
        found[name] = replace(track, pieces=pieces, lead=0.0)
    return found


def _led(before: Track, after: Track, seconds: float) -> Track:
    between = Actionlet(before.end, after.start, seconds)
    return Track((*before.pieces, between, *after.pieces), before.lead, after.trail)


def _bent_together(before: Track, after: Track, seconds: float) -> Track:
    middle = (before.end + after.start) / 2
    one = _bent(before, (before.duration - before.times) / seconds, middle - before.end)
    other = _bent(after, after.times / seconds, middle - after.start)
    return Track((*one.pieces, *other.pieces), before.lead, after.trail)


def _bent(track: Track, distances: np.ndarray[tuple[int], np.dtype[np.float64]], shift: float) -> Track:
    """The track with its extremes shifted, by less the farther off they are: all at 0, nothing from 1 on."""
    extremes = track.extremes + shift * share(np.clip(1 - distances, 0, 1), SYMMETRIC)
    pieces = tuple(
        piece.between(float(start), float(end))
        for piece, start, end in zip(track.pieces, extremes[:-1], extremes[1:], strict=True)
    )
    return replace(track, pieces=pieces)
