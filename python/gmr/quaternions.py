"""Products of arrays of quaternions (x, y, z, w)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "IDENTITY",
    "about",
    "conjugate",
    "from_matrices",
    "matrices",
    "multiply",
    "part_of",
    "rotated",
]

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


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


def rotated(a: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 3) vectors turned by (..., 4) unit quaternions: ``v + 2 q x (q x v + w v)``."""
    axis, w = a[..., :3], a[..., 3:]
    found: NDArray[np.float64] = vectors + 2 * np.cross(axis, np.cross(axis, vectors) + w * vectors)
    return found


def about(axis: NDArray[np.float64], angle: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 4) turns by (...,) angles in radians about (..., 3) unit axes."""
    half = np.asarray(angle)[..., None] / 2
    axis = np.broadcast_to(axis, (*half.shape[:-1], 3))
    return np.concatenate([axis * np.sin(half), np.cos(half)], axis=-1)


def part_of(a: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """(..., 4) ``share`` of each turn, the short way round: ``slerp(1, a, share)``."""
    size = np.linalg.norm(a[..., :3], axis=-1)
    angle = 2 * np.arctan2(size, np.abs(a[..., 3]))
    axis = a[..., :3] * np.where(a[..., 3:] < 0, -1.0, 1.0)
    return about(axis / np.where(size > 0, size, 1.0)[..., None], share * angle)


def matrices(a: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """(..., 3, 3) rotation matrices of (..., 4) unit quaternions."""
    x, y, z, w = np.moveaxis(np.asarray(a, np.float64), -1, 0)
    found: NDArray[np.float64] = np.empty((*a.shape[:-1], 3, 3))
    found[..., 0, :] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=-1)
    found[..., 1, :] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=-1)
    found[..., 2, :] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=-1)
    return found


def from_matrices(a: NDArray[np.float64]) -> NDArray[np.float64]:
    """(..., 4) unit quaternions of (..., 3, 3) rotation matrices; NaN where those are.

    Each row of ``4 q q^T`` is the quaternion times one of its components; that of the greatest is taken.
    Source: Shepperd, "Quaternion from Rotation Matrix", J. Guid. Control 1 (1978) 223.
    """
    found = np.empty((*a.shape[:-2], 4, 4))
    x, y, z = a[..., 0, 0], a[..., 1, 1], a[..., 2, 2]
    for k, square in enumerate((1 + x - y - z, 1 - x + y - z, 1 - x - y + z, 1 + x + y + z)):
        found[..., k, k] = square
    for i, j, k in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
        found[..., i, j] = found[..., j, i] = a[..., i, j] + a[..., j, i]
        found[..., k, 3] = found[..., 3, k] = (a[..., j, i] - a[..., i, j]) * (1 if k != 1 else -1)
    best = np.nan_to_num(np.diagonal(found, axis1=-2, axis2=-1)).argmax(axis=-1)
    row = np.take_along_axis(found, best[..., None, None], axis=-2)[..., 0, :]
    unit: NDArray[np.float64] = row / np.linalg.norm(row, axis=-1, keepdims=True)
    return unit
