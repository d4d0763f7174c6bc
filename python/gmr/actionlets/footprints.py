"""Which points of the feet of a figure stand on the ground, and where that is, seen from above."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.dofs import SIDES
from gmr.actionlets.figure import COLOURS, PATH, Figure

__all__ = ["plan", "standing"]

Floats = NDArray[np.float64]

_NEAR, _SLOW = 0.025, 0.45
"""Metres above the ground and metres a second within which a point of a foot stands."""


def standing(shown: Figure) -> dict[str, NDArray[np.bool_]]:
    """(F,) whether each point of the feet stands on the ground."""
    found = {}
    for side in SIDES:
        for point in ("heel", "ball"):
            places = shown.places[f"{side}_{point}"]
            speed = np.zeros(len(places))
            if len(places) > 1 and shown.frame_time > 0:
                speed = np.linalg.norm(np.gradient(places, shown.frame_time, axis=0), axis=-1)
            low = places[:, 1] - 0.013 * shown.height - shown.ground < _NEAR
            found[f"{side}_{point}"] = low & (speed < _SLOW)
    return found


def plan(
    shown: Figure,
    frames: NDArray[np.intp],
    feet_down: Mapping[str, NDArray[np.bool_]],
    width: float,
    largest: float,
) -> tuple[str, float]:
    """Path and feet from above, the way that the body faces first to the right; its height in pixels.

    Args:
        shown: F frames.
        frames: to mark.
        feet_down: see :func:`standing`.
        width: in pixels, at the most.
        largest: pixels in a metre, at the most.
    """
    facing = shown.facing[0]
    ahead, aside = np.array([np.sin(facing), np.cos(facing)]), np.array([np.cos(facing), -np.sin(facing)])

    def flat(places: Floats) -> Floats:
        level = places[:, [0, 2]] - shown.places["pelvis"][0, [0, 2]]
        return np.stack([level @ ahead, -(level @ aside)], axis=-1)

    path = flat(shown.places["pelvis"])
    feet = {name: flat(shown.places[name]) for name in feet_down}
    everything = np.concatenate([path, *feet.values()])
    low, high = everything.min(axis=0) - 0.06, everything.max(axis=0) + 0.06
    scale = min(largest, width / (high[0] - low[0]), 2.2 * largest / (high[1] - low[1]))

    def line(points: Floats) -> str:
        moved = (points - low) * scale
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in moved)

    every = max(1, len(path) // 200)
    parts = [f'<path d="{line(path[::every])}" fill="none" stroke="{PATH}" stroke-width="1.2"/>']
    for side in SIDES:
        on = feet_down[f"{side}_heel"] | feet_down[f"{side}_ball"]
        for begin, end in _runs(on):
            half = (begin + end) // 2
            both = np.stack([feet[f"{side}_heel"][half], feet[f"{side}_ball"][half]])
            parts.append(
                f'<path d="{line(both)}" stroke="{COLOURS[side]}" stroke-width="{0.05 * scale:.1f}" '
                'stroke-linecap="round"/>'
            )
    for frame in frames:
        x, y = (path[frame] - low) * scale
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="{PATH}"/>')
    return "".join(parts), float((high[1] - low[1]) * scale)


def _runs(on: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last frame of each time on the ground."""
    edges = np.diff(np.concatenate([[False], on, [False]]).astype(int))
    begins, ends = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    return [(int(a), int(b) - 1) for a, b in zip(begins, ends, strict=True)]
