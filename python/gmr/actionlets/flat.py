"""Pieces of tracks as arrays, so that sampling does nothing piece by piece.

An actionlet is sampled by halves, the one in which it speeds up and the one in which it slows down. Counted
from where the body rests, with ``g`` the share of the half's time and ``span`` the angle that it goes, both
are::

    angle        = rest + span (g - sin(pi g) / pi)
    velocity     = span (1 - cos(pi g)) / lasts
    acceleration = pi span sin(pi g) / lasts^2

which is the integral of the bell of :mod:`gmr.actionlets.bell`; ``lasts`` is below 0 in the second half,
whose time is counted backwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import SYMMETRIC, Actionlet
from gmr.actionlets.measured import Measured, cubic

if TYPE_CHECKING:
    from gmr.actionlets.track import Track

__all__ = ["Flat"]

Floats = NDArray[np.float64]
Places = NDArray[np.intp]

_BLOCK = 1 << 13
"""Angles that are sampled at once, or one track: the steps between stay in the cache."""


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """The halves of the pieces of D tracks, one track after the other.

    Args:
        seconds: (D,) how long each track lasts.
        first: (D + 1,) number of the first half of each track; H at the end.
        begins: (H,) seconds when each begins, counted from the beginning of its track, rising in a track.
        origins: (H,) seconds at which the actionlet rests at the end of this half.
        lasts: (H,) seconds, below 0 where it comes to rest.
        rests: (H,) radians there.
        spans: (H,) radians from there to the other end of the half.
        curves: the tracks in which something was measured.
    """

    seconds: Floats
    first: Places
    begins: Floats
    origins: Floats
    lasts: Floats
    rests: Floats
    spans: Floats
    curves: tuple[_Curve, ...] = ()

    @classmethod
    def of(cls, tracks: Sequence[Track]) -> Flat:
        """The pieces of tracks."""
        pieces = [piece for track in tracks for piece in track.pieces]
        skews = [piece.skew if isinstance(piece, Actionlet) else SYMMETRIC for piece in pieces]
        return cls(
            np.array([track.duration for track in tracks]),
            2 * np.cumsum([0, *(len(track.pieces) for track in tracks)]),
            *_halves(
                np.concatenate([track.times[:-1] for track in tracks]),
                np.array([piece.duration for piece in pieces]),
                np.array([piece.start for piece in pieces]),
                np.array([piece.end for piece in pieces]),
                np.array(skews),
            ),
            tuple(
                _Curve.of(column, track)
                for column, track in enumerate(tracks)
                if any(isinstance(piece, Measured) for piece in track.pieces)
            ),
        )

    @classmethod
    def through(cls, rows: Floats, first: Places, seconds: float) -> Flat:
        """Actionlets between extremes.

        Args:
            rows: (N, 3) seconds, radians and skew of the actionlet that ends there; track after track.
            first: (D + 1,) number of the first extreme of each track, two at least in each; N at the end.
            seconds: how long they last, from 0.
        """
        ends = np.delete(np.arange(len(rows)), first[:-1])
        (begins, starts, _), (finishes, angles, skews) = rows[ends - 1].T, rows[ends].T
        return cls(
            np.full(len(first) - 1, seconds),
            2 * (first - np.arange(len(first))),
            *_halves(begins, finishes - begins, starts, angles, skews),
        )

    def at(self, t: Floats, order: int) -> Floats:
        """(F, D) angles, velocities or accelerations after seconds; where a track has no piece it rests.

        Args:
            t: (F,) seconds; clamped to what each track lasts.
            order: 0, 1 or 2.
        """
        found = np.empty((len(self.seconds), len(t)))
        if (t[1:] >= t[:-1]).all():
            self._sample(t, order, found)
        else:
            ordered = np.argsort(t)
            self._sample(t[ordered], order, found)
            found[:, ordered] = found.copy()
        return found.T

    def _sample(self, t: Floats, order: int, found: Floats) -> None:
        """Writes (D, F) angles at rising times."""
        tracks = max(_BLOCK // max(len(t), 1), 1)
        for k in range(0, len(found), tracks):
            self._some(slice(k, k + tracks), t, order, found[k : k + tracks])
        for curve in self.curves:
            row = slice(curve.column, curve.column + 1)
            inside = curve.measured[np.repeat(*self._when(row, t)) - self.first[curve.column]]
            seconds = np.clip(t[inside], 0.0, self.seconds[curve.column])
            found[curve.column, inside] = curve.at(seconds, order)

    def _some(self, rows: slice, t: Floats, order: int, found: Floats) -> None:
        which, counts = self._when(rows, t)

        def spread(values: Floats) -> Floats:
            return np.repeat(values[which], counts).reshape(found.shape)

        seconds = np.minimum(np.maximum(t, 0.0), self.seconds[rows, None])
        lasts, spans = spread(self.lasts), spread(self.spans)
        g = np.minimum(np.maximum((seconds - spread(self.origins)) / lasts, 0.0), 1.0)
        match order:
            case 0:
                way = np.maximum(g - np.sin(np.pi * g) / np.pi, 0.0)
                np.add(spread(self.rests), spans * way, out=found)
            case 1:
                np.divide(spans * (1 - np.cos(np.pi * g)), lasts, out=found)
            case _:
                np.divide(np.pi * spans * np.sin(np.pi * g), lasts * lasts, out=found)

    def _when(self, rows: slice, t: Floats) -> tuple[Places, Places]:
        """The halves of some tracks, and in how many of the frames at rising times each of them is."""
        tracks = self.first[rows.start : rows.stop + 1]
        which = np.arange(tracks[0], tracks[-1])
        counts = np.diff(tracks)
        begin = np.searchsorted(np.maximum(t, 0.0), self.begins[which])
        begin[self.begins[which] > np.repeat(self.seconds[rows], counts)] = len(t)
        begin[tracks[:-1] - tracks[0]] = 0  # What comes before the first piece of a track is part of it.
        end = np.append(begin[1:], len(t))
        end[tracks[1:] - tracks[0] - 1] = len(t)
        return which, end - begin


def _halves(
    begins: Floats, durations: Floats, starts: Floats, ends: Floats, skews: Floats
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """(2 P,) when the halves of P actionlets begin, and what :class:`Flat` says of them."""
    up, down = skews * durations, (1 - skews) * durations
    both = (
        (begins, begins + up),
        (begins, begins + durations),
        (up, -down),
        (starts, ends),
        ((ends - starts) * skews, (starts - ends) * (1 - skews)),
    )
    begin, origin, lasts, rest, span = (np.stack(pair, axis=1).ravel() for pair in both)
    return begin, origin, lasts, rest, span


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """What was measured of a track."""

    column: int
    measured: NDArray[np.bool_]
    """(2 n,) whether each half of its pieces is of a measured one."""
    knots: Floats
    """Of all measured pieces together; nobody asks for what lies between two that do not touch."""
    values: Floats
    slopes: Floats

    @classmethod
    def of(cls, column: int, track: Track) -> _Curve:
        curves = [
            (piece.knots + begin, piece.angles, piece.slopes())
            for begin, piece in zip(track.times[:-1].tolist(), track.pieces, strict=True)
            if isinstance(piece, Measured)
        ]
        measured = np.repeat([isinstance(piece, Measured) for piece in track.pieces], 2)
        return cls(column, measured, *map(np.concatenate, zip(*curves, strict=True)))

    def at(self, t: Floats, order: int) -> Floats:
        return cubic(self.knots, self.values, self.slopes, t, order)
