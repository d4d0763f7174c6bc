"""Pieces of tracks as arrays, so that sampling does nothing piece by piece."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import SYMMETRIC, Actionlet, on_the_way
from gmr.actionlets.bell import bell, bell_slope, share
from gmr.actionlets.measured import Measured, cubic

if TYPE_CHECKING:
    from gmr.actionlets.track import Track

__all__ = ["Flat"]

Floats = NDArray[np.float64]

_BLOCK = 4096
"""Frames that are sampled at once: memory for the steps between is needed for no more than them."""


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """The P pieces of D tracks, one track after the other.

    Args:
        seconds: (D,) how long each track lasts.
        first: (D + 1,) number of the first piece of each track; P at the end.
        begins: (P,) seconds when each begins, counted from the beginning of its track, rising in a track.
        durations: (P,) seconds.
        starts, ends: (P,) radians.
        skews: (P,); 0.5 for what was measured.
        curves: the tracks in which something was measured: by number, which of its pieces, and the samples.
    """

    seconds: Floats
    first: NDArray[np.intp]
    begins: Floats
    durations: Floats
    starts: Floats
    ends: Floats
    skews: Floats
    curves: tuple[_Curve, ...] = ()

    @classmethod
    def of(cls, tracks: Sequence[Track]) -> Flat:
        """The pieces of tracks."""
        pieces = [piece for track in tracks for piece in track.pieces]
        return cls(
            np.array([track.duration for track in tracks]),
            np.cumsum([0, *(len(track.pieces) for track in tracks)]),
            np.concatenate([track.times[:-1] for track in tracks]),
            np.array([piece.duration for piece in pieces]),
            np.array([piece.start for piece in pieces]),
            np.array([piece.end for piece in pieces]),
            np.array([piece.skew if isinstance(piece, Actionlet) else SYMMETRIC for piece in pieces]),
            tuple(
                _Curve.of(column, track)
                for column, track in enumerate(tracks)
                if any(isinstance(piece, Measured) for piece in track.pieces)
            ),
        )

    @classmethod
    def through(cls, rows: Floats, first: NDArray[np.intp], seconds: float) -> Flat:
        """Actionlets between extremes.

        Args:
            rows: (N, 3) seconds, radians and skew of the actionlet that ends there; track after track.
            first: (D + 1,) number of the first extreme of each track, two at least in each; N at the end.
            seconds: how long they last, from 0.
        """
        ends = np.delete(np.arange(len(rows)), first[:-1])
        before, after = rows[ends - 1], rows[ends]
        return cls(
            np.full(len(first) - 1, seconds),
            first - np.arange(len(first)),
            before[:, 0],
            after[:, 0] - before[:, 0],
            before[:, 1],
            after[:, 1],
            after[:, 2],
        )

    def at(self, t: Floats, order: int) -> Floats:
        """(F, D) angles, velocities or accelerations after seconds; where a track has no piece it rests.

        Args:
            t: (F,) seconds; clamped to what each track lasts.
            order: 0, 1 or 2.
        """
        parts = np.array_split(t, max(-(-len(t) // _BLOCK), 1))
        return np.concatenate([self._at(part, order) for part in parts])

    def _at(self, t: Floats, order: int) -> Floats:
        seconds = np.clip(t, 0.0, self.seconds[:, None])
        spans = zip(self.first[:-1].tolist(), self.first[1:].tolist(), seconds, strict=True)
        # Where the first piece of a track begins is not asked: what comes before it is part of it.
        i = np.stack([np.searchsorted(self.begins[a + 1 : b], row, side="right") + a for a, b, row in spans])
        duration, skew = self.durations[i], self.skews[i]
        u = np.clip((seconds - self.begins[i]) / duration, 0.0, 1.0)
        start, end = self.starts[i], self.ends[i]
        match order:
            case 0:
                found = on_the_way(start, end, share(u, skew))
            case 1:
                found = 2 * (end - start) / duration * bell(u, skew)
            case _:
                found = 2 * (end - start) / duration**2 * bell_slope(u, skew)
        for curve in self.curves:
            row = curve.column
            inside = curve.measured[i[row] - self.first[row]]
            found[row, inside] = curve.at(seconds[row, inside], order)
        return found.T


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """What was measured of a track."""

    column: int
    measured: NDArray[np.bool_]
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
        measured = np.array([isinstance(piece, Measured) for piece in track.pieces])
        return cls(column, measured, *map(np.concatenate, zip(*curves, strict=True)))

    def at(self, t: Floats, order: int) -> Floats:
        return cubic(self.knots, self.values, self.slopes, t, order)
