"""Which pieces may take the place of those of a score.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 4: "choose same type of actionlets
but with different velocity functions from the actionlet database".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import SYMMETRIC, Actionlet
from gmr.actionlets.operations.timing import is_periodic
from gmr.actionlets.score import Score
from gmr.actionlets.track import Piece, Track

__all__ = ["Choices"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Choices:
    """For the P pieces of a score, one track after the other, the others that move the same way.

    Args:
        others: all that there are to choose from.
        skews: (Q,) of the others; 0.5 for what was measured.
        first: (P,) number of the first other of the type of each piece; the rest of them follow it.
        counts: (P,) how many there are.
        same_as: (P,) the piece that it is the same as: itself, or the first one where a track that is
            periodic begins in the middle of a piece and ends there.
    """

    others: tuple[Piece, ...]
    skews: Floats
    first: Ints
    counts: Ints
    same_as: Ints

    @classmethod
    def of(cls, score: Score, others: Mapping[str, Sequence[Piece]]) -> Choices:
        """Those of a score.

        Args:
            others: by DOF name, pieces to choose from.
        """
        every: list[Piece] = []
        first: list[int] = []
        counts: list[int] = []
        same_as: list[int] = []
        for name, track in score.tracks.items():
            ways = {
                way: [one for one in others.get(name, ()) if np.sign(one.travel) == way] for way in (-1, 1)
            }
            begins = {-1: len(every), 1: len(every) + len(ways[-1])}
            every += ways[-1] + ways[1]
            same_as += [len(same_as) + place for place in _places(track)]
            for piece in track.pieces:
                way = int(np.sign(piece.travel))
                first.append(begins.get(way, 0))
                counts.append(len(ways.get(way, ())))
        skews = [one.skew if isinstance(one, Actionlet) else SYMMETRIC for one in every]
        return cls(tuple(every), np.array(skews), np.array(first), np.array(counts), np.array(same_as))

    def drawn(self, rng: np.random.Generator) -> Ints:
        """(P,) by chance, the number of the other for each piece; -1 where it has none."""
        found = np.full(len(self.counts), -1)
        there = self.counts > 0
        found[there] = self.first[there] + rng.integers(self.counts[there])
        return found[self.same_as]


def _places(track: Track) -> list[int]:
    places = list(range(len(track.pieces)))
    if not track.is_whole and is_periodic(track):
        places[-1] = 0
    return places
