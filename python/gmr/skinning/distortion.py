"""What skinning does to a surface: volume lost, edges and areas stretched, cross-sections collapsed.

All figures compare a moved mesh with the same mesh at rest, so they need no idea of what is right: a good
blend keeps volume, edges and areas nearly as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import SkinError

__all__ = ["Distortion", "Surface", "segment_distances"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Distortion:
    """A mesh in F frames against itself at rest; (F,) each.

    Attributes:
        volume: enclosed volume over that at rest. Of a mesh with holes it is that of the mesh with each
            hole closed to its middle, and so only as good as the holes are small.
        edge: root mean square of the logarithm of edge lengths over those at rest, by length: 0.1 is a
            tenth longer or shorter.
        edge_worst: the same for the hundredth of the edges (by length) that changed most.
        area: as ``edge``, of the triangles' areas.
        area_worst: as ``edge_worst``, of the triangles' areas.
    """

    volume: FloatArray
    edge: FloatArray
    edge_worst: FloatArray
    area: FloatArray
    area_worst: FloatArray


class Surface:
    """Triangles, and what is measured of them at rest.

    Args:
        vertices: (V, 3) at rest.
        faces: (T, 3) triangles, turned so that they are seen counter-clockwise from outside.

    Raises:
        SkinError: there is no triangle with an area.
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        rest = np.asarray(vertices, np.float64)
        corners = np.asarray(faces, np.int64).reshape(-1, 3)
        area = _areas(rest[None], corners)[0]
        corners = corners[area > 0]
        if not len(corners):
            raise SkinError("the mesh has no triangle with an area, so nothing can be said about its surface")
        # Vertices that lie in one place are one: a seam of texture coordinates is no hole.
        _, first, self._welded = np.unique(rest, axis=0, return_index=True, return_inverse=True)
        self._faces = first[self._welded.reshape(-1)][corners]
        self._faces = self._faces[_areas(rest[None], self._faces)[0] > 0]
        pairs = np.sort(self._faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        self._edges = np.unique(pairs, axis=0)
        self._rims = _rims(self._faces)
        self._lengths = _lengths(rest[None], self._edges)[0]
        self._areas = _areas(rest[None], self._faces)[0]
        self._volume = float(self._volumes(rest[None])[0])

    @property
    def volume(self) -> float:
        """Enclosed at rest, in cubed units of the vertices."""
        return self._volume

    @property
    def is_closed(self) -> bool:
        """Whether there is no hole in it."""
        return not self._rims

    def measured(self, vertices: ArrayLike) -> Distortion:
        """(F, V, 3) moved vertices against those at rest."""
        moved = np.asarray(vertices, np.float64)
        edges = _log_ratio(_lengths(moved, self._edges), self._lengths)
        areas = _log_ratio(_areas(moved, self._faces), self._areas)
        return Distortion(
            volume=self._volumes(moved) / self._volume if self._volume else np.full(len(moved), np.nan),
            edge=_root_mean_square(edges, self._lengths),
            edge_worst=_worst(edges, self._lengths),
            area=_root_mean_square(areas, self._areas),
            area_worst=_worst(areas, self._areas),
        )

    def _volumes(self, vertices: FloatArray) -> FloatArray:
        """By the divergence theorem: of the pyramids between each triangle and the middle."""
        places = vertices - vertices.mean(axis=1, keepdims=True)
        a, b, c = (places[:, self._faces[:, k]] for k in range(3))
        total: FloatArray = np.einsum("fta,fta->f", a, np.cross(b, c)) / 6
        for rim in self._rims:
            middle = places[:, np.unique(rim)].mean(axis=1)[:, None]
            start, end = places[:, rim[:, 0]], places[:, rim[:, 1]]
            total += np.einsum("fta,fta->f", np.broadcast_to(middle, start.shape), np.cross(end, start)) / 6
        return total


def segment_distances(vertices: FloatArray, heads: FloatArray, tails: FloatArray) -> FloatArray:
    """(F, V): how far (F, V, 3) vertices are from the nearest of the segments, (F, B, 3) to (F, B, 3)."""
    way = (tails - heads)[:, None]
    from_head = vertices[:, :, None] - heads[:, None]
    share = (from_head * way).sum(axis=-1) / np.maximum((way * way).sum(axis=-1), 1e-300)
    nearest = from_head - np.clip(share, 0, 1)[..., None] * way
    found: FloatArray = np.linalg.norm(nearest, axis=-1).min(axis=-1)
    return found


def _rims(faces: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """The edges (n, 2) of one triangle only, as it goes round them, hole by hole."""
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, number, count = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True)
    rim = directed[count[number.reshape(-1)] == 1]
    group = {int(v): int(v) for v in rim.reshape(-1)}

    def top(vertex: int) -> int:
        while group[vertex] != vertex:
            group[vertex] = group[group[vertex]]
            vertex = group[vertex]
        return vertex

    for start, end in rim.tolist():
        group[top(start)] = top(end)
    holes = np.array([top(start) for start in rim[:, 0].tolist()])
    return [rim[holes == hole] for hole in np.unique(holes)] if len(rim) else []


def _lengths(vertices: FloatArray, edges: NDArray[np.int64]) -> FloatArray:
    found: FloatArray = np.linalg.norm(vertices[:, edges[:, 1]] - vertices[:, edges[:, 0]], axis=-1)
    return found


def _areas(vertices: FloatArray, faces: NDArray[np.int64]) -> FloatArray:
    a, b, c = (vertices[:, faces[:, k]] for k in range(3))
    found: FloatArray = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=-1)
    return found


def _log_ratio(now: FloatArray, rest: FloatArray) -> FloatArray:
    """Of what vanishes too: a thousandth of what it was is as good as nothing."""
    found: FloatArray = np.abs(np.log(np.maximum(now / rest, 1e-3)))
    return found


def _root_mean_square(values: FloatArray, weights: FloatArray) -> FloatArray:
    found: FloatArray = np.sqrt(np.average(values**2, axis=1, weights=weights))
    return found


def _worst(values: FloatArray, weights: FloatArray, share: float = 0.01) -> FloatArray:
    """The least of the greatest values that make up ``share`` of the weights."""
    order = np.argsort(-values, axis=1, kind="stable")
    heavy = np.cumsum(weights[order], axis=1) >= share * weights.sum()
    place = heavy.argmax(axis=1)
    rows = np.arange(len(values))
    found: FloatArray = values[rows, order[rows, place]]
    return found
