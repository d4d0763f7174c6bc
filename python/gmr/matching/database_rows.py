"""The rows of a motion database as arrays: what is known of each frame of its clips."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.matching.normalization import Normalization
from gmr.matching.schema import Schema

__all__ = ["DatabaseRows"]


class DatabaseRows:
    """N rows, the frames of C clips, clip after clip; see :class:`gmr.matching.Database`, which fills it.

    Lengths are metres; poses are seen from the simulation root of their own frame. Arrays are read-only and
    share the core's memory.
    """

    core: _core.Database
    schema: Schema
    clip_names: tuple[str, ...]
    mirrored: NDArray[np.bool_]
    starts: NDArray[np.float64]

    def __len__(self) -> int:
        """N."""
        return len(self.core.features)

    @property
    def rate(self) -> float:
        """Frames a second."""
        return self.core.rate

    @property
    def features(self) -> NDArray[np.float32]:
        """(N, D) scaled features; the sum of squared differences of two rows is the cost between them."""
        return self.core.features

    @cached_property
    def clips(self) -> NDArray[np.int32]:
        """(N,) index into :attr:`clip_names`."""
        return read_only(self.core.clips.astype(np.int32))

    @cached_property
    def frames(self) -> NDArray[np.int32]:
        """(N,) frame within the clip, at :attr:`rate`."""
        counts = [np.arange(end - start, dtype=np.int32) for start, end in self.core.clip_ranges]
        return read_only(np.concatenate(counts))

    @cached_property
    def seconds(self) -> NDArray[np.float64]:
        """(N,) time in the clip's file."""
        return read_only(self.starts[self.clips] + self.frames / self.rate)

    @property
    def candidates(self) -> NDArray[np.bool_]:
        """(N,) whether a frame can be found: its clip holds all that its features look at."""
        return self.core.candidates

    @property
    def tags(self) -> NDArray[np.uint32]:
        """(N,) tag bits."""
        return self.core.tags

    @property
    def normalization(self) -> Normalization:
        """How features are scaled; fixed when the database is built."""
        offset, scale = self.core.normalization
        return Normalization(np.array(offset, np.float32), np.array(scale, np.float32))

    @property
    def reach(self) -> tuple[int, int]:
        """How many frames before and after its own a frame's features look at."""
        frames = [round(time * self.rate) for group in self.schema.groups for time in group.times]
        return max(0, -min(frames)), max(0, *frames)

    @property
    def is_trajectory(self) -> NDArray[np.bool_]:
        """(D,) whether a number belongs to the path ahead, else to the pose."""
        return np.array(self.core.is_trajectory, bool)

    @property
    def positions(self) -> NDArray[np.float32]:
        """(N, J, 3) positions of all joints, metres, seen from the simulation root."""
        return self.core.positions

    @cached_property
    def displacements(self) -> NDArray[np.float32]:
        """(N, 2) the root's way to the next frame in its own frame: (left, forward), metres.

        The last frame of a clip repeats the one before it.
        """
        return read_only(self.core.displacements)

    @cached_property
    def turns(self) -> NDArray[np.float32]:
        """(N,) the root's turn to the next frame, radians, positive to the left; ends as in displacements."""
        return read_only(self.core.turns)

    @property
    def ground(self) -> NDArray[np.float64]:
        """(N, 2) the root's x and z in the world of its clip, metres."""
        return self.core.ground

    @property
    def headings(self) -> NDArray[np.float64]:
        """(N,) the root's heading in the world of its clip, radians, continuous within a clip."""
        return self.core.heading

    def clip_rows(self, clip: int | str) -> slice:
        """The rows of a clip, by its index or name."""
        index = self.clip_names.index(clip) if isinstance(clip, str) else clip
        return slice(*self.core.clip_ranges[index])
