"""Of the many angles that name one rotation, those that go on best from others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr import _core

__all__ = ["continued_angles", "nearest_angles"]

Floats = NDArray[np.float64]


def continued_angles(
    was: Floats, rotations: Floats, turned: NDArray[np.bool_], axes: NDArray[np.uint8]
) -> Floats:
    """Angles of a joint in which some frames turn otherwise than they did, without needless jumps.

    In each run of such frames the angles either go on from frame to frame, from those that the first one had,
    or are each the nearest to what they were; whichever jumps less, the frames before and after counted.

    Args:
        was: (F, 3) degrees.
        rotations: (F, 4) xyzw, as they are now.
        turned: (F,) the frames that turn otherwise.
        axes: (3,) 0, 1 or 2, in composing order.
    """
    found = was.copy()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], turned, [False]]).astype(np.int8)))
    for first, end in edges.reshape(-1, 2).tolist():
        run = np.ascontiguousarray(rotations[first:end, None])
        going_on = np.asarray(_core.quaternions_to_euler(run, np.ascontiguousarray(axes[None])))[:, 0]
        ways = [
            _alike(going_on, was[max(first - 1, 0)], axes),
            nearest_angles(going_on, was[first:end], axes.tolist()),
        ]
        around = slice(max(first - 1, 0), first), slice(end, end + 1)
        steps = [np.diff(np.concatenate([was[around[0]], way, was[around[1]]]), axis=0) for way in ways]
        found[first:end] = min(zip(ways, steps, strict=True), key=lambda one: np.abs(one[1]).max(initial=0))[
            0
        ]
    return found


def _alike(angles: Floats, to: Floats, axes: NDArray[np.uint8]) -> Floats:
    """(n, 3) angles that go on from frame to frame, all named in that of their ways that is nearest to ``to``
    in the first frame."""
    (start,) = nearest_angles(angles[:1], to[None], axes.tolist())
    shift = start - angles[0]
    if np.abs(shift - 360 * np.round(shift / 360)).max() < 1e-6:
        return np.asarray(angles + 360 * np.round(shift / 360), np.float64)
    other = _other_name(angles, axes.tolist())
    return np.asarray(other + 360 * np.round((start - other[0]) / 360), np.float64)


def nearest_angles(angles: Floats, to: Floats, axes: Sequence[int]) -> Floats:
    """Of all angles that name the same rotations, those nearest to others.

    ``(a, b, c)`` about three different axes is ``(a + 180, 180 - b, c + 180)`` too; where the first axis is
    the third, it is ``(a + 180, -b, c + 180)``; and full turns may be added to each.

    Args:
        angles: (F, 3) degrees.
        to: (F, 3) degrees.
        axes: 0, 1 or 2 for each of the three.
    """
    candidates = np.stack([angles, _other_name(angles, axes)])
    candidates = candidates + 360 * np.round((to - candidates) / 360)
    chosen = np.abs(candidates - to).max(axis=-1).argmin(axis=0)
    return np.asarray(candidates[chosen, np.arange(len(angles))], np.float64)


def _other_name(angles: Floats, axes: Sequence[int]) -> Floats:
    """The same rotations by the other three angles."""
    mirrored = -angles[:, 1] if axes[0] == axes[2] else 180 - angles[:, 1]
    return np.stack([angles[:, 0] + 180, mirrored, angles[:, 2] + 180], axis=1)
