"""How the segments of a body are turned in any motion: their world rotations since the anatomical posture.

The body is laid on the rest pose of the motion as a character is that the motion drives
(:mod:`gmr.skinning.driving`), so rest poses that differ are taken away; each segment then turns as the bone
that it follows. Knees and elbows are hinges: the thigh and the upper arm are turned about their own length so
that shin and forearm stay in the plane of the hinge. The part of that turn which a recording shows at large
flexion on the whole is its hinge's axis and holds in all frames; the rest of it fades out where the limb is
straight, for there the plane is not told.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.anatomy import Anatomy
from gmr.actionlets.body import Body
from gmr.actionlets.dofs import SIDES
from gmr.editing.contacts import contacts
from gmr.errors import ActionletError, GmrError
from gmr.quaternions import about, conjugate, from_matrices, multiply, rotated
from gmr.skinning.driving.alignment import Pairs, lay_on
from gmr.skinning.driving.body_parts import Body as Parts
from gmr.skinning.driving.body_parts import find_body
from gmr.skinning.driving.following import Following, follow
from gmr.skinning.driving.rest_poses import (
    MotionRest,
    facing_turn,
    motion_rest,
    shortest_turn,
)
from gmr.skinning.driving.standing_frame import standing_frame
from gmr.tpose import leading_rest_frames

__all__ = ["Turned", "turned_segments"]

Floats = NDArray[np.float64]

_DOWN, _UP = np.array([0.0, -1.0, 0.0]), np.array([0.0, 1.0, 0.0])
_FLATTEST = 0.25
"""Share of the frames of a foot on the ground in which it counts as flat: those with the lowest ankle."""
_HINGES = (("hip", "knee", "ankle", -1.0), ("shoulder", "elbow", "wrist", 1.0))
"""Joint, hinge and end of a limb; whether the hinge bends backward or forward."""
_TOLD = (np.sin(np.radians(12)), np.sin(np.radians(45)))
"""Sine of the flexion from which on, and from which on fully, a hinge's plane is told by the frame."""
_LITTLE = np.sin(np.radians(5))
"""Root mean square of that sine below which a recording does not tell its hinge's axis in full."""


@dataclass(frozen=True, eq=False)
class Turned:
    """The segments of a body in F frames.

    Args:
        world: (F, 4) by joint of the body: the rotation of what it turns, since the anatomical posture in
            which the body faces +Z.
        hinges: (F,) radians by hinge: knees and elbows, positive where they bend.
        rest: which pose of the motion was taken for its rest, in words.
    """

    world: Mapping[str, Floats]
    hinges: Mapping[str, Floats]
    rest: str


def turned_segments(body: Body, found: Anatomy, rest_frame: int | None = None) -> Turned:
    """World rotations of the segments of a body in a motion.

    Args:
        body: of any size; only its rest posture counts.
        found: the motion.
        rest_frame: in which the motion stands upright; None: its rest pose, else the frame that stands best.

    Raises:
        ActionletError: the motion does not show arms or trunk, or has no rest pose.
    """
    following = _following(body, found)
    resting = _resting(found, following, rest_frame)
    world = _world(body, found, following, resting)
    hinges: dict[str, Floats] = {}
    for side in SIDES:
        for top, hinge, end, sense in _HINGES:
            names = [f"{side}_{joint}" for joint in (top, hinge, end)]
            if all(name in found.joints for name in names):
                world[names[0]], hinges[names[1]] = _hinged(found, world[names[0]], names, sense)
    return Turned(world, hinges, resting.said)


def _following(body: Body, found: Anatomy) -> Following:
    mine = find_body(body.skeleton, body.rest)
    assert mine is not None
    parts = dict(mine.parts)
    head = found.parts["head"][0] if "head" in found.parts else None
    if head is not None and (found.by_ends or found.whole.skeleton.children[head]):
        # One joint for neck and head: it turns as the head does, where that turns.
        parts["head"] = parts.pop("neck")
    bodies = (Parts(parts, mine.found_by), Parts(found.parts, "parts"))
    try:
        return follow(body.skeleton, found.whole.skeleton, bodies, {}, by_ends=found.by_ends)
    except GmrError as error:
        raise ActionletError(f"{found.motion.name or 'the motion'}: {error}") from error


def _resting(found: Anatomy, following: Following, frame: int | None) -> MotionRest:
    whole, up = found.whole, found.scene.up
    try:
        rest = motion_rest(whole, following.begins, up, frame)
    except GmrError:
        if frame is not None:
            raise
        lead = leading_rest_frames(whole)
        standing = lead + standing_frame(found.all_places, following.begins)
        rest = motion_rest(whole, following.begins, up, standing)
    return rest


def _world(body: Body, found: Anatomy, following: Following, rest: MotionRest) -> dict[str, Floats]:
    pairs = Pairs(body.skeleton, found.whole.skeleton, following)
    joint_of = {part: joint for joint, part in following.parts.items()}
    sided = []
    for part in ("up_leg", "arm"):
        both = [joint_of.get(f"{side}_{part}") for side in SIDES]
        if None not in both:
            left, right = (int(joint or 0) for joint in both)
            sided.append(((left, right), (following.bones[left].start, following.bones[right].start)))
    facing = facing_turn(body.rest, rest.places, sided)
    laid = lay_on(pairs, body.rest, rest.places, facing)
    carriers = [bone.carrier for bone in following.bones.values()]
    turns = found.motion.bone_rotations(dtype=np.float64)[:, carriers]
    since = multiply(turns, conjugate(rest.rotations[carriers]))
    changes = multiply(found.upright, multiply(since, conjugate(rest.upright)))
    world = {}
    for k, joint in enumerate(following.bones):
        name = body.skeleton.names[joint]
        own = laid.turns[joint]
        if name.endswith("ankle"):
            own = _foot(found, rest, name, facing, changes[:, k])
        world[name] = multiply(changes[:, k], own)
    for name, led in _LIMBS.items():
        if name in world and {name, led} <= found.joints.keys():
            # Exactly along the limb, also where joints between bend.
            wanted = found.place(led) - found.place(name)
            world[name] = multiply(shortest_turn(rotated(world[name], _DOWN), wanted), world[name])
    return _completed(world, body)


_LIMBS = {
    f"{side}_{one}": f"{side}_{other}"
    for side in SIDES
    for one, other in (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
}


def _foot(found: Anatomy, rest: MotionRest, ankle: str, facing: Floats, changes: Floats) -> Floats:
    """(4,) turn that lays the foot on that of the rest pose, whose sole need not be level there.

    Which way is up in the foot is told by the frames in which it stands flat, else by the shin; where it
    points, by the ball of the foot at rest.
    """
    side = ankle.partition("_")[0]
    start, knee = found.joints[ankle], found.joints[f"{side}_knee"]
    below = found.whole.skeleton.children[start]
    ball = found.joints.get(f"{side}_ball", below[0] if below else start)
    way = rest.places[ball] - rest.places[start]
    if np.linalg.norm(way) < 0.02 * np.ptp(rest.places[:, 1]):
        return facing
    flat = _flat(found, start, ball)
    if flat.any():
        up = rotated(conjugate(changes[flat]), _UP).mean(axis=0)
    else:
        up = rest.places[knee] - rest.places[start]
        way = way * np.array([1.0, 0.0, 1.0])
        up = up - (up @ way) / (way @ way) * way
    up = up / np.linalg.norm(up)
    ahead = way - (way @ up) * up
    ahead = ahead / np.linalg.norm(ahead)
    return from_matrices(np.stack([np.cross(up, ahead), up, ahead], axis=-1))


def _flat(found: Anatomy, ankle: int, ball: int) -> NDArray[np.bool_]:
    """(F,) the frames in which a foot stands and its ankle is low above its ball."""
    if not found.motion.frame_time:
        return np.zeros(found.motion.frame_count, bool)
    held = contacts(found.motion, [ball]).mask[:, 0]
    if not held.any():
        return held
    above = found.all_places[:, ankle, 1] - found.all_places[:, ball, 1]
    return np.asarray(held & (above <= np.quantile(above[held], _FLATTEST)), np.bool_)


def _completed(world: dict[str, Floats], body: Body) -> dict[str, Floats]:
    """What the motion has no joint for goes along with the joint above."""
    skeleton = body.skeleton
    for joint in skeleton.parents_first:
        name, above = skeleton.names[joint], int(skeleton.parents[joint])
        if not skeleton.ends[joint] and name not in world:
            if above < 0:
                raise ActionletError(
                    "the motion has no joint that is known as hips, so nothing carries the body"
                )
            world[name] = world[skeleton.names[above]]
    return world


def _hinged(found: Anatomy, upper: Floats, names: list[str], sense: float) -> tuple[Floats, Floats]:
    """The upper segment of a limb turned about its length into the plane of its hinge, and the hinge's angle.

    With d the direction of the lower segment in the frame of the upper one, the hinge about X wants
    ``d = (0, -cos a, sense sin a)``.
    """
    lower = found.place(names[2]) - found.place(names[1])
    d = rotated(conjugate(upper), lower / np.linalg.norm(lower, axis=-1, keepdims=True))
    across, ahead = sense * d[:, 0], sense * d[:, 2]
    size = np.hypot(across, ahead)
    weight = size**2
    # The axis that the recording shows on the whole, then what is left in each frame.
    mean = np.arctan2((weight * across).sum(), (weight * ahead).sum())
    mean = mean * min(1.0, float(np.sqrt(weight.mean())) / _LITTLE)
    left = np.arctan2(
        across * np.cos(mean) - ahead * np.sin(mean), across * np.sin(mean) + ahead * np.cos(mean)
    )
    left = left - np.pi * np.round(left / np.pi)  # bent the other way is the same plane
    share = np.clip((size - _TOLD[0]) / (_TOLD[1] - _TOLD[0]), 0.0, 1.0)
    turn = mean + share**2 * (3 - 2 * share) * left
    bent = across * np.sin(turn) + ahead * np.cos(turn)
    return multiply(upper, about(_UP, turn)), np.arctan2(bent, -d[:, 1])
