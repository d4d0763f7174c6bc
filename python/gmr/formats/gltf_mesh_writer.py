"""Parts of a character as meshes of a .glb, such that the Khronos glTF-Validator finds nothing wrong."""

from __future__ import annotations

import warnings
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import FormatError, FormatWarning
from gmr.formats.gltf_blob import ELEMENTS, VERTICES, Blob
from gmr.skinning.part import Part
from gmr.skinning.weights import normalised_weights

__all__ = ["primitive_of"]

Floats = NDArray[np.float32]

_UNIT: Final = 1e-3
"""How far a normal may be from length 1 and be written as it is."""


def primitive_of(part: Part, material: int | None, blob: Blob) -> Any:
    """The ``pygltflib.Primitive`` of a part.

    Raises:
        FormatError: the part has no triangle, or values that are not finite.

    Warns:
        FormatWarning: normals without a direction, tangents that are none, colours outside of 0 to 1.
    """
    if not len(part.faces) or not len(part.vertices):
        raise FormatError(f"part '{part.name}' has no triangle, which glTF does not allow; leave it out")
    arrays = {"POSITION": part.vertices}
    if part.normals is not None:
        arrays["NORMAL"] = _normals(part, part.normals)
        if part.tangents is not None and _are_tangents(part.tangents):
            arrays["TANGENT"] = part.tangents
        elif part.tangents is not None:
            _warn(part, "has tangents that are not of length 1; they are left out")
    if part.texture_coordinates is not None:
        sets = (part.texture_coordinates, *part.more_texture_coordinates)
        arrays |= {f"TEXCOORD_{k}": one for k, one in enumerate(sets)}
    if part.colors is not None:
        arrays["COLOR_0"] = _colors(part, part.colors)
    if bad := [name for name, array in arrays.items() if not np.isfinite(array).all()]:
        raise FormatError(f"part '{part.name}': {bad[0]} has values that are not finite; mend them first")
    attributes = {
        name: blob.array(array, VERTICES, bounds=name == "POSITION") for name, array in arrays.items()
    }
    if part.is_skinned:
        attributes |= _influences(part, blob)
    corners = part.faces.reshape(-1)
    kind = np.uint16 if len(part.vertices) <= 65535 else np.uint32
    return blob.model.Primitive(
        attributes=blob.model.Attributes(**attributes),
        indices=blob.array(corners.astype(kind), ELEMENTS),
        material=material,
        mode=4,
    )


def _influences(part: Part, blob: Blob) -> dict[str, int]:
    """Joints and weights, four by four."""
    joints, weights = _merged(part.joints, part.weights)
    weights = normalised_weights(weights).weights
    spare = ((0, 0), (0, -joints.shape[1] % 4))
    joints, weights = np.pad(joints, spare), np.pad(weights, spare)
    kind = np.uint8 if joints.max() < 256 else np.uint16
    found = {}
    for k in range(joints.shape[1] // 4):
        four = slice(4 * k, 4 * k + 4)
        found[f"JOINTS_{k}"] = blob.array(joints[:, four].astype(kind), VERTICES)
        found[f"WEIGHTS_{k}"] = blob.array(weights[:, four], VERTICES)
    return found


def _merged(joints: NDArray[np.int32], weights: Floats) -> tuple[NDArray[np.int32], Floats]:
    """The same with no joint twice at a vertex: its first place has all of its weight."""
    joints, weights = joints.copy(), weights.copy()
    for later in range(1, joints.shape[1]):
        for earlier in range(later):
            twice = (joints[:, later] == joints[:, earlier]) & (weights[:, later] > 0)
            twice &= weights[:, earlier] > 0
            weights[twice, earlier] += weights[twice, later]
            weights[twice, later] = 0
            joints[twice, later] = 0
    return joints, weights


def _normals(part: Part, normals: Floats) -> Floats:
    """Normals of length 1; those without a direction get the one of their faces."""
    lengths = np.linalg.norm(normals.astype(np.float64), axis=1)
    if (np.abs(lengths - 1) <= _UNIT).all():
        return normals
    found = normals / np.where(lengths > 0, lengths, 1)[:, None]
    if (lengths == 0).any():
        _warn(part, f"has {int((lengths == 0).sum()):,} normals of length 0; they are made from the faces")
        found[lengths == 0] = _of_faces(part)[lengths == 0]
    return np.asarray(found, np.float32)


def _of_faces(part: Part) -> NDArray[np.float64]:
    """(V, 3) mean normal of the faces at each vertex, by their areas; +Y where there is none."""
    a, b, c = (part.vertices[part.faces[:, k]].astype(np.float64) for k in range(3))
    across = np.cross(b - a, c - a)
    found = np.zeros((len(part.vertices), 3))
    for k in range(3):
        np.add.at(found, part.faces[:, k], across)
    lengths = np.linalg.norm(found, axis=1)
    found[lengths == 0] = (0, 1, 0)
    return np.asarray(found / np.where(lengths > 0, lengths, 1)[:, None])


def _are_tangents(tangents: Floats) -> bool:
    lengths = np.linalg.norm(tangents[:, :3], axis=1)
    return bool((np.abs(lengths - 1) <= _UNIT).all() and (np.abs(tangents[:, 3]) == 1).all())


def _colors(part: Part, colors: Floats) -> Floats:
    """Colours from 0 to 1."""
    clipped = np.clip(colors, 0, 1)
    if not np.array_equal(clipped, colors):
        _warn(part, "has colours outside of 0 to 1, which are cut to that")
    return clipped


def _warn(part: Part, what: str) -> None:
    warnings.warn(FormatWarning(f"part '{part.name}' {what}."), stacklevel=7)
