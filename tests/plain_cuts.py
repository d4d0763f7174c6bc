"""The plain way to decompose a curve, to be beaten: cut at its extremes, fit the skew of each piece."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.bell import share

Floats = NDArray[np.float64]

_SKEWS = np.linspace(0.03, 0.97, 95)[:, None]


def plain_fit(curve: Floats, hysteresis: float) -> tuple[Floats, int]:
    """The curve as composed again, (F,), and the number of pieces."""
    cuts = extremes(curve, hysteresis)
    found = curve.copy()
    for one, other in pairwise(cuts):
        shares = share(np.linspace(0, 1, other - one + 1)[None], _SKEWS)
        tried = curve[one] + (curve[other] - curve[one]) * shares
        found[one : other + 1] = tried[((tried - curve[one : other + 1]) ** 2).sum(axis=1).argmin()]
    return found, len(cuts) - 1


def extremes(curve: Floats, hysteresis: float) -> list[int]:
    """Frames at which the curve turns by more than ``hysteresis``, the first and the last among them."""
    found, top, bottom, way = [0], 0, 0, 0
    for frame in range(1, len(curve)):
        if way >= 0 and curve[frame] > curve[top]:
            top = frame
        if way <= 0 and curve[frame] < curve[bottom]:
            bottom = frame
        if way >= 0 and curve[top] - curve[frame] > hysteresis:
            found.append(top)
            way, bottom = -1, frame
        elif way <= 0 and curve[frame] - curve[bottom] > hysteresis:
            found.append(bottom)
            way, top = 1, frame
    return sorted({*found, len(curve) - 1})
