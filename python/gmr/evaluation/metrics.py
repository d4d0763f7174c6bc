"""The figures of a trial: how well it kept its speed, its turn rate and its path.

All functions work on the logs of T trials at once, (T, S) arrays in, (T,) figures out, over recorded steps.
Source: the paper's section 3.3, Eqs 1 to 5, with the slips of its print mended where they are named below.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.log import Log

__all__ = [
    "along_and_cross_track",
    "centred_mean",
    "dynamic_error",
    "facing_error",
    "mean_where",
    "offset",
    "path_speed",
    "percentile_where",
    "rms_where",
    "static_error",
    "turn_rate",
    "worst_share",
]

Steps: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
PerTrial: TypeAlias = NDArray[np.float64]


def path_speed(log: Log) -> Steps:
    """Speed along the path actually gone, ``v_r = |dp| / dt`` (section 3.2.3).

    Returns:
        (T, S) metres per second on the way from step i to step i + 1, at index i; NaN at the last.
    """
    return _to_the_next_step(np.hypot(np.diff(log.x), np.diff(log.z)) * log.rate)


def turn_rate(log: Log) -> Steps:
    """Turn rate actually gone, ``w_r = wrap(dth) / dt`` (section 3.2.3).

    Returns:
        (T, S) radians per second, positive to the left, at the same index as :func:`path_speed`.
    """
    turn = np.diff(log.heading)
    wrapped = turn - 2 * np.pi * np.round(turn / (2 * np.pi))
    return _to_the_next_step(wrapped * log.rate)


def centred_mean(values: Steps, moving: Mask, rate: float) -> tuple[Steps, Mask]:
    """Mean of the second around each step, which takes the sway of the single footsteps out.

    Args:
        values: (T, S) speeds or turn rates, at the beginning of the way they stand for.
        moving: (T, S) the steps that count.
        rate: steps per second.

    Returns:
        (T, S) the means, and where they stand on counting steps only.
    """
    half = round(rate / 2)
    none = np.zeros((len(values), 1))
    total = np.concatenate([none, np.cumsum(np.where(moving, values, 0.0), axis=1)], axis=1)
    count = np.concatenate([none, np.cumsum(moving, axis=1)], axis=1)
    means = np.full(values.shape, np.nan)
    whole = np.zeros(values.shape, bool)
    inner = slice(half, values.shape[1] - half + 1)
    means[:, inner] = (total[:, 2 * half :] - total[:, : -2 * half]) / (2 * half)
    whole[:, inner] = count[:, 2 * half :] - count[:, : -2 * half] == 2 * half
    return means, whole


def static_error(values: Steps, reference: Steps, where: Mask) -> PerTrial:
    """Static error, ``SE = mean(x_r - x_ref)``: positive when the character is too fast (Eqs 1 and 2).

    The print sums i = 0..m, which are m + 1 terms, and divides by m; this is the mean over all of them. The
    reference is the one in force at each step, so that it also holds where the reference changes.
    """
    return mean_where(values - reference, where)


def dynamic_error(values: Steps, reference: Steps, where: Mask) -> PerTrial:
    """Dynamic error, ``DSE = std(x_r - x_ref)``, the spread about the mean (Eqs 3 and 4).

    The print adds the reference to ``x_r - SE`` where it must be subtracted, and divides by the number of
    reference values of the grid, so that it grows with the trial's length; this divides by the samples.
    """
    error = values - reference
    return rms_where(error - mean_where(error, where)[:, None], where)


def worst_share(values: Steps, reference: Steps, where: Mask) -> PerTrial:
    """The static error at each reference in force, as a share of it; of several the one farthest from 0.

    Where the speed switches, too fast at the one must not make up for too slow at the other.
    """
    worst = np.full(len(values), np.nan)
    for asked in np.unique(reference[where]).tolist():
        share = static_error(values, reference, where & (reference == asked)) / asked
        worst = np.where(np.isnan(worst) | (np.abs(share) > np.abs(worst)), share, worst)
    return worst


def offset(log: Log) -> Steps:
    """Distance from where the plan has the character at that time, ``e_i = |p_i - p_ref(t_i)|`` (Eq 5).

    The print calls the sum of these over all steps an error in metres; the table has their mean, root mean
    square, 95th percentile, maximum and last value, and the paper's sum beside them.

    Returns:
        (T, S) metres.
    """
    return np.hypot(log.x - log.ref_x, log.z - log.ref_z)


def along_and_cross_track(log: Log) -> tuple[Steps, Steps]:
    """The offset's two parts: along the path's direction (positive ahead) and across it (positive left).

    Returns:
        two (T, S) arrays, metres.
    """
    dx, dz = log.x - log.ref_x, log.z - log.ref_z
    way = log.ref_heading + log.ref_drift
    sin, cos = np.sin(way), np.cos(way)
    return dx * sin + dz * cos, dx * cos - dz * sin


def facing_error(log: Log) -> Steps:
    """How far it faces from where it should at that time.

    Returns:
        (T, S) radians, 0 to pi.
    """
    apart = log.heading - log.ref_heading
    return np.abs(apart - 2 * np.pi * np.round(apart / (2 * np.pi)))


def mean_where(values: Steps, where: Mask) -> PerTrial:
    """(T,) mean of each trial's values at some steps; NaN where there are none."""
    count = where.sum(axis=1)
    total = np.where(where, values, 0.0).sum(axis=1)
    return np.asarray(np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0))


def rms_where(values: Steps, where: Mask) -> PerTrial:
    """(T,) root mean square of each trial's values at some steps; NaN where there are none."""
    return np.asarray(np.sqrt(mean_where(values * values, where)))


def percentile_where(values: Steps, where: Mask, percent: float) -> PerTrial:
    """(T,) percentile of each trial's values at some steps, linear between samples; NaN without any."""
    return np.array(
        [
            np.percentile(trial[chosen], percent) if chosen.any() else np.nan
            for trial, chosen in zip(values, where, strict=True)
        ]
    )


def _to_the_next_step(values: Steps) -> Steps:
    return np.concatenate([values, np.full((len(values), 1), np.nan)], axis=1)
