"""Meshes without joints, bound to a skeleton."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.skeleton import Skeleton
from gmr.skinning.appearance import Material, Texture
from gmr.skinning.character import Character
from gmr.skinning.nodes import Nodes
from gmr.skinning.part import Part
from gmr.skinning.weights import normalised_weights

__all__ = ["bound", "in_the_world"]


def bound(
    name: str,
    parts: Sequence[Part],
    skeleton: Skeleton,
    materials: Sequence[Material] = (),
    textures: Sequence[Texture] = (),
) -> Character:
    """The character of these parts, carried by the joints of a skeleton at rest.

    All parts are bound as one mesh by :func:`gmr.skinning.bind`, so that seams between them hold.

    Args:
        name: what to call it.
        parts: meshes that stand in the world as the skeleton does, in its unit.
        skeleton: of J joints, which become the character's in its order; at home, if any root was moved.
        materials: what parts refer to.
        textures: what materials refer to.

    Raises:
        GmrError: there is no vertex to bind, or the binding gives what fits no mesh.
    """
    from gmr.skinning.binding import bind

    home = skeleton if skeleton.home is None else skeleton.home
    counts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    if not counts[-1]:
        raise GmrError(f"'{name}' has no vertices to bind")
    vertices = np.concatenate([part.vertices for part in parts])
    faces = np.concatenate([part.faces + start for part, start in zip(parts, counts[:-1], strict=True)])
    weights, joints = (np.asarray(found) for found in bind(vertices, faces, home))
    if weights.shape != joints.shape or len(weights) != len(vertices):
        raise GmrError(
            f"binding gave weights {weights.shape} and joints {joints.shape} for {counts[-1]} vertices"
        )
    weights = normalised_weights(weights.astype(np.float32)).weights
    nodes = _nodes(home)
    inverse_bind = np.tile(np.eye(4), (len(nodes), 1, 1))
    inverse_bind[:, :3, 3] = -nodes.world[:, :3, 3].astype(np.float32)
    made = [
        replace(part, joints=joints[a:b], weights=weights[a:b], inverse_bind=inverse_bind, node=-1)
        for part, a, b in zip(parts, counts[:-1], counts[1:], strict=True)
    ]
    chosen = np.arange(len(nodes), dtype=np.int32)
    return Character(name, nodes, chosen, tuple(made), tuple(materials), tuple(textures))


def in_the_world(part: Part, matrix: NDArray[np.float64]) -> Part:
    """A part without weights, moved by the (4, 4) world matrix of the node that holds it."""
    linear = matrix[:3, :3]
    vertices = part.vertices @ linear.T + matrix[:3, 3]
    mirrored = np.linalg.det(linear) < 0
    normals = part.normals
    if normals is not None:
        normals = normals @ np.linalg.pinv(linear)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = (normals / np.where(lengths > 0, lengths, 1)).astype(np.float32)
    tangents = part.tangents
    if tangents is not None:
        turned = tangents[:, :3] @ linear.T
        lengths = np.linalg.norm(turned, axis=1, keepdims=True)
        turned /= np.where(lengths > 0, lengths, 1)
        tangents = np.concatenate([turned, tangents[:, 3:] * (-1 if mirrored else 1)], axis=1)
    return replace(
        part,
        vertices=vertices.astype(np.float32),
        faces=part.faces[:, ::-1] if mirrored else part.faces,
        normals=normals,
        tangents=None if tangents is None else tangents.astype(np.float32),
        node=-1,
    )


def _nodes(skeleton: Skeleton) -> Nodes:
    """The joints as nodes, none of them turned."""
    count = skeleton.joint_count
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    return Nodes(skeleton.names, skeleton.parents, skeleton.offsets, turns, np.ones((count, 3)))
