"""How far a mean over trials may be trusted: confidence intervals by bootstrap.

Source: Efron, "Bootstrap methods: another look at the jackknife", Annals of Statistics 7 (1979): the
percentile method, with fixed chance so that the same trials give the same bits.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["Interval", "mean_interval"]

RESAMPLES: Final = 4000
SEED: Final = 1979


class Interval(NamedTuple):
    """A mean and within which bounds it lies; the bounds are NaN where one value says nothing of them."""

    mean: float
    low: float
    high: float


def mean_interval(values: ArrayLike, confidence: float = 0.95) -> Interval:
    """The mean of some values and the percentiles of the means of samples drawn from them anew.

    Args:
        values: (N,) one a trial.
        confidence: share of the samples whose mean lies within the bounds.
    """
    given = np.asarray(values, np.float64)
    mean = float(given.mean()) if len(given) else float("nan")
    if len(given) < 2:
        return Interval(mean, float("nan"), float("nan"))
    random = np.random.Generator(np.random.PCG64(SEED))
    drawn = (random.random((RESAMPLES, len(given))) * len(given)).astype(np.int64)
    tail = 50 * (1 - confidence)
    low, high = np.percentile(given[drawn].mean(axis=1), [tail, 100 - tail])
    return Interval(mean, float(low), float(high))
