"""Bone heat: weights as the temperatures of a skin that each bone warms where it is nearest.

``(C + M H) w_j = M H p_j``: C is the cotangent Laplacian, M the vertices' areas, ``H = 1/d^2`` with d the
distance to the nearest bone, and p_j is 1 where that bone is joint j's (shared where several are equally
near). Bones that the skin hides from a vertex are not told apart from others.

Source: Baran and Popović 2007, "Automatic Rigging and Animation of 3D Characters", section 4.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.errors import MissingExtraError, SkinError
from gmr.skinning.bone_segments import BoneSegments

if TYPE_CHECKING:
    from scipy.sparse import csc_array

__all__ = ["heat_weights"]

Floats = NDArray[np.float64]
Found = tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.uint32], int, int]

_INFLUENCES = 4

_EQUALLY_NEAR = 1e-6
"""Bones whose distances differ by less, as a part of the mesh's size, share a vertex."""

_FLATTEST = 1e-6
"""Sines of angles below which a triangle's cotangents are those of this one."""

_COLDEST = 1e-9
"""The least warmth that bones give a vertex, so that one with next to no area has a temperature."""

_NOTHING = 1e-6
"""Temperatures below this are what rounding leaves."""


def heat_weights(vertices: Floats, faces: NDArray[np.int32], bones: BoneSegments) -> Found:
    """Joints and weights (V, 4), no vertex in no box, and twice the count of torn edges.

    Vertices at one place are one; what no surface reaches, loose vertices, follows its nearest bone.

    Args:
        vertices: (V, 3), finite.
        faces: (T, 3).
        bones: B of them.

    Raises:
        SkinError: a triangle names a vertex that is not there.
        MissingExtraError: SciPy is not installed.
    """
    try:
        from scipy.sparse.linalg import splu
    except ImportError as error:
        raise MissingExtraError("scipy", "heat", "Binding by bone heat") from error
    _check(faces, len(vertices))
    places, inverse = np.unique(vertices + 0.0, axis=0, return_inverse=True)
    welded = inverse.reshape(-1)[faces]
    middle = places.mean(axis=0)
    size = max(
        float(np.linalg.norm(places - middle, axis=1).max()), float(np.abs(bones.tails - middle).max())
    )
    # Measured in its own size, a mesh has weights that do not depend on the unit.
    unit = (places - middle) / size
    distances = _distances(unit, (bones.heads - middle) / size, (bones.tails - middle) / size)
    nearest = distances.min(axis=1)
    carriers, first = np.unique(bones.joints, return_index=True)
    of_joints = np.minimum.reduceat(distances, first, axis=1)
    warmed = (of_joints <= nearest[:, None] + _EQUALLY_NEAR).astype(np.float64)
    warmed /= warmed.sum(axis=1, keepdims=True)
    laplacian, areas = _laplacian(unit, welded)
    warmth = np.maximum(areas / np.maximum(nearest, _EQUALLY_NEAR) ** 2, _COLDEST)
    matrix: Any = laplacian + _diagonal(warmth)
    temperatures = splu(matrix.tocsc()).solve(warmth[:, None] * warmed)
    joints, weights = _strongest(temperatures, carriers)
    torn = _torn(welded, joints, weights)
    inverse = inverse.reshape(-1)
    return joints[inverse], weights[inverse], np.zeros(0, np.uint32), torn, torn


def _check(faces: NDArray[np.int32], vertex_count: int) -> None:
    wrong = np.argwhere((faces < 0) | (faces >= vertex_count))
    if len(wrong):
        face, corner = wrong[0].tolist()
        raise SkinError(f"triangle {face} names vertex {faces[face, corner]}, but there are {vertex_count}")


def _distances(places: Floats, heads: Floats, tails: Floats) -> Floats:
    """(V, B) from places (V, 3) to the segments from heads to tails (B, 3)."""
    found = np.empty((len(places), len(heads)))
    for bone, (head, tail) in enumerate(zip(heads, tails, strict=True)):
        along = tail - head
        squared = along @ along
        part = np.clip((places - head) @ along / squared, 0, 1) if squared > 0 else np.zeros(len(places))
        found[:, bone] = np.linalg.norm(places - (head + part[:, None] * along), axis=1)
    return found


def _laplacian(places: Floats, faces: NDArray[np.intp]) -> tuple[csc_array, Floats]:
    """C (V, V), whose rows sum to 0, and (V,) a third of the area of the triangles round each vertex."""
    from scipy.sparse import coo_array

    count = len(places)
    rows, columns, values = [], [], []
    areas = np.zeros(count)
    for corner in range(3):
        at, b, c = (faces[:, (corner + k) % 3] for k in range(3))
        to_b, to_c = places[b] - places[at], places[c] - places[at]
        doubled = np.linalg.norm(np.cross(to_b, to_c), axis=1)
        np.add.at(areas, at, doubled / 6)
        sides = np.linalg.norm(to_b, axis=1) * np.linalg.norm(to_c, axis=1)
        flat = np.maximum(doubled, _FLATTEST * sides)
        dots = np.einsum("ti,ti->t", to_b, to_c)
        # Where an angle is obtuse its cotangent is negative, and temperatures could be: then nothing flows.
        half = np.maximum(np.divide(dots, 2 * flat, out=np.zeros(len(flat)), where=doubled > 0), 0.0)
        rows += [b, c, b, c]
        columns += [c, b, b, c]
        values += [-half, -half, half, half]
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return coo_array(entries, shape=(count, count)).tocsc(), areas


def _diagonal(values: Floats) -> csc_array:
    from scipy.sparse import coo_array

    place = np.arange(len(values))
    return coo_array((values, (place, place)), shape=(len(values), len(values))).tocsc()


def _strongest(
    temperatures: Floats, carriers: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """(V, 4) joints and weights of temperatures (V, C); joint 0 where the weight is 0."""
    warm = np.where(temperatures > _NOTHING, temperatures, 0.0)
    spare = max(0, _INFLUENCES - warm.shape[1])
    warm, numbers = np.pad(warm, ((0, 0), (0, spare))), np.pad(carriers, (0, spare))
    order = np.argsort(-warm, axis=1, kind="stable")[:, :_INFLUENCES]
    kept = np.take_along_axis(warm, order, axis=1)
    weights = (kept / kept.sum(axis=1, keepdims=True)).astype(np.float32)
    return np.where(weights > 0, numbers[order], 0).astype(np.int32), weights


def _torn(faces: NDArray[np.intp], joints: NDArray[np.int32], weights: NDArray[np.float32]) -> int:
    """How many edges have ends that follow no joint in common."""
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    a, b = edges[edges[:, 0] != edges[:, 1]].T
    same = joints[a][:, :, None] == joints[b][:, None, :]
    both = (weights[a] > 0)[:, :, None] & (weights[b] > 0)[:, None, :]
    return int((~(same & both).any(axis=(1, 2))).sum())
