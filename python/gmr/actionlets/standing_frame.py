"""The frame of a motion in which its body stands most like the anatomical posture."""

from __future__ import annotations

import numpy as np

from gmr.actionlets.anatomy import Anatomy
from gmr.actionlets.dofs import SIDES
from gmr.tpose import leading_rest_frames

__all__ = ["standing_frame"]


def standing_frame(found: Anatomy) -> int:
    """Index, in the whole motion, of the frame that stands best.

    Legs straight and upright, trunk upright over the hips, hips and shoulders parallel: the sum of what the
    cosines lack of 1.
    """
    up = np.array([0.0, 1.0, 0.0])
    lacking = np.zeros(found.motion.frame_count)
    for side in SIDES:
        hip, knee, ankle = (found.place(f"{side}_{joint}") for joint in ("hip", "knee", "ankle"))
        for one, other in ((hip, knee), (knee, ankle)):
            way = one - other
            lacking += 1 - way @ up / np.linalg.norm(way, axis=-1)
    across = [found.place("left_hip") - found.place("right_hip")]
    if {"left_shoulder", "right_shoulder"} <= found.joints.keys():
        left, right = found.place("left_shoulder"), found.place("right_shoulder")
        across.append(left - right)
        trunk = (left + right - found.place("left_hip") - found.place("right_hip")) / 2
        lacking += 1 - trunk @ up / np.linalg.norm(trunk, axis=-1)
        units = [way / np.linalg.norm(way, axis=-1, keepdims=True) for way in across]
        lacking += 1 - (units[0] * units[1]).sum(axis=-1)
    return leading_rest_frames(found.whole) + int(lacking.argmin())
