"""What a GMR file keeps of a motion, the same in text and in binary form.

Kept to the bit: joints, configuration, timing, unit, channels of the post-rotation file that it came from,
and the frames, as rows where they are rows as read, else as rotations and translations. Not kept: the name;
what :meth:`Motion.drop_dummies` removed, with the rotations of slots that turn no bone any more (the others
close ranks); the rows that a motion in another configuration was once read as; a layout that does not fit.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.apart import turned_apart
from gmr.arrays import read_only
from gmr.configurations import arranged
from gmr.errors import FormatError
from gmr.formats.finite import check_offsets, check_rows, first_not_finite, unsayable
from gmr.frames import Pose, Rows
from gmr.motion import Motion
from gmr.skeleton import Skeleton

__all__ = ["OffLength", "check", "kept", "off_length", "side_by_side"]

_FORM = "a GMR file"

_OFF_LENGTH = 1e-3
"""How far from 1 the squared length of a quaternion may be before it is said."""


def kept(motion: Motion) -> Motion:
    """The motion as a GMR file keeps it; reading one that was written gives just this.

    Returns:
        At home with rows that have a column, those rows; else a pose, whose layout fits or is None, with
        rotations for just the slots that it takes. Bones that turn apart have turns of their own.
    """
    motion = turned_apart(motion)
    skeleton, source = motion.skeleton, motion.source
    is_rows = isinstance(source, Rows) and skeleton.home is None
    if is_rows and (source.numbers[0].shape[1] or not len(source)):
        return replace(motion, dropped=None)
    pose, home = motion.pose, skeleton.home or skeleton
    layout = pose.layout if pose.layout is not None and pose.layout.fits(home) else None
    pose = Pose(pose.rotations, pose.translated, pose.translations, layout)
    if layout is None:
        skeleton, pose = _in_used_slots(skeleton, pose)
    return replace(motion, skeleton=skeleton, source=_identity_where_idle(skeleton, pose), dropped=None)


def check(motion: Motion) -> None:
    """Raises where what :func:`kept` gave cannot be written: no joint, or a number that is not finite.

    Raises:
        FormatError: joint, channel and frame are named.
    """
    skeleton, source = motion.skeleton, motion.source
    if not skeleton.joint_count:
        raise FormatError("a motion without joints cannot be written; it needs one", file=motion.name)
    check_offsets(motion, skeleton.home or skeleton, _FORM)
    if isinstance(source, Rows):
        check_rows(motion, source.layout, source.values, _FORM)
        return
    pose = motion.pose
    joints = {int(slot): joint for joint, slot in reversed(list(enumerate(skeleton.slots))) if slot >= 0}
    turned = [joints.get(slot, 0) for slot in range(skeleton.slot_count)]
    for values, whose, names in (
        (side_by_side(pose.translations), pose.translated.tolist(), ("XYZ", "position")),
        (side_by_side(pose.rotations), turned, ("XYZW", "quaternion")),
    ):
        if (found := first_not_finite(values)) is not None:
            frame, column = found
            which, axis = divmod(column, len(names[0]))
            who = f"joint '{skeleton.names[whose[which]]}', {names[0][axis]}{names[1]}"
            raise unsayable(motion, who, values[frame, column], frame, _FORM)


class OffLength(NamedTuple):
    """Quaternions that are not of length 1.

    Args:
        quaternions: how many.
        frame: the first frame that has one, from 0.
    """

    quaternions: int
    frame: int

    def __str__(self) -> str:
        many = "1 quaternion is" if self.quaternions == 1 else f"{self.quaternions:,} quaternions are"
        return f"{many} not of length 1, the first in frame {self.frame}"


def off_length(pose: Pose) -> OffLength | None:
    """Quaternions that are not of length 1; None where all are.

    They would stretch bones. How far the squared length may be off: :data:`_OFF_LENGTH`.
    """
    off = np.abs(np.einsum("fsc,fsc->fs", pose.rotations, pose.rotations) - 1) > _OFF_LENGTH
    if not off.any():
        return None
    return OffLength(int(off.sum()), int(np.argwhere(off)[0][0]))


def side_by_side(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, ...) as (F, C): the numbers of a frame in a row."""
    return array.reshape(len(array), math.prod(array.shape[1:]))


def _identity_where_idle(skeleton: Skeleton, pose: Pose) -> Pose:
    """The pose with the identity in the slots that turn no bone."""
    idle = np.setdiff1d(np.arange(skeleton.slot_count), skeleton.slots)
    identity = np.array([0.0, 0.0, 0.0, 1.0])
    if (pose.rotations[:, idle] == identity).all():
        return pose
    rotations = pose.rotations.copy()
    rotations[:, idle] = identity
    return replace(pose, rotations=read_only(rotations))


def _in_used_slots(skeleton: Skeleton, pose: Pose) -> tuple[Skeleton, Pose]:
    """The same without the slots that turn no bone; the others keep their order."""
    home = skeleton.home or skeleton
    used = np.unique(home.slots[home.slots >= 0])
    if len(used) == home.slot_count:
        return skeleton, pose
    numbers = np.full(home.slot_count + 1, -1, np.int32)
    numbers[used] = np.arange(len(used))
    lean = replace(home, slots=numbers[home.slots], slot_count=len(used))
    if skeleton.home is not None:
        lean = arranged(lean, _core.Forest(lean.topology, skeleton.parents))
    before = np.empty(lean.slot_count, np.intp)
    turned = skeleton.slots >= 0
    before[lean.slots[turned]] = skeleton.slots[turned]
    return lean, replace(pose, rotations=read_only(pose.rotations.take(before, axis=1)))
