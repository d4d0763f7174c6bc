"""Smooth ways from an edit to no edit, so that nothing jumps where it begins and ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["blend_weights", "eased", "smooth_above", "smooth_step"]

Floats = NDArray[np.float64]


def smooth_step(x: Floats) -> Floats:
    """``6 x^5 - 15 x^4 + 10 x^3`` on [0, 1], 0 before, 1 after: begins and ends without speed and without
    acceleration."""
    t = np.minimum(np.maximum(x, 0), 1)
    found: Floats = t * t * t * (t * (6 * t - 15) + 10)
    return found


def blend_weights(frame_count: int, first: int, end: int, blend: int) -> Floats:
    """(F,) 1 in the frames from ``first`` to before ``end``, falling smoothly to 0 over ``blend`` frames on
    both sides."""
    frames = np.arange(frame_count)
    outside = np.maximum(np.maximum(first - frames, frames - (end - 1)), 0)
    return smooth_step(1 - outside / (blend + 1))


def eased(values: Floats, intervals: Sequence[tuple[int, int]], blend: int) -> Floats:
    """Values that hold in some intervals, carried on to 0 outside of them with a continuous first derivative.

    From the last value of an interval and the slope there, a cubic leads to 0 within ``blend`` frames; where
    the next interval is too near for that, one cubic leads from the one to the other.
    Source: cubic Hermite interpolation.

    Args:
        values: (F, K); those outside the intervals are not looked at.
        intervals: (first, one past last) in order, apart from each other.
        blend: frames.
    """
    found = np.zeros_like(values)
    begins, ends = [], []
    for first, end in intervals:
        found[first:end] = values[first:end]
        slopes = np.diff(values[first:end], axis=0)
        still = np.zeros(values.shape[1:])
        begins.append(_Knot(first, values[first], slopes[0] if len(slopes) else still))
        ends.append(_Knot(end - 1, values[end - 1], slopes[-1] if len(slopes) else still))
    for before, after in zip([None, *ends], [*begins, None], strict=True):
        if before and after and after.frame - before.frame <= 2 * blend:
            _lead(found, before, after)
            continue
        if before:
            _lead(found, before, _Knot.at_rest(before.frame + blend, before))
        if after:
            _lead(found, _Knot.at_rest(after.frame - blend, after), after)
    return found


@dataclass(frozen=True, slots=True)
class _Knot:
    """Value and slope at a frame."""

    frame: int
    value: Floats
    slope: Floats

    @classmethod
    def at_rest(cls, frame: int, like: _Knot) -> _Knot:
        """0 and level."""
        return cls(frame, np.zeros_like(like.value), np.zeros_like(like.slope))


def _lead(found: Floats, one: _Knot, other: _Knot) -> None:
    """Writes the cubic between two knots into the frames between them."""
    frames = np.arange(max(one.frame + 1, 0), min(other.frame, len(found)))
    length = other.frame - one.frame
    t = ((frames - one.frame) / max(length, 1))[:, None]
    found[frames] = (
        (1 + 2 * t) * (1 - t) ** 2 * one.value
        + t * (1 - t) ** 2 * length * one.slope
        + t * t * (3 - 2 * t) * other.value
        - t * t * (1 - t) * length * other.slope
    )


def smooth_above(values: Floats, width: int) -> Floats:
    """(F,) a smooth curve that is nowhere below ``values``: the greatest of them nearby, averaged.

    Args:
        values: (F,), none below 0.
        width: frames on both sides beyond which a value has no influence.
    """
    half = width // 2
    if not half or not len(values):
        return values.copy()
    windows = np.lib.stride_tricks.sliding_window_view
    greatest = windows(np.pad(values, 2 * half, mode="edge"), 2 * half + 1).max(axis=-1)
    weights = np.hanning(2 * half + 3)[1:-1]
    averaged = np.convolve(greatest, weights / weights.sum(), mode="valid")
    return np.asarray(np.maximum(averaged, values), np.float64)
