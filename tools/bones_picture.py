"""Draws the hip of a CMU skeleton by the three rules for tails of bones, side by side.

python tools/bones_picture.py tests/data/cmu_10_03.bvh docs/images/bones.svg
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr import Motion

CAPTIONS = {
    "centroid": "the mean of the children: Blender",
    "first_child": "the first child in the file",
    "per_child": "each child: lines between joints",
}
HIP = "hip"
LEFT, RIGHT, BOTTOM, TOP = -30.0, 30.0, -44.0, 58.0
SCALE = 4.0
PANEL = (RIGHT - LEFT) * SCALE
HEADING = 52.0
GAP = 24.0
LEGEND = 40.0

Point = NDArray[np.float64]


def place(point: Point) -> Point:
    """Pixels in a panel, for a front view of a point (x, y, z); the figure's left is at the right."""
    return np.array([(point[0] - LEFT) * SCALE, HEADING + (TOP - point[1]) * SCALE])


def spindle(head: Point, tail: Point) -> str:
    """The outline that Blender gives a bone: widest at a tenth of its length."""
    a, b = place(head), place(tail)
    along = b - a
    across = 0.09 * np.array([-along[1], along[0]])
    corners = (a, a + 0.1 * along + across, b, a + 0.1 * along - across)
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)


def ring(point: Point, radius: float, style: str) -> str:
    x, y = place(point)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" {style}/>'


def panel(motion: Motion, rule: str) -> str:
    """The bones of the rest pose, those of the hip in colour, with its tails and children marked."""
    hip = motion.skeleton.index(HIP)
    bones = gmr.bones(motion, rule)
    grey: list[str] = []
    blue: list[str] = []
    marks: list[str] = []
    for joint, head, tail in zip(bones.joints.tolist(), *bones, strict=True):
        (blue if joint == hip else grey).append(f'<polygon points="{spindle(head, tail)}"/>')
        if joint == hip:
            marks.append(ring(tail, 8, 'fill="none" stroke="#c0392b" stroke-width="2.5"'))
    rest = gmr.bones(motion)
    marks += [ring(rest.heads[child], 3.5, 'fill="black"') for child in motion.skeleton.children[hip]]
    middle = PANEL / 2
    return "\n".join(
        [
            f'<text x="{middle}" y="18" font-weight="bold">{rule}</text>',
            f'<text x="{middle}" y="38">{CAPTIONS[rule]}</text>',
            '<g clip-path="url(#view)">',
            '<g fill="#d9d9d9" stroke="#8c8c8c">',
            *grey,
            '</g><g fill="#9cc3e6" stroke="#2a6ea9" stroke-width="1.5">',
            *blue,
            "</g>",
            *marks,
            "</g>",
        ]
    )


def legend(width: float, y: float) -> str:
    """What the marks mean, in one line."""
    x = width / 2
    return (
        f'<g text-anchor="start"><circle cx="{x - 310}" cy="{y - 5}" r="8" fill="none" stroke="#c0392b" '
        f'stroke-width="2.5"/><text x="{x - 294}" y="{y}">tail of a bone of the hip</text>'
        f'<circle cx="{x - 70}" cy="{y - 5}" r="3.5" fill="black"/>'
        f'<text x="{x - 60}" y="{y}">child of the hip, where a bone of its own begins</text></g>'
    )


def picture(motion: Motion) -> str:
    width = len(CAPTIONS) * (PANEL + GAP) + GAP
    bottom = HEADING + (TOP - BOTTOM) * SCALE
    panels = [
        f'<g transform="translate({GAP + k * (PANEL + GAP)} 8)">\n{panel(motion, rule)}\n</g>'
        for k, rule in enumerate(CAPTIONS)
    ]
    height = bottom + LEGEND + 16
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" '
            f'width="{width:g}" height="{height:g}" font-family="sans-serif" font-size="14" '
            'text-anchor="middle" stroke-linejoin="round">',
            f'<clipPath id="view"><rect y="{HEADING}" width="{PANEL}" height="{bottom - HEADING}"/>',
            "</clipPath>",
            '<rect width="100%" height="100%" fill="white"/>',
            *panels,
            legend(width, bottom + LEGEND),
            "</svg>\n",
        ]
    )


def main() -> None:
    source, target = map(Path, sys.argv[1:])
    target.write_text(picture(gmr.read(source)), encoding="utf-8")


if __name__ == "__main__":
    main()
