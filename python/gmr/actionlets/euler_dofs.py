"""Turns of joints become angles: in the ranges of motion where that is possible, continuous where not.

A turn ``R_f R_a R_r`` about three different axes is also that of ``(f + pi, pi - a, r + pi)``, and each angle
may have whole turns more. No joint's rotation about its bone ranges over a half turn, so at most one of these
is in range. Where the sideways angle is a right one, as with the arms of a T-pose, flexion and rotation turn
about one axis: the pose tells their sum alone, and each frame takes the angles nearest to the frame before.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.actionlets.dofs import Dof

__all__ = ["angles_of"]

Floats = NDArray[np.float64]

_EXACT = 1e-7
"""Radians by which a reading may leave its range for rounding's sake."""


def angles_of(rotations: Floats, dofs: Sequence[Dof]) -> Floats:
    """Angles of the turns of a joint.

    Args:
        rotations: (F, 4) unit quaternions.
        dofs: three of one joint, in the order of their turns, about three different axes.

    Returns:
        (F, 3) radians: in every frame those in the ranges where all frames have such; else a continuous
        course, the one of the two that leaves the ranges least, in whole turns nearest to them.
    """
    axes = np.array([[int(np.abs(dof.axis).argmax()) for dof in dofs]], np.uint8)
    signs = np.array([float(np.sum(dof.axis)) for dof in dofs])
    turns = np.ascontiguousarray(rotations[:, None])
    course: Floats = np.radians(_core.quaternions_to_euler(turns, axes)[:, 0]) * signs
    low, high = (np.array([getattr(dof, end) for dof in dofs]) for end in ("low", "high"))
    bounded = np.isfinite(low) & np.isfinite(high)
    middle = np.where(bounded, (np.where(bounded, low, 0.0) + np.where(bounded, high, 0.0)) / 2, 0.0)
    readings = [course, _other(course)]
    if bounded.all():
        near = [_near(reading, middle) for reading in readings]
        first, second = (np.all((one >= low - _EXACT) & (one <= high + _EXACT), axis=-1) for one in near)
        if (first | second).all():
            return np.where(first[:, None], near[0], near[1])
    whole = [_shifted(reading, middle) for reading in readings]
    excess = [np.maximum(low - one, 0.0) + np.maximum(one - high, 0.0) for one in whole]
    costs = [float((one**2).sum()) for one in excess]
    return whole[int(np.argmin(costs))]


def _other(angles: Floats) -> Floats:
    """The other angles of the same turns."""
    return np.asarray(angles * np.array([1.0, -1.0, 1.0]) + np.pi, np.float64)


def _near(angles: Floats, middle: Floats) -> Floats:
    """The same angles, each in whole turns nearest to the middle of its range."""
    return np.asarray(angles - 2 * np.pi * np.round((angles - middle) / (2 * np.pi)), np.float64)


def _shifted(course: Floats, middle: Floats) -> Floats:
    """A continuous course, moved as a whole by whole turns to where it is nearest to the ranges."""
    if not len(course):
        return course
    return np.asarray(
        course - 2 * np.pi * np.round((np.median(course, axis=0) - middle) / (2 * np.pi)), np.float64
    )
