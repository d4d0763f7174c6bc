"""Turns of joints become angles: in the ranges of motion where that is possible, continuous where not.

A turn ``R_f R_a R_r`` about three different axes is also that of ``(f + pi, pi - a, r + pi)``, and each angle
may have whole turns more. No joint's rotation about its bone ranges over a half turn, so at most one of these
is in range. Where the sideways angle is a right one, as with the arms of a T-pose, flexion and rotation turn
about one axis: the pose tells their sum alone, and each frame takes the angles nearest to the frame before.

A course that cannot stay in range is the cheapest way through the readings of all frames: it pays for the
squares of its steps and of what it lacks to be in range. Source: Viterbi, "Error bounds for convolutional
codes and an asymptotically optimum decoding algorithm", IEEE Trans. Inf. Theory 13 (1967) 260.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.actionlets.dofs import Dof
from gmr.quaternions import about, conjugate, multiply

__all__ = ["angles_of"]

Floats = NDArray[np.float64]

_EXACT = 1e-7
"""Radians by which a reading may leave its range for rounding's sake."""
_OUTSIDE = 0.2
"""Cost of a second out of range by a radian, in squared radians of steps."""
_LEAP = 100.0
"""Cost of a step of more than a half turn: no joint turns so far between two frames."""
_LOOSE = 1e-6
"""Cosine of the sideways angle below which flexion and rotation cannot be told apart."""
_TURNS = 2 * np.pi * np.array([[i, 0, k] for i in (-1, 0, 1) for k in (-1, 0, 1)], np.float64)


def angles_of(rotations: Floats, dofs: Sequence[Dof], frame_time: float) -> Floats:
    """Angles of the turns of a joint.

    Args:
        rotations: (F, 4) unit quaternions.
        dofs: three of one joint, in the order of their turns, about three different axes.
        frame_time: seconds.

    Returns:
        (F, 3) radians: in every frame those in the ranges where all frames have such; else a continuous
        course that leaves the ranges as little and as shortly as its continuity allows.
    """
    axes = np.array([[int(np.abs(dof.axis).argmax()) for dof in dofs]], np.uint8)
    signs = np.array([float(np.sum(dof.axis)) for dof in dofs])
    turns = np.ascontiguousarray(rotations[:, None])
    course: Floats = np.radians(_core.quaternions_to_euler(turns, axes)[:, 0]) * signs
    low, high = (np.array([getattr(dof, end) for dof in dofs]) for end in ("low", "high"))
    if not np.isfinite(low).all():
        return _shifted(course, np.zeros(3))
    middle = (low + high) / 2
    near = [_near(reading, middle) for reading in (course, _other(course))]
    first, second = (np.all((one >= low - _EXACT) & (one <= high + _EXACT), axis=-1) for one in near)
    if (first | second).all():
        return _settled(np.where(first[:, None], near[0], near[1]), rotations, dofs)
    whole = [_shifted(reading, middle) for reading in (course, _other(course))]
    readings = np.concatenate([reading[:, None] + _TURNS for reading in whole], axis=1)
    excess = np.maximum(low - readings, 0.0) + np.maximum(readings - high, 0.0)
    found = _cheapest(readings, _OUTSIDE * frame_time * (excess**2).sum(axis=-1))
    return _settled(found, rotations, dofs)


def _settled(angles: Floats, rotations: Floats, dofs: Sequence[Dof]) -> Floats:
    """The same poses, with the flexion between that of the frames around where it cannot be told."""
    loose = np.abs(np.cos(angles[:, 1])) < _LOOSE
    if not loose.any() or loose.all():
        return angles
    frames = np.arange(len(angles))
    found = angles.copy()
    found[loose, 0] = np.interp(frames[loose], frames[~loose], angles[~loose, 0])
    axes = [np.array(dof.axis) for dof in dofs]
    before = multiply(about(axes[0], found[loose, 0]), about(axes[1], found[loose, 1]))
    rest = multiply(conjugate(before), rotations[loose])
    turn = 2 * np.arctan2(rest[:, :3] @ axes[2], rest[:, 3])
    found[loose, 2] = _near(turn, angles[loose, 2])
    return found


def _cheapest(readings: Floats, costs: Floats) -> Floats:
    """(F, 3) the course through (F, R, 3) readings that pays least: their (F, R) costs and its steps."""
    count, choices = costs.shape
    before = np.zeros((count, choices), np.intp)
    total = costs[0]
    for frame in range(1, count):
        steps = readings[frame, None] - readings[frame - 1, :, None]
        squares = steps * steps
        paid = squares.sum(axis=-1) + _LEAP * (squares > np.pi**2).any(axis=-1) + total[:, None]
        before[frame] = paid.argmin(axis=0)
        total = paid[before[frame], np.arange(choices)] + costs[frame]
    chosen = np.empty(count, np.intp)
    chosen[-1] = total.argmin()
    for frame in range(count - 1, 0, -1):
        chosen[frame - 1] = before[frame, chosen[frame]]
    return readings[np.arange(count), chosen]


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
