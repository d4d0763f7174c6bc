"""Some of the frames of a dataset: for each recording the ranges that are left of it.

A recording is a clip together with its mirrored copy: what is left of the one is left of the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.matching.database import Database
from gmr.matching.naming import recording_of
from gmr.table import Table

__all__ = ["Part", "Range", "Recording", "gaps", "ranges_of", "recordings_of", "whole"]

Range = tuple[int, int]
"""First frame and one past the last, at the database's rate, counted from the clip's beginning."""


@dataclass(frozen=True, slots=True)
class Recording:
    """A clip of a database, with its mirrored copy where there is one.

    Attributes:
        name: of the clip.
        frames: how many it has.
        starts: the first row of it, and of its copy.
    """

    name: str
    frames: int
    starts: tuple[int, ...]

    def total(self, per_row: NDArray[np.int64]) -> NDArray[np.int64]:
        """(frames,) a count of every row of a database, of the clip and its copy together."""
        return np.asarray(sum(per_row[start : start + self.frames] for start in self.starts), np.int64)


@dataclass(frozen=True)
class Part:
    """What is left of a dataset.

    Attributes:
        rate: frames a second.
        ranges: by the name of every recording the ranges that are left, in order and apart; none where it is
            gone.
    """

    rate: float
    ranges: Mapping[str, tuple[Range, ...]]

    @cached_property
    def seconds(self) -> float:
        """How long it lasts, mirrored copies not counted."""
        frames = (end - first - 1 for ranges in self.ranges.values() for first, end in ranges)
        return sum(frames) / self.rate

    def without(self, name: str, gone: Range) -> Part:
        """What is left when a range of a recording goes too."""
        left = [
            piece
            for first, end in self.ranges[name]
            for piece in ((first, min(end, gone[0])), (max(first, gone[1]), end))
            if piece[0] < piece[1]
        ]
        return Part(self.rate, {**self.ranges, name: tuple(left)})

    def rows(self, database: Database) -> NDArray[np.bool_]:
        """(N,) the rows of a database that are left."""
        left = np.zeros(len(database), bool)
        for recording in recordings_of(database):
            for start in recording.starts:
                for first, end in self.ranges[recording.name]:
                    left[start + first : start + end] = True
        return left

    @property
    def table(self) -> Table:
        """One row a range that is left: ``clip``, ``from_seconds`` and ``to_seconds`` in the clip."""
        rows = [(name, piece) for name, ranges in self.ranges.items() for piece in ranges]
        return Table(
            {
                "clip": np.array([name for name, _ in rows], object),
                "from_seconds": np.array([first / self.rate for _, (first, _) in rows], np.float64),
                "to_seconds": np.array([(end - 1) / self.rate for _, (_, end) in rows], np.float64),
            }
        )


def recordings_of(database: Database) -> list[Recording]:
    """The recordings of a database, in the order of its rows."""
    found: dict[str, list[int]] = {}
    original = ""
    for clip, (name, copy) in enumerate(zip(database.clip_names, database.mirrored.tolist(), strict=True)):
        original = original if copy else name
        found.setdefault(original, []).append(clip)
    ranges = database.core.clip_ranges
    return [
        Recording(name, ranges[clips[0]][1] - ranges[clips[0]][0], tuple(ranges[clip][0] for clip in clips))
        for name, clips in found.items()
    ]


def whole(database: Database) -> Part:
    """All of a dataset, the clips too that were left out of its database because others equal them."""
    ranges: dict[str, tuple[Range, ...]] = {
        each.name: ((0, each.frames),) for each in recordings_of(database)
    }
    twice = {name: ranges[recording_of(first)] for name, first in database.duplicates.items()}
    return Part(database.rate, ranges | twice)


def ranges_of(left: NDArray[np.bool_], least_gap: int = 1) -> tuple[Range, ...]:
    """The unbroken runs of True; what is less than ``least_gap`` apart is one."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], left, [False]]).astype(np.int8)))
    found: list[Range] = []
    for first, end in edges.reshape(-1, 2).tolist():
        if found and first - found[-1][1] < least_gap:
            found[-1] = (found[-1][0], end)
        else:
            found.append((first, end))
    return tuple(found)


def gaps(frames: int, ranges: tuple[Range, ...]) -> Iterator[Range]:
    """What ranges leave out of so many frames."""
    begin = 0
    for first, end in (*ranges, (frames, frames)):
        if first > begin:
            yield begin, first
        begin = end
