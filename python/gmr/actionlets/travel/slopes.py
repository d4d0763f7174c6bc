"""Slopes of sampled curves at the ends of runs of frames, many at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["slopes", "spread"]

Floats = NDArray[np.float64]
Frames = NDArray[np.intp]

_WEIGHTS = np.array([[0.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.5, 2.0, -0.5]])
"""Of the nearest three frames of a run of one, two, or more."""


def slopes(values: Floats, ends: Frames, inward: int, lengths: Frames) -> Floats:
    """(g, K) change a frame at the first or last frames of g runs, from the frames of the run alone.

    To second order: ``(-3 v0 + 4 v1 - v2) / 2``; a run of two frames tells its difference, one frame 0.

    Args:
        values: (F, K).
        ends: (g,) frames.
        inward: 1 where the runs begin there, -1 where they end.
        lengths: (g,) frames of each run less one; -1: there is none, and the slope is 0.
    """
    others = np.minimum(np.maximum(lengths, 0), 2)
    near = ends[:, None] + inward * np.minimum(np.arange(3), others[:, None])
    near = np.minimum(np.maximum(near, 0), len(values) - 1)
    found: Floats = inward * np.einsum("gi,gik->gk", _WEIGHTS[others], values[near])
    return found


def spread(counts: Frames) -> Frames:
    """Numbers from 0 in each of g runs of so many frames, one run after the other."""
    return np.asarray(np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts), np.intp)
