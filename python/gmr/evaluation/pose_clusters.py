"""Poses gathered into clusters, and how evenly time is spread over them.

Source: S. Lloyd, "Least squares quantization in PCM", IEEE Trans. Inf. Theory 28 (1982): k-means; C. Shannon,
"A mathematical theory of communication" (1948): entropy.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr import _core

__all__ = ["CLUSTERS", "clustered", "entropy"]

CLUSTERS: Final = 32

_ROUNDS: Final = 12


def clustered(features: NDArray[np.float32], clusters: int = CLUSTERS) -> NDArray[np.int64]:
    """(N,) which cluster each of N rows (N, P) belongs to: k-means without chance.

    The first centres are rows at even distances in the order given, which is time: what lasts long gets many.
    Each round gives every row to its nearest centre, ties to the first, and moves each centre to the mean of
    its rows, until nothing changes or 12 rounds are over. The same rows give the same clusters everywhere.
    """
    if len(features) == 0:
        return np.zeros(0, np.int64)
    seeds = (np.arange(clusters) * len(features)) // clusters
    centres = features[np.unique(seeds)]
    nearest = np.full(len(features), -1, np.int64)
    for _ in range(_ROUNDS):
        before, nearest = nearest, _core.Index(centres).search(features, 1, threads=1)[1][:, 0]
        if np.array_equal(before, nearest):
            break
        centres = _means(features, nearest, centres)
    return nearest


def entropy(cluster: NDArray[np.int64], weight: NDArray[np.float64]) -> float:
    """Shannon entropy in bits of the shares that clusters have of a weight.

    Args:
        cluster: (N,) of each row.
        weight: (N,) of each row, 0 or more, not all of them 0.
    """
    share = np.bincount(cluster, weight) / weight.sum()
    share = share[share > 0]
    return float(-(share * np.log2(share)).sum()) + 0.0


def _means(
    features: NDArray[np.float32], cluster: NDArray[np.int64], centres: NDArray[np.float32]
) -> NDArray[np.float32]:
    """(K, P) mean row of each cluster; an empty one keeps its centre."""
    count = np.bincount(cluster, minlength=len(centres))
    sums = np.stack([np.bincount(cluster, column, len(centres)) for column in features.T], axis=1)
    means = sums / np.maximum(count, 1)[:, None]
    return np.where(count[:, None] > 0, means, centres).astype(np.float32)
