"""Which number of a row of a GMR text file is which number of a motion.

The columns follow the joints as the file nests them: a joint's positions, the rotation of its bone, and what
is idle. The rotation that several siblings share stands at the first of them. Source: docs/gmr-format.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.channels import POSITIONS, ROTATIONS, ChannelLayout
from gmr.formats.gmr_trees import TreesError
from gmr.formats.text import named
from gmr.frames import Pose
from gmr.skeleton import Skeleton

__all__ = ["Columns", "PoseColumns", "columns_of_pose", "columns_of_rows", "moving_joints", "pose_of_columns"]

QUATERNION = {"xquaternion": 0, "yquaternion": 1, "zquaternion": 2, "wquaternion": 3}
"""Component of each quaternion channel, by its name in lower case."""


class Columns(NamedTuple):
    """The columns of a file."""

    names: list[tuple[str, ...]]
    """(J,) the channels of each joint."""
    sources: NDArray[np.intp]
    """(C,) for each column of the file the one of the motion's numbers."""


def _first_turned(skeleton: Skeleton, order: Sequence[int]) -> dict[int, int]:
    """The joint at which each slot's rotation stands: the first in the file that it turns."""
    found: dict[int, int] = {}
    slots = skeleton.slots.tolist()
    for joint in order:
        if slots[joint] >= 0:
            found.setdefault(slots[joint], joint)
    return found


def columns_of_rows(skeleton: Skeleton, layout: ChannelLayout, order: Sequence[int]) -> Columns:
    """Those of the rows of a post-rotation file: a joint's rotation stands at the first of its children."""
    turning = {joint: slot for slot, joint in _first_turned(skeleton, order).items()}
    owners, owned = layout.slot_joints.tolist(), layout.owned_slots.tolist()
    used = set(turning.values())
    names: list[tuple[str, ...]] = [()] * skeleton.joint_count
    sources: list[int] = []

    def columns(joint: int, known: dict[str, int]) -> list[tuple[str, int]]:
        start = int(layout.starts[joint])
        return [(name, start + k) for k, name in enumerate(layout.names[joint]) if name.lower() in known]

    for joint in order:
        found = columns(joint, POSITIONS)
        if joint in turning:
            found += columns(owners[turning[joint]], ROTATIONS)
        if owned[joint] >= 0 and owned[joint] not in used:
            found += [("Idle", column) for _, column in columns(joint, ROTATIONS)]
        names[joint] = tuple(name for name, _ in found)
        sources += [column for _, column in found]
    return Columns(names, np.array(sources, np.intp))


def columns_of_pose(skeleton: Skeleton, pose: Pose, order: Sequence[int]) -> Columns:
    """Those of translations (T x 3), then rotations (S x 4); of a slot that turns no bone just one, 0."""
    turning = {joint: slot for slot, joint in _first_turned(skeleton, order).items()}
    idle = set(range(skeleton.slot_count)) - set(turning.values())
    owners = {} if pose.layout is None else {int(pose.layout.slot_joints[slot]): slot for slot in idle}
    moving = {joint: k for k, joint in enumerate(pose.translated.tolist())}
    names: list[tuple[str, ...]] = [()] * skeleton.joint_count
    sources: list[int] = []
    for joint in order:
        if joint in moving:
            names[joint] += ("Xposition", "Yposition", "Zposition")
            sources += range(3 * moving[joint], 3 * moving[joint] + 3)
        if joint in turning:
            names[joint] += ("Xquaternion", "Yquaternion", "Zquaternion", "Wquaternion")
            start = 3 * len(moving) + 4 * turning[joint]
            sources += range(start, start + 4)
        if joint in owners:
            names[joint] += ("Idle",)
            sources.append(3 * len(moving) + 4 * owners[joint])
    return Columns(names, np.array(sources, np.intp))


def moving_joints(skeleton: Skeleton, channels: Sequence[tuple[str, ...]]) -> list[int]:
    """The joints with a translation, in their order: the roots, and those with position channels."""
    return [
        joint
        for joint, names in enumerate(channels)
        if skeleton.parents[joint] < 0 or any(name.lower() in POSITIONS for name in names)
    ]


def pose_of_columns(
    skeleton: Skeleton,
    channels: Sequence[tuple[str, ...]],
    order: Sequence[int],
    translated: Sequence[int],
    adds_offset: bool,
) -> PoseColumns:
    """How to read a pose from rows with these channels.

    Args:
        skeleton: J joints.
        channels: (J,) of each joint.
        order: the joints in the order of their columns.
        translated: the :func:`moving_joints`, in the motion's order.
        adds_offset: position channels add to the offset instead of replacing it.

    Raises:
        TreesError: a joint has rotation channels that are not its own, or lacks channels (what no column
            says would take memory for nothing).
    """
    turning = {joint: slot for slot, joint in _first_turned(skeleton, order).items()}
    reading = PoseColumns(
        skeleton,
        np.array(translated, np.int32),
        np.full((len(translated), 3), -1, np.int32),
        np.full((skeleton.slot_count, 3), -1, np.int32),
        np.zeros((skeleton.slot_count, 3), np.uint8),
        np.full((skeleton.slot_count, 4), -1, np.int32),
        adds_offset,
    )
    rows = {joint: k for k, joint in enumerate(reading.translated.tolist())}
    start = 0
    for joint in order:
        turns = 0
        for column, name in enumerate((name.lower() for name in channels[joint]), start):
            if name in POSITIONS:
                reading.places[rows[joint], POSITIONS[name]] = column
            elif name != "idle":
                slot = _turned(skeleton, turning, joint)
                if name in ROTATIONS:
                    reading.angles[slot, turns], reading.axes[slot, turns] = column, ROTATIONS[name]
                    turns += 1
                else:
                    reading.parts[slot, QUATERNION[name]] = column
        start += len(channels[joint])
    _check_columns(reading, turning, channels)
    return reading


def _check_columns(
    reading: PoseColumns, turning: dict[int, int], channels: Sequence[tuple[str, ...]]
) -> None:
    """Raises unless there are columns for each root, each turn, and what else there is room for."""
    placed = set(reading.translated[(reading.places >= 0).any(axis=1)].tolist())
    for joint in reading.skeleton.roots:
        if joint not in placed:
            raise TreesError(
                joint, "is a root without position channels. Write Xposition Yposition Zposition."
            )
    for joint, slot in turning.items():
        if reading.parts[slot, 0] < 0 and reading.angles[slot, 0] < 0:
            what = "has a TURN of its own, but no rotation channels. Write them, or the TURN that it shares"
            raise TreesError(joint, f"{what} with its parent or a sibling.")
    idle = sum(name.lower() == "idle" for names in channels for name in names)
    if len(reading.parts) - len(turning) > idle:
        highest = int(reading.skeleton.slots.argmax())
        what = f"has TURN {reading.skeleton.slots[highest]}, but lower numbers turn no bone"
        raise TreesError(highest, f"{what}. Let the TURNs close ranks.")


def _turned(skeleton: Skeleton, turning: dict[int, int], joint: int) -> int:
    """The slot whose rotation stands at a joint."""
    if joint in turning:
        return turning[joint]
    slot = int(skeleton.slots[joint])
    if slot < 0:
        what = "its bone turns as the one above it, or not at all: it has the same TURN, or none"
    else:
        other = next(one for one, turned in turning.items() if turned == slot)
        what = f"its bone turns as that of {named(skeleton.names[other])}, whose channels come first"
    raise TreesError(joint, f"has rotation channels, but {what}. Remove them, or give it a TURN of its own.")


class PoseColumns(NamedTuple):
    """Where the numbers of a pose stand in a row; -1: nowhere."""

    skeleton: Skeleton
    translated: NDArray[np.int32]
    places: NDArray[np.int32]
    angles: NDArray[np.int32]
    axes: NDArray[np.uint8]
    parts: NDArray[np.int32]
    adds_offset: bool

    def pose(self, rows: NDArray[np.float64], layout: ChannelLayout | None) -> Pose:
        """The pose of (F, C) rows."""
        rotations = np.empty((len(rows), len(self.parts), 4))
        whole = np.flatnonzero(self.parts[:, 0] >= 0)
        angled = np.flatnonzero(self.parts[:, 0] < 0)
        rotations[:, whole] = rows[:, self.parts[whole]]
        if len(angled):
            turned = np.empty((len(rows), len(angled), 4))
            if rows.shape[1]:
                _core.euler_to_quaternions(rows, self.angles[angled], self.axes[angled], turned)
            else:
                turned[:] = (0, 0, 0, 1)
            rotations[:, angled] = turned
        given = self.places >= 0
        base = self.skeleton.offsets[self.translated]
        translations = np.empty((len(rows), *base.shape))
        translations[:] = base
        if self.adds_offset:
            translations[:, given] += rows[:, self.places[given]]
        else:
            translations[:, given] = rows[:, self.places[given]]
        return Pose(read_only(rotations), self.translated, read_only(translations), layout)
