"""The simulation root of a motion: a joint of the file that already is one, else the smoothed hips and
facing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.body.joints import Joints
from gmr.body.measures import Poses
from gmr.motion import Motion
from gmr.quaternions import matrices
from gmr.skeleton import Skeleton

__all__ = [
    "HEADING_WINDOW",
    "POSITION_WINDOW",
    "RootJoint",
    "RootTrack",
    "find_root_joint",
    "joints_left_behind",
    "root_track",
]

POSITION_WINDOW = 0.5
"""Seconds of hip positions that a smoothed position is fitted to."""

HEADING_WINDOW = 1.0
"""Seconds of facing directions that a smoothed heading is fitted to."""

_NEAR_GROUND = 0.15
_NEAR_BODY = 0.6
_TRAVELS = 0.5
"""In metres: how high above the lowest joint a root joint may lie, how far from the hips, and how far one
travels."""

_AGREES = 0.8
"""Mean cosine between the heading of a root joint and the body's facing."""


@dataclass(frozen=True, slots=True)
class RootJoint:
    """A joint above the hips that lies on the ground and goes with the body: the file's own simulation
    root."""

    joint: int
    child: int
    """A joint whose bone the root joint's rotation turns."""
    forward: tuple[float, float, float]
    """The axis of the root joint that points where the body faces."""


@dataclass(frozen=True, slots=True)
class RootTrack:
    """The simulation root in every frame."""

    ground: NDArray[np.float64]
    """(F, 2) x and z, metres."""
    heading: NDArray[np.float64]
    """(F,) radians, forward = (sin, cos) in (x, z), continuous."""

    def mirrored(self) -> RootTrack:
        """The track seen in a mirror at x = 0."""
        return RootTrack(np.ascontiguousarray(self.ground * [-1.0, 1.0]), -self.heading)


def root_track(
    motion: Motion, positions: NDArray[np.float32], joints: Joints, root: RootJoint | None
) -> RootTrack:
    """The simulation root of a motion in metres, Y up.

    Args:
        motion: F frames.
        positions: (F, J, 3) its world positions.
        joints: the body's joints.
        root: the file's own simulation root, None to make one.

    Raises:
        ValueError: no frame shows a facing.
    """
    if root is None:
        window = [round(seconds * motion.fps) | 1 for seconds in (POSITION_WINDOW, HEADING_WINDOW)]
        return RootTrack(*_core.simulation_root(positions, joints["hips"], joints.across, *window))
    forward = _turned(motion, root)
    ground = np.ascontiguousarray(positions[:, root.joint, ::2], np.float64)
    return RootTrack(ground, np.unwrap(np.arctan2(forward[:, 0], forward[:, 2])))


def find_root_joint(
    skeleton: Skeleton, joints: Joints, poses: Sequence[Poses], clips: Iterable[Motion]
) -> RootJoint | None:
    """The joint above the hips that is the simulation root of every clip, if there is one.

    It lies on the ground and near the body in every sampled frame, travels in at least one clip, and one of
    its axes points where the body faces. A joint that rests at the origin while the body walks away is none.

    Args:
        skeleton: whose joints they are.
        joints: the body's joints.
        poses: world positions of some frames of each clip, metres, Y up.
        clips: the same frames as motions; looked at only where a joint travels with the body.
    """
    for joint, child in _joints_above(skeleton, joints["hips"]):
        goes_along = all(_goes_along(clip, joint, joints["hips"]) for clip in poses)
        if goes_along and any(_travels(clip, joint) for clip in poses):
            sampled = zip(clips, poses, strict=True)
            axes = np.concatenate([_facing_in(clip, at, child, joints) for clip, at in sampled])
            forward = _main_axis(axes.mean(axis=0))
            if forward is not None:
                return RootJoint(joint, child, forward)
    return None


def joints_left_behind(skeleton: Skeleton, joints: Joints, poses: Sequence[Poses]) -> tuple[int, ...]:
    """The joints above the hips from which the body walks away, and all above them; the uppermost first.

    Args:
        skeleton: whose joints they are.
        joints: the body's joints.
        poses: world positions of some frames of each clip, metres, Y up.
    """
    above = [joint for joint, _ in _joints_above(skeleton, joints["hips"])]
    behind = [
        any(_distance(clip, joint, joints["hips"]).max() > _NEAR_BODY for clip in poses) for joint in above
    ]
    return tuple(above[behind.index(True) :][::-1]) if any(behind) else ()


def _joints_above(skeleton: Skeleton, hips: int) -> list[tuple[int, int]]:
    """Ancestors of the hips, each with its child on the way down, the nearest first."""
    found, child = [], hips
    while (parent := int(skeleton.parents[child])) >= 0:
        found.append((parent, child))
        child = parent
    return found


def _goes_along(positions: Poses, joint: int, hips: int) -> bool:
    lowest = positions[:, :, 1].min(axis=1)
    near = _distance(positions, joint, hips) < _NEAR_BODY
    return bool(np.all(positions[:, joint, 1] - lowest < _NEAR_GROUND) and np.all(near))


def _distance(positions: Poses, joint: int, hips: int) -> NDArray[np.float64]:
    """(F,) distance on the ground."""
    return np.asarray(np.linalg.norm(positions[:, joint, ::2] - positions[:, hips, ::2], axis=1), np.float64)


def _travels(positions: Poses, joint: int) -> bool:
    return bool(np.linalg.norm(np.ptp(positions[:, joint, ::2], axis=0)) > _TRAVELS)


def _facing_in(motion: Motion, positions: Poses, child: int, joints: Joints) -> NDArray[np.float64]:
    """(F, 3) direction that the body faces, in the frame that turns the bone of ``child``."""
    left, right = joints.across[0]
    across = positions[:, left] - positions[:, right]
    facing = np.stack([-across[:, 2], np.zeros(len(across)), across[:, 0]], axis=1)
    facing /= np.linalg.norm(facing, axis=1, keepdims=True).clip(1e-9)
    frame = matrices(motion.bone_rotations(dtype=np.float64)[:, child])
    return np.asarray(np.einsum("fji,fj->fi", frame, facing), np.float64)


def _main_axis(mean: NDArray[np.float64]) -> tuple[float, float, float] | None:
    axis = int(np.argmax(np.abs(mean)))
    if abs(mean[axis]) < _AGREES:
        return None
    unit = [0.0, 0.0, 0.0]
    unit[axis] = float(np.sign(mean[axis]))
    return unit[0], unit[1], unit[2]


def _turned(motion: Motion, root: RootJoint) -> NDArray[np.float64]:
    """(F, 3) where the root joint's forward axis points."""
    frame = matrices(motion.bone_rotations(dtype=np.float64)[:, root.child])
    return np.asarray(frame @ np.array(root.forward), np.float64)
