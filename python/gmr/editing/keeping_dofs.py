"""The values of an AMC file after an edit: those that it left alone as they were, to the bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.dof_rows import DofRows
from gmr.dofs_of_pose import own_turns, with_bones_of
from gmr.editing.nearest_angles import continued_angles
from gmr.frames import Pose

__all__ = ["dofs_kept"]

Floats = NDArray[np.float64]


def dofs_kept(was: DofRows, pose: Pose, turned: NDArray[np.bool_], moved: NDArray[np.bool_]) -> DofRows:
    """Values of a pose on the bones of an ASF; a bone that turns as its degrees of freedom cannot say gets
    three.

    Args:
        was: the values before the edit.
        pose: of the same skeleton, after it.
        turned: (F, S) the rotations that the edit changed.
        moved: (F,) the frames in which it changed the root's place.
    """
    found = with_bones_of(was.acclaim, pose)
    before, after = was.acclaim, found.acclaim
    old = np.where(before.turns, np.degrees(was.values), was.values) if was.radians else was.values
    own = own_turns(after, pose.rotations)
    values = found.values.copy()
    if was.radians:
        values[:, after.turns] = np.radians(values[:, after.turns])
    for slot in range(len(after.slot_joints)):
        ours, theirs = after.rotation_columns[slot], before.rotation_columns[slot]
        ours, theirs = ours[ours >= 0], theirs[theirs >= 0]
        if len(ours) != len(theirs):
            continue
        if len(ours) == 3:
            axes = after.rotation_axes[slot]
            angles = continued_angles(old[:, theirs], own[:, slot], turned[:, slot], axes)
        else:
            angles = found.values[:, ours]
            angles = angles + 360 * np.round((old[:, theirs] - angles) / 360)
        angles = np.radians(angles) if was.radians else angles
        values[:, ours] = np.where(turned[:, slot, None], angles, was.values[:, theirs])
    for axis, column in enumerate(before.translation_columns):
        ours_at = after.translation_columns[axis]
        if column >= 0:
            values[~moved, ours_at] = was.values[~moved, column]
    return replace(was, values=read_only(values), acclaim=after)
