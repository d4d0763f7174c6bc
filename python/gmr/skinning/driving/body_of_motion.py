"""The body in a motion: its parts, by names or by shape, and what its joints are named for."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gmr.body.measures import UP_TURNS
from gmr.editing.roles import known_roles
from gmr.editing.scene import Scene
from gmr.motion import Motion
from gmr.quaternions import rotated
from gmr.skinning.driving.body_parts import Body, find_body
from gmr.skinning.driving.following import names_for_ends, with_stated
from gmr.skinning.driving.rest_poses import zero_places
from gmr.tpose import leading_rest_frames

__all__ = ["body_of_motion"]


def body_of_motion(motion: Motion, scene: Scene, stated: Mapping[str, str]) -> tuple[Body | None, bool]:
    """The body of a motion, and whether its joints are named for the bones that end in them."""
    lead = leading_rest_frames(motion)
    first = motion[lead : lead + 1].positions(dtype=np.float64)[0]
    upright = [rotated(np.array(UP_TURNS[scene.up]), pose) for pose in (zero_places(motion), first)]
    bodies = (find_body(motion.skeleton, pose) for pose in upright)
    body = next((one for one in bodies if one is not None), None)
    by_ends = motion.acclaim is not None
    if body is not None and not by_ends and body.found_by != "shape":
        by_ends = names_for_ends(motion.skeleton, body, known_roles(motion) or {})
    return with_stated(body, motion.skeleton, stated), by_ends
