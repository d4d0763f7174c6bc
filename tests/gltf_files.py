"""glTF files made by hand: one that is right, to be bent in one place by each test."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}


class Gltf:
    """A file that grows: ``content`` is its JSON, ``binary`` its one buffer."""

    def __init__(self) -> None:
        self.content: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [],
            "accessors": [],
            "bufferViews": [],
        }
        self.binary = bytearray()

    def view(self, data: bytes, **more: Any) -> int:
        """A view of these bytes; its index."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        views = self.content["bufferViews"]
        views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data), **more})
        self.binary += data
        return len(views) - 1

    def array(self, values: ArrayLike, dtype: str = "f4", **more: Any) -> int:
        """An accessor of (count, ...) values, matrices as (count, rows, columns); its index."""
        array = np.asarray(values).astype(f"<{dtype}")
        shape = array.shape[1:]
        if len(shape) == 2:
            array = array.swapaxes(1, 2)
        view = self.view(np.ascontiguousarray(array).tobytes())
        return self.accessor(view, len(array), shape, dtype, **more)

    def accessor(self, view: int, count: int, shape: tuple[int, ...], dtype: str, **more: Any) -> int:
        """An accessor of a view; its index."""
        self.content["accessors"].append(
            {
                "bufferView": view,
                "componentType": COMPONENTS[dtype],
                "count": count,
                "type": TYPES[shape],
                **more,
            }
        )
        return len(self.content["accessors"]) - 1

    def glb(self) -> bytes:
        """The binary form."""
        content = {**self.content, "buffers": [{"byteLength": len(self.binary)}]}
        text = json.dumps(content).encode()
        text += b" " * (-len(text) % 4)
        binary = bytes(self.binary) + b"\0" * (-len(self.binary) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def gltf(self, uri: str | None = None) -> bytes:
        """The text form, its buffer at ``uri`` or in the file itself."""
        encoded = "data:application/octet-stream;base64," + base64.b64encode(self.binary).decode()
        buffers = [{"byteLength": len(self.binary), "uri": uri or encoded}]
        return json.dumps({**self.content, "buffers": buffers}).encode()


POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 2, 0.5], [1, 2, 0], [0.5, 1, 1]], np.float32)
FACES = np.array([[0, 1, 2], [2, 1, 4], [3, 2, 5], [4, 5, 1]], np.uint16)
WEIGHTS = np.array(
    [
        [1, 0, 0, 0],
        [0.5, 0.5, 0, 0],
        [0.25, 0.25, 0.5, 0],
        [0, 0, 1, 0],
        [0, 0.75, 0.25, 0],
        [0.5, 0.25, 0.25, 0],
    ],
    np.float32,
)
JOINTS = np.tile(np.array([0, 1, 2, 0], np.uint8), (6, 1))


def turn(degrees: float, axis: int) -> list[float]:
    """A quaternion xyzw about a coordinate axis."""
    half = np.radians(degrees) / 2
    found = [0.0, 0.0, 0.0, float(np.cos(half))]
    found[axis] = float(np.sin(half))
    return found


def inverse_binds() -> NDArray[np.float32]:
    """(3, 4, 4) of the joints of :func:`arm`: the mesh was bound before they were put where they are."""
    found = np.tile(np.eye(4, dtype=np.float32), (3, 1, 1))
    found[1, 1, 3], found[2, 1, 3] = -1, -2
    return found


def arm() -> Gltf:
    """Three joints in a row under a turned and scaled node, carrying six points; two seconds of motion.

    Nodes: 0 holder (turned, scaled), 1 mesh, 2 "upper", 3 "lower", 4 "hand".
    """
    file = Gltf()
    content = file.content
    content["nodes"] = [
        {"name": "holder", "children": [1, 2], "rotation": turn(-90, 0), "scale": [2, 2, 2]},
        {"name": "body", "mesh": 0, "skin": 0, "translation": [5, 5, 5]},
        {"name": "upper", "children": [3], "translation": [0, 0.5, 0]},
        {"name": "lower", "children": [4], "translation": [0, 1, 0], "rotation": turn(20, 2)},
        {"name": "hand", "translation": [0, 1, 0]},
    ]
    content["meshes"] = [
        {
            "name": "body",
            "primitives": [
                {
                    "attributes": {
                        "POSITION": file.array(POINTS, min=[0, 0, 0], max=[1, 2, 1]),
                        "JOINTS_0": file.array(JOINTS, "u1"),
                        "WEIGHTS_0": file.array(WEIGHTS),
                        "TEXCOORD_0": file.array(POINTS[:, :2] / 2),
                    },
                    "indices": file.array(FACES.ravel(), "u2"),
                    "material": 0,
                }
            ],
        }
    ]
    content["materials"] = [{"name": "skin", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1]}}]
    content["skins"] = [{"joints": [2, 3, 4], "inverseBindMatrices": file.array(inverse_binds())}]
    times = file.array([0.0, 0.5, 1.0, 2.0])
    turns = file.array([turn(0, 2), turn(60, 2), turn(-30, 0), turn(90, 1)])
    moves = file.array([[0.0, 0.5, 0.0], [1.0, 0.5, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 2.0]])
    content["animations"] = [
        {
            "name": "wave",
            "samplers": [{"input": times, "output": turns}, {"input": times, "output": moves}],
            "channels": [
                {"sampler": 0, "target": {"node": 3, "path": "rotation"}},
                {"sampler": 1, "target": {"node": 2, "path": "translation"}},
            ],
        }
    ]
    return file
