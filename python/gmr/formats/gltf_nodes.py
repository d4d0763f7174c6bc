"""The node tree of a glTF file, and which of it is in the scene."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.formats.gltf_document import Document
from gmr.skinning.nodes import Nodes, parents_first

__all__ = ["read_nodes", "scene_name", "scene_nodes"]

_UNIT = 1e-6
"""How far a quaternion may be from length 1 and be left as it is."""
_NOTICED = 1e-3
_LARGEST = 1e38
"""Beyond it single precision, in which vertices are moved, has no numbers."""


def read_nodes(document: Document) -> Nodes:
    """All nodes of the file, in its order; those without a name are called "node_3" after their place.

    Raises:
        FormatError: a node has two parents or hangs on itself, or a transform is none.
    """
    entries = document.content.nodes
    parents = _parents(document, entries)
    transforms = np.zeros((len(entries), 10))
    matrices = {}
    turned = []
    for k, node in enumerate(entries):
        place = f"nodes[{k}]"
        if node.matrix is not None:
            matrices[k] = _matrix(document, node.matrix, place)
        translation = _numbers(document, node.translation, (0.0,) * 3, f"{place}.translation")
        rotation = _numbers(document, node.rotation, (0.0, 0.0, 0.0, 1.0), f"{place}.rotation")
        scale = _numbers(document, node.scale, (1.0,) * 3, f"{place}.scale")
        length = float(np.linalg.norm(rotation))
        if not 1e-12 < length < 1e12:
            document.wrong(f"{place}.rotation has the length {length:g}; export the file again")
        if abs(length - 1) > _UNIT:
            rotation = rotation / length
        if abs(length - 1) > _NOTICED:
            turned.append(place)
        transforms[k] = np.concatenate([translation, rotation, scale])
    if turned:
        document.odd(f"{len(turned)} nodes have rotations that are not of length 1, which they are read as")
    names = tuple(node.name or f"node_{k}" for k, node in enumerate(entries))
    return Nodes(names, parents, transforms[:, :3], transforms[:, 3:7], transforms[:, 7:], matrices)


def scene_nodes(document: Document, nodes: Nodes) -> NDArray[np.bool_]:
    """(N,) whether each node is in the scene that the file shows; all are where it has no scenes."""
    content = document.content
    if not content.scenes:
        return np.ones(len(nodes), bool)
    index = 0 if content.scene is None else content.scene
    scene = document.at("scenes", index, "scene")
    shown = np.zeros(len(nodes), bool)
    for root in scene.nodes:
        document.at("nodes", root, f"scenes[{index}]")
        shown[root] = True
    for node in nodes.order:
        if nodes.parents[node] >= 0:
            shown[node] |= shown[nodes.parents[node]]
    return shown


def scene_name(document: Document) -> str | None:
    """What the scene is called; None where it is not."""
    content = document.content
    index = content.scene or 0
    return content.scenes[index].name or None if index < len(content.scenes) else None


def _parents(document: Document, entries: list[Any]) -> NDArray[np.int32]:
    """(N,) the parent of each node."""
    parents = np.full(len(entries), -1, np.int32)
    for k, node in enumerate(entries):
        for child in node.children:
            document.at("nodes", child, f"nodes[{k}]")
            if parents[child] >= 0:
                document.wrong(
                    f"nodes[{child}] hangs on nodes[{parents[child]}] and nodes[{k}]; a node has one parent"
                )
            parents[child] = k
    _, circle = parents_first(parents)
    if circle is not None:
        document.wrong(f"nodes[{circle}] hangs on itself, through its parents; the nodes must make a tree")
    return parents


def _matrix(document: Document, found: list[float], place: str) -> NDArray[np.float64]:
    """(4, 4) from 16 numbers, column after column."""
    if len(found) != 16:
        document.wrong(f"{place}.matrix has {len(found)} numbers; it must have 16")
    matrix = _single(document, found, f"{place}.matrix").reshape(4, 4).T
    if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=_UNIT):
        document.wrong(f"{place}.matrix has the last row {matrix[3].tolist()}; it must be 0 0 0 1")
    return matrix


def _numbers(
    document: Document, found: list[float] | None, default: tuple[float, ...], place: str
) -> NDArray[np.float64]:
    if found is None:
        return np.array(default)
    if len(found) != len(default):
        document.wrong(f"{place} has {len(found)} numbers; it must have {len(default)}")
    return _single(document, found, place)


def _single(document: Document, found: list[float], place: str) -> NDArray[np.float64]:
    """The numbers, if single precision can hold them."""
    if max(map(abs, found)) > _LARGEST:
        document.wrong(f"{place} has the number {max(found, key=abs):g}; export the file again")
    return np.array(found, np.float64)
