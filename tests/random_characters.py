"""Random characters for property tests: any tree, any parts, materials, textures and animations."""

from __future__ import annotations

import struct
import zlib
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from gmr.skinning import Animation, Channel, Character, Material, Nodes, Part, Texture, TextureUse
from gmr.skinning.keyframes import Interpolation, Path
from gmr.skinning.weights import normalised_weights

Rng = np.random.Generator


def character(seed: int) -> Character:
    """A character; the same for the same seed."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 9))
    tree = nodes(rng, count)
    joints = rng.permutation(count - 1)[: rng.integers(1, count)].astype(np.int32) + 1
    textures = tuple(texture(rng, k) for k in range(rng.integers(0, 3)))
    materials = tuple(material(rng, len(textures)) for _ in range(rng.integers(0, 4)))
    parts = tuple(part(rng, joints, tree, len(materials), k) for k in range(rng.integers(1, 4)))
    clips = tuple(animation(rng, joints, k) for k in range(rng.integers(0, 3)))
    return Character(f"c{seed}", tree, joints, parts, materials, textures, clips)


def nodes(rng: Rng, count: int) -> Nodes:
    """One tree whose nodes are in any order but for the root, which is the first.

    The last three hold parts.
    """
    place = np.concatenate([[0], rng.permutation(count - 1) + 1])
    parents = np.full(count, -1, np.int32)
    for k in range(1, count):
        parents[place[k]] = place[rng.integers(0, k)]
    scales = np.where(rng.random((count, 1)) < 0.3, rng.uniform(0.5, 2, (count, 1)), 1.0)
    mirrored = np.where(rng.random((count, 3)) < 0.1, -1.0, 1.0)
    arrays = [rng.normal(size=(count, 3)), turns(rng, count).astype(np.float64), scales * mirrored]
    rest = (np.zeros(3), np.array([0.0, 0, 0, 1]), np.ones(3))
    matrices = {0: matrix(rng)} if rng.random() < 0.3 else {}
    for array, default in zip(arrays, rest, strict=True):
        array[list(matrices)] = default
    a, b, c = [np.vstack([array, *[default] * 3]) for array, default in zip(arrays, rest, strict=True)]
    names = tuple(f"n{k}" for k in range(count + 3))
    return Nodes(names, np.append(parents, np.zeros(3, np.int32)), a, b, c, matrices)


def turns(rng: Rng, count: int) -> NDArray[np.float32]:
    """(count, 4) unit quaternions."""
    found = rng.normal(size=(count, 4))
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found.astype(np.float32)


def matrix(rng: Rng) -> NDArray[np.float64]:
    """A turn, twice as large, somewhere."""
    found = np.eye(4)
    found[:3, :3] = 2 * np.linalg.qr(rng.normal(size=(3, 3)))[0]
    found[:3, 3] = rng.normal(size=3)
    return found


def part(rng: Rng, joints: NDArray[np.int32], tree: Nodes, materials: int, k: int) -> Part:
    count, width = int(rng.integers(3, 20)), int(rng.integers(0, 3)) * 4
    vertices = rng.normal(size=(count, 3)).astype(np.float32)
    corners = np.stack([rng.permutation(count)[:3] for _ in range(rng.integers(1, 30))])
    used = min(width, len(joints))
    chosen, weights = np.zeros((count, width), np.int32), np.zeros((count, width), np.float32)
    for vertex in range(count if used else 0):
        chosen[vertex, :used] = rng.permutation(len(joints))[:used]
        weights[vertex, :used] = rng.random(used) + 0.01
    normals = turns(rng, count)[:, :3] + np.float32(0.01)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    inverse_bind = rng.normal(size=(len(joints), 4, 4)).astype(np.float32).astype(np.float64)
    inverse_bind[:, 3] = (0, 0, 0, 1)
    sets = [rng.random((count, 2)).astype(np.float32) for _ in range(rng.integers(0, 3))]
    return Part(
        name=f"mesh{k}",
        vertices=vertices,
        faces=corners.astype(np.int32),
        normals=normals if rng.random() < 0.7 else None,
        texture_coordinates=sets[0] if sets else None,
        material=int(rng.integers(0, materials)) if materials and len(sets) == 2 else None,
        joints=chosen,
        weights=normalised_weights(weights).weights if width else weights,
        inverse_bind=inverse_bind if width else None,
        colors=rng.random((count, 4)).astype(np.float32) if rng.random() < 0.3 else None,
        more_texture_coordinates=tuple(sets[1:]),
        node=len(tree) - 3 + k,
    )


def png(shade: int) -> bytes:
    """A picture of one pixel."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0)
    rows = zlib.compress(bytes([0, shade]))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def texture(rng: Rng, k: int) -> Texture:
    if rng.random() < 0.5:
        return Texture(png(int(rng.integers(0, 256))), "image/png", f"t{k}")
    return Texture(png(k), "image/png", f"t{k}", 9729, 9987, 33071, 33648)


def material(rng: Rng, textures: int) -> Material:
    def use(chance: float) -> TextureUse | None:
        if not textures or rng.random() > chance:
            return None
        return TextureUse(int(rng.integers(0, textures)), int(rng.integers(0, 2)))

    normal = use(0.5)
    return Material(
        name=f"m{rng.integers(0, 100)}",
        base_color=cast(Any, tuple(rng.random(4).tolist())),
        metallic=float(rng.random()),
        roughness=float(rng.random()),
        emissive=cast(Any, tuple(rng.random(3).tolist())),
        alpha_mode="MASK" if rng.random() < 0.5 else "BLEND",
        double_sided=bool(rng.random() < 0.5),
        base_color_texture=use(0.7),
        normal_texture=None if normal is None else replace(normal, strength=0.5),
        occlusion_texture=use(0.3),
        extensions={"KHR_materials_unlit": {}} if rng.random() < 0.3 else {},
    )


def animation(rng: Rng, joints: NDArray[np.int32], k: int) -> Animation:
    channels = []
    for node in joints.tolist():
        paths = [path for path in ("translation", "rotation", "scale") if rng.random() < 0.5]
        channels += [channel(rng, node, path) for path in paths]
    return Animation(f"clip{k}", tuple(channels or [channel(rng, int(joints[0]), "rotation")]))


def channel(rng: Rng, node: int, path: str) -> Channel:
    count = int(rng.integers(1, 6))
    mode = str(rng.choice(["STEP", "LINEAR", "CUBICSPLINE"] if count > 1 else ["STEP", "LINEAR"]))
    times = np.cumsum(rng.random(count) + 0.01).astype(np.float32)
    width = 4 if path == "rotation" else 3
    values = turns(rng, count) if path == "rotation" else rng.normal(size=(count, 3)).astype(np.float32)
    if mode == "CUBICSPLINE":
        tangents = rng.normal(size=(count, 3, width)).astype(np.float32)
        tangents[:, 1] = values
        values = tangents
    return Channel(node, cast(Path, path), times, values, cast(Interpolation, mode))
