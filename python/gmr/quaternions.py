"""Products of arrays of quaternions (x, y, z, w)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["conjugate", "multiply"]


def multiply(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 4) Hamilton product: the rotation ``b``, then ``a``."""
    ax, ay, az, aw = np.moveaxis(a, -1, 0)
    bx, by, bz, bw = np.moveaxis(b, -1, 0)
    found: NDArray[np.float64] = np.empty(np.broadcast_shapes(a.shape, b.shape))
    found[..., 0] = aw * bx + ax * bw + ay * bz - az * by
    found[..., 1] = aw * by - ax * bz + ay * bw + az * bx
    found[..., 2] = aw * bz + ax * by - ay * bx + az * bw
    found[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return found


def conjugate(a: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 4) the inverse rotations of unit quaternions."""
    inverse: NDArray[np.float64] = a * np.array([-1.0, -1.0, -1.0, 1.0])
    return inverse
