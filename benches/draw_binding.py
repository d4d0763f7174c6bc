"""Draws what binding gives CesiumMan beside what its artist gave it, and where they differ.

GMR_DATA=... python benches/draw_binding.py docs/images/bind_weights.svg

Every joint has a colour; a vertex shows the mean of the colours of the joints that it follows, by weight.
Needs GMR_DATA for the model (c) Cesium, CC BY 4.0.
"""

from __future__ import annotations

import argparse
import base64
import colorsys
import os
import struct
import warnings
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr.skinning import Character, bind
from gmr.skinning.bone_segments import bone_segments

Floats = NDArray[np.float64]

PIXELS = 270
"""A metre, in the picture's units; the raster has half as many again, and is drawn at twice that."""

MARGIN = 0.06
LIGHT = np.array([0.35, 0.55, 0.75])
WORST = np.array([0.70, 0.02, 0.10])


@dataclass(frozen=True)
class View:
    """A parallel projection."""

    name: str
    right: Floats
    towards: Floats
    """To the eye."""

    def project(self, places: Floats) -> Floats:
        """(N, 3): right, up, towards the eye; metres."""
        return np.stack([places @ self.right, places[:, 1], places @ self.towards], axis=1)


# CesiumMan looks along +X.
VIEWS = (
    View("front", np.array([0.0, 0, -1]), np.array([1.0, 0, 0])),
    View("side", np.array([1.0, 0, 0]), np.array([0.0, 0, 1])),
)


def dense(weights: NDArray[np.float32], joints: NDArray[np.int32], joint_count: int) -> Floats:
    found = np.zeros((len(weights), joint_count))
    for column in range(weights.shape[1]):
        np.add.at(found, (np.arange(len(found)), joints[:, column]), weights[:, column])
    return found


def joint_colours(count: int) -> Floats:
    """(J, 3): hues a golden angle apart, so that joints that follow each other look unlike."""
    colours = [
        colorsys.hsv_to_rgb(k * 0.618034 % 1, (0.85, 0.6)[k // 2 % 2], (0.95, 0.8)[k % 2])
        for k in range(count)
    ]
    return np.array(colours)


def raster(view: View, vertices: Floats, faces: NDArray[np.int32], colours: Floats, scale: float) -> Floats:
    """(H, W, 4) the triangles with (V, 3) colours between their vertices, lit, the nearest in front."""
    seen = view.project(vertices)
    low, high = _bounds(view, vertices)
    width, height = np.ceil((high - low) * scale).astype(int)
    image, depth = np.zeros((height, width, 4)), np.full((height, width), -np.inf)
    normals = np.cross(
        vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]]
    )
    smooth = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(smooth, faces[:, corner], normals)
    smooth = view.project(smooth / np.maximum(np.linalg.norm(smooth, axis=1, keepdims=True), 1e-12))
    lit = colours * (0.55 + 0.45 * np.clip(smooth @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1))[:, None]
    at = np.stack([(seen[:, 0] - low[0]) * scale, (high[1] - seen[:, 1]) * scale, seen[:, 2]], axis=1)
    for face in faces:
        a, b, c = at[face]
        doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(doubled) < 1e-12:
            continue
        low_corner = np.floor(np.min([a, b, c], axis=0)).astype(int)
        high_corner = np.ceil(np.max([a, b, c], axis=0)).astype(int)
        x, y = np.meshgrid(*(np.arange(low_corner[k], high_corner[k]) for k in (0, 1)))
        of_b = ((x + 0.5 - a[0]) * (c[1] - a[1]) - (y + 0.5 - a[1]) * (c[0] - a[0])) / doubled
        of_c = ((b[0] - a[0]) * (y + 0.5 - a[1]) - (b[1] - a[1]) * (x + 0.5 - a[0])) / doubled
        parts = np.stack([1 - of_b - of_c, of_b, of_c], axis=-1)
        z = parts @ np.array([a[2], b[2], c[2]])
        inside = (parts >= 0).all(axis=-1)
        rows, columns, parts, z = y[inside], x[inside], parts[inside], z[inside]
        front = z > depth[rows, columns]
        rows, columns = rows[front], columns[front]
        depth[rows, columns] = z[front]
        image[rows, columns, :3] = parts[front] @ lit[face]
        image[rows, columns, 3] = 1
    return image


def _bounds(view: View, vertices: Floats) -> tuple[Floats, Floats]:
    seen = view.project(vertices)[:, :2]
    return seen.min(axis=0) - MARGIN, seen.max(axis=0) + MARGIN


def halved(image: Floats) -> Floats:
    """Each two by two pixels as one; colours count by how much they cover."""
    height, width = (size // 2 * 2 for size in image.shape[:2])
    blocks = image[:height, :width].reshape(height // 2, 2, width // 2, 2, 4)
    cover = blocks[..., 3:].sum(axis=(1, 3))
    colour = (blocks[..., :3] * blocks[..., 3:]).sum(axis=(1, 3)) / np.maximum(cover, 1e-12)
    return np.concatenate([colour, cover / 4], axis=-1)


def png(image: Floats) -> bytes:
    """(H, W, 4) of 0 to 1 as a PNG file; see its specification, chapters 5, 9 and 11."""
    pixels = np.round(image * 255).astype(np.uint8)
    height, width = pixels.shape[:2]
    # Filter 2 writes each row as its difference from the one above.
    rows = np.diff(pixels, axis=0, prepend=np.zeros_like(pixels[:1])).reshape(height, -1)
    lines = np.insert(rows, 0, 2, axis=1).tobytes()

    def chunk(kind: bytes, content: bytes) -> bytes:
        return (
            struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        )

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def drawn(character: Character) -> str:
    """The picture as SVG."""
    vertices = character.skin(character.rest_pose())[0].astype(np.float64)
    count = len(character.joints)
    weights, joints = bind(vertices, character.faces, character.skeleton)
    ours = dense(weights, joints, count)
    artists = dense(character.merged.weights, character.merged.joints, count)
    elsewhere = 0.5 * np.abs(ours - artists).sum(axis=1)
    colours = joint_colours(count)
    shades = 0.93 + elsewhere[:, None] * (WORST - 0.93)
    columns = (
        ("gmr.skinning.bind", ours @ colours, True),
        ("the artist", artists @ colours, True),
        ("difference", shades, False),
    )
    sizes = [(high - low) * PIXELS for low, high in (_bounds(view, vertices) for view in VIEWS)]
    column_width = sum(size[0] for size in sizes)
    height = max(size[1] for size in sizes)
    parts = []
    for number, (title, colour, with_bones) in enumerate(columns):
        x = number * (column_width + 14) + 10
        parts.append(_text(x + column_width / 2, 24, title, 17, bold=True))
        for view, size in zip(VIEWS, sizes, strict=True):
            image = halved(raster(view, vertices, character.faces, colour, 3 * PIXELS))
            data = base64.b64encode(png(image)).decode()
            parts.append(
                f'<image x="{x:.1f}" y="34" width="{size[0]:.1f}" height="{size[1]:.1f}" '
                f'href="data:image/png;base64,{data}"/>'
            )
            if with_bones:
                parts += _bones(character, view, vertices, (x, 34.0))
            x += size[0]
    width = 3 * (column_width + 14) + 6
    parts += _key(width - column_width / 2 - 10, height + 46, float(elsewhere.mean()))
    total = height + 84
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {total:.0f}" width="{width:.0f}" '
        f'height="{total:.0f}" font-family="Helvetica, Arial, sans-serif">\n'
        '<linearGradient id="key"><stop offset="0" stop-color="#ededed"/>'
        f'<stop offset="1" stop-color="{_hex(WORST)}"/></linearGradient>\n'
        f'<rect width="100%" height="100%" fill="#ffffff"/>\n' + "\n".join(parts) + "\n</svg>\n"
    )


def _bones(character: Character, view: View, vertices: Floats, corner: Sequence[float]) -> list[str]:
    """Thin lines over the figure, and a dot at each joint."""
    low, high = _bounds(view, vertices)
    bones = bone_segments(character.skeleton)
    known = ~(bones.open[:, 1])

    def on_page(places: Floats) -> Floats:
        seen = view.project(places)
        return np.stack([seen[:, 0] - low[0], high[1] - seen[:, 1]], axis=1) * PIXELS + corner

    heads, tails = on_page(bones.heads), on_page(bones.tails)
    lines = [
        f'<path d="M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" stroke="#222" stroke-width="1.2"/>'
        for a, b in zip(heads[known], tails[known], strict=True)
    ]
    dots = [
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="#fff" stroke="#222" stroke-width="1.2"/>'
        for x, y in np.unique(heads.round(1), axis=0)
    ]
    return lines + dots


def _key(x: float, y: float, mean: float) -> list[str]:
    return [
        f'<rect x="{x - 70:.1f}" y="{y - 10:.1f}" width="140" height="10" fill="url(#key)" stroke="#999"/>',
        _text(x - 84, y, "0 %", 12),
        _text(x + 92, y, "100 %", 12),
        _text(x, y + 18, f"of the weight on other joints; mean {100 * mean:.0f} %", 12),
    ]


def _text(x: float, y: float, text: str, size: int, *, bold: bool = False) -> str:
    weight = ' font-weight="bold"' if bold else ""
    place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size}"{weight}'
    return f'<text {place} text-anchor="middle" fill="#222">{text}</text>'


def _hex(colour: Floats) -> str:
    return "#" + "".join(f"{round(255 * part):02x}" for part in colour.tolist())


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw the weights of CesiumMan.")
    parser.add_argument("out", type=Path)
    path = Path(os.environ["GMR_DATA"]) / "gltf" / "cesium_man.gltf"
    with warnings.catch_warnings():
        # Some of its weights do not sum to 1.
        warnings.simplefilter("ignore", gmr.FormatWarning)
        character = gmr.read_character(path)
    parser.parse_args().out.write_text(drawn(character), encoding="utf-8")


if __name__ == "__main__":
    main()
