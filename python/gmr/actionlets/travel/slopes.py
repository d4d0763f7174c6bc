"""Slopes of sampled curves at the ends of runs of frames, many at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["slopes", "spread"]

Floats = NDArray[np.float64]
Frames = NDArray[np.intp]


def slopes(values: Floats, ends: Frames, inward: int, lengths: Frames) -> Floats:
    """(g, K) change a frame at the first or last frames of g runs, from the frames of the run alone.

    To second order: ``(-3 v0 + 4 v1 - v2) / 2``; a run of two frames tells its difference, one frame 0.

    Args:
        values: (F, K).
        ends: (g,) frames.
        inward: 1 where the runs begin there, -1 where they end.
        lengths: (g,) frames of each run less one; -1: there is none, and the slope is 0.
    """
    behind = np.minimum(np.arange(3), np.maximum(lengths, 0)[:, None])
    long, short = np.array([-1.5, 2.0, -0.5]), np.array([-1.0, 1.0, 0.0])
    weights = np.where(lengths[:, None] > 1, long, np.where(lengths[:, None] == 1, short, 0.0))
    near = values[np.clip(ends[:, None] + inward * behind, 0, len(values) - 1)]
    return np.asarray(inward * (weights[:, :, None] * near).sum(axis=1), np.float64)


def spread(counts: Frames) -> Frames:
    """Numbers from 0 in each of g runs of so many frames, one run after the other."""
    return np.asarray(np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts), np.intp)
