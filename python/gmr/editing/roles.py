"""Which joints of a motion are its hips, legs, feet and shoulders, as names and poses tell together.

Poses are asked too because a name can mean two things: ``lfemur`` is a hip where a joint is named for the
bone that begins in it, and a knee where it is named for the one that ends in it, as in ASF.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gmr.body.joints import find_joints
from gmr.errors import DatasetError
from gmr.motion import Motion
from gmr.tpose import leading_rest_frames

__all__ = ["body_roles", "known_roles"]

_SAMPLES = 200
"""Frames that are looked at."""


def body_roles(motion: Motion, names: Mapping[str, str | int] | None = None) -> Mapping[str, int]:
    """The joints of the body by role, at home; see :mod:`gmr.body.joints`.

    Args:
        motion: any; poses that are not known (NaN) are not looked at.
        names: joints by role, where they are not found by their names.

    Raises:
        DatasetError: they are not found.
    """
    sampled = motion[leading_rest_frames(motion) :]
    poses = sampled[:: max(1, sampled.frame_count // _SAMPLES)].positions(dtype=np.float64)
    poses = poses[np.isfinite(poses).all(axis=(1, 2))]
    skeleton = motion.skeleton if motion.skeleton.home is None else motion.skeleton.home
    return find_joints(skeleton, poses, names).roles


def known_roles(motion: Motion) -> Mapping[str, int] | None:
    """As :func:`body_roles`; None where they are not found, so that names have to do."""
    try:
        return body_roles(motion)
    except DatasetError:
        return None
