"""The skins of a glTF file: joints, inverse bind matrices, and the weights of the meshes that they carry.

Source: glTF 2.0 specification, 3.7.3 "Skins".
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_accessors import Accessors
from gmr.formats.gltf_document import Document
from gmr.formats.gltf_meshes import Geometry
from gmr.skinning.nodes import Nodes
from gmr.skinning.weights import normalised_weights

__all__ = ["Influences", "Skins"]

_AFFINE = 1e-6


class Influences(NamedTuple):
    """Which joints carry each vertex of a part."""

    joints: NDArray[np.int32]
    """(V, K) into the character's joints."""
    weights: NDArray[np.float32]
    """(V, K) that sum to 1."""
    inverse_bind: NDArray[np.float64]
    """(J, 4, 4) for the character's joints."""


class Skins:
    """The skins of a file.

    Args:
        document: the file.
        accessors: its arrays.
        nodes: its tree.
        used: indices of the skins that are looked at.
        more: nodes that are joints though no skin names them.
    """

    def __init__(
        self, document: Document, accessors: Accessors, nodes: Nodes, used: list[int], more: list[int]
    ) -> None:
        self.document = document
        self.accessors = accessors
        self.nodes = nodes
        self._joints = {index: self._joints_of(index) for index in used}
        named = [node for index in used for node in self._joints[index].tolist()]
        union = dict.fromkeys([*named, *more])
        self.joints = np.array(list(union), np.int32)
        """(J,) nodes that are joints, in the order in which the skins name them."""
        self.place = {node: joint for joint, node in enumerate(union)}
        """Node -> joint."""
        self._binds: dict[int, NDArray[np.float64]] = {}

    def influences(self, index: int, geometry: Geometry) -> Influences | None:
        """What carries the vertices of a primitive; None where it has no weights.

        Raises:
            FormatError: a joint is out of range, or no vertex has any weight.
        """
        if geometry.joints is None or geometry.weights is None:
            self.document.odd(f"{geometry.place} has a skin but no weights; it stays where its node is")
            return None
        if index not in geometry.cache:
            geometry.cache[index] = self._mapped(index, geometry, geometry.joints, geometry.weights)
        joints, weights = geometry.cache[index]
        return Influences(joints, weights, self.inverse_bind(index))

    def rigid(self, joint: int, matrix: NDArray[np.float64], count: int, place: str) -> Influences:
        """What carries ``count`` vertices of a mesh that one joint carries whole.

        Args:
            joint: of the character.
            matrix: (4, 4) from the mesh to the joint.
            count: V.
            place: of the mesh.
        """
        self.accessors.take(8 * count + 128 * len(self.joints), place)
        inverse_bind = self._at_rest()
        inverse_bind[joint] = _single(matrix)
        joints = np.full((count, 1), joint, np.int32)
        return Influences(joints, np.ones((count, 1), np.float32), inverse_bind)

    def inverse_bind(self, index: int) -> NDArray[np.float64]:
        """(J, 4, 4) of the skin ``index``.

        Joints that the skin does not have get the inverse of where they are at rest.
        """
        if index in self._binds:
            return self._binds[index]
        place = f"skins[{index}]"
        chosen = self._joints[index]
        self.accessors.take(128 * len(self.joints), place)
        found = self._at_rest()
        found[[self.place[node] for node in chosen.tolist()]] = self._given(index, len(chosen), place)
        found.flags.writeable = False
        self._binds[index] = found
        return found

    def _given(self, index: int, count: int, place: str) -> NDArray[np.float64]:
        """(count, 4, 4) as the skin has them; the identity where it has none."""
        accessor = self.document.content.skins[index].inverseBindMatrices
        if accessor is None:
            return np.broadcast_to(np.eye(4), (count, 4, 4))
        asked = f"{place}.inverseBindMatrices"
        found = self.accessors.floats(accessor, asked, ("MAT4",))
        if len(found) < count:
            self.document.wrong(f"{asked} are {len(found)} for {count} joints; export the file again")
        matrices = found[:count].astype(np.float64)
        names = [self.nodes.names[node] for node in self._joints[index].tolist()]
        if len(bad := np.flatnonzero(~np.isfinite(matrices).all(axis=(1, 2)))):
            self.document.wrong(f"{asked}: that of joint '{names[bad[0]]}' has values that are not finite")
        if (np.abs(matrices[:, 3] - (0, 0, 0, 1)) > _AFFINE).any():
            self.document.odd(f"{asked} have last rows other than 0 0 0 1, which they are read as")
        matrices[:, 3] = (0, 0, 0, 1)
        if len(flat := np.flatnonzero(_is_flat(matrices))):
            self.document.odd(
                f"{asked}: that of joint '{names[flat[0]]}' flattens what the joint carries "
                f"({len(flat)} such matrices); they are used as they are"
            )
        return matrices

    def _at_rest(self) -> NDArray[np.float64]:
        """(J, 4, 4) inverse world matrices of the joints at rest; the identity where there is no inverse."""
        world = self.nodes.world[self.joints]
        flat = _is_flat(world) | ~np.isfinite(world).all(axis=(1, 2))
        found = np.array(np.linalg.inv(np.where(flat[:, None, None], np.eye(4), world)))
        found[:, 3] = (0, 0, 0, 1)
        return _single(found)

    def _mapped(
        self,
        index: int,
        geometry: Geometry,
        joints: NDArray[Any],
        weights: NDArray[np.float32],
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Joints of the character instead of the skin, and weights that sum to 1."""
        place, document, chosen = geometry.place, self.document, self._joints[index]
        self.accessors.take(24 * joints.size, place)
        outside = joints >= len(chosen)
        if len(bad := np.flatnonzero((outside & (weights > 0)).any(axis=1))):
            document.wrong(
                f"{place}: vertex {bad[0]} names the joints {joints[bad[0]].tolist()}, but "
                f"skins[{index}] has {len(chosen)} joints; export the file again"
            )
        if outside.any():
            document.odd(f"{place} names joints that skins[{index}] has not, with weights of 0")
        places = np.array([self.place[node] for node in chosen.tolist()], np.int32)
        mapped = places[np.where(outside, 0, joints)]
        normalised = normalised_weights(weights)
        if len(normalised.empty) == len(weights):
            document.wrong(f"{place} has a skin but no weight other than 0; bind it where it was made")
        if normalised.off:
            document.odd(
                f"{place}: the weights of {normalised.off:,} of {len(weights):,} vertices do not sum to 1 "
                f"(the least to {normalised.least:.2g}); they were divided by their sums"
            )
        if len(normalised.empty):
            document.odd(
                f"{place}: {len(normalised.empty):,} of {len(weights):,} vertices have no weight; each goes "
                "with the first joint that it names"
            )
        mapped.flags.writeable = normalised.weights.flags.writeable = False
        return mapped, normalised.weights

    def _joints_of(self, index: int) -> NDArray[np.int32]:
        """Nodes that are the joints of a skin."""
        skin = self.document.content.skins[index]
        place = f"skins[{index}]"
        if not skin.joints:
            self.document.wrong(f"{place} has no joints; export the file again")
        for node in skin.joints:
            self.document.at("nodes", node, place)
        if len(set(skin.joints)) < len(skin.joints):
            self.document.wrong(f"{place} names a joint twice; export the file again")
        return np.array(skin.joints, np.int32)


def _single(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same to single precision, in which a file holds them, so that they come back from one."""
    return matrices.astype(np.float32).astype(np.float64)


def _is_flat(matrices: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(...,) whether (..., 4, 4) matrices have no inverse to single precision."""
    linear = matrices[..., :3, :3]
    size = np.abs(linear).max(axis=(-2, -1))
    with np.errstate(all="ignore"):
        share = np.abs(np.linalg.det(linear / np.where(size > 0, size, 1)[..., None, None]))
    return np.asarray((size == 0) | ~(share > 1e-12))
