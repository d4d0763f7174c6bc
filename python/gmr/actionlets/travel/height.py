"""The height of the pelvis: legs that stand on the ground hold it up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.leg import BENT, Law, leg_reach
from gmr.editing.easing import smooth_above, smooth_step

__all__ = ["carried_stiffly", "held_up", "kept_bend", "lowered", "passing", "room"]

Floats = NDArray[np.float64]

_EASED = 0.1
"""Seconds before and after a frame over which the height is averaged."""

_GOING = np.radians(8.0)
"""Radians of the knee's bend that a leg keeps while the body goes."""

_LANDING = np.radians(7.0)
_LANDING_MOST = np.radians(14.0)
"""Radians of that bend for each metre a second when the foot lands, and how many more that may be."""

_GOES = 0.4
"""Metres a second from which on a body goes."""

_GIVES_WAY = 0.16
"""Seconds before and after a leg is too short within which the pelvis gives way."""


def room(law: Law, hip: Floats, end: Floats, bend: Floats, length: Floats | None = None) -> Floats:
    """(n,) height of a pelvis whose leg, ``length`` long, ends at a place: by Pythagoras.

    Args:
        law: of the leg to that end.
        hip: (n, 3) the hip: x and z in the world, its height from the pelvis.
        end: (n, 3) where the leg ends, in the world.
        bend: (n,) radians of the knee at least.
        length: (n,) metres from hip to end; by default as far as the leg reaches.
    """
    most = leg_reach(law, bend)
    reach = most if length is None else np.minimum(length, most)
    aside = ((end[:, ::2] - hip[:, ::2]) ** 2).sum(axis=1)
    upright = np.sqrt(np.maximum(reach**2 - aside, (most / 5) ** 2))
    return np.asarray(end[:, 1] - hip[:, 1] + upright, np.float64)


def passing(root: Floats, fps: float) -> Floats:
    """(F,) metres a second at which a pelvis at (F, 3) places goes over the ground."""
    if len(root) < 2:
        return np.zeros(len(root))
    found: Floats = np.hypot(*np.gradient(root[:, ::2].T, axis=1)) * fps
    return found


def kept_bend(speed: Floats, stood: Floats) -> Floats:
    """(n,) radians by which the knee of a leg on the ground stays bent, the more the faster the hip passes.

    The bend changes by ``1 / (l sin(bend / 2))`` radians with each metre between hip and ankle, so a body
    that goes must not straighten a leg quite, least of all when it lands on it. One that stands may.

    Args:
        speed: (n,) of the pelvis, metres a second.
        stood: (n,) share of the stance that is over; 1 where the foot did not land.
    """
    landing = np.clip(_LANDING * speed - _GOING, 0, _LANDING_MOST) * smooth_step(1 - 2 * stood)
    return np.asarray(BENT + (_GOING - BENT + landing) * smooth_step(speed / _GOES), np.float64)


def held_up(heights: Floats, loads: Floats, fps: float) -> Floats:
    """(F,) height of the pelvis, from what each leg would hold it at.

    Args:
        heights: (F, L) metres, at which each leg keeps its nominal bend.
        loads: (F, L) share of each leg; 0 where the foot is in the air. Where all are, the height leads over.
        fps: frames a second.
    """
    total = loads.sum(axis=1)
    on = np.flatnonzero(total > 0)
    known = (heights[on] * loads[on]).sum(axis=1) / total[on]
    found = np.asarray(np.interp(np.arange(len(total)), on, known), np.float64)
    half = round(_EASED * fps)
    if half < 1:
        return found
    weights = np.hanning(2 * half + 3)[1:-1]
    padded = np.pad(found, half, mode="edge")
    return np.asarray(np.convolve(padded, weights / weights.sum(), mode="valid"), np.float64)


def carried_stiffly(heights: Floats, loads: Floats, stiff: Floats) -> Floats:
    """(F, L) heights of legs that hold the pelvis no lower than the stiff ones among them.

    Args:
        heights, loads: (F, L) as for :func:`held_up`.
        stiff: (F, L) 0 to 1: how far each leg holds the pelvis up whatever the others do.
    """
    total = loads.sum(axis=1, keepdims=True)
    mean = (heights * loads).sum(axis=1, keepdims=True) / np.where(total > 0, total, 1)
    most = np.max(stiff * np.where(loads > 0, heights - mean, 0), axis=1, keepdims=True)
    return np.broadcast_to(mean + np.maximum(most, 0), heights.shape)


def lowered(height: Floats, highest: Floats, fps: float) -> Floats:
    """(F,) a height that stays below ``highest`` (inf where anything goes), and gives way smoothly."""
    over = np.maximum(height - highest, 0)
    if not over.any():
        return height
    return height - smooth_above(over, max(round(_GIVES_WAY * fps), 2))
