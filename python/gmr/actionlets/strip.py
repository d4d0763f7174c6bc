"""One row of a film strip: where its figures stand in the picture, and their drawing as SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.dofs import SIDES
from gmr.actionlets.figure import COLOURS, INK, LIMBS, PAPER, PATH, Figure, outline
from gmr.actionlets.footprints import plan, standing

__all__ = ["Row", "drawing", "row_of"]

Floats = NDArray[np.float64]

_SCALE = 110.0
"""Pixels in a metre."""
_GAP, _MARGIN, _OVERLAP = 0.08, 0.05, 0.8
"""Metres between two figures and beside them; share of their width by which they may stand closer when they
travel."""


@dataclass(frozen=True, eq=False)
class Row:
    """Figures of a motion side by side.

    Args:
        shown: the figure in all F frames.
        frames: (N,) those that are drawn.
        flat: (F, 2) metres to the right and up in the picture, by place; the ground is at 0.
        deep: (F,) metres towards the eye, by place.
        columns: (N,) metres to the right of the first figure.
        is_travelling: the figures stand as far apart as they are.
        left: metres from the edge of the picture to the first figure.
        low: metres, the lowest point.
        high: metres, the upper edge.
        width: pixels.
        head: pixels above it, for a title.
    """

    shown: Figure
    frames: NDArray[np.intp]
    flat: Mapping[str, Floats]
    deep: Mapping[str, Floats]
    columns: Floats
    is_travelling: bool
    left: float
    low: float
    high: float
    width: float
    head: float

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of a place in metres."""
        return (x + self.left) * _SCALE, self.head + (self.high - y) * _SCALE

    def shift(self, which: int) -> float:
        """Metres by which a figure is moved into its column."""
        return float(self.columns[which] - self.flat["pelvis"][self.frames[which], 0])


def row_of(shown: Figure, count: int, around: float, above: float, head: float) -> Row:
    """The figures of a motion in a row.

    Args:
        shown: the figure.
        count: figures, from the first frame to the last.
        around: degrees that the camera goes round from the front of the first figure to its right.
        above: degrees that it looks down.
        head: pixels above.
    """
    frames = np.unique(np.linspace(0, len(shown.facing) - 1, count).round().astype(int))
    right, up, towards = _camera(float(shown.facing[0]) - np.radians(around), np.radians(above))
    # Each figure stands on the one ground line, however far towards the eye it has come.
    below = shown.places["pelvis"] * np.array([1.0, 0.0, 1.0]) + np.array([0.0, shown.ground, 0.0])
    flat = {
        name: np.stack([places @ right, (places - below) @ up], axis=-1)
        for name, places in shown.places.items()
    }
    deep = {name: places @ towards for name, places in shown.places.items()}
    drawn = np.stack([places[frames] for places in flat.values()])
    middle = flat["pelvis"][frames, 0]
    before, after = (drawn[..., 0] - middle).min(), (drawn[..., 0] - middle).max()
    pitch = after - before + _GAP
    is_travelling = len(frames) > 1 and float(np.diff(middle).min()) > _OVERLAP * pitch
    columns = middle - middle[0] if is_travelling else np.arange(len(frames)) * pitch
    left = _MARGIN - before
    return Row(
        shown=shown,
        frames=frames,
        flat=flat,
        deep=deep,
        columns=columns,
        is_travelling=is_travelling,
        left=float(left),
        low=min(0.0, float(drawn[..., 1].min())),
        high=max(0.3, float(drawn[..., 1].max()) + 0.12),
        width=float((columns[-1] + left + after + _MARGIN) * _SCALE),
        head=head,
    )


def drawing(row: Row, labels: Sequence[str] | None, with_plan: bool) -> tuple[str, float]:
    """SVG of a row, and its height in pixels."""
    down = standing(row.shown)
    x, y = row.at(-row.left, 0.0)
    parts = [f'<path d="M{x:.1f} {y:.1f}H{row.width:.1f}" stroke="{INK}" stroke-width="1"/>']
    for which, frame in enumerate(row.frames.tolist()):
        parts += [_body(row, which), _bars(row, which, down)]
        label = f"{frame * row.shown.frame_time:.2f} s" if labels is None else labels[which]
        parts.append(_label(row, which, label))
    parts.append(_trail(row))
    bottom = row.at(0.0, row.low)[1] + 30
    if with_plan:
        prints, tall = plan(row.shown, row.frames, down, row.width - 64, _SCALE)
        note = f'<text x="0" y="10" font-size="10" fill="{INK}">from above</text>'
        moved = f'<g transform="translate(64 0)">{prints}</g>'
        parts.append(f'<g transform="translate(0 {bottom:.1f})">{note}{moved}</g>')
        bottom += tall
    return "".join(parts), bottom + 8


def _camera(turn: float, rise: float) -> tuple[Floats, Floats, Floats]:
    """Orthographic: the directions to the right and up in the picture, and towards the eye."""
    level = np.array([np.sin(turn), 0.0, np.cos(turn)])
    towards = np.cos(rise) * level + np.sin(rise) * np.array([0.0, 1.0, 0.0])
    right = np.cross([0.0, 1.0, 0.0], level)
    return right, np.cross(towards, right), towards


def _body(row: Row, which: int) -> str:
    """The limbs of one figure, the farthest first."""
    frame, shift, height = row.frames[which], row.shift(which), row.shown.height
    shapes = []
    for limb in LIMBS:
        points = [(name, radius * height) for name, radius in limb.points if name in row.flat]
        if not points:
            continue
        depth = float(np.mean([row.deep[name][frame] for name, _ in points]))
        depth -= 0.1 * height * (points[0][0] == "neck")  # the head hides it
        circles = [
            (*row.at(row.flat[name][frame, 0] + shift, row.flat[name][frame, 1]), radius * _SCALE)
            for name, radius in points
        ]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in outline(np.array(circles)))
        shapes.append(
            (depth, f'<path d="M{path}Z" fill="{COLOURS[limb.side]}" stroke="{PAPER}" stroke-width="0.8"/>')
        )
    return "".join(shape for _, shape in sorted(shapes, key=lambda one: one[0]))


def _bars(row: Row, which: int, down: Mapping[str, NDArray[np.bool_]]) -> str:
    """Bars below the heels and balls that stand on the ground."""
    frame, shift, bars = row.frames[which], row.shift(which), []
    for k, side in enumerate(SIDES):
        for point in ("heel", "ball"):
            if down[f"{side}_{point}"][frame]:
                x, y = row.at(row.flat[f"{side}_{point}"][frame, 0] + shift, 0.0)
                bars.append(
                    f'<rect x="{x - 6:.1f}" y="{y + 2 + 4 * k:.1f}" width="12" height="3" rx="1" '
                    f'fill="{COLOURS[side]}"/>'
                )
    return "".join(bars)


def _label(row: Row, which: int, words: str) -> str:
    x, y = row.at(float(row.columns[which]), row.low)
    safe = words.replace("&", "&amp;").replace("<", "&lt;")
    return (
        f'<text x="{x:.1f}" y="{y + 24:.1f}" font-size="10" fill="{INK}" text-anchor="middle">{safe}</text>'
    )


def _trail(row: Row) -> str:
    """The way of the pelvis from figure to figure."""
    pelvis = row.flat["pelvis"]
    every = np.linspace(0, len(pelvis) - 1, 80).round().astype(int)
    if row.is_travelling:
        across = pelvis[every, 0] - pelvis[0, 0]
    else:
        across = np.interp(every, row.frames, row.columns)
    points = [row.at(x, y) for x, y in zip(across, pelvis[every, 1], strict=True)]
    line = "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
    return f'<path d="M{line}" fill="none" stroke="{PATH}" stroke-width="1" stroke-dasharray="3 3"/>'
