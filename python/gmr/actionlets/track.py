"""A track: the actionlets of one degree of freedom, one after the other.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", Eq. 3: ``y_i = concat(f_i0, f_i1, ...)``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.actionlet import SYMMETRIC, Actionlet, checked_number
from gmr.actionlets.flat import Flat
from gmr.actionlets.measured import Measured
from gmr.arrays import read_only
from gmr.errors import ActionletError

__all__ = ["MEETING", "Extreme", "Piece", "Track"]

Floats = NDArray[np.float64]

Piece: TypeAlias = Actionlet | Measured
"""What a track is made of."""

Extreme: TypeAlias = tuple[float, float] | tuple[float, float, float]
"""(seconds, radians) or (seconds, radians, skew of the piece that ends there)."""

MEETING = 1e-9
"""Radians by which the end of a piece and the start of the next may differ: rounding, no jump."""


@dataclass(frozen=True)
class Track:
    """The course of one degree of freedom: pieces that follow each other, each at rest at both ends.

    It may begin and end in the middle of a piece, as a part of a movement that goes on does: then ``lead``
    and ``trail`` tell what is not shown of the first and of the last piece.

    Args:
        pieces: one or more; each starts at the angle where the one before ends.
        lead: seconds of the first piece that are over when the track begins, less than it lasts.
        trail: seconds of the last piece that are still to come when the track ends, less than it lasts.

    Raises:
        ActionletError: no pieces, a jump between two of them, or nothing left between lead and trail.
    """

    pieces: tuple[Piece, ...]
    lead: float = 0.0
    trail: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "pieces", tuple(self.pieces))
        for name in ("lead", "trail"):
            value = checked_number(getattr(self, name), f"a track's {name}", "give seconds")
            object.__setattr__(self, name, value)
        _check_pieces(self.pieces)
        _check_window(self)

    @classmethod
    def through(cls, extremes: Iterable[Sequence[float]], window: tuple[float, float] | None = None) -> Track:
        """The track through extremes: an actionlet between each two, a silence where they are equal.

        Args:
            extremes: (seconds, radians) or (seconds, radians, skew) each, two or more in rising order of
                their times; the skew is that of the actionlet that ends there, 0.5 where it is not given.
                An (N, 3) array will do.
            window: the seconds at which the track begins and ends; where the first extreme comes later it
                is waited for, and the last one is held. None: from the first to the last.

        Raises:
            ActionletError: fewer than two, times that do not rise, or a number that cannot be.
        """
        knots = [_extreme(place, extreme) for place, extreme in enumerate(extremes)]
        if len(knots) < 2:
            raise ActionletError(f"a track goes through two extremes or more; {len(knots)} given")
        pieces: list[Piece] = []
        for place, ((t0, a0, _), (t1, a1, skew)) in enumerate(pairwise(knots)):
            if not t1 > t0:
                raise ActionletError(
                    f"extreme {place + 1} of a track is at {t1:g} s, the one before at {t0:g} s;"
                    " their times must rise"
                )
            pieces.append(Actionlet(a0, a1, t1 - t0, skew))
        begin, end = window or (knots[0][0], knots[-1][0])
        if begin < (first := knots[0])[0]:
            pieces.insert(0, Actionlet.silence(first[1], first[0] - begin))
        if end > (last := knots[-1])[0]:
            pieces.append(Actionlet.silence(last[1], end - last[0]))
        origin = min(begin, knots[0][0])
        return cls(tuple(pieces)).excerpt(begin - origin, end - origin)

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(N + 1,) seconds where pieces begin and end, counted from the beginning of the first piece."""
        return read_only(np.concatenate([[0.0], np.cumsum([piece.duration for piece in self.pieces])]))

    @property
    def times(self) -> NDArray[np.float64]:
        """(N + 1,) seconds where pieces begin and end; the first is ``-lead``, the last lies ``trail`` after
        the end."""
        return self.bounds - self.lead

    @cached_property
    def extremes(self) -> NDArray[np.float64]:
        """(N + 1,) radians where pieces begin and end."""
        return read_only(np.array([self.pieces[0].start, *(piece.end for piece in self.pieces)]))

    @property
    def duration(self) -> float:
        """Seconds that it lasts."""
        return float(self.bounds[-1]) - self.lead - self.trail

    @property
    def start(self) -> float:
        """Radians where it begins."""
        return float(self.angle(0.0)) if self.lead else self.pieces[0].start

    @property
    def end(self) -> float:
        """Radians where it ends."""
        return float(self.angle(self.duration)) if self.trail else self.pieces[-1].end

    @property
    def is_whole(self) -> bool:
        """Whether it shows all of its pieces, so that it is at rest at both ends."""
        return not (self.lead or self.trail)

    def angle(self, t: ArrayLike) -> NDArray[np.float64]:
        """Angle after ``t`` seconds.

        Args:
            t: seconds since the track began, any shape; clamped to [0, duration].

        Returns:
            Radians, the shape of ``t``.
        """
        return self._at(t, 0)

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """Radians a second after ``t`` seconds, clamped to [0, duration]; the shape of ``t``."""
        return self._at(t, 1)

    def acceleration(self, t: ArrayLike) -> NDArray[np.float64]:
        """Radians a second squared after ``t`` seconds, clamped to [0, duration]; the shape of ``t``."""
        return self._at(t, 2)

    def excerpt(self, begin: float, end: float) -> Track:
        """What it does from ``begin`` to ``end`` seconds; pieces wholly outside are left out.

        Raises:
            ActionletError: the interval is empty or reaches out of the track.
        """
        duration, slack = self.duration, 1e-9 * max(1.0, self.duration)
        if not -slack <= begin < end <= duration + slack:
            raise ActionletError(
                f"an excerpt from {begin:g} to {end:g} s of a track of {duration:g} s; choose a beginning"
                " before the end, both within the track"
            )
        begin, end = max(begin, 0.0) + self.lead, min(end, duration) + self.lead
        bounds = self.bounds
        # A rounding error's worth of a piece is none of it.
        first = min(int(np.searchsorted(bounds, begin + slack, side="right")) - 1, len(self.pieces) - 1)
        last = max(int(np.searchsorted(bounds, end - slack, side="left")), first + 1)
        lead, trail = float(begin - bounds[first]), float(bounds[last] - end)
        return _shown(self.pieces[first:last], max(lead, 0.0), max(trail, 0.0), slack)

    @cached_property
    def _flat(self) -> Flat:
        return Flat.of([self])

    def _at(self, t: ArrayLike, order: int) -> Floats:
        seconds = np.asarray(t, np.float64)
        return self._flat.at(seconds.ravel(), order).reshape(seconds.shape)


def _shown(pieces: tuple[Piece, ...], lead: float, trail: float, slack: float) -> Track:
    """The track of these pieces; of a silence at its ends there is no part that it does not show."""
    kept = list(pieces)
    if len(kept) == 1 and _is_still(kept[0]):
        return Track((kept[0].lasting(kept[0].duration - lead - trail),))
    if lead and _is_still(kept[0]):
        kept[0], lead = kept[0].lasting(kept[0].duration - lead), 0.0
    if trail and _is_still(kept[-1]):
        kept[-1], trail = kept[-1].lasting(kept[-1].duration - trail), 0.0
    return Track(tuple(kept), lead if lead > slack else 0.0, trail if trail > slack else 0.0)


def _is_still(piece: Piece) -> bool:
    return isinstance(piece, Actionlet) and piece.is_silence


def _extreme(place: int, extreme: Sequence[float]) -> tuple[float, float, float]:
    if not 2 <= len(extreme) <= 3:
        raise ActionletError(
            f"extreme {place} of a track has {len(extreme)} numbers; give seconds, radians and, if you like,"
            " the skew"
        )
    time = checked_number(extreme[0], f"the time of extreme {place} of a track", "give seconds")
    angle = checked_number(extreme[1], f"the angle of extreme {place} of a track", "give radians")
    return time, angle, float(extreme[2]) if len(extreme) == 3 else SYMMETRIC


def _check_pieces(pieces: tuple[Piece, ...]) -> None:
    if not pieces:
        raise ActionletError("a track without pieces; give one actionlet or more, a silence for rest")
    time = 0.0
    for place, (one, other) in enumerate(pairwise(pieces)):
        time += one.duration
        if not abs(other.start - one.end) <= MEETING * max(1.0, abs(one.end)):
            raise ActionletError(
                f"piece {place} of a track ends at {np.degrees(one.end):.6g} degrees, piece {place + 1}"
                f" starts at {np.degrees(other.start):.6g} ({time:g} s after its beginning); each piece"
                " starts where the one before ends: concatenate() joins tracks that do not meet"
            )


def _check_window(track: Track) -> None:
    first, last = track.pieces[0].duration, track.pieces[-1].duration
    for name, value, whole in (("lead", track.lead, first), ("trail", track.trail, last)):
        if not 0 <= value < whole:
            raise ActionletError(
                f"a track's {name} is {value:g} s, and its piece there lasts {whole:g} s;"
                f" give 0 or more, and less than that"
            )
    if not track.duration > 0:
        raise ActionletError(
            f"a track with a lead of {track.lead:g} s and a trail of {track.trail:g} s in one piece of"
            f" {first:g} s shows nothing; give less of them"
        )
