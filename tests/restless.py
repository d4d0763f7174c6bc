"""Motions that have no rest pose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gmr.motion import Motion
from gmr.quaternions import conjugate, multiply, rotated


def without_rest(motion: Motion, seed: int) -> Motion:
    """The same places in every frame, from bones with frames of their own: at zero, no body stands."""
    rng = np.random.default_rng(seed)
    skeleton = motion.skeleton
    count = skeleton.slot_count
    own = rng.normal(size=(count, 4))
    own /= np.linalg.norm(own, axis=1, keepdims=True)
    local = multiply(motion.rotations, own)
    offsets = skeleton.offsets.copy()
    for joint in range(skeleton.joint_count):
        slot = skeleton.slots[joint]
        if slot >= 0:
            offsets[joint] = rotated(conjugate(own[slot]), offsets[joint])
            for child in skeleton.children[joint]:
                below = skeleton.slots[child]
                local[:, below] = multiply(
                    conjugate(own[slot]), multiply(motion.rotations[:, below], own[below])
                )
    return Motion.from_pose(replace(skeleton, offsets=offsets), local, motion.translations, motion.frame_time)
