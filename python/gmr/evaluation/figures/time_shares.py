"""How much of the time of a dataset goes how fast, each window by the seconds that it stands for.

A clip has a window for each of its frames but those of its last second, so that a window of a short clip
stands for more.
"""

from __future__ import annotations

import numpy as np

from gmr.table import Table

__all__ = ["turning_share", "usual_speeds"]


def turning_share(windows: Table, faster_than_deg: float) -> float:
    """The share of the time that turns faster than some degrees/s, either way."""
    weight = windows["weight"]
    return float(weight[np.abs(windows["turn_rate_deg"]) > faster_than_deg].sum() / weight.sum())


def usual_speeds(windows: Table) -> tuple[float, float]:
    """The speeds, m/s, between which nine tenths of the time lie, a twentieth below and above."""
    order = np.argsort(windows["speed"], kind="stable")
    speed, until = windows["speed"][order], np.cumsum(windows["weight"][order])
    low, high = np.searchsorted(until, np.array([0.05, 0.95]) * until[-1])
    return float(speed[low]), float(speed[min(high, len(speed) - 1)])
