"""Linear blend skinning and the transforms of nodes, written from the glTF 2.0 standard alone."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def blended(vertices: Any, joints: Any, weights: Any, transforms: Any) -> NDArray[np.float32]:
    """(F, V, 3) ``sum_i w_i E_i v``."""
    transforms = np.asarray(transforms, np.float64)
    points = np.concatenate([np.asarray(vertices, np.float64), np.ones((len(vertices), 1))], axis=1)
    found = np.zeros((len(transforms), len(points), 3))
    for k in range(joints.shape[1]):
        moved = np.einsum("fvij,vj->fvi", transforms[:, joints[:, k]], points)[..., :3]
        found += weights[:, k, None] * moved
    return found.astype(np.float32)


def node_matrix(node: dict[str, Any]) -> Array:
    """(4, 4) of a node of the JSON: matrix, or T R S."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    turn = np.array(node.get("rotation", (0, 0, 0, 1)), float)
    x, y, z, w = turn / np.linalg.norm(turn)
    rotation = np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )
    found = np.eye(4)
    found[:3, :3] = rotation @ np.diag(node.get("scale", (1, 1, 1)))
    found[:3, 3] = node.get("translation", (0, 0, 0))
    return found


def world_matrix(nodes: list[dict[str, Any]], index: int) -> Array:
    """(4, 4) of a node in the world, by asking for its parent."""
    for k, node in enumerate(nodes):
        if index in node.get("children", ()):
            return world_matrix(nodes, k) @ node_matrix(nodes[index])
    return node_matrix(nodes[index])


def json_of(data: bytes) -> Any:
    """The JSON of a .gltf or .glb file."""
    if data[:4] == b"glTF":
        length = int.from_bytes(data[12:16], "little")
        return json.loads(data[20 : 20 + length])
    return json.loads(data)
