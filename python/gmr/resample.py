"""A motion at another rate."""

from __future__ import annotations

import math
import numbers
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.errors import GmrError
from gmr.forest import changed_at_home
from gmr.frames import Pose

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["nominal_fps", "resample"]

_MOST_FRAMES = 10**8
"""More would be days of capture and not fit into memory; what asks for them is a slip of the pen."""

_PRINTED = 1e-4
"""How far a printed frame time may be from the rate that was meant: .0083333 is 120 fps, 0.0333 is not 30."""


def nominal_fps(motion: Motion) -> float:
    """Frames a second, as a whole number where the file's frame time is one that was cut off in print."""
    fps = motion.fps
    whole = round(fps) if math.isfinite(fps) else fps
    return float(whole) if abs(fps - whole) <= _PRINTED * fps else fps


def resample(motion: Motion, fps: float) -> Motion:
    """The motion at ``fps`` frames a second: rotations by slerp, translations linearly, both as at home.

    The first frame stays. The last one stays where it falls on a new frame; else the motion ends at the last
    new frame before it, for nothing is known after it. Where the old rate is a multiple of the new one,
    frames are taken as they are.

    Args:
        motion: any; a frame time cut off in print (.0083333) counts as the rate that was meant (120).
        fps: frames a second, above 0.

    Returns:
        A new motion; the same one where it has this rate already.

    Raises:
        GmrError: the rate is not above 0 or absurdly high, or the motion has a frame time of 0.
    """
    if not isinstance(fps, numbers.Real):
        raise TypeError(f"a rate is a number of frames a second, not {fps!r}")
    if not (math.isfinite(fps) and fps > 0):
        raise GmrError(f"a motion cannot be resampled to {fps} frames a second; give a rate above 0")
    if motion.frame_time == 0:
        raise GmrError(
            f"{motion.name or 'this motion'} has a frame time of 0, so it has no rate to resample from"
        )
    step = _step(motion, fps)
    if math.isclose(step, 1, rel_tol=1e-9):
        return motion
    if math.isclose(step, round(step), rel_tol=1e-9):
        return replace(motion[:: round(step)], frame_time=1 / fps)
    last = max(motion.frame_count - 1, 0)
    if last / step > _MOST_FRAMES:
        raise GmrError(
            f"{motion.name or 'this motion'} would have {last / step:.3g} frames at {fps:g} frames a second; "
            "give a lower rate"
        )
    count = math.floor(last / step * (1 + 1e-12)) + 1 if motion.frame_count else 0
    times = np.minimum(np.arange(count) * step, last)

    def between(one: Motion) -> Motion:
        dropped = None if one.dropped is None else one.dropped.without_rows()
        return replace(one, source=_interpolated(one.pose, times), frame_time=1 / fps, dropped=dropped)

    if motion.skeleton.home is None:
        return between(motion)
    # Between two frames each configuration would have rotations of its own; those of home are the motion's.
    return changed_at_home(motion, between, np.arange(motion.skeleton.joint_count))


def _step(motion: Motion, fps: float) -> float:
    """Old frames from a new one to the next; whole, or one part of a whole, where either rate makes it so."""
    steps = [motion.fps / fps, nominal_fps(motion) / fps]
    for step in steps:
        for ratio in (step, 1 / step):
            if math.isclose(ratio, round(ratio), rel_tol=1e-9):
                return step
    return steps[-1]


def _interpolated(pose: Pose, times: NDArray[np.float64]) -> Pose:
    """The pose at ``times``, in frames from 0 to the last."""
    before = np.minimum(times.astype(np.intp), max(len(pose) - 2, 0))
    after = np.minimum(before + 1, max(len(pose) - 1, 0))
    weight = (times - before)[:, None, None]
    start, end = pose.translations[before], pose.translations[after]
    layout = None if pose.layout is None else pose.layout.completed()
    rotations = np.asarray(_core.slerp_frames(pose.rotations, times))
    moves = start + weight * (end - start)
    return Pose(read_only(rotations), pose.translated, read_only(moves), layout, acclaim=pose.acclaim)
