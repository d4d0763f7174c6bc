"""Ranges of motion, kept softly: what comes near to a limit is squashed against it and does not pass it.

Between its limits that is the identity but for a margin ``m`` at both ends. There, with
``y = (x - high + m) / m``, it is ``high - m + m y / sqrt(1 + y^2)``: C2 where the margin begins, and below
``high`` for every ``x``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["MARGIN", "near", "squashed", "unsquashed"]

Floats = NDArray[np.float64]

MARGIN = np.radians(3.0)
"""Radians before a limit from which on angles are squashed."""

_FARTHEST = 0.999
"""Share of the margin up to which it is told where an angle came from."""


def near(angles: Floats, low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Which angles are squashed: those in the margins and beyond."""
    return np.asarray((angles > high - MARGIN) | (angles < low + MARGIN), np.bool_)


def squashed(angles: Floats, low: Floats, high: Floats) -> Floats:
    """(..., K) angles between their limits.

    Args:
        angles: (..., K) radians.
        low, high: (K,) radians, further apart than two margins.
    """
    top, bottom = high - MARGIN, low + MARGIN
    kept = np.minimum(np.maximum(angles, bottom), top)
    y = (angles - kept) / MARGIN
    return np.asarray(kept + MARGIN * y / np.sqrt(1 + y * y), np.float64)


def unsquashed(angles: Floats, low: Floats, high: Floats) -> Floats:
    """(..., K) what is squashed to these angles; those beyond the limits count as just within them."""
    kept = np.minimum(np.maximum(angles, low + MARGIN), high - MARGIN)
    z = np.minimum(np.maximum((angles - kept) / MARGIN, -_FARTHEST), _FARTHEST)
    return np.asarray(kept + MARGIN * z / np.sqrt(1 - z * z), np.float64)
