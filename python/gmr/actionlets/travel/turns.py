"""Turns of a joint: flexion about X, then sideways about Z, then rotation about Y, as matrices and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["about_x", "about_y", "about_z", "angles_of", "pitched", "product", "turned", "turned_back"]

Floats = NDArray[np.float64]


def product(x: Floats, z: Floats, y: Floats) -> Floats:
    """(F, 3, 3) ``Rx(x) Rz(z) Ry(y)`` of (F,) signed angles about the axes in radians."""
    cx, sx, cz, sz, cy, sy = np.cos(x), np.sin(x), np.cos(z), np.sin(z), np.cos(y), np.sin(y)
    up, aside = sz * cy, sz * sy
    found = np.empty((len(x), 3, 3))
    found[:, 0, 0], found[:, 0, 1], found[:, 0, 2] = cz * cy, -sz, cz * sy
    found[:, 1, 0], found[:, 1, 1], found[:, 1, 2] = cx * up + sx * sy, cx * cz, cx * aside - sx * cy
    found[:, 2, 0], found[:, 2, 1], found[:, 2, 2] = sx * up - cx * sy, sx * cz, sx * aside + cx * cy
    return found


def angles_of(turn: Floats) -> tuple[Floats, Floats, Floats]:
    """(F,) x, z and y of (F, 3, 3) matrices, so that :func:`product` gives them back; z within a quarter."""
    z = np.arcsin(np.clip(-turn[:, 0, 1], -1, 1))
    return np.arctan2(turn[:, 2, 1], turn[:, 1, 1]), z, np.arctan2(turn[:, 0, 2], turn[:, 0, 0])


def about_x(angle: Floats) -> Floats:
    """(F, 3, 3) turns about X by (F,) radians."""
    found = np.zeros((len(angle), 3, 3))
    found[:, 0, 0] = 1
    found[:, 1, 1] = found[:, 2, 2] = np.cos(angle)
    found[:, 2, 1] = np.sin(angle)
    found[:, 1, 2] = -found[:, 2, 1]
    return found


def about_y(angle: Floats) -> Floats:
    """(F, 3, 3) turns about Y by (F,) radians: to the left."""
    found = np.zeros((len(angle), 3, 3))
    found[:, 1, 1] = 1
    found[:, 0, 0] = found[:, 2, 2] = np.cos(angle)
    found[:, 0, 2] = np.sin(angle)
    found[:, 2, 0] = -found[:, 0, 2]
    return found


def about_z(angle: Floats) -> Floats:
    """(F, 3, 3) turns about Z by (F,) radians."""
    found = np.zeros((len(angle), 3, 3))
    found[:, 2, 2] = 1
    found[:, 0, 0] = found[:, 1, 1] = np.cos(angle)
    found[:, 1, 0] = np.sin(angle)
    found[:, 0, 1] = -found[:, 1, 0]
    return found


def pitched(pitch: Floats) -> Floats:
    """(F, 3, 3) turns that lift the toes by (F,) radians."""
    return about_x(-pitch)


def turned(matrix: Floats, vector: Floats) -> Floats:
    """(F, 3) vectors ``M v``; one vector (3,) is turned by all matrices."""
    if vector.ndim == 1:
        return np.asarray((matrix.reshape(-1, 3) @ vector).reshape(-1, 3), np.float64)
    return np.asarray((matrix @ vector[:, :, None])[:, :, 0], np.float64)


def turned_back(matrix: Floats, vector: Floats) -> Floats:
    """(F, 3) vectors ``M^T v`` of (F, 3) vectors."""
    return np.asarray((vector[:, None, :] @ matrix)[:, 0, :], np.float64)
