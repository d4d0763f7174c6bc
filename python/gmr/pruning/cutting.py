"""What is left of a dataset as files: whole ones as they are, and pieces of those of which only parts are.

A piece begins at a frame of its file that the database resampled to one of its own, so that the same instants
are resampled again; it holds every frame of the part.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import PurePosixPath

import numpy as np
from numpy.typing import NDArray

from gmr.matching.database import Database
from gmr.motion import Motion
from gmr.pruning.part import Part, Recording, recordings_of
from gmr.resample import nominal_fps

__all__ = ["Piece", "origins", "pieces_of"]

_SIMPLE = 60
"""Frames of the database after which one falls on a frame of the file again, at the most."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A file of the smaller dataset.

    Attributes:
        file: its path below the folder, as the file system has it.
        source: the recording that it is of.
        frames: first frame of the file that it is of, and one past the last; None: it is the whole file.
        begins: frame of the recording, at the database's rate, that its first one is.
    """

    file: str
    source: str
    frames: tuple[int, int] | None
    begins: int

    def of(self, motion: Motion) -> Motion:
        """The piece of its source's motion."""
        return motion if self.frames is None else motion[slice(*self.frames)]


def pieces_of(
    database: Database, motions: Mapping[str, Motion], paths: Mapping[str, str], part: Part
) -> list[Piece]:
    """The files that a part is written to, in the order of the recordings.

    Args:
        database: of the whole dataset.
        motions: by the names of its recordings, as read.
        paths: where each of them is below its folder, as the file system has it.
        part: what is left.
    """
    starts = dict(zip(database.clip_names, database.starts.tolist(), strict=True))
    found = []
    for recording in recordings_of(database):
        for first, end in part.ranges[recording.name]:
            if (first, end) == (0, recording.frames):
                found.append(Piece(paths[recording.name], recording.name, None, 0))
            else:
                motion, path = motions[recording.name], paths[recording.name]
                start = starts[recording.name]
                found.append(_piece(recording, motion, path, start, database.rate, (first, end)))
    return found


def _piece(
    recording: Recording, motion: Motion, path: str, start: float, rate: float, part: tuple[int, int]
) -> Piece:
    fps = nominal_fps(motion)
    step = Fraction(fps / rate).limit_denominator(_SIMPLE)
    simple = math.isclose(float(step) * rate, fps, rel_tol=1e-9)
    begins = part[0] - part[0] % step.denominator if simple else part[0]
    skipped = round(start / motion.frame_time)
    first = skipped + math.floor(begins * fps / rate + 1e-6) if begins else 0
    end = skipped + math.ceil((part[1] - 1) * fps / rate - 1e-6) + 1
    if part[1] == recording.frames or end > motion.frame_count:
        end = motion.frame_count
    name = PurePosixPath(path)
    digits = len(str(motion.frame_count))
    numbers = f"{first:0{digits}}-{end - 1:0{digits}}"
    return Piece(
        str(name.with_name(f"{name.stem}.{numbers}{name.suffix}")), recording.name, (first, end), begins
    )


def origins(whole: Database, cut: Database, pieces: list[Piece]) -> NDArray[np.int64]:
    """(n,) row of the whole dataset's database of each row of that of the pieces; -1 where there is none."""
    starts = {
        (each.name, copy): start for each in recordings_of(whole) for copy, start in enumerate(each.starts)
    }
    frames = {each.name: each.frames for each in recordings_of(whole)}
    by_file = {piece.file: piece for piece in pieces}
    found = np.full(len(cut), -1, np.int64)
    for recording in recordings_of(cut):
        piece = by_file[recording.name]
        for copy, start in enumerate(recording.starts):
            at = piece.begins + np.arange(recording.frames)
            rows = np.where(at < frames[piece.source], starts[piece.source, copy] + at, -1)
            found[start : start + recording.frames] = rows
    return found
