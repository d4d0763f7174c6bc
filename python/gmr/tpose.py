"""The T-pose that some converters put before the first frame of a take.

It is a jump of the whole body within one frame: comparing, decomposing and evaluating leave it out, and say
so.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.channels import ChannelLayout
from gmr.errors import SkeletonError

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["has_leading_tpose", "leading_rest_frames", "without_leading_tpose"]

_RESTING = 0.9
"""Share of the angles that must look set by hand: whole numbers, or next to 0."""
_NEXT_TO_ZERO_DEG = 2.0
_JUMP_DEG = 2.0
"""Mean turn of all joints from the rest pose to the recording, at the least."""
_JUMP_RATIO = 8.0
"""How many times the mean turn from there to the next frame."""
_MOST_FRAMES = 10


def has_leading_tpose(motion: Motion) -> bool:
    """Whether the motion begins with a pose that a converter added and nobody recorded."""
    return leading_rest_frames(motion) > 0


def without_leading_tpose(motion: Motion) -> Motion:
    """The recording alone; the same motion where nothing was added before it."""
    return motion[leading_rest_frames(motion) :] if has_leading_tpose(motion) else motion


def leading_rest_frames(motion: Motion) -> int:
    """How many frames at the beginning are rest poses that a converter added.

    In a rest pose nearly all angles are whole numbers (or next to 0); from the last one the whole body jumps
    to the recording. CMU's conversions to BVH begin with one, at the place where the roots stand in frame 1;
    a few go on with frames of zeros (07_12, 09_10), which count too.
    """
    start = motion[: _MOST_FRAMES + 2].to_post_rotation()
    try:
        angles = start.rows[:, _turning_columns(start)]
    except SkeletonError:
        return 0  # what channels cannot say was not set by a converter
    if not angles.shape[1] or not np.isfinite(angles).all():
        return 0
    resting = _resting(angles) >= _RESTING
    count = len(resting) if resting.all() else int(np.argmin(resting))
    if not 0 < count <= len(start) - 2:
        return 0
    jump, after = _mean_turns_deg(start[count - 1 : count + 2])
    return count if jump >= _JUMP_DEG and jump >= _JUMP_RATIO * after else 0


def _turning_columns(motion: Motion) -> NDArray[np.bool_]:
    layout = motion.layout or ChannelLayout.standard(motion.skeleton, motion.translated)
    return layout.column_turns


def _resting(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F,) share of the angles that look set by hand."""
    set_by_hand = (np.abs(angles - np.round(angles)) < 1e-9) | (np.abs(angles) < _NEXT_TO_ZERO_DEG)
    return np.asarray(set_by_hand.mean(axis=1), np.float64)


def _mean_turns_deg(motion: Motion) -> NDArray[np.float64]:
    """(F - 1,) mean angle by which the slots turn from each frame to the next."""
    cosines = np.abs((motion.rotations[1:] * motion.rotations[:-1]).sum(axis=-1))
    return np.asarray(np.degrees(2 * np.arccos(np.minimum(cosines, 1))).mean(axis=1), np.float64)
