"""What gives way where a leg is too short for a foot that is held: the heel lifts, or the hips sink."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.editing.easing import smooth_above
from gmr.editing.limbs import Limb
from gmr.frames import Pose
from gmr.motion import Motion
from gmr.quaternions import about, multiply, rotated
from gmr.skeleton import Skeleton
from gmr.tpose import leading_rest_frames

__all__ = ["HeldFoot", "lifted_heel", "lowered_hips"]

Floats = NDArray[np.float64]

_NEARLY_STRAIGHT = 0.995
"""Share of its length to which a leg may be straightened, unless it was straighter before. Beyond it a
millimetre turns the knee by ten degrees, which looks like a knee that snaps."""

_MOST_LIFT = np.radians(25)
"""By which a heel is lifted at most."""

_MOST_SINKING = 0.25
"""Share of a leg's length by which hips are lowered at most."""

_SINKING = 0.4
"""Seconds over which hips come down and rise again: the weight of a body does not jerk."""


@dataclass(frozen=True, eq=False, slots=True)
class HeldFoot:
    """A foot put where it is to stand.

    Args:
        limb: the leg.
        joint: the one that is held, the ankle or one below it.
        pivot: (F, 3) its place.
        end: (F, 3) place of the ankle.
        turn: (F, 4) turn in the world of what hangs on the ankle.
        toes: (F, 4) turn in the world of what hangs on the joint that is held.
    """

    limb: Limb
    joint: int
    pivot: Floats
    end: Floats
    turn: Floats
    toes: Floats

    def turns(self, skeleton: Skeleton) -> dict[int, Floats]:
        """The turns by joint, for :func:`gmr.editing.moved_roots`."""
        if self.joint == self.limb.end:
            return {self.joint: self.turn}
        below = [child for child in skeleton.children[self.joint] if skeleton.slots[child] >= 0]
        return {self.limb.end: self.turn, **dict.fromkeys(below, self.toes)}


def lifted_heel(motion: Motion, foot: HeldFoot, blend: int) -> tuple[HeldFoot, Floats]:
    """The foot turned about the ball, as far as the leg needs to reach its ankle; the toes stay as they are.

    In the triangle of the pivot, the ankle and the hip the leg's length gives the angle at the pivot by the
    law of cosines; the foot turns by what is lacking, up to 25 degrees, smoothed so that it never lacks.

    Returns:
        The foot, and (F,) the angle in radians by which it turned.
    """
    top, longest, _ = _leg(motion, foot.limb)
    to_end, to_top = foot.end - foot.pivot, top - foot.pivot
    a, b = _length(to_end), _length(to_top)
    is_short = (_length(foot.end - top) > longest * (1 + 1e-9)) & (a > 0) & (b > 0)
    sides = np.where(is_short, 2 * a * b, 1.0)
    angle = np.arccos(np.clip((to_end * to_top).sum(axis=1) / sides * 2, -1, 1))
    wanted = np.arccos(np.clip((a * a + b * b - longest * longest) / sides, -1, 1))
    lacking = np.where(is_short, np.clip(angle - wanted, 0, _MOST_LIFT), 0.0)
    lift = _smooth(motion, lacking, blend)
    normal = np.cross(to_end, to_top)
    size = _length(normal)[:, None]
    turn = about(normal / np.where(size > 0, size, 1.0), np.where(size[:, 0] > 0, lift, 0.0))
    lifted = replace(foot, end=foot.pivot + rotated(turn, to_end), turn=multiply(turn, foot.turn))
    return (lifted if lift.any() else foot), lift


def lowered_hips(
    loose: Motion, motion: Motion, feet: Sequence[HeldFoot], up: Floats
) -> tuple[Motion, Floats]:
    """The motion, its feet cut off, with the hips so much lower that the legs reach them.

    A hip that is ``h`` above its ankle and ``r`` beside it is lowered by ``h - sqrt(l^2 - r^2)`` where the
    leg's length ``l`` is too short, smoothed so that it never lacks.

    Returns:
        The motion, and (F,) by how much the hips were lowered, file units.
    """
    lacking = np.zeros(motion.frame_count)
    for foot in feet:
        top, longest, length = _leg(motion, foot.limb)
        apart = top - foot.end
        height = apart @ up
        beside = np.maximum((apart * apart).sum(axis=1) - height * height, 0)
        needed = height - np.sqrt(np.maximum(longest * longest - beside, 0))
        is_short = _length(apart) > longest * (1 + 1e-9)
        lacking = np.maximum(lacking, np.where(is_short, np.clip(needed, 0, _MOST_SINKING * length), 0))
    sunk = _smooth(motion, lacking, round(_SINKING * motion.fps) if motion.frame_time else 0)
    columns = {joint: k for k, joint in enumerate(loose.translated.tolist())}
    roots = {loose.skeleton.forest.root_of(foot.limb.top) for foot in feet}
    translations = loose.translations.copy()
    for root in roots:
        translations[:, columns[root]] -= sunk[:, None] * up
    pose = loose.pose
    source = Pose(pose.rotations, pose.translated, read_only(translations), pose.layout)
    return replace(loose, source=source), sunk


def _smooth(motion: Motion, lacking: Floats, width: int) -> Floats:
    """A smooth curve above what is lacking in the recording; 0 in what a converter put before it."""
    lead = leading_rest_frames(motion)
    return np.concatenate([np.zeros(lead), smooth_above(lacking[lead:], width)])


def _leg(motion: Motion, limb: Limb) -> tuple[Floats, Floats, Floats]:
    """Where a leg begins (F, 3), how long it may be made (F,), and how long it is when straight (F,)."""
    joints = motion.positions(dtype=np.float64, joints=[limb.top, limb.middle, limb.end])
    top, middle, end = np.moveaxis(joints, 1, 0)
    straight = _length(middle - top) + _length(end - middle)
    return top, np.maximum(_length(end - top), _NEARLY_STRAIGHT * straight), straight


def _length(vectors: Floats) -> Floats:
    return np.asarray(np.linalg.norm(vectors, axis=-1), np.float64)
