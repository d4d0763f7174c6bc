"""A motion's rest pose, and the turns that lead to it from the default pose of H-Anim.

In the default pose a humanoid stands and faces +Z with its arms at its sides. Trunk, head and shoulder girdle
stand in it as the motion's do at rest, turned about the vertical; arms and legs hang straight down; feet
point forward. Each limb gets there by the shortest turn after that of the bone above, so that no twist is
added.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import UP_TURNS
from gmr.editing.scene import Scene
from gmr.errors import GmrError
from gmr.formats.hanim import FINGERS
from gmr.formats.x3d_parts import Stand
from gmr.motion import Motion
from gmr.quaternions import multiply, rotated
from gmr.skinning.driving.rest_poses import MotionRest, heading_turn, motion_rest, shortest_turn
from gmr.skinning.driving.standing_frame import standing_frame

__all__ = ["default_turns", "rest_of"]

Floats = NDArray[np.float64]

_DOWN, _FORWARD, _LEFT = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
_SIDES = ("left", "right")
_SAMPLES = 200
_FEW = 4096
"""Frames of the beginning in which a rest pose is looked for."""


def rest_of(
    motion: Motion, scene: Scene, begins: Mapping[str, int], frame: int | None
) -> tuple[MotionRest, str]:
    """The rest pose of a motion; the frame in which it stands most upright where it has none.

    Args:
        motion: at home.
        scene: its axes.
        begins: joints in which the parts of the body begin.
        frame: in which it rests; None: find it.

    Returns:
        The pose, and why it is no rest pose of the motion's own; "" where it is.
    """
    looked_at = motion[:_FEW]
    if frame is not None:
        return motion_rest(motion, begins, scene.up, frame), ""
    try:
        return motion_rest(looked_at, begins, scene.up, None), ""
    except GmrError:
        frame = _most_upright(motion, scene, begins)
        chosen = motion_rest(motion, begins, scene.up, frame)
        said = f"frame {frame}, in which the body stands most upright"
        return replace(
            chosen, said=said
        ), f"where nothing is turned no body stands; it is taken to rest in {said}"


def _most_upright(motion: Motion, scene: Scene, begins: Mapping[str, int]) -> int:
    step = max(1, motion.frame_count // _SAMPLES)
    places = rotated(np.array(UP_TURNS[scene.up]), motion[::step].positions(dtype=np.float64))
    return step * standing_frame(places, begins)


def default_turns(motion: Motion, rest: MotionRest, stands: Mapping[str, Stand]) -> dict[str, Floats]:
    """(4,) by H-Anim's names: the turn from the default pose to the rest pose, upright."""
    by_part: dict[str, str] = {}
    for name, stand in stands.items():
        by_part.setdefault(stand.part, name)
    facing = _facing(rest, stands, by_part)
    found = dict.fromkeys(stands, facing)

    def hang(part: str, ends: tuple[str, ...], before: Floats) -> Floats:
        if part not in by_part:
            return before
        way = _way(
            motion,
            rest,
            stands[by_part[part]],
            [stands[by_part[end]].joint for end in ends if end in by_part],
        )
        turn = multiply(shortest_turn(rotated(before, _DOWN), way), before) if np.any(way) else before
        found[by_part[part]] = turn
        return turn

    for side in _SIDES:
        for upper, lower, end in (("arm", "forearm", "hand"), ("up_leg", "leg", "foot")):
            turn = hang(f"{side}_{upper}", (f"{side}_{lower}", f"{side}_{end}"), facing)
            turn = hang(f"{side}_{lower}", (f"{side}_{end}",), turn)
            if end == "hand":
                turn = hang(f"{side}_hand", (f"{side}_middle", f"{side}_index"), turn)
        for name, stand in stands.items():
            if stand.part in [f"{side}_{finger}" for finger in FINGERS]:
                found[name] = _turn_of_hand(found, by_part, side, facing)
        if f"{side}_foot" in by_part:
            foot = stands[by_part[f"{side}_foot"]]
            toe = [stands[by_part[f"{side}_toe"]].joint] if f"{side}_toe" in by_part else []
            way = _way(motion, rest, foot, toe)
            turn = (
                multiply(heading_turn(rotated(facing, _FORWARD), way), facing)
                if np.any(way[[0, 2]])
                else facing
            )
            found |= {by_part[part]: turn for part in (f"{side}_foot", f"{side}_toe") if part in by_part}
    return found


def _turn_of_hand(
    found: Mapping[str, Floats], by_part: Mapping[str, str], side: str, facing: Floats
) -> Floats:
    """The turn of the lowest part of an arm that there is, which its fingers share."""
    known = [by_part[f"{side}_{part}"] for part in ("hand", "forearm", "arm") if f"{side}_{part}" in by_part]
    return found[known[0]] if known else facing


def _facing(rest: MotionRest, stands: Mapping[str, Stand], by_part: Mapping[str, str]) -> Floats:
    """(4,) turn about the vertical from +Z to where the body looks at rest, by its hips and shoulders."""
    left = np.zeros(3)
    for part in ("up_leg", "arm"):
        if all(f"{side}_{part}" in by_part for side in _SIDES):
            one, other = (rest.places[stands[by_part[f"{side}_{part}"]].joint] for side in _SIDES)
            level = (one - other) * np.array([1.0, 0.0, 1.0])
            left += level / max(float(np.linalg.norm(level)), 1e-12)
    return heading_turn(_LEFT, left)


def _way(motion: Motion, rest: MotionRest, stand: Stand, ends: list[int]) -> Floats:
    """(3,) where a bone points at rest: to the first of ``ends``, else to the farthest joint below it."""
    start = rest.places[stand.joint]
    if ends:
        return np.asarray(rest.places[ends[0]] - start, np.float64)
    ways = [rest.places[child] - start for child in motion.skeleton.children[stand.joint]]
    return np.asarray(max(ways, key=np.linalg.norm, default=np.zeros(3)), np.float64)
