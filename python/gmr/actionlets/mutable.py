"""A score as arrays: what mutation changes in it, and what chance has no say in.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 4: "perturb the parameters of the
velocity functions".
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import SYMMETRIC, Actionlet
from gmr.actionlets.operations.timing import is_periodic
from gmr.actionlets.score import Score
from gmr.actionlets.track import MEETING, Track

__all__ = ["Mutable", "Mutant", "Pace"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_TEMPO, _WARP, _TRAVEL, _SKEW = 0.3, 0.8, 0.45, 2.0
"""What an amount of 1 changes at most: the logarithm of the duration; the pace from moment to moment, as a
share; an extreme, as a share of the lesser way to its neighbours (below a half, so that no way is turned
round); the logarithm of ``T / (1 - T)``."""

_WAVES = 3
"""Slow waves of which a change of pace is made."""

_LEAST = 1e-3
"""How near skews come to 0 and 1."""


@dataclass(frozen=True, eq=False)
class Pace:
    """Changes of pace, each for a group of degrees of freedom.

    Args:
        sizes, phases: (G, W) of the slow waves of which each is made; the sizes add up to less than 1.
    """

    sizes: Floats
    phases: Floats

    def warped(self, u: Floats, group: Ints | int = 0) -> Floats:
        """(N,) shares of the duration after the change: rising, 0 and 1 where they were, and
        ``g(u + 1) = g(u) + 1``."""
        sizes, phases = self.sizes[group], self.phases[group]
        waves = 2 * np.pi * np.arange(1, _WAVES + 1)
        swing = np.sin(np.multiply.outer(u, waves) + phases) - np.sin(phases)
        return np.asarray(u + (swing * (sizes / waves)).sum(axis=1))


@dataclass(frozen=True, eq=False)
class Mutant:
    """What became of a :class:`Mutable`.

    Args:
        tempo: what the duration is multiplied with.
        pace: how the times were changed.
        times: (N,) of the extremes, shares of the duration.
        extremes: (N,) radians.
        skews: (P,) of the pieces.
    """

    tempo: float
    pace: Pace
    times: Floats
    extremes: Floats
    skews: Floats


@dataclass(frozen=True, eq=False)
class Mutable:
    """The P pieces and N extremes of a score, one track after the other.

    Args:
        dofs: of the tracks.
        first: (D + 1,) number of the first piece of each track; its first extreme has ``k`` more in track k.
        times: (N,) of the extremes, shares of the duration.
        extremes: (N,) radians.
        skews: (P,)
        is_bent: (P,) whether it is an actionlet that moves, and so its skew changes.
        level: (N,) numbers of the extremes; those that must stay at one angle have the same.
        room: (L,) by number, the lesser way to the neighbours.
        low, high: (N,) radians, range of each extreme.
        group: (N,) the number of the group which keeps its times together.
        waves: (G, 2 W) which of the numbers that chance gives make the waves of each group.
        shifts: (L,) which of them move each level.
        tilts: (P,) which of them tilt each piece.
        chances: how many they are.
    """

    dofs: tuple[str, ...]
    first: Ints
    times: Floats
    extremes: Floats
    skews: Floats
    is_bent: NDArray[np.bool_]
    level: Ints
    room: Floats
    low: Floats
    high: Floats
    group: Ints
    waves: Ints
    shifts: Ints
    tilts: Ints
    chances: int

    @classmethod
    def of(
        cls,
        score: Score,
        ranges: Mapping[str, tuple[float, float]],
        groups: Sequence[Collection[str]] | None = None,
    ) -> Mutable:
        """A score as arrays.

        Args:
            ranges: (low, high) by DOF name; a DOF that it does not name is free.
            groups: names of degrees of freedom that keep their common times; each name is in one. None: all.
        """
        named = [list(group) for group in groups] if groups is not None else [list(score.dofs)]
        tracks = [score[dof] for group in named for dof in group]
        counts = np.array([len(track.pieces) for track in tracks])
        levels = [_levels(track) for track in tracks]
        rooms = [_room(track, level) for track, level in zip(tracks, levels, strict=True)]
        pieces = [piece for track in tracks for piece in track.pieces]
        limits = [ranges.get(dof, (-np.inf, np.inf)) for group in named for dof in group]
        waves, shifts, tilts, chances = _chances(map(len, named), [*map(len, rooms)], tracks)
        before = np.cumsum([0, *map(len, rooms[:-1])])
        return cls(
            dofs=tuple(dof for group in named for dof in group),
            first=np.concatenate([[0], np.cumsum(counts)]),
            times=np.concatenate([track.times / track.duration for track in tracks]),
            extremes=np.concatenate([track.extremes for track in tracks]),
            skews=np.array([piece.skew if isinstance(piece, Actionlet) else SYMMETRIC for piece in pieces]),
            is_bent=np.array([isinstance(piece, Actionlet) and not piece.is_silence for piece in pieces]),
            level=np.concatenate([level + number for level, number in zip(levels, before, strict=True)]),
            room=np.concatenate(rooms),
            low=np.repeat([low for low, _ in limits], counts + 1),
            high=np.repeat([high for _, high in limits], counts + 1),
            group=np.repeat(np.repeat(np.arange(len(named)), [len(group) for group in named]), counts + 1),
            waves=waves,
            shifts=shifts,
            tilts=tilts,
            chances=chances,
        )

    def changed(self, rng: np.random.Generator, size: float) -> Mutant:
        """Extremes, times and skews a little different, each within ``size``, 0 to 1.

        Args:
            rng: where chance comes from: ``chances`` numbers.
        """
        chance = rng.random(self.chances)
        way = 2 * chance - 1
        waves = way[self.waves[:, :_WAVES]], chance[self.waves[:, _WAVES:]]
        pace = Pace(size * _WARP / _WAVES * waves[0], 2 * np.pi * waves[1])
        shifts = size * _TRAVEL * self.room * way[self.shifts]
        odds = self.skews / (1 - self.skews) * np.exp(size * _SKEW * way[self.tilts])
        skews = np.clip(odds / (1 + odds), _LEAST, 1 - _LEAST)
        return Mutant(
            tempo=float(np.exp(size * _TEMPO * way[0])),
            pace=pace,
            times=pace.warped(self.times, self.group),
            extremes=np.clip(self.extremes + shifts[self.level], self.low, self.high),
            skews=np.where(self.is_bent, skews, self.skews),
        )


def _chances(
    sizes: Iterable[int], levels: Sequence[int], tracks: Sequence[Track]
) -> tuple[Ints, Ints, Ints, int]:
    """Which of the numbers that chance gives does what: the first is for the duration, then come for each
    group its waves, and for each of its tracks its levels and its pieces."""
    count = 1
    waves, shifts, tilts = [], [], []
    rest = iter(zip(levels, tracks, strict=True))
    for size in sizes:
        waves.append(count + np.arange(2 * _WAVES))
        count += 2 * _WAVES
        for _, (level, track) in zip(range(size), rest, strict=False):
            shifts.append(count + np.arange(level))
            count += level
            own = count + np.arange(len(track.pieces))
            count += len(own)
            if not track.is_whole and is_periodic(track):
                own[-1] = own[0]
            tilts.append(own)
    return np.stack(waves), np.concatenate(shifts), np.concatenate(tilts), count


def _room(track: Track, level: Ints) -> Floats:
    """(L,) the lesser way from each level to its neighbours; 0 for one without."""
    ways = np.abs([piece.travel for piece in track.pieces])
    moves = level[1:] != level[:-1]
    room = np.full(level.max() + 1, np.inf)
    np.minimum.at(room, level[:-1][moves], ways[moves])
    np.minimum.at(room, level[1:][moves], ways[moves])
    room[~np.isfinite(room)] = 0.0
    return room


def _levels(track: Track) -> Ints:
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
    return np.unique(same, return_inverse=True)[1].astype(np.intp)
