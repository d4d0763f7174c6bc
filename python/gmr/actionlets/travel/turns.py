"""Turns of a joint: flexion about X, then sideways about Z, then rotation about Y, as matrices and back.

What is returned lies in Fortran's order, the frames of one element side by side: then what is done to an
element is done to a long row of numbers. Matrices in the other order are welcome, and take longer.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "about_x",
    "about_y",
    "about_z",
    "angles_of",
    "bent",
    "dots",
    "picked",
    "pitched",
    "product",
    "seen_from",
    "times",
    "turned",
    "turned_back",
]

Floats = NDArray[np.float64]


def product(x: Floats, z: Floats, y: Floats) -> Floats:
    """(F, 3, 3) ``Rx(x) Rz(z) Ry(y)`` of (F,) signed angles about the axes in radians."""
    cx, sx, cz, sz, cy, sy = np.cos(x), np.sin(x), np.cos(z), np.sin(z), np.cos(y), np.sin(y)
    up, aside = sz * cy, sz * sy
    found = _matrices(len(x))
    found[:, 0, 0], found[:, 0, 1], found[:, 0, 2] = cz * cy, -sz, cz * sy
    found[:, 1, 0], found[:, 1, 1], found[:, 1, 2] = cx * up + sx * sy, cx * cz, cx * aside - sx * cy
    found[:, 2, 0], found[:, 2, 1], found[:, 2, 2] = sx * up - cx * sy, sx * cz, sx * aside + cx * cy
    return found


def angles_of(turn: Floats) -> tuple[Floats, Floats, Floats]:
    """(F,) x, z and y of (F, 3, 3) matrices, so that :func:`product` gives them back; z within a quarter."""
    z = np.arcsin(np.minimum(np.maximum(-turn[:, 0, 1], -1), 1))
    return np.arctan2(turn[:, 2, 1], turn[:, 1, 1]), z, np.arctan2(turn[:, 0, 2], turn[:, 0, 0])


def about_x(angle: Floats) -> Floats:
    """(F, 3, 3) turns about X by (F,) radians."""
    return _about(0, 1, 2, angle)


def about_y(angle: Floats) -> Floats:
    """(F, 3, 3) turns about Y by (F,) radians: to the left."""
    return _about(1, 2, 0, angle)


def about_z(angle: Floats) -> Floats:
    """(F, 3, 3) turns about Z by (F,) radians."""
    return _about(2, 0, 1, angle)


def pitched(pitch: Floats) -> Floats:
    """(F, 3, 3) turns that lift the toes by (F,) radians."""
    return about_x(-pitch)


def bent(matrix: Floats, angle: Floats) -> Floats:
    """(F, 3, 3) ``M Rx(angle)``: the turns ``M`` of what is turned about X by (F,) radians first."""
    c, s = np.cos(angle), np.sin(angle)
    found = _matrices(len(matrix))
    columns, y, z = found.T, matrix[:, :, 1].T, matrix[:, :, 2].T
    columns[0] = matrix[:, :, 0].T
    columns[1] = y * c + z * s
    columns[2] = z * c - y * s
    return found


def times(matrix: Floats, other: Floats) -> Floats:
    """(F, 3, 3) ``M N``."""
    found: Floats = np.einsum("fij,fjk->fik", np.asfortranarray(matrix), np.asfortranarray(other), order="F")
    return found


def seen_from(matrix: Floats, other: Floats) -> Floats:
    """(F, 3, 3) ``M^T N``: the turns ``N`` in the frame of ``M``."""
    found: Floats = np.einsum("fji,fjk->fik", np.asfortranarray(matrix), np.asfortranarray(other), order="F")
    return found


def dots(one: Floats, other: Floats) -> Floats:
    """(F,) ``u v`` of (F, 3) vectors."""
    found: Floats = np.einsum("fi,fi->f", one, other)
    return found


def turned(matrix: Floats, vector: Floats) -> Floats:
    """(F, 3) vectors ``M v``; one vector (3,) is turned by all matrices."""
    rule = "fij,j->fi" if vector.ndim == 1 else "fij,fj->fi"
    found: Floats = np.einsum(rule, np.asfortranarray(matrix), np.asfortranarray(vector))
    return found


def turned_back(matrix: Floats, vector: Floats) -> Floats:
    """(F, 3) vectors ``M^T v`` of (F, 3) vectors."""
    found: Floats = np.einsum("fji,fj->fi", np.asfortranarray(matrix), np.asfortranarray(vector))
    return found


def picked(values: Floats, frames: NDArray[np.intp]) -> Floats:
    """(m, ...) some of (F, ...) frames."""
    found: Floats = values.T.take(frames, axis=-1).T
    return found


def _matrices(count: int) -> Floats:
    return np.empty((count, 3, 3), order="F")


def _about(axis: int, first: int, second: int, angle: Floats) -> Floats:
    """Turns about an axis that take the first of the others towards the second."""
    found = np.zeros((len(angle), 3, 3), order="F")
    found[:, axis, axis] = 1
    found[:, first, first] = found[:, second, second] = np.cos(angle)
    found[:, second, first] = np.sin(angle)
    found[:, first, second] = -found[:, second, first]
    return found
