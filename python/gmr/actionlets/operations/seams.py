"""Where one track ends and another begins: whether they fit, and as one track."""

from __future__ import annotations

import math

import numpy as np

from gmr.actionlets.actionlet import Actionlet
from gmr.actionlets.measured import Measured
from gmr.actionlets.track import MEETING, Piece, Track

__all__ = ["fits", "joined", "same_piece"]

_ALIKE = 1e-6
"""Radians, seconds and skews by which two pieces may differ and be the same: rounding."""


def fits(before: Track, after: Track) -> bool:
    """Whether ``after`` goes on where ``before`` ends: both at rest at one angle, or within one piece."""
    if not before.trail and not after.lead:
        return abs(after.start - before.end) <= MEETING * max(1.0, abs(before.end))
    piece = before.pieces[-1]
    shown = piece.duration - before.trail
    goes_on = before.trail > 0 and after.lead > 0 and math.isclose(shown, after.lead, abs_tol=_ALIKE)
    return goes_on and same_piece(piece, after.pieces[0])


def joined(before: Track, after: Track) -> Track:
    """Both as one track; they fit."""
    kept = before.pieces[:-1] if before.trail else before.pieces
    return Track((*kept, *after.pieces), before.lead, after.trail)


def same_piece(one: Piece, other: Piece) -> bool:
    """Whether two pieces are the same but for rounding."""
    if not math.isclose(one.duration, other.duration, abs_tol=_ALIKE):
        return False
    match one, other:
        case Actionlet(), Actionlet():
            pairs = ((one.start, other.start), (one.end, other.end), (one.skew, other.skew))
            return all(math.isclose(a, b, abs_tol=_ALIKE) for a, b in pairs)
        case Measured(), Measured():
            same_length = len(one.angles) == len(other.angles)
            return same_length and bool(np.allclose(one.angles, other.angles, rtol=0, atol=_ALIKE))
        case _:
            return False
