"""Matrices from translation, rotation and scale, and back: ``M = T R S``, as glTF composes them.

Source: glTF 2.0 specification, 3.5.3 "Transformations".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.quaternions import from_matrices, matrices

__all__ = ["Decomposed", "continuous", "decomposed", "local_matrices", "nearest_rotations"]

Array = NDArray[np.float64]

_RIGID = 1e-9
"""How far ``M^T M`` may be from the identity for M to count as a rotation without looking further."""


def local_matrices(translations: Array, rotations: Array, scales: Array) -> Array:
    """(..., 4, 4) of (..., 3) translations, (..., 4) unit quaternions xyzw and (..., 3) scales."""
    shape = np.broadcast_shapes(translations.shape[:-1], rotations.shape[:-1], scales.shape[:-1])
    found = np.zeros((*shape, 4, 4))
    found[..., :3, :3] = matrices(rotations) * scales[..., None, :]
    found[..., :3, 3] = translations
    found[..., 3, 3] = 1
    return found


class Decomposed(NamedTuple):
    """What :func:`decomposed` finds."""

    translations: Array
    """(..., 3)"""
    rotations: Array
    """(..., 4) unit quaternions xyzw."""
    scales: Array
    """(..., 3)"""
    error: Array
    """(...,) greatest difference between the matrix and what the three make, as a share of its greatest
    entry: where it is not small the matrix is sheared."""


def decomposed(found: Array, signs: Array | None = None) -> Decomposed:
    """Translation, rotation and scale of (..., 4, 4) matrices.

    Args:
        found: affine matrices.
        signs: (..., 3) of the scales where they are known (1 or -1); a mirror image has all three negative
            where these do not make one.
    """
    linear = found[..., :3, :3]
    lengths = np.linalg.norm(linear, axis=-2)
    mirrored = np.linalg.det(linear) < 0
    given = np.ones(3) if signs is None else np.where(signs < 0, -1.0, 1.0)
    given = np.broadcast_to(given, lengths.shape)
    fits = (given.prod(axis=-1) < 0) == mirrored
    scales = lengths * np.where(fits[..., None], given, np.where(mirrored, -1.0, 1.0)[..., None])
    divisors = np.where(scales == 0, 1.0, scales)
    rotations = from_matrices(nearest_rotations(linear / divisors[..., None, :]))
    rebuilt = local_matrices(found[..., :3, 3], rotations, scales)
    size = np.maximum(np.abs(linear).max(axis=(-2, -1)), np.finfo(float).tiny)
    error = np.abs(rebuilt - found)[..., :3, :3].max(axis=(-2, -1)) / size
    return Decomposed(found[..., :3, 3].copy(), rotations, scales, error)


def nearest_rotations(linear: Array) -> Array:
    """(..., 3, 3) the rotation nearest to each matrix: its orthogonal polar factor.

    Source: Higham, "Computing the polar decomposition with applications", SIAM J. Sci. Stat.
    Comput. 7 (1986).
    """
    gram = np.swapaxes(linear, -1, -2) @ linear
    rigid = (np.abs(gram - np.eye(3)).max(axis=(-2, -1)) <= _RIGID) & (np.linalg.det(linear) > 0)
    if rigid.all():
        return linear
    found = np.array(linear)
    u, _, v = np.linalg.svd(linear[~rigid])
    u[..., :, 2] *= np.where(np.linalg.det(u @ v) < 0, -1.0, 1.0)[..., None]
    found[~rigid] = u @ v
    return found


def continuous(rotations: Array) -> Array:
    """(F, ..., 4) the same rotations, each quaternion on the side of the one before it."""
    dots = (rotations[1:] * rotations[:-1]).sum(axis=-1)
    signs = np.cumprod(np.where(dots < 0, -1.0, 1.0), axis=0)
    found = rotations.copy()
    found[1:] *= signs[..., None]
    return found
