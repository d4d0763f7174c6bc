"""The frames of an AMC file as they were read, and poses as an ASF can say them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.acclaim import Acclaim
from gmr.arrays import frozen, read_only
from gmr.errors import GmrError
from gmr.frames import Pose

__all__ = ["DofRows"]


@dataclass(frozen=True, eq=False)
class DofRows:
    """Frames as an AMC file writes them: a value for each degree of freedom.

    Args:
        values: (F, C) float64 in the file's angles and units; columns as ``acclaim`` numbers them.
        acclaim: the skeleton that they move.
        radians: the angles are radians, else degrees.
        listed: the joints as a frame of the file lists them; those left out follow in the skeleton's order.
        first: the number of the first frame.
        rate_known: whether somebody said how many frames there are in a second.
        notes: the comments at the beginning of the file.
    """

    values: NDArray[np.float64]
    acclaim: Acclaim
    radians: bool = False
    listed: tuple[int, ...] = ()
    first: int = 1
    rate_known: bool = False
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        values = frozen(self.values, np.float64)
        columns = self.acclaim.column_count
        if values.ndim != 2 or values.shape[1] != columns:
            raise GmrError(f"values have the shape {values.shape}; it must be (frames, {columns})")
        object.__setattr__(self, "values", values)

    def __len__(self) -> int:
        return len(self.values)

    @property
    def layout(self) -> None:
        """No channels of a post-rotation file."""
        return

    @property
    def translated(self) -> NDArray[np.int32]:
        """(1,) int32: the root."""
        return _ROOT

    @property
    def numbers(self) -> tuple[NDArray[np.float64], ...]:
        """All that was given, whatever its form."""
        return (self.values,)

    def frames(self, part: slice) -> DofRows:
        """Some of the frames; consecutive ones share memory."""
        kept = range(self.first, self.first + len(self))[part]
        values = read_only(np.ascontiguousarray(self.values[part]))
        return replace(self, values=values, first=kept.start if len(kept) else self.first)

    @property
    def pose(self) -> Pose:
        """Rotations and translations; the core makes quaternions of the angles, about the bones' own axes."""
        acclaim = self.acclaim
        values = (
            np.where(acclaim.turns, np.degrees(self.values), self.values) if self.radians else self.values
        )
        rotations = np.empty((len(self), len(acclaim.slot_joints), 4))
        if acclaim.column_count:
            _core.turned_euler_to_quaternions(
                values, acclaim.rotation_columns, acclaim.rotation_axes, acclaim.frames, rotations
            )
        else:
            rotations[:] = (0, 0, 0, 1)
        translations = np.empty((len(self), 1, 3))
        for axis, column in enumerate(acclaim.translation_columns):
            place = acclaim.root.position[axis]
            translations[:, 0, axis] = place if column < 0 else self.values[:, column] + place
        return Pose(read_only(rotations), _ROOT, read_only(translations), acclaim=acclaim)

    def __reduce__(self) -> tuple[Any, ...]:
        rest = (self.acclaim, self.radians, self.listed, self.first, self.rate_known, self.notes)
        return _owned, (self.values, *rest)


_ROOT = read_only(np.zeros(1, np.int32))


def _owned(values: NDArray[np.float64], *rest: Any) -> DofRows:
    """Frames from an unpickled array, which nobody else holds and so needs no copy."""
    return DofRows(read_only(values), *rest)
