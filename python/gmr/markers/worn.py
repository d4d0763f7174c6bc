"""Markers put on a motion: what cameras would see of a body that moves so; for tests and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from gmr.markers.recording import Markers, Up
from gmr.quaternions import matrices

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["wear"]


def wear(motion: Motion, places: Mapping[str, tuple[str, Sequence[float]]]) -> Markers:
    """The markers that a body wears, wherever it goes.

    Args:
        motion: +Y up.
        places: label -> joint, and where the marker is in that joint's frame (post-rotation), in the unit of
            the motion.

    Raises:
        SkeletonError: the motion has no such joint, or the joint has no one frame.
    """
    joints = motion.skeleton.indices(joint for joint, _ in places.values())
    steps = np.array([place for _, place in places.values()], np.float64).reshape(len(joints), 3)
    turns = matrices(motion.joint_rotations(dtype=np.float64)[:, joints])
    positions = motion.positions(dtype=np.float64)[:, joints] + (turns @ steps[..., None])[..., 0]
    return Markers(
        labels=tuple(places),
        positions=positions,
        frame_time=motion.frame_time,
        unit=motion.unit,
        up=Up("+Y", "a motion has +Y up"),
        name=motion.name,
    )
