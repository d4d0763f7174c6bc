"""A capsule on two bones, bent and twisted: where blending shows what it does.

Two bones of length 1 meet in the middle of a tube of radius 0.25 with round ends. Each vertex follows the two
bones by the linear gradient of its projection (spec "Skinning", binding): half and half at the joint.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from gmr.skinning.blending import Method, Skin
from gmr.skinning.distortion import Surface, segment_distances
from gmr.table import Table

__all__ = ["RADIUS", "Movement", "capsule", "measured_capsule", "moved_bones", "transforms"]

Movement = Literal["bend", "twist"]
FloatArray = NDArray[np.float64]

RADIUS: Final = 0.25
_LENGTH: Final = 1.0
_MARGIN: Final = 0.35
"""Of a bone's length, to each side of the joint, over which the weights fall."""
_AROUND: Final = 48
_ALONG: Final = 97
"""Rings, of which the middle one lies round the joint."""


@dataclass(frozen=True)
class Capsule:
    """The skin at rest, along Y from -1 to 1, its surface, and the vertices round the joint."""

    skin: Skin
    surface: Surface
    ring: NDArray[np.int64]


@cache
def capsule() -> Capsule:
    """The capsule."""
    angles = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)
    cap = np.linspace(0, np.pi / 2, 13)[1:-1]
    profile = [
        *((-_LENGTH - RADIUS * np.cos(a), RADIUS * np.sin(a)) for a in cap),
        *((y, RADIUS) for y in np.linspace(-_LENGTH, _LENGTH, _ALONG)),
        *((_LENGTH + RADIUS * np.sin(a), RADIUS * np.cos(a)) for a in cap),
    ]
    rings = [
        np.stack([r * np.cos(angles), np.full(_AROUND, y), r * np.sin(angles)], axis=1) for y, r in profile
    ]
    poles = np.array([[0, -_LENGTH - RADIUS, 0], [0, _LENGTH + RADIUS, 0]])
    vertices = np.concatenate([*rings, poles])
    faces = _faces(len(rings), len(vertices))
    second = np.clip((vertices[:, 1] + _MARGIN) / (2 * _MARGIN), 0, 1)
    weights = np.stack([1 - second, second], axis=1)
    outward = vertices - np.clip(vertices * [0, 1, 0], -_LENGTH, _LENGTH)
    skin = Skin(
        vertices,
        np.broadcast_to([0, 1], weights.shape),
        weights,
        2,
        normals=outward / np.linalg.norm(outward, axis=1, keepdims=True),
        faces=faces,
    )
    middle = len(cap) + _ALONG // 2
    return Capsule(skin, Surface(vertices, faces), np.arange(middle * _AROUND, (middle + 1) * _AROUND))


def transforms(movement: Movement, degrees: FloatArray) -> FloatArray:
    """(F, 2, 4, 4): the second bone bent about Z, or twisted about its own axis."""
    turn = np.radians(degrees)
    cosine, sine = np.cos(turn), np.sin(turn)
    found = np.broadcast_to(np.eye(4), (len(turn), 2, 4, 4)).copy()
    a, b = (0, 1) if movement == "bend" else (0, 2)
    found[:, 1, a, a] = found[:, 1, b, b] = cosine
    found[:, 1, a, b], found[:, 1, b, a] = -sine, sine
    return found


def moved_bones(matrices: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Heads and tails (F, 2, 3) of the bones."""
    joint = np.zeros(3)
    end = np.einsum("fab,b->fa", matrices[:, 1, :3, :3], [0, _LENGTH, 0])
    start = np.broadcast_to([0, -_LENGTH, 0], end.shape)
    middle = np.broadcast_to(joint, end.shape)
    return np.stack([start, middle], axis=1), np.stack([middle, end], axis=1)


def measured_capsule(movement: Movement, method: Method, degrees: FloatArray) -> Table:
    """What a movement does to the capsule, a row an angle.

    Returns:
        ``degrees``; ``volume`` over that at rest; ``section``, the area of the ring round the joint over that
        at rest, as a radius (the square root), and ``section_least``, the least distance of its vertices from
        its middle over the radius: 0 where it has collapsed; ``bulge``, how far the outermost vertex is from
        the bones, over the radius, less 1; ``edge`` and ``area`` distortion with their worst hundredths, see
        :class:`~gmr.skinning.distortion.Distortion`.
    """
    of = capsule()
    matrices = transforms(movement, degrees)
    moved = of.skin.blend(matrices, method).astype(np.float64)
    ring = moved[:, of.ring]
    spokes = ring - ring.mean(axis=1, keepdims=True)
    fans = np.cross(spokes, np.roll(spokes, -1, axis=1)).sum(axis=1)
    area = 0.5 * np.linalg.norm(fans, axis=-1)
    rest = 0.5 * _AROUND * RADIUS**2 * np.sin(2 * np.pi / _AROUND)
    distances = segment_distances(moved, *moved_bones(matrices))
    distortion = of.surface.measured(moved)
    return Table(
        {
            "degrees": degrees,
            "volume": distortion.volume,
            "section": np.sqrt(area / rest),
            "section_least": np.linalg.norm(spokes, axis=-1).min(axis=1) / RADIUS,
            "bulge": distances.max(axis=1) / RADIUS - 1,
            "edge": distortion.edge,
            "edge_worst": distortion.edge_worst,
            "area": distortion.area,
            "area_worst": distortion.area_worst,
        }
    )


def _faces(rings: int, vertex_count: int) -> NDArray[np.int64]:
    """Two triangles for each four vertices of two neighbouring rings, and a fan round each pole."""
    start = np.arange(rings - 1)[:, None] * _AROUND
    here = np.arange(_AROUND)
    after = (here + 1) % _AROUND
    a, b, c, d = start + here, start + after, start + _AROUND + here, start + _AROUND + after
    tube = np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)]).reshape(-1, 3)
    south, north, last = vertex_count - 2, vertex_count - 1, (rings - 1) * _AROUND
    bottom = np.stack([np.full(_AROUND, south), here, after], axis=1)
    top = np.stack([np.full(_AROUND, north), last + after, last + here], axis=1)
    return np.concatenate([tube, bottom, top])
