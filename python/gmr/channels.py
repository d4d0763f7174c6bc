"""Which number of a row moves what: the channels of a post-rotation file, joint by joint.

Euler channels compose in the written order: ``Zrotation Xrotation Yrotation`` is ``R = Rz Rx Ry``. Position
channels replace the joint's OFFSET (as Blender reads them), or add to it when the layout says so (as three.js
does).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.errors import SkeletonError
from gmr.skeleton import Skeleton, owned_slots

__all__ = ["POSITIONS", "ROTATIONS", "ChannelLayout", "turning_freely"]

POSITIONS = {"xposition": 0, "yposition": 1, "zposition": 2}
"""Axis of each position channel, by its name in lower case."""

ROTATIONS = {"xrotation": 0, "yrotation": 1, "zrotation": 2}
"""Axis of each rotation channel, by its name in lower case."""

_STANDARD_ROTATIONS = ("Zrotation", "Xrotation", "Yrotation")
_STANDARD_POSITIONS = ("Xposition", "Yposition", "Zposition")


@dataclass(frozen=True)
class ChannelLayout:
    """Channels of J joints in file order; a row of a motion has one column for each.

    Args:
        names: (J,) for each joint its channel names as the file has them, () for end sites and joints
            without.
        parents: (J,) parent of each joint, -1 for a root.
        adds_offset: position channels add to the joint's offset instead of replacing it.

    Raises:
        SkeletonError: an unknown channel, more than three rotations in one joint, or one position twice.
    """

    names: tuple[tuple[str, ...], ...]
    parents: tuple[int, ...]
    adds_offset: bool = False

    def __post_init__(self) -> None:
        if len(self.names) != len(self.parents):
            raise SkeletonError(f"channels for {len(self.names)} joints, but {len(self.parents)} parents")
        for joint, channels in enumerate(self.names):
            if channels:
                _check_joint(joint, channels)

    @classmethod
    def of(
        cls, skeleton: Skeleton, names: Sequence[Sequence[str]], *, adds_offset: bool = False
    ) -> ChannelLayout:
        """Layout with these channels for the joints of ``skeleton``."""
        return cls(tuple(tuple(joint) for joint in names), tuple(skeleton.parents.tolist()), adds_offset)

    @classmethod
    def standard(
        cls, skeleton: Skeleton, translated: Sequence[int] | NDArray[np.int32] = ()
    ) -> ChannelLayout:
        """The usual layout: positions of roots and ``translated`` joints, then Z, X, Y rotations."""
        moving = {*skeleton.roots, *(int(joint) for joint in translated)}
        names = tuple(
            (_STANDARD_POSITIONS if joint in moving else ())
            + (_STANDARD_ROTATIONS if children or joint in skeleton.roots else ())
            for joint, children in enumerate(skeleton.children)
        )
        return cls.of(
            skeleton, [() if end else joint for joint, end in zip(names, skeleton.ends, strict=True)]
        )

    @cached_property
    def column_count(self) -> int:
        """C, the numbers in a row."""
        return sum(len(channels) for channels in self.names)

    @cached_property
    def starts(self) -> NDArray[np.int32]:
        """(J + 1,) int32: the joint's channels are the columns from its entry to the next one's."""
        counts = np.fromiter((len(channels) for channels in self.names), np.int32, len(self.names))
        return read_only(np.concatenate([np.zeros(1, np.int32), np.cumsum(counts, dtype=np.int32)]))

    def channel(self, column: int) -> tuple[int, str]:
        """The joint that a column moves, and the name of its channel."""
        joint = int(np.searchsorted(self.starts, column, side="right")) - 1
        return joint, self.names[joint][column - int(self.starts[joint])]

    @cached_property
    def column_axes(self) -> NDArray[np.uint8]:
        """(C,) uint8: 0, 1, 2 for x, y, z."""
        axis = {**POSITIONS, **ROTATIONS}
        return read_only(np.array([axis[name.lower()] for joint in self.names for name in joint], np.uint8))

    @cached_property
    def column_turns(self) -> NDArray[np.bool_]:
        """(C,) bool: the column is an angle, else a position."""
        return read_only(
            np.array([name.lower() in ROTATIONS for joint in self.names for name in joint], bool)
        )

    @cached_property
    def owned_slots(self) -> NDArray[np.int32]:
        """(J,) int32: the slot that each joint owns, -1 for none; see :func:`gmr.skeleton.owned_slots`."""
        turning = [joint for joint, channels in enumerate(self.names) if channels]
        return read_only(owned_slots(np.array(self.parents, np.int32), turning))

    @cached_property
    def slot_joints(self) -> NDArray[np.int32]:
        """(S,) int32: the joint that owns each rotation slot."""
        return read_only(np.flatnonzero(self.owned_slots >= 0).astype(np.int32))

    @cached_property
    def rotation_columns(self) -> NDArray[np.int32]:
        """(S, 3) int32: per slot the columns of its angles in composing order; -1: the angle is 0."""
        return read_only(self._rotation_steps[0])

    @cached_property
    def rotation_axes(self) -> NDArray[np.uint8]:
        """(S, 3) uint8: per slot the axes of its angles in composing order."""
        return read_only(self._rotation_steps[1])

    @cached_property
    def _rotation_steps(self) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
        columns = np.full((len(self.slot_joints), 3), -1, np.int32)
        axes = np.zeros((len(self.slot_joints), 3), np.uint8)
        for slot, joint in enumerate(self.slot_joints.tolist()):
            turns = [
                (self.starts[joint] + k, ROTATIONS[name.lower()])
                for k, name in enumerate(self.names[joint])
                if name.lower() in ROTATIONS
            ]
            for step, (column, axis) in enumerate(turns):
                columns[slot, step], axes[slot, step] = column, axis
        return columns, axes

    @cached_property
    def translated(self) -> NDArray[np.int32]:
        """(T,) int32: joints with a translation per frame: all roots, and those with a position channel."""
        found = [
            joint
            for joint, (channels, parent) in enumerate(zip(self.names, self.parents, strict=True))
            if parent < 0 or any(name.lower() in POSITIONS for name in channels)
        ]
        return read_only(np.array(found, np.int32))

    @cached_property
    def translation_columns(self) -> NDArray[np.int32]:
        """(T, 3) int32: the columns of x, y, z of each translated joint; -1: the offset's component."""
        columns = np.full((len(self.translated), 3), -1, np.int32)
        for row, joint in enumerate(self.translated.tolist()):
            for k, name in enumerate(self.names[joint]):
                if name.lower() in POSITIONS:
                    columns[row, POSITIONS[name.lower()]] = self.starts[joint] + k
        return read_only(columns)

    def with_positions(self, joints: Iterable[int]) -> ChannelLayout:
        """The layout with all three position channels in these joints."""
        moving = set(joints)
        if not moving:
            return self
        return replace(
            self,
            names=tuple(
                (*_STANDARD_POSITIONS, *(name for name in channels if name.lower() in ROTATIONS))
                if joint in moving
                else channels
                for joint, channels in enumerate(self.names)
            ),
        )

    def completed(self) -> ChannelLayout:
        """The layout with three rotations in each joint whose channels cannot write every rotation it may
        come to.

        One channel is left alone: a hinge stays a hinge when its motion is resampled.
        """
        return self._completed

    @cached_property
    def _completed(self) -> ChannelLayout:
        names = tuple(_completed(channels) for channels in self.names)
        return self if names == self.names else replace(self, names=names)

    def fits(self, skeleton: Skeleton) -> bool:
        """Whether the slots that this layout numbers are the ones that turn the skeleton's bones."""
        if self.parents != tuple(skeleton.parents.tolist()) or skeleton.slot_count != len(self.slot_joints):
            return False
        above = np.array(self.parents, np.int32)
        return np.array_equal(skeleton.slots, np.where(above >= 0, self.owned_slots[above], -1))


def turning_freely(channels: tuple[str, ...]) -> tuple[str, ...]:
    """The channels of one joint, with three rotations that can write any turn."""
    completed = _completed(channels)
    if sum(name.lower() in ROTATIONS for name in completed) == 3:
        return completed
    return (*(name for name in channels if name.lower() in POSITIONS), *_STANDARD_ROTATIONS)


def _completed(channels: tuple[str, ...]) -> tuple[str, ...]:
    """The channels of one joint, with rotations added or exchanged so that they can write any rotation."""
    turns = [name for name in channels if name.lower() in ROTATIONS]
    axes = [ROTATIONS[name.lower()] for name in turns]
    if len(axes) < 2:
        return channels
    if axes[0] == axes[1] or (len(axes) == 3 and axes[1] == axes[2]):
        return (*(name for name in channels if name not in turns), *_STANDARD_ROTATIONS)
    return channels if len(axes) == 3 else (*channels, f"{'XYZ'[3 - axes[0] - axes[1]]}rotation")


def _check_joint(joint: int, channels: tuple[str, ...]) -> None:
    """Raises when a joint's channels cannot be composed."""
    known = [name.lower() for name in channels]
    unknown = [name for name in channels if name.lower() not in POSITIONS and name.lower() not in ROTATIONS]
    if unknown:
        raise SkeletonError(
            f"joint {joint} has an unknown channel '{unknown[0]}'; use Xposition, Yposition, Zposition, "
            "Xrotation, Yrotation, Zrotation"
        )
    positions = [name for name in known if name in POSITIONS]
    if len(set(positions)) < len(positions):
        raise SkeletonError(f"joint {joint} has a position channel twice ({' '.join(channels)}); remove one")
    if len(known) - len(positions) > 3:
        raise SkeletonError(f"joint {joint} has more than three rotation channels ({' '.join(channels)})")
