"""The frames of a dataset as an evaluation sees them: one row a frame, clip after clip, at one rate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Frames"]


@dataclass(frozen=True, slots=True)
class Frames:
    """N rows, one for every frame of every clip (a mirrored copy is a clip of its own).

    Attributes:
        clip_names: the C names.
        mirrored: (C,) bool, whether the clip is a mirrored copy.
        clip: (N,) int32, index into ``clip_names``, ascending.
        frame: (N,) int32, frame within its clip at ``rate``.
        seconds: (N,) time in the clip's source file.
        displacement: (N, 2), the root's way to the next frame in its own frame, (left, forward) in metres;
            not used in a clip's last row.
        turn: (N,), the root's turn to the next frame in radians, positive to the left; likewise.
        rate: frames per second.
    """

    clip_names: tuple[str, ...]
    mirrored: NDArray[np.bool_]
    clip: NDArray[np.int32]
    frame: NDArray[np.int32]
    seconds: NDArray[np.float64]
    displacement: NDArray[np.float64]
    turn: NDArray[np.float64]
    rate: float

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.clip)

    @property
    def names(self) -> NDArray[np.object_]:
        """(N,) the name of every row's clip."""
        return np.array(self.clip_names, object)[self.clip]

    @property
    def starts(self) -> NDArray[np.int64]:
        """(C + 1,) first row of every clip, and N."""
        numbers = np.arange(len(self.clip_names) + 1, dtype=self.clip.dtype)
        return np.searchsorted(self.clip, numbers).astype(np.int64)

    @property
    def has_next(self) -> NDArray[np.bool_]:
        """(N,) whether a row is followed by another of its clip."""
        followed = np.zeros(len(self), bool)
        followed[:-1] = self.clip[1:] == self.clip[:-1]
        return followed
