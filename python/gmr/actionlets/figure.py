"""The figure of a body as a film strip shows it: round-ended limbs of a plausible thickness.

Radii are shares of the figure's height, chosen by eye.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.anatomy import Anatomy, anatomy
from gmr.motion import Motion

__all__ = ["COLOURS", "INK", "LIMBS", "PAPER", "PATH", "Figure", "figure", "outline"]

Floats = NDArray[np.float64]

COLOURS = {"left": "#8fb8de", "right": "#1d4f8a", "": "#5b7088"}
"""Of the limbs, by their side."""
INK, PATH, PAPER = "#27313b", "#c4621f", "#ffffff"
"""Of letters and the ground, of the pelvis' path, and of what is behind."""

_ANKLE_OVER_BALL = np.arctan2(0.039, 0.0722)
"""Angle above the sole at which the ankle is seen from the ball of the foot."""
_BEHIND = 0.37
"""The heel is that much farther back than the ankle, in lengths of the foot from ankle to ball."""


@dataclass(frozen=True, slots=True)
class Limb:
    """A convex shape around points.

    Args:
        side: ``"left"``, ``"right"`` or ``""``.
        points: names of places, with a radius each.
    """

    side: str
    points: tuple[tuple[str, float], ...]


def _sided(side: str) -> list[Limb]:
    def limb(*points: tuple[str, float]) -> Limb:
        return Limb(side, tuple((f"{side}_{name}", radius) for name, radius in points))

    return [
        limb(("shoulder", 0.029), ("elbow", 0.021)),
        limb(("elbow", 0.021), ("wrist", 0.014)),
        limb(("wrist", 0.014), ("knuckle", 0.018), ("hand", 0.009)),
        limb(("hip", 0.047), ("knee", 0.031)),
        limb(("knee", 0.031), ("calf", 0.032), ("ankle", 0.019)),
        limb(("ankle", 0.019), ("heel", 0.013), ("ball", 0.013), ("toe", 0.008)),
    ]


_SHOULDERS = (("left_shoulder", 0.03), ("right_shoulder", 0.03))

LIMBS: tuple[Limb, ...] = (
    Limb("", (("left_hip", 0.05), ("right_hip", 0.05), ("left_waist", 0.045), ("right_waist", 0.045))),
    Limb("", (("left_waist", 0.045), ("right_waist", 0.045), ("chest", 0.062), *_SHOULDERS)),
    Limb("", (("neck", 0.028), ("chin", 0.03))),
    Limb("", (("chin", 0.042), ("crown", 0.05))),
    *_sided("left"),
    *_sided("right"),
)
"""All limbs of a figure."""


@dataclass(frozen=True, eq=False)
class Figure:
    """The places that limbs are drawn around.

    Args:
        places: (F, 3) metres, +Y up, by name.
        height: of the body, roughly, metres.
        facing: (F,) radians: which way it faces, 0 along +Z, positive to the left.
        ground: height of the ground.
        frame_time: seconds.
    """

    places: Mapping[str, Floats]
    height: float
    facing: Floats
    ground: float
    frame_time: float


def figure(motion: Motion) -> Figure:
    """The figure of a motion.

    Raises:
        ActionletError: its body or its unit is not known.
    """
    body = anatomy(motion)
    places = {name: body.place(name) for name in body.joints}
    legs = [
        np.linalg.norm(places[f"{side}_{one}"] - places[f"{side}_{other}"], axis=-1).mean()
        for side in ("left", "right")
        for one, other in (("hip", "knee"), ("knee", "ankle"))
    ]
    height = float(np.sum(legs)) / 2 / 0.491
    places |= _trunk(body, places, height)
    for side in ("left", "right"):
        places |= _arm(body, places, side) | _foot(body, places, side, height)
    across = places["left_hip"] - places["right_hip"]
    if "left_shoulder" in places and "right_shoulder" in places:
        across = across + places["left_shoulder"] - places["right_shoulder"]
    facing = np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))
    feet = [
        places[f"{side}_{point}"][:, 1] for side in ("left", "right") for point in ("heel", "ball", "toe")
    ]
    lowest = np.min(feet, axis=0)
    is_own = motion.skeleton.names[0] == "pelvis" and "left_ankle_end" in motion.skeleton.names
    ground = 0.0 if is_own else float(np.percentile(lowest, 10)) - 0.005 * height
    return Figure(places, height, facing, ground, body.motion.frame_time)


def outline(circles: Floats) -> Floats:
    """(N, 2) convex outline around circles (K, 3): x, y, radius."""
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    points = (circles[:, None, :2] + circles[:, None, 2:] * ring).reshape(-1, 2)
    return _hull(points)


def _hull(points: Floats) -> Floats:
    """Convex hull by Andrew's monotone chain, Inf. Proc. Lett. 9 (1979) 216."""
    ordered = points[np.lexsort((points[:, 1], points[:, 0]))].tolist()

    def half(chain: list[list[float]]) -> list[list[float]]:
        found: list[list[float]] = []
        for x, y in chain:
            while len(found) > 1:
                (ax, ay), (bx, by) = found[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                found.pop()
            found.append([x, y])
        return found[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _trunk(body: Anatomy, places: Mapping[str, Floats], height: float) -> dict[str, Floats]:
    hips = (places["left_hip"] + places["right_hip"]) / 2
    found = {"pelvis": hips}
    if "left_shoulder" in places and "right_shoulder" in places:
        shoulders = (places["left_shoulder"] + places["right_shoulder"]) / 2
    else:
        shoulders = places.get("neck", hips)
    neck = places.get("neck", shoulders)
    across = 0.5 * (places["left_hip"] - places["right_hip"])
    across = across * (0.035 * height / np.linalg.norm(across, axis=-1, keepdims=True))
    found["left_waist"] = hips + 0.3 * (shoulders - hips) + across
    found["right_waist"] = found["left_waist"] - 2 * across
    found["chest"] = hips + 0.72 * (shoulders - hips)
    found["neck"] = neck
    top = body.tip("neck") if "neck" in body.joints else shoulders + 0.5 * (shoulders - hips)
    way = top - neck
    length = np.linalg.norm(way, axis=-1, keepdims=True)
    way = way / np.where(length > 0, length, 1.0)
    # A measured neck may begin low between the shoulders, and its end may be the chin's.
    least = 0.175 * height - ((neck - shoulders) * way).sum(axis=-1, keepdims=True)
    top = neck + np.clip(length, least, np.maximum(least, 0.2 * height)) * way
    found["crown"], found["chin"] = top - 0.05 * height * way, top - 0.082 * height * way
    return found


def _arm(body: Anatomy, places: Mapping[str, Floats], side: str) -> dict[str, Floats]:
    wrist, elbow = places.get(f"{side}_wrist"), places.get(f"{side}_elbow")
    if wrist is None or elbow is None:
        return {}
    tip = body.tip(f"{side}_wrist")
    way = tip - wrist
    if not np.linalg.norm(way, axis=-1).max() > 0:
        way = 0.4 * (wrist - elbow)
    return {f"{side}_knuckle": wrist + 0.45 * way, f"{side}_hand": wrist + 0.95 * way}


def _foot(body: Anatomy, places: Mapping[str, Floats], side: str, height: float) -> dict[str, Floats]:
    ankle, knee = places[f"{side}_ankle"], places[f"{side}_knee"]
    tip = body.tip(f"{side}_ankle")
    found = {f"{side}_calf": knee + 0.3 * (ankle - knee)}
    if not np.linalg.norm(tip - ankle, axis=-1).max() > 0:
        return found | {f"{side}_{name}": ankle for name in ("heel", "ball", "toe")}
    toe = tip
    if f"{side}_ball" in places and np.linalg.norm(places[f"{side}_ball"] - ankle, axis=-1).mean() > 0.02:
        ball = places[f"{side}_ball"]
        found[f"{side}_ball"] = ball
        forward, reach, angle = ball - ankle, 1.0, _ANKLE_OVER_BALL
    else:
        # The tip of the toes lies farther out than the ball, and is seen flatter from the ankle.
        forward, reach, angle = tip - ankle, 1.0, np.arctan2(0.039, 0.1249)
    size = np.linalg.norm(forward, axis=-1, keepdims=True)
    ahead = forward / np.where(size > 0, size, 1.0)
    up = knee - ankle
    up = up - (up * ahead).sum(axis=-1, keepdims=True) * ahead
    up = up / np.maximum(np.linalg.norm(up, axis=-1, keepdims=True), 1e-12)
    sole = np.cos(angle) * ahead + np.sin(angle) * up  # along the sole, from heel to toes
    normal = np.cos(angle) * up - np.sin(angle) * ahead
    below = ankle - reach * np.sin(angle) * size * normal
    level = np.cos(angle) * size
    is_tip = f"{side}_ball" not in found
    ball_at, heel_at = (0.578, 0.217) if is_tip else (1.0, _BEHIND)
    radius = 0.013 * height * normal
    found[f"{side}_heel"] = below - heel_at * level * sole + radius
    found[f"{side}_ball"] = below + ball_at * level * sole + radius
    found[f"{side}_toe"] = toe + 0.008 * height * normal
    return found
