"""One or two normal distributions fitted to samples, many sets of them at once.

Sources: Dempster, Laird, Rubin, "Maximum Likelihood from Incomplete Data via the EM Algorithm" (1977);
Schwarz, "Estimating the Dimension of a Model" (1978), which chooses between one and two; Otsu, "A
Threshold Selection Method from Gray-Level Histograms" (1979), which parts the samples to begin with.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["Mixtures", "fitted"]

Floats = NDArray[np.float64]

_CLASSES: Final = 64
"""Samples of a set are taken together in as many classes; their means and variances are kept exactly."""

_ROUNDS: Final = 200
_GAIN: Final = 1e-6
"""Rounds of EM, at most, and the gain of log-likelihood a sample below which a set needs no more of them."""


@dataclass(frozen=True, slots=True)
class Mixtures:
    """T fits of at most two components, that of the lower mean first.

    Attributes:
        components: (T,) 1 or 2; 0 for a set without samples.
        shares: (T, 2) of the samples; of a single component 1 and NaN.
        means, deviations: (T, 2) likewise.
    """

    components: NDArray[np.int64]
    shares: Floats
    means: Floats
    deviations: Floats


def fitted(values: Floats, where: NDArray[np.bool_], independent: Floats) -> Mixtures:
    """Fit one and two normal distributions to every set, and keep what is told better by its samples.

    The mean and the variance of a fit are exactly those of its samples.

    Args:
        values: (T, S) samples.
        where: (T, S) which of them count.
        independent: (T,) as how many independent samples each set counts in the choice: neighbouring steps of
            a walk tell hardly more than one of them.
    """
    count, mean, spread = _classes(values, where)
    total = count.sum(axis=1)
    share = count / np.maximum(total, 1)[:, None]
    centre = (share * mean).sum(axis=1)
    variance = (share * (spread + (mean - centre[:, None]) ** 2)).sum(axis=1)
    one = -0.5 * (np.log(2 * np.pi * np.where(variance > 0, variance, 1.0)) + 1)
    shares, means, variances, two = _em(share, mean, spread, variance)
    # Two parameters against five: half of Schwarz's criterion, for each way.
    better = two - 5 / 2 * _penalty(independent) > one - 2 / 2 * _penalty(independent)
    pair = better & (variance > 0) & (total > 0)
    alone = np.stack([np.ones(len(total)), np.full(len(total), np.nan)], axis=1)
    single = np.where(total > 0, 1.0, np.nan)[:, None] * alone
    order = np.argsort(means, axis=1)

    def chosen(both: Floats, lone: Floats) -> Floats:
        return np.where(pair[:, None], np.take_along_axis(both, order, axis=1), lone)

    return Mixtures(
        components=np.where(total > 0, 1 + pair, 0).astype(np.int64),
        shares=chosen(shares, single),
        means=chosen(means, single * centre[:, None]),
        deviations=chosen(np.sqrt(variances), single * np.sqrt(variance)[:, None]),
    )


def _penalty(independent: Floats) -> Floats:
    """Schwarz's price of a parameter, for each sample."""
    samples = np.maximum(independent, 2.0)
    return np.asarray(np.log(samples) / samples)


def _classes(values: Floats, where: NDArray[np.bool_]) -> tuple[Floats, Floats, Floats]:
    """(T, C) number, mean and variance of the samples of each class, from the least to the greatest."""
    low = np.min(values, axis=1, where=where, initial=np.inf)
    high = np.max(values, axis=1, where=where, initial=-np.inf)
    width = np.where(high > low, high - low, 1.0)
    trial, step = np.nonzero(where)
    sample = values[trial, step]
    place = ((sample - low[trial]) / width[trial] * _CLASSES).astype(np.int64)
    cell = trial * _CLASSES + np.minimum(place, _CLASSES - 1)
    cells = len(values) * _CLASSES
    count = np.bincount(cell, minlength=cells).astype(np.float64)
    mean = np.bincount(cell, sample, cells) / np.maximum(count, 1)
    spread = np.bincount(cell, (sample - mean[cell]) ** 2, cells) / np.maximum(count, 1)
    shape = (len(values), _CLASSES)
    return count.reshape(shape), mean.reshape(shape), spread.reshape(shape)


def _em(
    share: Floats, mean: Floats, spread: Floats, variance: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Shares, means and variances (T, 2) of two components, and the log-likelihood a sample (T,)."""
    # No component may shrink onto a single sample, where the likelihood has no bound.
    least = np.maximum(variance * 1e-4, 1e-12)[:, None]
    belongs = _parted(share, mean)
    before = np.full(len(share), -np.inf)
    for _ in range(_ROUNDS):
        part = (belongs * share[:, None]).sum(axis=2)
        safe = np.maximum(part, 1e-300)
        means = (belongs * (share * mean)[:, None]).sum(axis=2) / safe
        around = spread[:, None] + (mean[:, None] - means[..., None]) ** 2
        variances = np.maximum((belongs * share[:, None] * around).sum(axis=2) / safe, least)
        log = -0.5 * (around / variances[..., None] + np.log(2 * np.pi * variances)[..., None])
        log += np.log(safe)[..., None]
        most = log.max(axis=1, keepdims=True)
        joint = np.exp(log - most)
        both = joint.sum(axis=1, keepdims=True)
        belongs = joint / both
        likelihood = (share * (most + np.log(both))[:, 0]).sum(axis=1)
        if np.all(likelihood - before < _GAIN):
            break
        before = likelihood
    return part, means, variances, likelihood


def _parted(share: Floats, mean: Floats) -> Floats:
    """(T, 2, C) the classes on both sides of the border that parts their means best."""
    below = np.cumsum(share, axis=1)
    moment = np.cumsum(share * mean, axis=1)
    above = 1 - below
    apart = np.where(
        (below > 0) & (above > 1e-9),
        (moment[:, -1:] * below - moment) ** 2 / np.maximum(below * above, 1e-12),
        -1.0,
    )
    border = np.argmax(apart, axis=1)
    low = np.arange(share.shape[1])[None, :] <= border[:, None]
    return np.stack([low, ~low], axis=1).astype(np.float64)
