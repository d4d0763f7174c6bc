"""The velocity bell of an actionlet over normalised time, its slope and its integral, in closed form.

With ``u`` in [0, 1] and the skew ``T`` in (0, 1), where the bell peaks::

    v(u) = (1 - cos(pi u / T)) / 2                    for u <= T
    v(u) = (1 + cos(pi (u - T) / (1 - T))) / 2        for u >= T

which is Eq. 1 with ``sin(x - pi/2) = -cos x``. The bell begins and ends at 0 and peaks at 1; its area is 1/2
whatever the skew. Its slope is 0 at both ends and at the peak, so actionlets meet without a jump even in
their accelerations.
Source: Zheng et al., "Human Motion Simulation and Action Corpus", Eq. 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["bell", "bell_slope", "share", "share_by_skew"]

Floats = NDArray[np.float64]


def bell(u: Floats, skew: Floats | float) -> Floats:
    """Velocity v(u), 0 to 1; ``u`` in [0, 1] and ``skew`` in (0, 1) of shapes that broadcast."""
    rising, falling = _halves(u, skew)
    found: Floats = np.where(u <= skew, 1 - np.cos(np.pi * rising), 1 + np.cos(np.pi * falling)) / 2
    return found


def bell_slope(u: Floats, skew: Floats | float) -> Floats:
    """dv/du."""
    rising, falling = _halves(u, skew)
    up = np.sin(np.pi * rising) / skew
    down = np.sin(np.pi * falling) / (1 - skew)
    found: Floats = np.pi / 2 * np.where(u <= skew, up, -down)
    return found


def share(u: Floats, skew: Floats | float) -> Floats:
    """The share of the way that is behind at ``u``: s(u), twice the integral of v from 0 to u.

    s = u - (T/pi) sin(pi u/T) up to T, and u + ((1-T)/pi) sin(pi (u-T)/(1-T)) from there.
    """
    is_up = u <= skew
    before = np.where(is_up, 0.0, skew)
    lasts = np.where(is_up, skew, 1 - skew)
    half = (u - before) / lasts
    swing = np.sin(np.pi * half) / np.pi
    way = before + lasts * (half + np.where(is_up, -swing, swing))
    # Where nearly nothing or nearly all is behind, the difference of two such numbers may be beyond it.
    found: Floats = np.clip(way, 0.0, 1.0)
    return found


def share_by_skew(u: Floats, skew: Floats | float) -> Floats:
    """ds/dT, the change of the share with the skew."""
    rising, falling = _halves(u, skew)
    up = rising * np.cos(np.pi * rising) - np.sin(np.pi * rising) / np.pi
    down = (falling - 1) * np.cos(np.pi * falling) - np.sin(np.pi * falling) / np.pi
    found: Floats = np.where(u <= skew, up, down)
    return found


def _halves(u: Floats, skew: Floats | float) -> tuple[Floats, Floats]:
    """How much of the acceleration, and how much of the deceleration, is behind at ``u``: 0 to 1 each."""
    return np.minimum(u, skew) / skew, (np.maximum(u, skew) - skew) / (1 - skew)
