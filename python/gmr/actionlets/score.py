"""A score: the tracks of all degrees of freedom that move, played together.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", Eqs. 2 and 3:
``Y(t) = (y_0(t), ..., y_21(t))``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.actionlet import checked_number
from gmr.actionlets.flat import Flat
from gmr.actionlets.track import Track
from gmr.errors import ActionletError

__all__ = ["SAME_DURATION", "Score"]

SAME_DURATION = 1e-6
"""Seconds by which the durations of tracks of one score may differ: rounding."""


@dataclass(frozen=True)
class Score:
    """Tracks by the names of their degrees of freedom, all of one duration; those not named rest at 0.

    Args:
        tracks: name -> track, one or more, kept in this order.

    Raises:
        ActionletError: no tracks, or tracks of different durations.
    """

    tracks: Mapping[str, Track] = field(hash=False)

    def __post_init__(self) -> None:
        tracks = dict(self.tracks)
        if not tracks:
            raise ActionletError("a score without tracks lasts no time; give one track or more, by DOF name")
        first, duration = next((name, track.duration) for name, track in tracks.items())
        for name, track in tracks.items():
            if not abs(track.duration - duration) <= SAME_DURATION * max(1.0, duration):
                raise ActionletError(
                    f"the track of '{name}' lasts {track.duration:g} s, that of '{first}' {duration:g} s; all"
                    " tracks of a score last as long: add a silence or stretch one of them"
                )
        object.__setattr__(self, "tracks", MappingProxyType(tracks))

    @classmethod
    def through(cls, extremes: Mapping[str, NDArray[np.float64]], seconds: float) -> Score:
        """The score whose tracks go through extremes, from 0 to ``seconds``; each track is made when it is
        first asked for.

        Args:
            extremes: name -> (N, 3) as in :meth:`Track.through`.

        Raises:
            ActionletError: as :meth:`Track.through`.
        """
        tracks = _Through(dict(extremes), seconds)
        rows = np.concatenate([*tracks.extremes.values()]) if extremes else np.zeros((0, 3))
        first = np.cumsum([0, *map(len, tracks.extremes.values())])
        if not extremes or not _can_be(rows, first, seconds):
            return cls({dof: tracks[dof] for dof in tracks})
        made = cls.__new__(cls)
        object.__setattr__(made, "tracks", tracks)
        made.__dict__.update(duration=seconds, _flat=Flat.through(rows, first, seconds))
        return made

    @property
    def dofs(self) -> tuple[str, ...]:
        """Names of its degrees of freedom, in the order in which they were given."""
        return tuple(self.tracks)

    @cached_property
    def duration(self) -> float:
        """Seconds that it lasts."""
        return next(iter(self.tracks.values())).duration

    @property
    def piece_count(self) -> int:
        """Pieces of all its tracks together."""
        return sum(len(track.pieces) for track in self.tracks.values())

    def __getitem__(self, dof: str) -> Track:
        """The track of a degree of freedom.

        Raises:
            ActionletError: it has none; the message names those that are there.
        """
        if dof not in self.tracks:
            raise ActionletError(f"this score has no track '{dof}'; it has {', '.join(self.tracks)}")
        return self.tracks[dof]

    def times(self, fps: float) -> NDArray[np.float64]:
        """(F,) seconds of its frames at ``fps``: 0, 1/fps, ... up to its end.

        Raises:
            ActionletError: ``fps`` is no rate above 0.
        """
        rate = checked_number(fps, "the rate of a score", "give frames a second")
        if rate <= 0:
            raise ActionletError(f"{rate:g} frames a second cannot be; give a rate above 0")
        return np.arange(int(self.duration * rate + 1e-6) + 1) / rate

    def sample(self, fps: float, dofs: Iterable[str] | None = None) -> NDArray[np.float64]:
        """(F, D) radians at :meth:`times`; columns as in :meth:`angles`."""
        return self.angles(self.times(fps), dofs)

    def angles(self, times: ArrayLike, dofs: Iterable[str] | None = None) -> NDArray[np.float64]:
        """Angles at times.

        Args:
            times: (F,) seconds since the score began; clamped to [0, duration].
            dofs: names, one column each; 0 for those without a track. None: all tracks, in their order.

        Returns:
            (F, D) radians.
        """
        return self._columns(times, dofs, 0)

    def velocities(self, times: ArrayLike, dofs: Iterable[str] | None = None) -> NDArray[np.float64]:
        """(F, D) radians a second; otherwise as :meth:`angles`."""
        return self._columns(times, dofs, 1)

    def mapped(self, change: Callable[[Track], Track]) -> Score:
        """The score with ``change`` made to every track."""
        return Score({name: change(track) for name, track in self.tracks.items()})

    def excerpt(self, begin: float, end: float) -> Score:
        """What it does from ``begin`` to ``end`` seconds.

        Raises:
            ActionletError: the interval is empty or reaches out of the score.
        """
        return self.mapped(lambda track: track.excerpt(begin, min(end, track.duration)))

    def only(self, dofs: Iterable[str]) -> Score:
        """The tracks of these degrees of freedom alone.

        Raises:
            ActionletError: it has no track of one of them, or none is named.
        """
        return Score({dof: self[dof] for dof in dofs})

    def renamed(self, names: Mapping[str, str]) -> Score:
        """The same tracks under other names; those that ``names`` does not have keep theirs.

        Raises:
            ActionletError: it has no track of that name, or two would have the same.
        """
        for name in names:
            self[name]
        found = [names.get(dof, dof) for dof in self.dofs]
        doubled = [name for name in found if found.count(name) > 1]
        if doubled:
            raise ActionletError(f"two tracks would be named '{doubled[0]}'; give each a name of its own")
        return Score(dict(zip(found, self.tracks.values(), strict=True)))

    def beside(self, other: Score) -> Score:
        """Both scores at once: the tracks of both, which last as long and name different degrees of freedom.

        Raises:
            ActionletError: they share a degree of freedom, or do not last as long.
        """
        shared = [dof for dof in self.tracks if dof in other.tracks]
        if shared:
            raise ActionletError(
                f"both scores move '{shared[0]}'; take it out of one of them with only(), or concatenate them"
            )
        return Score({**self.tracks, **other.tracks})

    @cached_property
    def _flat(self) -> Flat:
        return Flat.of([*self.tracks.values()])

    def _columns(self, times: ArrayLike, dofs: Iterable[str] | None, order: int) -> NDArray[np.float64]:
        seconds = np.asarray(times, np.float64)
        if seconds.ndim != 1:
            raise ActionletError(
                f"a score is sampled at a row of times; these have the shape {seconds.shape}"
            )
        sampled = self._flat.at(seconds, order)
        if dofs is None:
            return sampled
        columns = {name: column for column, name in enumerate(self.dofs)}
        names = tuple(dofs)
        found = np.zeros((len(seconds), len(names)))
        for column, name in enumerate(names):
            if name in columns:
                found[:, column] = sampled[:, columns[name]]
        return found


class _Through(Mapping[str, Track]):
    """Tracks through extremes, each made when it is first asked for."""

    def __init__(self, extremes: Mapping[str, NDArray[np.float64]], seconds: float) -> None:
        self.extremes = extremes
        self.seconds = seconds
        self._made: dict[str, Track] = {}

    def __getitem__(self, dof: str) -> Track:
        if dof not in self._made:
            self._made[dof] = Track.through(self.extremes[dof], (0.0, self.seconds))
        return self._made[dof]

    def __iter__(self) -> Iterator[str]:
        return iter(self.extremes)

    def __len__(self) -> int:
        return len(self.extremes)


def _can_be(rows: NDArray[np.float64], first: NDArray[np.intp], seconds: float) -> bool:
    """Whether all that :meth:`Track.through` demands holds in all tracks."""
    rises = np.diff(rows[:, 0]) > 0
    rises[first[1:-1] - 1] = True
    ends = np.delete(rows[:, 2], first[:-1])
    return bool(
        seconds > 0
        and (np.diff(first) >= 2).all()
        and np.isfinite(rows).all()
        and rises.all()
        and ((ends > 0) & (ends < 1)).all()
    )
