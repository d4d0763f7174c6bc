"""Which clips repeat each other and which cannot be blended, in words, and what to capture for it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.pose_coverage import REDUNDANT, THIN, UNBLENDABLE, BlendLimits
from gmr.evaluation.regions import Grid
from gmr.evaluation.words import count, duration, going, listing, percent, turning
from gmr.table import Table

__all__ = ["blending_sentences", "lead_in_sentences"]

MOST_TOLD: Final = 3


def blending_sentences(
    poses: Table, limits: BlendLimits | None = None, *, mirrored: bool = False
) -> Iterator[str]:
    """Say how much of the clips repeats others, and how much of it nothing can be blended with.

    Args:
        poses: a table of :func:`gmr.evaluation.pose_coverage.pose_coverage`.
        limits: that it was made with.
        mirrored: its seconds count mirrored copies, too, which is then said.
    """
    limits = limits or BlendLimits()
    judged = poses["kind"] != THIN
    total = float(poses["seconds"][judged].sum())
    if total == 0:
        return
    twice, apart = poses["kind"] == REDUNDANT, poses["kind"] == UNBLENDABLE
    if twice.any():
        yield (
            f"Dense and redundant {_amount(float(poses['seconds'][twice].sum()), total, mirrored)}: "
            f"another clip has the same pose within {limits.redundant * 100:g} cm."
        )
    if apart.any():
        most = int(np.argmax(np.where(apart, poses["seconds"], -1.0)))
        yield (
            f"Dense but unblendable {_amount(float(poses['seconds'][apart].sum()), total, mirrored)}: "
            f"clips that go alike in poses {limits.unblendable * 100:g} cm and more apart. Most of it in one "
            f"place is {going(float(poses['speed'][most]), float(poses['turn_rate_deg'][most]))} "
            f"({duration(float(poses['seconds'][most]))} of {count(int(poses['clips'][most]), 'clip')}, "
            f"{poses['nearest_mean'][most] * 100:.0f} cm from the nearest pose of another)."
        )


def _amount(seconds: float, total: float, mirrored: bool) -> str:
    verb = "is" if duration(seconds) == "1 second" else "are"
    copies = ", mirrored copies counted" if mirrored else ""
    return f"{verb} {duration(seconds)} ({percent(seconds / total)} of what is dense enough to judge{copies})"


def lead_in_sentences(poses: Table, grid: Grid, limits: BlendLimits | None = None) -> Iterator[str]:
    """Say where trials fail although the clips hold the movement, since nothing leads into it.

    Args:
        poses: a table of :func:`gmr.evaluation.pose_coverage.pose_coverage`.
        grid: the trials.
        limits: that the table was made with.
    """
    limits = limits or BlendLimits()
    nearest = _nearest_on_grid(poses, grid)
    told = ~grid.held & (grid.seconds >= grid.limits.covered) & (nearest >= limits.unblendable)
    worst = sorted(np.argwhere(told).tolist(), key=lambda at: -nearest[tuple(at)])[:MOST_TOLD]
    if not worst:
        return
    places = [
        f"{_asked(float(grid.speeds[v]), float(grid.turn_rates_deg[w]))} "
        f"({duration(float(grid.seconds[v, w]))} of it, {nearest[v, w] * 100:.0f} cm from any other clip)"
        for v, w in worst
    ]
    yield (
        f"Capture takes that lead from other movements into {listing(places)} and out again: "
        f"the clips hold that much of it, but in poses that no other clip comes near."
    )


def _nearest_on_grid(poses: Table, grid: Grid) -> NDArray[np.float64]:
    """(V, W) metres to the nearest pose of another clip, the mean of the time about each trial; NaN where
    there is none."""
    known = np.isfinite(poses["nearest_mean"])
    seconds, nearest = poses["seconds"][known], poses["nearest_mean"][known]
    at = (poses["speed"][known], poses["turn_rate_deg"][known])
    total = np.histogram2d(*at, bins=grid.borders, weights=seconds)[0]
    metres = np.histogram2d(*at, bins=grid.borders, weights=seconds * nearest)[0]
    return np.divide(metres, total, out=np.full(total.shape, np.nan), where=total > 0)


def _asked(speed: float, turn_rate_deg: float) -> str:
    return f"{speed:g} m/s {turning(turn_rate_deg, turn_rate_deg)}"
