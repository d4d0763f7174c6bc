"""Polygons cut into triangles: fans where they are convex, ears where they are not.

Source: Meisters, "Polygons have ears", Amer. Math. Monthly 82 (1975) 648; normals after Newell, in
Sutherland, Sproull and Schumacker, "A characterization of ten hidden-surface algorithms", Comput. Surv. 6
(1974).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

__all__ = ["triangulated"]

Points = NDArray[np.float64]

_MOST_CONCAVE: Final = 500
"""Corners of a concave polygon at most: finding ears may take their number cubed."""


def triangulated(
    corners: NDArray[np.int32], sizes: NDArray[np.int64], vertices: NDArray[np.floating]
) -> NDArray[np.int32]:
    """(T, 3) triangles, polygon after polygon, wound as the polygons are.

    Args:
        corners: (C,) vertices of all polygons, one after the other.
        sizes: (P,) corners of each, 3 or more.
        vertices: (V, 3) places.

    Raises:
        ValueError: a polygon is concave and has too many corners; its arguments are the polygon and a
            sentence.
    """
    starts = np.cumsum(sizes) - sizes
    counts = sizes - 2
    faces = np.empty((int(counts.sum()), 3), np.int32)
    firsts = np.cumsum(counts) - counts
    places = vertices.astype(np.float64)
    three = sizes == 3
    faces[firsts[three]] = corners[starts[three][:, None] + np.arange(3)]
    four = np.flatnonzero(sizes == 4)
    if len(four):
        quads = corners[starts[four][:, None] + np.arange(4)]
        pairs = _of_quads(quads, places)
        faces[firsts[four]], faces[firsts[four] + 1] = pairs[:, 0], pairs[:, 1]
    for polygon in np.flatnonzero(sizes > 4).tolist():
        mine = corners[starts[polygon] : starts[polygon] + sizes[polygon]]
        flat = _flattened(places[mine])
        if len(mine) > _MOST_CONCAVE and not _is_convex(flat):
            what = f"a concave polygon has {len(mine):,} corners; cut it into triangles where it was made"
            raise ValueError(polygon, what)
        faces[firsts[polygon] : firsts[polygon] + counts[polygon]] = mine[_triangles(flat)]
    return faces


def _of_quads(quads: NDArray[np.int32], places: Points) -> NDArray[np.int32]:
    """(Q, 2, 3) both triangles of each, cut from the first corner unless that would lie outside."""
    a, b, c, d = (places[quads[:, k]] for k in range(4))
    normal = np.cross(c - a, d - b)
    one, other = (np.cross(b - a, c - a) * normal).sum(1), (np.cross(c - a, d - a) * normal).sum(1)
    outside = (one < 0) | (other < 0)
    found = np.where(outside[:, None], quads[:, [1, 2, 3, 1, 3, 0]], quads[:, [0, 1, 2, 0, 2, 3]])
    return found.reshape(-1, 2, 3)


def _flattened(points: Points) -> NDArray[np.float64]:
    """(N, 2) the polygon seen along its normal, wound counter-clockwise."""
    points = points - points[0]
    following = np.roll(points, -1, axis=0)
    normal = np.cross(points, following).sum(axis=0)
    axis = int(np.abs(normal).argmax())
    flat = np.delete(points, axis, axis=1)
    # Seen along x or z the other two axes make a right-handed pair; along y a left-handed one.
    if (normal[axis] < 0) != (axis == 1):
        flat[:, 0] *= -1
    return flat


def _is_convex(flat: NDArray[np.float64]) -> bool:
    turns = _cross(flat, np.roll(flat, -1, axis=0), np.roll(flat, -2, axis=0))
    steps = np.roll(flat, -1, axis=0) - flat
    # Turning to one side all the way, and once around.
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    around = np.abs((np.diff(np.append(angles, angles[0])) + np.pi) % (2 * np.pi) - np.pi).sum()
    return bool((turns >= 0).all() and around < 3 * np.pi)


def _triangles(flat: NDArray[np.float64]) -> NDArray[np.int64]:
    """(N - 2, 3) corners of the triangles."""
    count = len(flat)
    if _is_convex(flat):
        rest = np.arange(1, count - 1)
        return np.stack([np.zeros_like(rest), rest, rest + 1], axis=1)
    left = list(range(count))
    faces = []
    while len(left) > 3:
        k = _ear(flat[left])
        faces.append([left[k - 1], left[k], left[(k + 1) % len(left)]])
        del left[k]
    return np.array([*faces, left])


def _ear(flat: NDArray[np.float64]) -> int:
    """A corner whose triangle holds no other corner; the sharpest where a polygon crosses itself."""
    before, after = np.roll(flat, 1, axis=0), np.roll(flat, -1, axis=0)
    turns = _cross(before, flat, after)
    reflex = flat[turns <= 0]
    for k in np.flatnonzero(turns > 0).tolist():
        a, b, c = before[k], flat[k], after[k]
        inside = (_cross(a, b, reflex) >= 0) & (_cross(b, c, reflex) >= 0) & (_cross(c, a, reflex) >= 0)
        corner = (reflex == a).all(axis=1) | (reflex == b).all(axis=1) | (reflex == c).all(axis=1)
        if not (inside & ~corner).any():
            return k
    return int(turns.argmax())


def _cross(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
    """(...,) twice the area of the triangles, positive where they are wound counter-clockwise."""
    along, across = b - a, c - a
    return np.asarray(along[..., 0] * across[..., 1] - along[..., 1] * across[..., 0])
