"""A character becomes a .glb: node tree, skins, meshes, materials with their pictures, animations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gmr import _core
from gmr.errors import FormatError
from gmr.formats.gltf_animation_writer import animation_of
from gmr.formats.gltf_blob import Blob
from gmr.formats.gltf_document import pygltflib
from gmr.formats.gltf_material_writer import MaterialWriter
from gmr.formats.gltf_mesh_writer import primitive_of
from gmr.skinning.character import Character
from gmr.skinning.part import Part
from gmr.skinning.posed_channels import as_transforms, posed_animation

__all__ = ["glb_pieces"]


def glb_pieces(
    character: Character, poses: ArrayLike | None = None, frame_time: float | None = None
) -> list[bytes]:
    """The pieces, in order, of a .glb file that holds a character; see :func:`gmr.write_character`.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: a node is sheared, a part has no triangle, or there is nothing to write.
        GmrError: the poses do not fit, or are sheared.
    """
    model = pygltflib()
    animations = character.animations
    if poses is not None:
        animations = (posed_animation(character, poses, frame_time),)
        nodes = as_transforms(character.nodes, character.joints.tolist())
    else:
        nodes = as_transforms(character.nodes, ())
    if not character.parts and not animations:
        raise FormatError(f"character '{character.name}' has neither parts nor animations; nothing to write")
    blob = Blob(model)
    tree = [_node(nodes, k, model) for k in range(len(nodes))]
    for node, parent in enumerate(nodes.parents.tolist()):
        if parent >= 0:
            tree[parent].children.append(node)
    roots = [node for node, parent in enumerate(nodes.parents.tolist()) if parent < 0]
    roots = _with_common_root(character, tree, roots, model)
    materials = MaterialWriter(character, blob)
    meshes, skins = _Meshes(character, tree, blob, materials), _Skins(character, blob)
    for parts in _groups(character):
        node = meshes.node_of(parts[0], roots)
        tree[node].mesh = meshes.add(parts)
        tree[node].skin = skins.of(parts[0])
    content = model.GLTF2(
        asset=model.Asset(generator=f"gmr {_core.__version__}", version="2.0"),
        scene=0,
        scenes=[model.Scene(name=character.name or None, nodes=roots)],
        nodes=tree,
        meshes=meshes.meshes,
        skins=skins.skins,
        animations=[animation_of(animation, blob) for animation in animations],
        materials=materials.materials,
        textures=materials.textures,
        images=materials.images,
        samplers=materials.samplers,
        accessors=blob.accessors,
        bufferViews=blob.views,
        buffers=[model.Buffer()],
        extensionsUsed=sorted(materials.extensions),
    )
    content.set_binary_blob(blob.data())
    return [bytes(piece) for piece in content.save_to_bytes()]


def _node(nodes: Any, k: int, model: Any) -> Any:
    """One node without its children; what is as by default is left out."""
    node = model.Node(name=nodes.names[k], children=[])
    if k in nodes.matrices:
        node.matrix = nodes.matrices[k].T.ravel().tolist()
        return node
    for key, default in (("translation", (0, 0, 0)), ("rotation", (0, 0, 0, 1)), ("scale", (1, 1, 1))):
        values = getattr(nodes, f"{key}s")[k]
        if not np.array_equal(values, default):
            setattr(node, key, values.tolist())
    return node


def _with_common_root(character: Character, tree: list[Any], roots: list[int], model: Any) -> list[int]:
    """The roots of the scene; joints that hang on several get a node over all, as the standard asks."""
    tops = {_top(character, node) for node in character.joints.tolist()}
    if len(tops) < 2 or not any(part.is_skinned for part in character.parts):
        return roots
    tree.append(model.Node(name=f"{character.name}_root", children=sorted(tops)))
    return [*(root for root in roots if root not in tops), len(tree) - 1]


def _top(character: Character, node: int) -> int:
    while character.nodes.parents[node] >= 0:
        node = int(character.nodes.parents[node])
    return node


def _groups(character: Character) -> Iterable[list[Part]]:
    """The parts that are written as one mesh: of one name, at one node, with one skin."""
    groups: dict[Any, list[Part]] = {}
    for k, part in enumerate(character.parts):
        bind = None if part.inverse_bind is None else part.inverse_bind.tobytes()
        groups.setdefault((part.node if part.node >= 0 else -1 - k, part.name, bind), []).append(part)
    return groups.values()


class _Meshes:
    """Collects meshes, and gives each a node."""

    def __init__(self, character: Character, tree: list[Any], blob: Blob, materials: MaterialWriter) -> None:
        self.meshes: list[Any] = []
        self.tree = tree
        self.blob = blob
        self.materials = materials
        self._taken: set[int] = set()

    def node_of(self, part: Part, roots: list[int]) -> int:
        """The node that holds a part; a new root where it has none, or that holds another mesh."""
        if part.node >= 0 and part.node not in self._taken:
            self._taken.add(part.node)
            return part.node
        self.tree.append(self.blob.model.Node(name=part.name or None, children=[]))
        if part.node >= 0 and not part.is_skinned:
            self.tree[part.node].children.append(len(self.tree) - 1)
        else:
            roots.append(len(self.tree) - 1)
        return len(self.tree) - 1

    def add(self, parts: list[Part]) -> int:
        """The mesh of these parts."""
        primitives = [primitive_of(part, self.materials.material_of(part), self.blob) for part in parts]
        self.meshes.append(self.blob.model.Mesh(name=parts[0].name or None, primitives=primitives))
        return len(self.meshes) - 1


class _Skins:
    """Collects skins: one for each set of inverse bind matrices, all with all joints."""

    def __init__(self, character: Character, blob: Blob) -> None:
        self.skins: list[Any] = []
        self.character = character
        self.blob = blob
        self._known: dict[bytes, int] = {}

    def of(self, part: Part) -> int | None:
        """The skin of a part; None where nothing carries it."""
        if part.inverse_bind is None:
            return None
        key = part.inverse_bind.tobytes()
        if key not in self._known:
            matrices = self.blob.array(part.inverse_bind.astype(np.float32))
            joints = self.character.joints.tolist()
            self._known[key] = len(self.skins)
            self.skins.append(self.blob.model.Skin(joints=joints, inverseBindMatrices=matrices))
        return self._known[key]
