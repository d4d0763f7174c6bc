"""Time: stretching, repeating, and one group of degrees of freedom that follows another.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", Eq. 7.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gmr.actionlets.actionlet import checked_number
from gmr.actionlets.operations.both import Played, on_scores
from gmr.actionlets.operations.seams import fits
from gmr.actionlets.score import Score
from gmr.actionlets.track import Track
from gmr.errors import ActionletError

__all__ = ["is_periodic", "repeated", "stretched", "synchronise"]


def synchronise(played: Played, scale: float = 1.0, phase: float = 0.0) -> Played:
    """One period of what follows ``played``: ``q(t) = p(scale t + phase)``, p and q periodic.

    The period of p is its duration P; that of q is P / scale. Arms follow legs so, and the knee its hip.

    Args:
        played: p, a track or a score that ends as it begins.
        scale: s_h, above 0: how many times as fast q is.
        phase: seconds of p that q is ahead; any number.

    Returns:
        q from 0 to P / scale; it may begin in the middle of a piece, and then ends in the middle of the same.

    Raises:
        ActionletError: p is not periodic (names the degree of freedom), or scale is not above 0.

    Source: Eq. 7.
    """
    scale = checked_number(scale, "the scale of a synchronisation", "give a number above 0")
    if scale <= 0:
        raise ActionletError(f"the scale of a synchronisation is {scale:g}; give a number above 0")
    ahead = checked_number(phase, "the phase of a synchronisation", "give seconds")
    return stretched(on_scores(lambda score: _turned(score, ahead), played), 1 / scale)


def stretched(played: Played, factor: float) -> Played:
    """The same angles, ``factor`` times as slow.

    Raises:
        ActionletError: the factor is not above 0.
    """
    slower = checked_number(factor, "the factor of a stretch", "give a number above 0")
    if slower <= 0:
        raise ActionletError(f"the factor of a stretch is {slower:g}; give a number above 0")
    if slower == 1:
        return played
    return on_scores(lambda score: score.mapped(lambda track: _slower(track, slower)), played)


def repeated(played: Played, count: int) -> Played:
    """``count`` periods, one after the other.

    Raises:
        ActionletError: it does not end as it begins (names the degree of freedom), or a count below 1.
    """
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
        raise ActionletError(f"an action cannot be repeated {count!r} times; give a whole number from 1 on")
    return on_scores(lambda score: _periodic(score).mapped(lambda track: _periods(track, count)), played)


def is_periodic(track: Track) -> bool:
    """Whether it can begin anew where it ends: at rest at one angle, or within one piece."""
    return fits(track, track)


def _turned(score: Score, ahead: float) -> Score:
    return _periodic(score).mapped(lambda track: _track_turned(track, ahead))


def _track_turned(track: Track, ahead: float) -> Track:
    period = track.duration
    begin = ahead % period
    if min(begin, period - begin) <= 1e-12 * period:
        return track
    return _periods(track, 2).excerpt(begin, begin + period)


def _periodic(score: Score) -> Score:
    for name, track in score.tracks.items():
        if not is_periodic(track):
            ends = " and ".join(f"{np.degrees(angle):.6g}" for angle in (track.start, track.end))
            raise ActionletError(
                f"'{name}' is not periodic: it begins and ends at {ends} degrees"
                f"{'' if track.is_whole else ', in pieces that do not go on in each other'}; lead it back to"
                " its beginning first"
            )
    return score


def _periods(track: Track, count: int) -> Track:
    # Of a piece that goes on over the seam there is one, not two.
    anew = track.pieces if track.is_whole else track.pieces[1:]
    return replace(track, pieces=(*track.pieces, *(anew * (count - 1))))


def _slower(track: Track, factor: float) -> Track:
    pieces = tuple(piece.lasting(piece.duration * factor) for piece in track.pieces)
    return Track(pieces, track.lead * factor, track.trail * factor)
