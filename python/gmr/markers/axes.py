"""Which way is up in a laboratory, and the turning of a recording so that +Y is."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.markers.recording import Up

if TYPE_CHECKING:
    from gmr.markers.recording import Markers

__all__ = ["AXES", "axis_vector", "floor_axis", "turned_up"]

AXES: Final = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")

_TO_Y: Final = {
    "+X": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-X": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "+Y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-Y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "+Z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-Z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
}
"""Rotation, as rows, that takes each axis to +Y by a quarter or half turn about one other axis."""

_BELOW: Final = 0.03
"""Part of an axis' extent that may lie below 0 where 0 is the floor: a marker through a soft mat, noise."""


def turned_up(markers: Markers, axis: str = "+Y", was: str | None = None) -> Markers:
    """The recording turned by quarter turns so that what was up is along ``axis``.

    Args:
        markers: any recording.
        axis: the axis that up shall be along; gmr's motions have "+Y".
        was: the axis that is up now, where the recording does not know it, or not rightly.

    Raises:
        GmrError: an axis is none of :data:`AXES`, or the recording does not say which way is up.
    """
    now = was or (markers.up.axis if markers.up else None)
    if now is None:
        raise GmrError(
            f"{markers.name or 'this recording'} does not say which way is up; "
            "say it: markers.with_up('+Y', was='+Z')"
        )
    for name in (axis, now):
        if name not in AXES:
            raise GmrError(f"there is no axis '{name}'; use one of {', '.join(AXES)}")
    turn = np.array(_TO_Y[axis]).T @ np.array(_TO_Y[now])
    if np.array_equal(turn, np.eye(3)):
        return replace(markers, up=Up(axis, "given" if was else markers.up.by if markers.up else "given"))
    said = f"turned so that {now}, which was up, is {axis}: (x, y, z) became {_written(turn)}"
    return replace(
        markers,
        positions=markers.positions @ turn.T.astype(float),
        up=Up(axis, f"turned from {now}"),
        history=(*markers.history, said),
    )


def axis_vector(axis: str) -> NDArray[np.float64]:
    """(3,) the unit vector along an axis of :data:`AXES`."""
    return np.array(_TO_Y[axis][1], np.float64)


def floor_axis(positions: NDArray[np.float64]) -> str | None:
    """The one axis along which everything lies above 0, where laboratories put their floor; None where none
    or several are so.

    Args:
        positions: (..., 3) with NaN where not seen.
    """
    seen = positions[np.isfinite(positions).all(axis=-1)]
    if not len(seen):
        return None
    low, high = seen.min(axis=0), seen.max(axis=0)
    above = [axis for axis in range(3) if low[axis] >= -_BELOW * (high[axis] - low[axis]) and high[axis] > 0]
    return f"+{'XYZ'[above[0]]}" if len(above) == 1 else None


def _written(turn: NDArray[np.int_]) -> str:
    """A turn by quarter turns as what becomes of (x, y, z)."""
    parts = []
    for row in turn:
        axis = int(np.abs(row).argmax())
        parts.append(f"{'-' if row[axis] < 0 else ''}{'xyz'[axis]}")
    return f"({', '.join(parts)})"
