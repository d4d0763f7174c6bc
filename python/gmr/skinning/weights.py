"""Weights that sum to 1."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Normalised", "normalised_weights"]

_ROUNDING = 1e-7
"""How far the sum may miss 1 for each weight that is not 0; less than what the glTF-Validator lets pass."""

_NOTICED = 1e-2
"""How far the sum may miss 1 by rounding to bytes; more is worth telling."""


class Normalised(NamedTuple):
    """What :func:`normalised_weights` finds."""

    weights: NDArray[np.float32]
    """(V, K) that sum to 1."""
    off: int
    """Vertices whose sum missed 1 by more than a hundredth."""
    least: float
    """The least sum among those; 1 where there are none."""
    empty: NDArray[np.intp]
    """Vertices without any weight; their first joint has all of it now."""


def normalised_weights(weights: NDArray[np.float32]) -> Normalised:
    """(V, K) weights, none negative, divided by their sums; rows that sum to 1 already are not touched.

    A vertex without any weight goes with its first joint: where weights are sought by distance it is one that
    nothing was near, and left behind it would tear the mesh as soon as the body walks away.
    """
    sums = weights.sum(axis=1, dtype=np.float64)
    counts = np.maximum((weights > 0).sum(axis=1), 1)
    empty = np.flatnonzero(sums == 0)
    wrong = (np.abs(sums - 1) > _ROUNDING * counts) & (sums > 0)
    off = (np.abs(sums - 1) > _NOTICED) & (sums > 0)
    found = np.array(weights, np.float32)
    if wrong.any():
        found[wrong] = _rounded(weights[wrong] / sums[wrong, None])
    found[empty, :1] = 1
    return Normalised(found, int(off.sum()), float(sums[off].min(initial=1.0)), empty)


def _rounded(weights: NDArray[np.float64]) -> NDArray[np.float32]:
    """(V, K) in float32, the greatest weight of each row taking what rounding left over."""
    found = weights.astype(np.float32)
    rows, greatest = np.arange(len(found)), found.argmax(axis=1)
    left = 1 - found.sum(axis=1, dtype=np.float64)
    found[rows, greatest] = (found[rows, greatest] + left).astype(np.float32)
    return found
