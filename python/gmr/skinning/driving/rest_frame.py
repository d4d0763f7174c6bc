"""The frame that stands in for the rest pose of a motion that has none, where nobody can be asked for one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import UP_TURNS, fault
from gmr.editing.scene import scene_of
from gmr.errors import GmrError
from gmr.forest import home
from gmr.motion import Motion
from gmr.quaternions import rotated
from gmr.skeleton import Skeleton
from gmr.skinning.driving.body_of_motion import body_of_motion
from gmr.skinning.driving.parts import LEG_PARTS
from gmr.skinning.driving.rest_poses import motion_rest
from gmr.skinning.driving.standing_frame import standing_frame

__all__ = ["rest_frame"]

_LOOKED_AT = 200
"""Frames of a motion that are looked at, evenly spaced."""


def rest_frame(motion: Motion) -> int | None:
    """The frame in which a motion stands best, where it has no rest pose of its own.

    Bones are laid on others by their directions, which are the motion's whatever pose it rests in; only how
    far they are twisted about themselves depends on it.

    Returns:
        None where the motion has a rest pose, or no body is found in it.

    Raises:
        GmrError: it has none, and stands in no frame either.
    """
    at_home = home(motion)
    scene = scene_of(at_home)
    body, _ = body_of_motion(at_home, scene, {})
    if body is None:
        return None
    begins = {part: joints[0] for part, joints in body.parts.items()}
    try:
        motion_rest(at_home, begins, scene.up, None)
    except GmrError:
        upright = rotated(np.array(UP_TURNS[scene.up]), at_home.positions(dtype=np.float64))
        if (frame := _standing(at_home.skeleton, upright, begins)) is not None:
            return frame
        raise GmrError(
            f"{motion.name or 'the motion'} has no rest pose, and its body stands in no frame. Lay it on the "
            "skeleton yourself, in Python: gmr.skinning.retarget(motion, like, rest=FRAME)"
        ) from None
    return None


def _standing(skeleton: Skeleton, upright: NDArray[np.float64], begins: Mapping[str, int]) -> int | None:
    """The frame that stands best of those in which nothing contradicts that a body stands: in a run, feet
    point backward now and then."""
    roles = {part: begins[part] for part in LEG_PARTS if part in begins}
    frames = np.arange(0, len(upright), max(1, len(upright) // _LOOKED_AT))
    sound = [frame for frame in frames if fault(skeleton, upright[frame : frame + 1], roles) is None]
    return int(sound[standing_frame(upright[sound], begins)]) if sound else None
