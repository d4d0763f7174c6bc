"""The rest poses of a motion and of a character, and the turns that lay one on the other.

With ``G(t)`` the world rotation of a bone and ``G_0`` that at rest, a joint that follows it is turned from
its own rest by ``U G(t) G_0^-1 D^-1 A W``: ``D`` and ``U`` turn the world of the motion upright, at rest and
while it plays, ``W`` turns the character to face the motion's way, and ``A`` lays the character's bone on the
motion's. ``A`` is the shortest turn after that of the bone above, so that it adds no twist.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.body.measures import UP_TURNS, fault, up_axis
from gmr.editing.contacts import contacts
from gmr.errors import GmrError
from gmr.frames import Pose
from gmr.motion import Motion
from gmr.quaternions import IDENTITY, about, rotated
from gmr.skinning.driving.parts import LEG_PARTS
from gmr.tpose import leading_rest_frames

__all__ = [
    "MotionRest",
    "facing_turn",
    "heading_turn",
    "motion_rest",
    "shortest_turn",
    "with_flat_feet",
    "zero_places",
]

Floats = NDArray[np.float64]

_SIDES = ("left", "right")
_UPRIGHT = 0.7
"""Cosine of the lean beyond which neither trunk nor leg stands."""


@dataclass(frozen=True, eq=False)
class MotionRest:
    """The pose of a motion that the character's rest is laid on.

    Args:
        places: (J, 3) joints, file units, +Y up.
        rotations: (J, 4) world rotations of the bones (:meth:`Motion.bone_rotations`) in that pose.
        upright: (4,) turn that brings +Y up: ``D``.
        said: which pose it is, in words.
    """

    places: Floats
    rotations: Floats
    upright: Floats
    said: str


def zero_places(motion: Motion) -> Floats:
    """(J, 3) places of the joints at home where nothing turns; a joint without an offset that each frame
    moves is where it is in the middle of them."""
    pose = motion.pose
    offsets = motion.skeleton.offsets[pose.translated]
    translations = np.where(offsets.any(axis=1, keepdims=True), offsets, np.median(pose.translations, axis=0))
    still = np.tile(IDENTITY, (1, pose.rotations.shape[1], 1))
    zero = Pose(read_only(still), pose.translated, read_only(translations[None]))
    found = replace(motion, source=zero, dropped=None).positions(dtype=np.float64)[0]
    return np.asarray(found - found[motion.skeleton.roots[0]], np.float64)


def motion_rest(motion: Motion, begins: Mapping[str, int], up: str, frame: int | None) -> MotionRest:
    """The rest pose of a motion at home.

    It is the frame that is asked for, else the pose in which nothing is turned, else the T-pose that a
    converter put before the recording, whichever stands.

    Args:
        motion: at home.
        begins: its joints by part of the body, as far as they are known.
        up: its axis that points up.
        frame: in which it rests; None: find it.

    Raises:
        GmrError: there is no such frame, or none of the poses stands; the message says how to give one.
    """
    if frame is not None:
        if not -motion.frame_count <= frame < motion.frame_count:
            raise GmrError(f"rest={frame}: the motion has frames 0 to {motion.frame_count - 1}")
        chosen = _of_frame(motion, frame % motion.frame_count, up)
        return replace(chosen, said=f"frame {frame % motion.frame_count}, as stated")
    zero = zero_places(motion)
    roles = {part: begins[part] for part in LEG_PARTS if part in begins}
    if len(roles) < len(LEG_PARTS):
        still = np.tile(IDENTITY, (motion.skeleton.joint_count, 1))
        turn = np.array(UP_TURNS[up])
        return MotionRest(rotated(turn, zero), still, turn, "the pose in which nothing is turned")
    stands = np.array(UP_TURNS[up_axis(zero[None], roles)])
    upright = rotated(stands, zero)
    wrong = fault(motion.skeleton, upright[None], roles) or _askew(motion, upright, begins)
    if wrong is None:
        still = np.tile(IDENTITY, (motion.skeleton.joint_count, 1))
        return MotionRest(upright, still, stands, "the pose in which nothing is turned")
    if leading_rest_frames(motion):
        first = _of_frame(motion, 0, up)
        if fault(motion.skeleton, first.places[None], roles) is None:
            return replace(first, said="the T-pose before the first frame")
    raise GmrError(
        f"{motion.name or 'the motion'} has no rest pose: where nothing is turned, no body stands ({wrong}), "
        "so it cannot be laid on the character's. Say in which frame it stands upright, the nearer to a "
        "T-pose or to the character's rest the better: rest=0 in Python, gmr skin --rest 0"
    )


def _of_frame(motion: Motion, frame: int, up: str) -> MotionRest:
    one = motion[frame : frame + 1]
    turn = np.array(UP_TURNS[up])
    places = rotated(turn, one.positions(dtype=np.float64)[0])
    return MotionRest(places, one.bone_rotations(dtype=np.float64)[0], turn, f"frame {frame}")


def _askew(motion: Motion, places: Floats, begins: Mapping[str, int]) -> str | None:
    """What leans or hangs as in no body that stands, as the rest of a sentence."""
    called = {part: f"'{motion.skeleton.names[joint]}' ({part})" for part, joint in begins.items()}
    for above, below in (("head", "hips"), ("neck", "hips"), *((f"{s}_up_leg", f"{s}_foot") for s in _SIDES)):
        if above in begins:
            way = places[begins[above]] - places[begins[below]]
            if way[1] < _UPRIGHT * np.linalg.norm(way):
                return f"{called[above]} is not above {called[below]}"
    if all(f"{side}_arm" in begins for side in _SIDES):
        hips, arms = (
            places[begins[f"left_{part}"]] - places[begins[f"right_{part}"]] for part in ("up_leg", "arm")
        )
        if hips @ arms <= 0:
            return f"{called['left_arm']} is to the right of {called['right_arm']}"
    return None


def with_flat_feet(
    rest: MotionRest, motion: Motion, up: str, feet: Sequence[tuple[int, int | None, Sequence[int]]]
) -> MotionRest:
    """The rest pose with each foot as it is where it stands flattest, for few frames have both feet flat.

    That is the frame of its contacts in which the ankle is lowest above the ball; a foot without contacts
    stays as it is.

    Args:
        rest: a frame of the motion.
        motion: at home.
        up: its axis that points up.
        feet: (ankle, ball or None, joints whose bone rotations turn the foot) of each.
    """
    turn = np.array(UP_TURNS[up])
    places, rotations = rest.places.copy(), rest.rotations.copy()
    for ankle, ball, carriers in feet:
        if ball is None or not motion.frame_time:
            continue
        held = contacts(motion, [ball]).mask[:, 0]
        if held.any():
            way = rotated(turn, motion.positions(dtype=np.float64, joints=[ankle, ball]))
            flattest = int(np.where(held, way[:, 0, 1] - way[:, 1, 1], np.inf).argmin())
            there = motion[flattest : flattest + 1].bone_rotations(dtype=np.float64)[0]
            rotations[list(carriers)] = there[list(carriers)]
            places[ball] = places[ankle] + way[flattest, 1] - way[flattest, 0]
    return replace(rest, places=places, rotations=rotations)


def facing_turn(
    mine: Floats, theirs: Floats, pairs: Sequence[tuple[tuple[int, int], tuple[int, int]]]
) -> Floats:
    """(4,) turn about +Y after which a character faces the same way as a motion.

    Args:
        mine: (J, 3) the character's places at rest.
        theirs: (K, 3) the motion's.
        pairs: ((left, right) of the character, (left, right) of the motion): hips and shoulders.
    """
    if not pairs:
        return IDENTITY.copy()
    own = np.sum([_level(mine[left] - mine[right]) for (left, right), _ in pairs], axis=0)
    other = np.sum([_level(theirs[left] - theirs[right]) for _, (left, right) in pairs], axis=0)
    return heading_turn(own, other)


def heading_turn(one: Floats, other: Floats) -> Floats:
    """(4,) turn about +Y that brings the direction of one vector over that of another."""
    cross, dot = one[2] * other[0] - one[0] * other[2], one[0] * other[0] + one[2] * other[2]
    return about(np.array([0.0, 1.0, 0.0]), np.arctan2(cross, dot))


def _level(vector: Floats) -> Floats:
    """Its direction along the ground."""
    level = vector * np.array([1.0, 0.0, 1.0])
    size = np.linalg.norm(level)
    return np.asarray(level / size if size > 0 else level, np.float64)


def shortest_turn(one: Floats, other: Floats) -> Floats:
    """(..., 4) the shortest turn from the direction of one vector to that of another; none where either has
    no length, and a half turn about some axis at right angles where they are opposite."""
    sizes = np.linalg.norm(one, axis=-1, keepdims=True) * np.linalg.norm(other, axis=-1, keepdims=True)
    safe = np.where(sizes > 0, sizes, 1.0)
    real = 1 + (one * other).sum(axis=-1, keepdims=True) / safe
    found = np.concatenate([np.cross(one, other) / safe, real], axis=-1)
    aside = np.cross(one, np.eye(3)[np.abs(one).argmin(axis=-1)])
    half = np.concatenate([aside, np.zeros_like(real)], axis=-1)
    found = np.where(real > 1e-12, found, half)
    length = np.linalg.norm(found, axis=-1, keepdims=True)
    unit: Floats = np.where((sizes > 0) & (length > 0), found / np.where(length > 0, length, 1.0), IDENTITY)
    return unit
