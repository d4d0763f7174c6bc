"""The meshes of a glTF file: points and triangles, and what each point carries besides.

Source: glTF 2.0 specification, 3.7.2 "Meshes".
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_accessors import Accessors
from gmr.formats.gltf_document import Document

__all__ = ["Geometry", "Meshes"]

Floats = NDArray[np.float32]

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_OTHERS: Final = {0: "points", 1: "lines", 2: "line loops", 3: "line strips"}
_MOST_SETS: Final = 16
"""Sets of texture coordinates, and of joints, that are looked for."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """One primitive: V vertices, T triangles."""

    name: str
    """Of its mesh."""
    place: str
    """Where it is in the file."""
    material: int | None
    vertices: Floats
    faces: NDArray[np.int32]
    normals: Floats | None = None
    tangents: Floats | None = None
    colors: Floats | None = None
    texture_coordinates: tuple[Floats, ...] = ()
    joints: NDArray[Any] | None = None
    """(V, K) into the joints of the skin."""
    weights: Floats | None = None
    """(V, K) as the file has them."""
    cache: dict[Any, Any] = field(default_factory=dict, repr=False)
    """What was made of it for a skin, for meshes that several nodes hold."""


class Meshes:
    """The meshes of a file, each read once."""

    def __init__(self, document: Document, accessors: Accessors) -> None:
        self.document = document
        self.accessors = accessors
        self._read: dict[int, tuple[Geometry, ...]] = {}

    def geometries(self, index: int, asker: str) -> tuple[Geometry, ...]:
        """The primitives of the mesh ``index`` that are triangles."""
        mesh = self.document.at("meshes", index, asker)
        if index not in self._read:
            if not mesh.primitives:
                self.document.odd(f"meshes[{index}] is empty")
            name = mesh.name or f"mesh_{index}"
            found = [
                self._geometry(primitive, name, f"meshes[{index}].primitives[{k}]")
                for k, primitive in enumerate(mesh.primitives)
            ]
            self._read[index] = tuple(one for one in found if one is not None)
        return self._read[index]

    def _geometry(self, primitive: Any, name: str, place: str) -> Geometry | None:
        """One primitive; None where it is not drawn as triangles."""
        document, attributes = self.document, primitive.attributes
        if not isinstance(attributes, dict):
            document.wrong(f"{place} has no attributes; export the file again")
        if primitive.mode in _OTHERS:
            document.odd(f"{place} is made of {_OTHERS[primitive.mode]}, which are left out")
            return None
        if primitive.mode not in (_TRIANGLES, _STRIP, _FAN):
            document.wrong(f"{place} has the mode {primitive.mode}; the modes are 0 to 6")
        if "POSITION" not in attributes:
            document.odd(f"{place} has no POSITION, so that nothing is drawn; it is left out")
            return None
        if primitive.targets:
            document.odd(f"{place} has {len(primitive.targets)} morph targets, which are left out")
        if primitive.material is not None:
            document.at("materials", primitive.material, place)
        vertices = self.accessors.floats(attributes["POSITION"], f"{place}.POSITION", ("VEC3",))
        if len(bad := np.flatnonzero(~np.isfinite(vertices).all(axis=1))):
            document.wrong(
                f"{place}: vertex {bad[0]} is at {vertices[bad[0]].tolist()} ({len(bad):,} such vertices); "
                "mend the mesh where it was made and export it again"
            )
        reader = _Attributes(self.document, self.accessors, attributes, len(vertices), place)
        faces = self._faces(primitive, vertices, place)
        joints, weights = reader.influences()
        return Geometry(
            name, place, primitive.material, vertices, faces,
            normals=reader.floats("NORMAL", ("VEC3",)),
            tangents=reader.floats("TANGENT", ("VEC4",)),
            colors=reader.colors(),
            texture_coordinates=reader.texture_coordinates(),
            joints=joints, weights=weights,
        )  # fmt: skip

    def _faces(self, primitive: Any, vertices: Floats, place: str) -> NDArray[np.int32]:
        """(T, 3) triangles."""
        document = self.document
        if primitive.indices is None:
            self.accessors.take(4 * len(vertices), place)
            corners = np.arange(len(vertices), dtype=np.int32)
        else:
            found = self.accessors.array(primitive.indices, f"{place}.indices", ("SCALAR",))
            if found.dtype.kind != "u":
                document.wrong(f"{place}.indices must be unsigned whole numbers; export the file again")
            if found.max(initial=0) >= len(vertices):
                document.wrong(
                    f"{place}.indices go up to {found.max():,}, but there are {len(vertices):,} vertices; "
                    "export the file again"
                )
            self.accessors.take(12 * len(found), place)
            corners = found.astype(np.int32)
        faces = _triangles(corners, primitive.mode)
        if primitive.mode == _TRIANGLES and (rest := len(corners) % 3):
            document.odd(f"{place} has {rest} corners more than its triangles need, which are left out")
        if flat := int(_degenerate(faces).sum()):
            document.odd(f"{place} has {flat:,} triangles two corners of which are one vertex; they are kept")
        return faces


@dataclass(frozen=True)
class _Attributes:
    """What the vertices of one primitive carry besides their place."""

    document: Document
    accessors: Accessors
    found: dict[str, int]
    count: int
    place: str

    def floats(self, name: str, types: tuple[str, ...]) -> Floats | None:
        """(V, C) an attribute; None where it is not there, or where it says nothing."""
        if name not in self.found:
            return None
        array = self.accessors.floats(self.found[name], f"{self.place}.{name}", types)
        self._check_count(array, name)
        if not np.isfinite(array).all():
            self.document.odd(f"{self.place}.{name} has values that are not finite; it is left out")
            return None
        return array

    def texture_coordinates(self) -> tuple[Floats, ...]:
        """All sets."""
        sets = []
        for k in range(_MOST_SETS):
            found = self.floats(f"TEXCOORD_{k}", ("VEC2",))
            if found is None:
                break
            sets.append(found)
        return tuple(sets)

    def colors(self) -> Floats | None:
        """(V, 4) the first set of colours."""
        found = self.floats("COLOR_0", ("VEC3", "VEC4"))
        if found is None or found.shape[1] == 4:
            return found
        self.accessors.take(16 * len(found), self.place)
        return np.concatenate([found, np.ones((len(found), 1), np.float32)], axis=1)

    def influences(self) -> tuple[NDArray[Any] | None, Floats | None]:
        """(V, K) joints and weights of all sets; None where there are none."""
        sets = []
        for k in range(_MOST_SETS):
            names = (f"JOINTS_{k}", f"WEIGHTS_{k}")
            there = [name for name in names if name in self.found]
            if not there:
                break
            if len(there) == 1:
                lacking = next(name for name in names if name not in there)
                self.document.wrong(f"{self.place} has {there[0]} but no {lacking}; export the file again")
            sets.append((self._joints(names[0]), self._weights(names[1])))
        if not sets:
            return None, None
        if len(sets) == 1:
            return sets[0]
        self.accessors.take(32 * self.count * len(sets), self.place)
        joints, weights = zip(*sets, strict=True)
        return np.concatenate(joints, axis=1), np.concatenate(weights, axis=1)

    def _joints(self, name: str) -> NDArray[Any]:
        joints = self.accessors.array(self.found[name], f"{self.place}.{name}", ("VEC4",))
        self._check_count(joints, name)
        if joints.dtype.kind != "u":
            self.document.wrong(f"{self.place}.{name} must be unsigned whole numbers; export the file again")
        return joints

    def _weights(self, name: str) -> Floats:
        found = self.accessors.array(self.found[name], f"{self.place}.{name}", ("VEC4",))
        self._check_count(found, name)
        if found.dtype.kind == "u":
            # Whole numbers are parts of 1 whether or not the file remembers to say so.
            self.accessors.take(4 * found.size, self.place)
            found = found.astype(np.float32) / np.float32(np.iinfo(found.dtype).max)
        bad = ~(np.isfinite(found).all(axis=1) & (found >= 0).all(axis=1))
        if bad.any():
            first = int(np.flatnonzero(bad)[0])
            self.document.wrong(
                f"{self.place}.{name}: vertex {first} has the weights {found[first].tolist()}; "
                "weights must be 0 or more"
            )
        return found

    def _check_count(self, array: NDArray[Any], name: str) -> None:
        if len(array) != self.count:
            self.document.wrong(
                f"{self.place}.{name} has {len(array):,} elements for {self.count:,} vertices; "
                "export the file again"
            )


def _triangles(corners: NDArray[np.int32], mode: int) -> NDArray[np.int32]:
    """(T, 3) triangles of a list, a strip or a fan; of a strip without those that only join it."""
    if mode == _TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if len(corners) < 3:
        return np.zeros((0, 3), np.int32)
    if mode == _FAN:
        first = np.full(len(corners) - 2, corners[0], np.int32)
        return np.stack([corners[1:-1], corners[2:], first], axis=1)
    faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
    faces[1::2, 1:] = faces[1::2, :0:-1]
    return faces[~_degenerate(faces)]


def _degenerate(faces: NDArray[np.int32]) -> NDArray[np.bool_]:
    """(T,) whether two corners are one."""
    a, b, c = faces.T
    return np.asarray((a == b) | (b == c) | (c == a))
