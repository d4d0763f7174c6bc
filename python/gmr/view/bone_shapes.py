"""Bones as bodies: one shape, placed, turned and stretched for each bone and frame."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["BONE_FACES", "BONE_VERTICES", "Placed", "placed_bones"]

Floats = NDArray[np.float32]

_SIDES = 8
_RINGS = ((0.0, 0.45), (0.03, 0.8), (0.12, 1.0), (0.95, 0.45), (1.0, 0.25))
"""Height and radius of the rings of a bone of length 1 and thickness 1: thick near its head."""
_SLIM = 0.1
"""Thickness over length."""
_THICKEST, _THINNEST = 0.022, 0.009
"""Shares of the figure's size between which the thickness of a bone stays."""
_STEP = 1e-4
"""Share of the figure's size to which lengths are rounded: they do not change by noise."""


def _shape() -> tuple[Floats, NDArray[np.uint32]]:
    """Vertices and faces of a bone from (0, 0, 0) to (0, 1, 0)."""
    angles = np.arange(_SIDES) * (2 * np.pi / _SIDES)
    ring = np.stack([np.sin(angles), np.zeros(_SIDES), np.cos(angles)], axis=1)
    vertices = np.concatenate([ring * radius + [0.0, height, 0.0] for height, radius in _RINGS])
    vertices = np.concatenate([vertices, [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    faces = []
    here, there = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    for start in range(0, _SIDES * (len(_RINGS) - 1), _SIDES):
        above = start + _SIDES
        faces += [np.stack([start + here, start + there, above + there], 1)]
        faces += [np.stack([start + here, above + there, above + here], 1)]
    bottom, top = len(vertices) - 2, len(vertices) - 1
    last = _SIDES * (len(_RINGS) - 1)
    faces += [np.stack([np.full(_SIDES, bottom), there, here], 1)]
    faces += [np.stack([np.full(_SIDES, top), last + here, last + there], 1)]
    return vertices.astype(np.float32), np.concatenate(faces).astype(np.uint32)


BONE_VERTICES, BONE_FACES = _shape()


class Placed(NamedTuple):
    """How the shape stands for each of B bones."""

    positions: Floats
    """(..., B, 3)"""
    wxyzs: Floats
    """(..., B, 4) unit quaternions, w first."""
    scales: Floats
    """(..., B, 3); 0 for a bone that is not known."""


def placed_bones(heads: Floats, tails: Floats, size: float) -> Placed:
    """The short turn that leads +Y to each bone, and its length and thickness.

    Args:
        heads: (..., B, 3).
        tails: (..., B, 3); a bone with NaN in it gets scale 0.
        size: of the figure, in the same unit.
    """
    known = np.asarray(np.isfinite(np.concatenate([heads, tails], axis=-1)).all(axis=-1), np.bool_)
    heads = np.where(known[..., None], heads, np.float32(0))
    vectors = np.where(known[..., None], tails, np.float32(0)) - heads
    lengths = np.linalg.norm(vectors, axis=-1)
    up = np.array([0.0, 1.0, 0.0], np.float32)
    x, y, z = np.moveaxis(np.where(lengths[..., None] > 0, vectors / _above_zero(lengths), up), -1, 0)
    # The quaternion of the short turn from a to b is (1 + a . b, a x b); down from up has no one axis.
    turns = np.stack([1 + y, z, np.zeros_like(x), -x], axis=-1)
    turns = np.where(y[..., None] < -0.999999, np.array([0.0, 1.0, 0.0, 0.0], np.float32), turns)
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    lengths = np.round(lengths / (size * _STEP)) * (size * _STEP)
    thick = np.clip(lengths * _SLIM, size * _THINNEST, size * _THICKEST)
    scales = np.where(known[..., None], np.stack([thick, lengths, thick], axis=-1), 0.0)
    return Placed(heads.astype(np.float32), turns.astype(np.float32), scales.astype(np.float32))


def _above_zero(lengths: Floats) -> Floats:
    return np.where(lengths > 0, lengths, 1)[..., None]
