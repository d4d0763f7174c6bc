"""A motion on the skeleton of another one: that skeleton is a character without a mesh, and is driven.

So both directions meet: what a character takes over from a motion, a dataset's skeleton takes over from what
was recorded, or synthesised, on another body. See :mod:`gmr.skinning.driving.drive_character`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.body.measures import UP_TURNS
from gmr.editing.scene import Scene, scene_of
from gmr.errors import GmrError, SkeletonError
from gmr.forest import home
from gmr.motion import Motion
from gmr.quaternions import IDENTITY, about, conjugate, from_matrices, multiply, rotated
from gmr.skinning.character import Character
from gmr.skinning.driving.body_of_motion import body_of_motion
from gmr.skinning.driving.body_parts import Body
from gmr.skinning.driving.drive_character import drive
from gmr.skinning.driving.driven import Driven, DrivingReport
from gmr.skinning.driving.following import Names
from gmr.skinning.driving.rest_poses import MotionRest, motion_rest, with_flat_feet
from gmr.skinning.driving.standing_frame import standing_frame
from gmr.skinning.nodes import Nodes
from gmr.skinning.transforms import continuous

__all__ = ["Retargeted", "retarget"]

Floats = NDArray[np.float64]

_STAYS = 0.05
"""Metres within which a joint above the hips stays where it is while the body goes away."""

_RESTING = 0.1
"""Quantile of the heights of the lower foot that counts as its height on the ground."""

_SMOOTHED = (0.5, 1.0)
"""Seconds over which the place and the heading of a root on the ground are smoothed."""


@dataclass(frozen=True, eq=False)
class Retargeted:
    """A motion on another skeleton, and how it was laid on it."""

    motion: Motion
    report: DrivingReport


def retarget(
    motion: Motion,
    like: Motion,
    *,
    names: Names | None = None,
    fps: float | None = None,
    root_scale: float | None = None,
    ground: bool = True,
    rest: int | None = None,
    like_rest: int | None = None,
) -> Retargeted:
    """What a motion does, on the skeleton, in the unit and with the up axis of another.

    Args:
        motion: F frames; see :func:`gmr.skinning.drive` for this and what is not told here.
        like: whose skeleton it is to have; its own poses say no more than where its joints rest.
        names: who follows whom, where names and shape do not tell: joint of ``like`` -> joint of ``motion``.
        fps: frames a second of the answer; the motion's where left out.
        root_scale: metres to go for a metre of the motion; the ratio of the legs' lengths where left out.
        ground: set the feet on the ground.
        rest: the frame in which ``motion`` stands, where it has no rest pose.
        like_rest: the frame in which ``like`` does.

    Returns:
        F frames with the names, parents and slots of ``like``; joints above the hips stay where they are
        in ``like``, or go along on the ground below the hips where they do so there.

    Raises:
        SkeletonError: siblings of ``like`` turn apart from each other, or nothing is matched.
        GmrError: one of the two has no rest pose, or poses that are not known.
    """
    at_home = home(like)
    scene = scene_of(at_home)
    stand = _stand(at_home, scene, like_rest)
    character = _without_mesh(at_home, scene, stand)
    driven = drive(motion, character, names=names, fps=fps, root_scale=root_scale, ground=ground, rest=rest)
    placed = _placed(driven, at_home, scene, stand)
    made = Motion.from_pose(
        at_home.skeleton,
        continuous(_local(placed.turns, at_home)),
        _translations(placed, at_home),
        driven.frame_time,
        translated=at_home.translated,
        layout=at_home.layout,
        unit=scene.unit.metres if like.unit is None else like.unit,
        name=motion.name,
    )
    return Retargeted(made, driven.report)


@dataclass(frozen=True, eq=False)
class _Stand:
    """How the skeleton rests: the body in it, the pose, and the frame of each joint in that pose."""

    body: Body
    rest: MotionRest
    frames: Floats
    """(J, 4) world frame of each joint (:meth:`Motion.joint_rotations`)."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """World frames (F, J, 4) and places (F, J, 3) of the joints of ``like``, in its unit and its axes."""

    turns: Floats
    places: Floats


def _stand(like: Motion, scene: Scene, frame: int | None) -> _Stand:
    body, _ = body_of_motion(like, scene, {})
    if body is None:
        raise SkeletonError(
            f"no body is found in the skeleton of {like.name or 'the motion'}; nothing can be laid on it"
        )
    begins = {part: joints[0] for part, joints in body.parts.items()}
    try:
        rest = motion_rest(like, begins, scene.up, frame)
    except GmrError:
        if frame is not None:
            raise
        upright = rotated(np.array(UP_TURNS[scene.up]), like.positions(dtype=np.float64))
        rest = motion_rest(like, begins, scene.up, standing_frame(upright, begins))
    if "frame" in rest.said:
        rest = with_flat_feet(rest, like, scene.up, _feet(like, body))
    # A joint's frame is that of its children's bones.
    carriers = np.arange(like.skeleton.joint_count)
    for joint, children in enumerate(like.skeleton.children):
        carriers[joint] = children[0] if children else joint
    on_ground = rest.places + np.array([0.0, _floor(like, scene, body) - _lowest(rest.places, body), 0.0])
    return _Stand(body, replace(rest, places=on_ground), rest.rotations[carriers])


def _floor(like: Motion, scene: Scene, body: Body) -> float:
    """How high the lowest joint of the feet is where ``like`` stands on its ground."""
    upright = rotated(np.array(UP_TURNS[scene.up]), like.positions(dtype=np.float64))
    return float(np.quantile(_lowest(upright, body), _RESTING))


def _lowest(places: Floats, body: Body) -> Floats:
    """The height of the lowest joint of the feet in (..., J, 3) upright places."""
    parts = (f"{side}_{part}" for side in ("left", "right") for part in ("foot", "toe"))
    feet = [body.parts[part][0] for part in parts if part in body.parts]
    return np.asarray(places[..., feet, 1].min(axis=-1), np.float64)


def _feet(like: Motion, body: Body) -> list[tuple[int, int | None, list[int]]]:
    """(ankle, ball or None, joints whose bones turn as the foot does) of each foot."""
    children = like.skeleton.children
    found: list[tuple[int, int | None, list[int]]] = []
    for side in ("left", "right"):
        ankle, ball = body.parts[f"{side}_foot"][0], body.one(f"{side}_toe")
        below = [] if ball is None else list(children[ball])
        found.append((ankle, ball, [*children[ankle], *below]))
    return found


def _without_mesh(like: Motion, scene: Scene, stand: _Stand) -> Character:
    """A character whose joints rest where those of ``like`` stand, none of them turned; ends are left out."""
    proper = _proper(like)
    place = {joint: k for k, joint in enumerate(proper.tolist())}
    parents = np.array([place.get(int(parent), -1) for parent in like.skeleton.parents[proper]], np.int32)
    places = stand.rest.places[proper] * (scene.unit.metres or 1.0)
    return Character(
        like.name or "skeleton",
        Nodes(
            tuple(like.skeleton.names[joint] for joint in proper),
            parents,
            places - np.where(parents[:, None] >= 0, places[parents], 0.0),
            np.tile(IDENTITY, (len(proper), 1)),
            np.ones((len(proper), 3)),
        ),
        np.arange(len(proper), dtype=np.int32),
        (),
    )


def _proper(like: Motion) -> NDArray[np.intp]:
    return np.flatnonzero(like.skeleton.ends == 0)


def _placed(driven: Driven, like: Motion, scene: Scene, stand: _Stand) -> _Placed:
    """Where the joints of ``like`` are: a joint is turned in the world by ``U^-1 M D G_0``.

    ``M`` is its turn from rest, ``D`` and ``U`` turn ``like`` upright at rest and while it plays, and ``G_0``
    is its frame at rest.
    """
    proper = _proper(like)
    down = conjugate(np.array(UP_TURNS[scene.up]))
    turns = np.tile(IDENTITY, (len(driven.poses), like.skeleton.joint_count, 1))
    places = np.zeros((*turns.shape[:2], 3))
    from_rest = multiply(multiply(down, from_matrices(driven.poses[..., :3, :3])), stand.rest.upright)
    turns[:, proper] = multiply(from_rest, stand.frames[proper])
    places[:, proper] = rotated(down, driven.poses[..., :3, 3]) / (scene.unit.metres or 1.0)
    for joint in _above_hips(like, stand.body):
        turns[:, joint], places[:, joint] = _carried_root(joint, places, driven, like, scene, stand.body)
    return _Placed(turns, places)


def _above_hips(like: Motion, body: Body) -> list[int]:
    found, joint = [], body.parts["hips"][0]
    while (joint := int(like.skeleton.parents[joint])) >= 0:
        found.append(joint)
    return found


def _carried_root(
    joint: int, places: Floats, driven: Driven, like: Motion, scene: Scene, body: Body
) -> tuple[Floats, Floats]:
    """Frames and places of a joint above the hips: where it is in ``like`` if it stays there, else on the
    ground with the body, as the simulation root of a motion database goes."""
    first = like.positions(dtype=np.float64, joints=[joint])[:, 0]
    frame = like[:1].joint_rotations(dtype=np.float64)[0, joint]
    count = len(places)
    if np.ptp(first, axis=0).max() * (scene.unit.metres or 1.0) < _STAYS:
        return np.tile(frame, (count, 1)), np.tile(first[0], (count, 1))
    upright = np.array(UP_TURNS[scene.up])
    own = rotated(upright, like.positions(dtype=np.float64))
    new = rotated(upright, places)
    (ground, heading), (_, was) = (
        _simulation_root(p, t, body) for p, t in ((new, driven.frame_time), (own, like.frame_time))
    )
    turn = about(np.array([0.0, 1.0, 0.0]), heading - was[0])
    height = np.full(count, rotated(upright, first)[:, 1].mean())
    down = conjugate(upright)
    on_ground = np.stack([ground[:, 0], height, ground[:, 1]], axis=1)
    return multiply(multiply(down, turn), multiply(upright, frame)), rotated(down, on_ground)


def _simulation_root(places: Floats, frame_time: float, body: Body) -> tuple[Floats, Floats]:
    """(F, 2) x and z, and (F,) heading, of upright places, smoothed as matching does."""
    pairs = [
        (body.parts[f"left_{part}"][0], body.parts[f"right_{part}"][0])
        for part in ("up_leg", "arm")
        if f"left_{part}" in body.parts and f"right_{part}" in body.parts
    ]
    windows = [round(seconds / frame_time) | 1 for seconds in _SMOOTHED]
    ground, heading = _core.simulation_root(
        np.ascontiguousarray(places, np.float32), body.parts["hips"][0], pairs, *windows
    )
    return ground, heading


def _local(turns: Floats, like: Motion) -> Floats:
    """(F, S, 4) each slot's rotation in the frame of the slot above, of (F, J, 4) frames in the world."""
    skeleton = like.skeleton
    found = np.tile(IDENTITY, (len(turns), skeleton.slot_count, 1))
    for joint, slot in enumerate(skeleton.frame_slots.tolist()):
        if skeleton.ends[joint] or slot < 0:
            continue
        parent = int(skeleton.parents[joint])
        found[:, slot] = turns[:, joint]
        if parent >= 0:
            found[:, slot] = multiply(conjugate(turns[:, parent]), turns[:, joint])
    return found


def _translations(placed: _Placed, like: Motion) -> Floats:
    """(F, T, 3) of ``like``'s translated joints: roots in the world, others their bone in its own frame."""
    skeleton = like.skeleton
    turns, places = placed.turns, placed.places
    found = np.empty((len(turns), len(like.translated), 3))
    for place, joint in enumerate(like.translated.tolist()):
        parent = int(skeleton.parents[joint])
        found[:, place] = places[:, joint]
        if skeleton.ends[joint]:
            found[:, place] = skeleton.offsets[joint]
        elif parent >= 0:
            bone = places[:, joint] - places[:, parent]
            found[:, place] = rotated(conjugate(turns[:, parent]), bone)
    return found
