"""Made-up bodies that walk on arcs of known speed and turn rate, with joints named by any convention."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gmr.motion import Motion
from gmr.quaternions import multiply
from gmr.skeleton import Skeleton

CMU = {
    "hips": "Hips", "spine": "Spine", "head": "Head",
    "left_up_leg": "LeftUpLeg", "left_knee": "LeftLeg", "left_foot": "LeftFoot", "left_toe": "LeftToeBase",
    "right_up_leg": "RightUpLeg", "right_knee": "RightLeg", "right_foot": "RightFoot",
    "right_toe": "RightToeBase", "left_shoulder": "LeftArm", "left_hand": "LeftHand",
    "right_shoulder": "RightArm", "right_hand": "RightHand",
}  # fmt: skip
"""Names by part, in the order of the joints."""

_PARENTS = {
    "hips": None, "spine": "hips", "head": "spine",
    "left_up_leg": "hips", "left_knee": "left_up_leg", "left_foot": "left_knee", "left_toe": "left_foot",
    "right_up_leg": "hips", "right_knee": "right_up_leg", "right_foot": "right_knee",
    "right_toe": "right_foot", "left_shoulder": "spine", "left_hand": "left_shoulder",
    "right_shoulder": "spine", "right_hand": "right_shoulder",
}  # fmt: skip

_OFFSETS = {
    "hips": (0, 0.9, 0), "spine": (0, 0.25, 0), "head": (0, 0.45, 0),
    "left_up_leg": (0.1, -0.05, 0), "left_knee": (0, -0.4, 0), "left_foot": (0, -0.4, 0),
    "left_toe": (0, -0.05, 0.15), "left_shoulder": (0.18, 0.25, 0), "left_hand": (0, -0.5, 0),
}  # fmt: skip

HIPS_HEIGHT = 0.9


def body(names: Mapping[str, str] = CMU, scale: float = 1.0) -> Skeleton:
    """The skeleton of a walker, 0.8 m of leg times ``scale``."""
    parts = list(_PARENTS)
    offsets = [
        np.array(_OFFSETS[part.replace("right", "left")]) * (-1 if part.startswith("right") else 1, 1, 1)
        for part in parts
    ]
    parents = [-1 if above is None else parts.index(above) for above in _PARENTS.values()]
    labels = [names[part] for part in parts]
    return Skeleton.post_rotation(labels, parents, np.array(offsets) * scale, turning=range(len(parts)))


def walker(
    seconds: float = 3.0,
    speed: float = 1.2,
    turn_rate: float = 0.0,
    *,
    heading: float = 0.0,
    start: tuple[float, float] = (0.0, 0.0),
    fps: float = 60.0,
    scale: float = 1.0,
    swing: float = 0.5,
    drift: float = 0.0,
    names: Mapping[str, str] = CMU,
    name: str | None = None,
    unit: float | None = 1.0,
) -> Motion:
    """A body that goes at ``speed`` (m/s) and turns at ``turn_rate`` (rad/s, positive to the left).

    Its hips are on the path exactly and face along it, or go ``drift`` radians to the left of where they
    face; legs and arms swing, the left leg ahead at first.
    """
    skeleton = body(names, scale)
    t = np.arange(round(seconds * fps) + 1) / fps
    facing = heading + turn_rate * t
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (len(t), skeleton.slot_count, 1))
    rotations[:, 0] = about_y(facing)
    for side, phase in (("left", 0.0), ("right", np.pi)):
        forward = swing * np.sin(2 * np.pi * 0.9 * t + phase + 0.6)
        rotations[:, list(_PARENTS).index(f"{side}_up_leg")] = _about_x(-forward)
        rotations[:, list(_PARENTS).index(f"{side}_knee")] = _about_x(0.3 * swing * (1 + np.cos(forward)))
        rotations[:, list(_PARENTS).index(f"{side}_shoulder")] = _about_x(0.6 * forward)
    ground = arc(t, speed, turn_rate, heading + drift) + start
    hips = np.stack([ground[:, 0], np.full(len(t), HIPS_HEIGHT), ground[:, 1]], axis=1) * scale
    return Motion.from_pose(skeleton, rotations, hips[:, None], 1 / fps, unit=unit, name=name)


def arc(t: NDArray[np.float64], speed: float, turn_rate: float, heading: float) -> NDArray[np.float64]:
    """(F, 2) x and z on a path of constant speed and turn rate from the origin."""
    half = turn_rate * t / 2
    chord = speed * t * np.sinc(half / np.pi)
    return np.stack([chord * np.sin(heading + half), chord * np.cos(heading + half)], axis=1)


def placed(motion: Motion, turn: float, shift: tuple[float, float]) -> Motion:
    """The motion in a world that is turned about the vertical and moved along the ground."""
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[:, 0] = multiply(about_y(np.array(turn)), rotations[:, 0])
    x, z = translations[:, 0, 0].copy(), translations[:, 0, 2].copy()
    translations[:, 0, 0] = np.cos(turn) * x + np.sin(turn) * z + shift[0]
    translations[:, 0, 2] = -np.sin(turn) * x + np.cos(turn) * z + shift[1]
    return Motion.from_pose(
        motion.skeleton, rotations, translations, motion.frame_time, unit=motion.unit, name=motion.name
    )


def about_y(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 4) quaternions that turn the heading by ``angle``."""
    half = np.asarray(angle) / 2
    return np.stack([np.zeros_like(half), np.sin(half), np.zeros_like(half), np.cos(half)], axis=-1)


def _about_x(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    half = angle / 2
    return np.stack([np.sin(half), np.zeros_like(half), np.zeros_like(half), np.cos(half)], axis=-1)
