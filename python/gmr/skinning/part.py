"""One mesh of a character: points, triangles, what they look like, and which joints carry them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import frozen
from gmr.errors import GmrError

__all__ = ["Part"]


@dataclass(frozen=True, eq=False, repr=False)
class Part:
    """One mesh with one material.

    Args:
        name: of the mesh; parts of one mesh share it.
        vertices: (V, 3) float32 metres, in the mesh's own space.
        faces: (T, 3) int32 triangles, counter-clockwise seen from outside.
        normals: (V, 3) float32 unit vectors; None where the file has none.
        texture_coordinates: (V, 2) float32, v downward as in glTF; None where the file has none.
        material: which of the character's materials; None: the file names none.
        joints: (V, K) int32 into the character's joints; K = 0 where nothing carries the part.
        weights: (V, K) float32 that sum to 1.
        inverse_bind: (J, 4, 4) float64 from mesh space to the space of each of the character's joints;
            None where nothing carries the part.
        tangents: (V, 4) float32, the fourth the sign of the bitangent.
        colors: (V, 4) float32 linear RGBA.
        more_texture_coordinates: further sets, (V, 2) float32 each.
        node: which of the character's nodes holds the mesh; its transform says nothing about a part that
            joints carry.

    Raises:
        GmrError: the arrays do not fit each other, or an index is out of range.
    """

    name: str
    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]
    normals: NDArray[np.float32] | None
    texture_coordinates: NDArray[np.float32] | None
    material: int | None
    joints: NDArray[np.int32]
    weights: NDArray[np.float32]
    inverse_bind: NDArray[np.float64] | None
    tangents: NDArray[np.float32] | None = None
    colors: NDArray[np.float32] | None = None
    more_texture_coordinates: tuple[NDArray[np.float32], ...] = ()
    node: int = -1

    def __post_init__(self) -> None:
        self._hold("vertices", np.float32, (None, 3))
        count = len(self.vertices)
        self._hold("faces", np.int32, (None, 3))
        self._hold("joints", np.int32, (count, None))
        self._hold("weights", np.float32, (count, self.joints.shape[1]))
        for key, width in (("normals", 3), ("texture_coordinates", 2), ("tangents", 4), ("colors", 4)):
            if getattr(self, key) is not None:
                self._hold(key, np.float32, (count, width))
        sets = tuple(frozen(one, np.float32) for one in self.more_texture_coordinates)
        if any(one.shape != (count, 2) for one in sets):
            raise GmrError(f"part '{self.name}': texture coordinates must have the shape ({count}, 2)")
        object.__setattr__(self, "more_texture_coordinates", sets)
        if len(self.faces) and not (self.faces.min() >= 0 and self.faces.max() < count):
            raise GmrError(f"part '{self.name}': its faces must name vertices from 0 to {count - 1}")
        if self.is_skinned:
            if self.inverse_bind is None:
                raise GmrError(f"part '{self.name}' has weights, so it needs inverse bind matrices")
            self._hold("inverse_bind", np.float64, (None, 4, 4))
            if count and not (self.joints.min() >= 0 and self.joints.max() < len(self.inverse_bind)):
                raise GmrError(
                    f"part '{self.name}': its joints must be from 0 to {len(self.inverse_bind) - 1}"
                )

    @property
    def is_skinned(self) -> bool:
        """Whether joints carry it."""
        return bool(self.joints.shape[1])

    def _hold(self, key: str, dtype: type[Any], shape: tuple[int | None, ...]) -> None:
        array = frozen(getattr(self, key), dtype)
        if array.ndim != len(shape) or any(
            n is not None and n != m for n, m in zip(shape, array.shape, strict=True)
        ):
            wanted = ", ".join("any" if n is None else str(n) for n in shape)
            raise GmrError(f"part '{self.name}': {key} has the shape {array.shape}; it must be ({wanted})")
        object.__setattr__(self, key, array)

    def __repr__(self) -> str:
        carried = f"{self.joints.shape[1]} joints a vertex" if self.is_skinned else "no weights"
        return f"Part({self.name!r}, {len(self.vertices):,} vertices, {len(self.faces):,} faces, {carried})"
