"""Where the joints of a body are in any motion: its parts are found by names or by shape."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import UP_TURNS
from gmr.editing.scene import Scene, scene_of
from gmr.errors import ActionletError
from gmr.forest import home
from gmr.listing import quoted
from gmr.motion import Motion
from gmr.quaternions import rotated
from gmr.skeleton import Skeleton
from gmr.skinning.driving.body_of_motion import body_of_motion
from gmr.tpose import leading_rest_frames

__all__ = ["PARTS", "Anatomy", "anatomy"]

Floats = NDArray[np.float64]

PARTS: Mapping[str, str] = {
    "pelvis": "hips",
    "waist": "spine",
    "neck": "neck",
    **{
        f"{side}_{joint}": f"{side}_{part}"
        for side in ("left", "right")
        for joint, part in (
            ("shoulder", "arm"),
            ("elbow", "forearm"),
            ("wrist", "hand"),
            ("hip", "up_leg"),
            ("knee", "leg"),
            ("ankle", "foot"),
            ("ball", "toe"),
        )
    },
}
"""Joints of gmr's body and the parts of any body that begin in them."""

_NEEDED = tuple(joint for joint in PARTS if joint.partition("_")[2] in ("hip", "knee", "ankle"))


@dataclass(frozen=True, eq=False)
class Anatomy:
    """A motion whose parts of the body are known.

    Args:
        motion: at home, without the T-pose that a converter put before it.
        whole: the same with it.
        scene: its unit and up.
        joints: index of the motion's joint that is each of the body's, keys of :data:`PARTS`, where found.
        by_ends: the motion's joints are named for the bones that end in them.
        parts: joints by part of the body, as they are named.
    """

    motion: Motion
    whole: Motion
    scene: Scene
    joints: Mapping[str, int]
    by_ends: bool
    parts: Mapping[str, tuple[int, ...]]

    @property
    def metres(self) -> float:
        """Metres in a unit of the motion.

        Raises:
            ActionletError: neither the file nor the body tells.
        """
        metres = self.scene.unit.metres
        if metres is None:
            raise ActionletError(
                f"{self.motion.name or 'the motion'} does not say how long its unit is, and its body does "
                "not tell; declare it: motion.with_unit('cm')"
            )
        return metres

    @property
    def upright(self) -> Floats:
        """(4,) turn that brings +Y up."""
        return np.array(UP_TURNS[self.scene.up])

    @cached_property
    def all_places(self) -> Floats:
        """(F, J, 3) world places of the motion's joints, metres, +Y up."""
        return rotated(self.upright, self.motion.positions(dtype=np.float64)) * self.metres

    def place(self, joint: str) -> Floats:
        """(F, 3) of a joint of the body."""
        return self.all_places[:, self.joints[joint]]

    def tip(self, joint: str) -> Floats:
        """(F, 3) of the farthest end below a joint of the body; the joint's own without one."""
        start, named = self.joints[joint], self.parts[PARTS[joint]][0]
        below = [named, *_below(self.motion.skeleton, named)]
        away = np.linalg.norm(self.all_places[0, below] - self.all_places[0, start], axis=-1)
        return self.all_places[:, below[int(away.argmax())]]


def anatomy(motion: Motion) -> Anatomy:
    """The parts of the body in a motion.

    Raises:
        ActionletError: hips, knees or ankles are not found, or the motion has no frames.
    """
    if not motion.frame_count:
        raise ActionletError(f"{motion.name or 'the motion'} has no frames, so it shows no body")
    whole = home(motion)
    scene = scene_of(whole)
    body, by_ends = body_of_motion(whole, scene, {})
    parts: Mapping[str, tuple[int, ...]] = {} if body is None else body.parts
    skeleton = whole.skeleton
    joints = {
        joint: _begin(skeleton, parts[part][0], by_ends) for joint, part in PARTS.items() if part in parts
    }
    lacking = [joint for joint in _NEEDED if joint not in joints]
    if lacking:
        raise ActionletError(
            f"{motion.name or 'the motion'} has no joint that is known as {lacking[0].replace('_', ' ')}; "
            f"its joints are {quoted(skeleton.names, 40)}. Rename them as a skeleton that gmr knows does"
        )
    return Anatomy(whole[leading_rest_frames(whole) :], whole, scene, joints, by_ends, parts)


def _begin(skeleton: Skeleton, joint: int, by_ends: bool) -> int:
    above = int(skeleton.parents[joint])
    return above if by_ends and above >= 0 else joint


def _below(skeleton: Skeleton, joint: int) -> list[int]:
    found = [joint]
    for one in found:  # grows while it is walked
        found.extend(skeleton.children[one])
    return found[1:]
