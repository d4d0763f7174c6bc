"""A glTF file becomes a character."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import PurePath

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_accessors import Accessors
from gmr.formats.gltf_animations import read_animations
from gmr.formats.gltf_buffers import Buffers
from gmr.formats.gltf_document import Document, open_document
from gmr.formats.gltf_materials import read_materials
from gmr.formats.gltf_meshes import Geometry, Meshes
from gmr.formats.gltf_nodes import read_nodes, scene_name, scene_nodes
from gmr.formats.gltf_skins import Influences, Skins
from gmr.skinning.character import Character
from gmr.skinning.keyframes import Animation
from gmr.skinning.nodes import Nodes
from gmr.skinning.part import Part

__all__ = ["read_gltf_character"]


def read_gltf_character(data: bytes, *, name: str | None = None, strict: bool = False) -> Character:
    """The character in a .gltf or .glb file.

    Joints are the nodes that skins name, in their order, skin after skin. A mesh without a skin that hangs on
    a joint, or on a node that an animation moves (which is a joint then), is carried by it whole. Where the
    file has no skin, the nodes that animations move, and those below them, are the joints.

    Args:
        data: the file's bytes.
        name: the file's path: for errors, and to find the files beside that it names.
        strict: raise where a warning would do.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: the file cannot be read; says where and how to mend it.

    Warns:
        FormatWarning: weights that do not sum to 1, morph targets, points and lines, pictures that are
            missing, and whatever else is left out or odd.
    """
    document = open_document(data, name, strict)
    buffers = Buffers(document)
    accessors = Accessors(document, buffers)
    nodes = read_nodes(document)
    animations = read_animations(document, accessors, nodes)
    holders = _holders(document, scene_nodes(document, nodes))
    moved = _moved(animations)
    used = _used_skins(document, holders)
    more = [] if used else _joints_without_skin(document, nodes, moved)
    skinned = {node for index in used for node in document.content.skins[index].joints}
    carriers = _carriers(document, nodes, holders, moved, {*skinned, *more})
    skins = Skins(document, accessors, nodes, used, [*more, *carriers.values()])
    reader = _Parts(document, nodes, skins, Meshes(document, accessors), carriers)
    parts = tuple(part for node in holders for part in reader.parts_of(node))
    materials, textures = read_materials(document, buffers)
    called = scene_name(document) or (PurePath(name).stem if name else "character")
    return Character(called, nodes, skins.joints, parts, materials, textures, animations)


def _holders(document: Document, shown: NDArray[np.bool_]) -> list[int]:
    """Nodes of the scene that hold a mesh."""
    holders = [k for k, node in enumerate(document.content.nodes) if node.mesh is not None]
    if hidden := sum(not shown[node] for node in holders):
        document.odd(f"{hidden} nodes with meshes are not in the scene that is shown; they are left out")
    for node in holders:
        document.at("meshes", document.content.nodes[node].mesh, f"nodes[{node}]")
    return [node for node in holders if shown[node]]


def _used_skins(document: Document, holders: list[int]) -> list[int]:
    """The skins that meshes of the scene have; all of them where none has one."""
    found = {}
    for node in holders:
        index = document.content.nodes[node].skin
        if index is not None:
            document.at("skins", index, f"nodes[{node}]")
            found[index] = True
    return sorted(found) or list(range(len(document.content.skins)))


def _moved(animations: Iterable[Animation]) -> set[int]:
    """Nodes that any animation moves."""
    return {channel.node for animation in animations for channel in animation.channels}


def _joints_without_skin(document: Document, nodes: Nodes, moved: set[int]) -> list[int]:
    """Nodes that are moved, and those below them that hold no mesh."""
    below = set(moved)
    for node in nodes.order:
        if int(nodes.parents[node]) in below and document.content.nodes[node].mesh is None:
            below.add(node)
    return sorted(below)


def _carriers(
    document: Document, nodes: Nodes, holders: list[int], moved: set[int], joints: set[int]
) -> dict[int, int]:
    """Node with a mesh that has no skin -> the nearest node from it upwards that is a joint or is moved."""
    nearest: dict[int, int | None] = {}
    for node in nodes.order:
        here = node in joints or node in moved
        nearest[node] = node if here else nearest.get(int(nodes.parents[node]))
    found = {}
    for node in holders:
        carrier = nearest[node]
        if document.content.nodes[node].skin is None and carrier is not None:
            found[node] = carrier
    return found


@dataclass
class _Parts:
    """Makes the parts of a character."""

    document: Document
    nodes: Nodes
    skins: Skins
    meshes: Meshes
    carriers: dict[int, int]

    def parts_of(self, node: int) -> list[Part]:
        """The parts that a node holds."""
        entry = self.document.content.nodes[node]
        matrix = self._to_carrier(node) if node in self.carriers else None
        found = []
        for geometry in self.meshes.geometries(entry.mesh, f"nodes[{node}]"):
            influences = None
            if matrix is not None:
                joint = self.skins.place[self.carriers[node]]
                influences = self.skins.rigid(joint, matrix, len(geometry.vertices), geometry.place)
            elif entry.skin is not None:
                influences = self.skins.influences(entry.skin, geometry)
            found.append(_part(geometry, influences, node))
        return found

    def _to_carrier(self, node: int) -> NDArray[np.float64]:
        """(4, 4) from the mesh of a node to the node that carries it."""
        carrier, matrix = self.carriers[node], np.eye(4)
        while node != carrier:
            matrix = self.nodes.local[node] @ matrix
            node = int(self.nodes.parents[node])
        return matrix


def _part(geometry: Geometry, influences: Influences | None, node: int) -> Part:
    sets = geometry.texture_coordinates
    part = Part(
        name=geometry.name,
        vertices=geometry.vertices,
        faces=geometry.faces,
        normals=geometry.normals,
        texture_coordinates=sets[0] if sets else None,
        material=geometry.material,
        joints=np.zeros((len(geometry.vertices), 0), np.int32),
        weights=np.zeros((len(geometry.vertices), 0), np.float32),
        inverse_bind=None,
        tangents=geometry.tangents,
        colors=geometry.colors,
        more_texture_coordinates=sets[1:],
        node=node,
    )
    return part if influences is None else replace(part, **influences._asdict())
