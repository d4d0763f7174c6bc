"""Numbers that no file can say: who has them, and in which frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.channels import ChannelLayout
from gmr.errors import FormatError
from gmr.motion import Motion
from gmr.skeleton import Skeleton

__all__ = ["check_offsets", "check_rows", "first_not_finite", "unsayable"]

_BLOCK = 1 << 18


def check_offsets(motion: Motion, skeleton: Skeleton, form: str) -> None:
    """Raises for an offset that is no finite number, which ``form`` cannot say."""
    for joint in np.flatnonzero(~np.isfinite(skeleton.offsets).all(axis=1)).tolist():
        offset = skeleton.offsets[joint].tolist()
        what = f"the offset of joint '{skeleton.names[joint]}' is {offset}, which {form} cannot say"
        raise FormatError(f"{what}. Correct it.", file=motion.name)


def check_rows(motion: Motion, layout: ChannelLayout, rows: NDArray[np.float64], form: str) -> None:
    """Raises for a value of a row that is no finite number; its joint, channel and frame are named."""
    if (found := first_not_finite(rows)) is not None:
        frame, column = found
        joint, channel = layout.channel(column)
        name = motion.skeleton.names[joint]
        raise unsayable(motion, f"joint '{name}', {channel}", rows[frame, column], frame, form)


def first_not_finite(values: NDArray[np.float64]) -> tuple[int, int] | None:
    """Frame and column of the first of (F, C) values that is not finite, if there is one."""
    step = max(1, _BLOCK // max(1, values.shape[1]))
    for start in range(0, len(values), step):
        finite = np.isfinite(values[start : start + step])
        if not finite.all():
            frame, column = np.argwhere(~finite)[0].tolist()
            return start + frame, column
    return None


def unsayable(motion: Motion, who: str, value: float, frame: int, form: str) -> FormatError:
    """The error for a number that is none."""
    what = f"{who} is {value} in frame {frame}, which {form} cannot say"
    return FormatError(f"{what}. Fill the gap, or cut the frame out.", file=motion.name)
