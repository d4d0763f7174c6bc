"""The T-pose that some converters put before the first frame of a take.

It is a jump of the whole body within one frame: comparing, decomposing and evaluating leave it out, and say
so.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.errors import SkeletonError

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["has_leading_tpose"]

_RESTING = 0.9
"""Share of the angles that must look set by hand: whole numbers, or next to 0."""
_NEXT_TO_ZERO_DEG = 2.0
_JUMP_DEG = 2.0
"""Mean turn of all joints from frame 0 to frame 1, at the least; a body at full speed stays below it."""
_JUMP_RATIO = 8.0
"""How many times the mean turn of the next frame."""
_ROOT_SHARE = 0.1
"""How far the root may move from frame 0 to frame 1, as a share of the body's extent."""


def has_leading_tpose(motion: Motion) -> bool:
    """Whether frame 0 is a rest pose that a converter added, and not part of the recording.

    It is where the roots stand where they stand in frame 1, nearly all angles are whole numbers (or next to
    0), and the whole body jumps from there to frame 1. CMU's conversions to BVH begin like this.
    """
    if motion.frame_count < 3:
        return False
    start = motion[:3]
    try:
        angles = start.rows[:, _turning_columns(start)]
    except SkeletonError:
        return False  # bones that turn on their own were not set by a converter to one angle a joint
    if not angles.shape[1] or not np.isfinite(angles).all():
        return False
    first, then = (_mean_turn_deg(start, k) for k in (0, 1))
    jumps = first >= _JUMP_DEG and first >= _JUMP_RATIO * then
    return bool(jumps and _resting(angles[0]) >= _RESTING > _resting(angles[1]) and _root_stays(start))


def _turning_columns(motion: Motion) -> NDArray[np.bool_]:
    from gmr.channels import ChannelLayout

    layout = motion.layout or ChannelLayout.standard(motion.skeleton, motion.translated)
    return layout.column_turns


def _resting(angles: NDArray[np.float64]) -> float:
    """Share of the angles that look set by hand."""
    whole = np.abs(angles - np.round(angles)) < 1e-9
    return float((whole | (np.abs(angles) < _NEXT_TO_ZERO_DEG)).mean())


def _mean_turn_deg(motion: Motion, frame: int) -> float:
    """Mean angle by which the slots turn from ``frame`` to the next."""
    now, then = motion.rotations[frame], motion.rotations[frame + 1]
    cosine = np.clip(np.abs((now * then).sum(axis=-1)), 0, 1)
    return float(np.degrees(2 * np.arccos(cosine)).mean())


def _root_stays(motion: Motion) -> bool:
    """Whether no root goes anywhere, measured by the body's extent, from frame 0 to frame 1."""
    positions = motion.positions()
    extent = float(np.ptp(positions[1], axis=0).max())
    roots = list(motion.skeleton.roots)
    moved = np.linalg.norm(positions[1, roots] - positions[0, roots], axis=-1)
    return bool((moved <= _ROOT_SHARE * extent).all())
