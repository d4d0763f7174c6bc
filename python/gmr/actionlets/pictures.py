"""A film strip: the figure of a moving body at equal times, side by side, to judge a movement by eye.

The left limbs are light, the right ones dark. Bars on the ground mark the heels and the balls of the feet
that stand on it; below, the path of the pelvis and the places of the feet are seen from above.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.figure import LIMBS, Figure, figure, outline
from gmr.errors import ActionletError, MissingExtraError
from gmr.motion import Motion
from gmr.replacing import replacing

__all__ = ["VIEWS", "film_strip"]

Floats = NDArray[np.float64]

VIEWS = {"side": (90.0, 0.0), "front": (0.0, 0.0), "three-quarter": (40.0, 10.0)}
"""By name: how far the camera goes round from the front to the body's right, and how high, degrees."""

_COLOURS = {"left": "#8fb8de", "right": "#1d4f8a", "": "#5b7088"}
_INK, _PATH, _PAPER = "#27313b", "#c4621f", "#ffffff"
_SCALE = 110.0
"""Pixels in a metre."""
_NEAR, _SLOW = 0.025, 0.45
"""Metres above the ground and metres a second within which a point of a foot stands."""
_SIDES = ("left", "right")


@dataclass(frozen=True)
class _Camera:
    """Orthographic: ``right`` and ``up`` span the picture, ``towards`` points to the eye."""

    right: Floats
    up: Floats
    towards: Floats


def film_strip(
    motion: Motion | Sequence[Motion],
    path: str | os.PathLike[str] | None = None,
    count: int = 12,
    view: str = "side",
    *,
    titles: Sequence[str] | None = None,
    plan: bool = True,
    scale: float = 1.5,
) -> str:
    """Draws a film strip of one motion, or of several below each other.

    Args:
        motion: of a body that gmr knows, in any unit.
        path: ``.svg`` or ``.png`` to write; None: nothing is written.
        count: figures of each motion, from its first frame to its last.
        view: ``"side"`` (from the body's right, so that it goes to the right), ``"front"`` or
            ``"three-quarter"``, as the body faces in the first frame.
        titles: above each row.
        plan: show the path from above.
        scale: of the pixels of a PNG.

    Returns:
        The SVG.

    Raises:
        ActionletError: an unknown view, a count below 1, another suffix, or no body in a motion.
        MissingExtraError: a PNG needs the extra [report].
    """
    if view not in VIEWS:
        raise ActionletError(f"view={view!r}: give one of {', '.join(VIEWS)}")
    if count < 1:
        raise ActionletError(f"count={count}: give 1 or more figures")
    motions = [motion] if isinstance(motion, Motion) else list(motion)
    rows = []
    width, top = 0.0, 8.0
    for k, one in enumerate(motions):
        title = titles[k] if titles is not None and k < len(titles) else None
        row, (wide, high) = _row(figure(one), count, view, title, plan)
        rows.append(f'<g transform="translate(8 {top:.1f})">{row}</g>')
        width, top = max(width, wide + 16), top + high
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {top:.0f}" width="{width:.0f}" '
        f'height="{top:.0f}" font-family="system-ui, Segoe UI, Roboto, Helvetica, Arial, sans-serif">'
        f'<rect width="100%" height="100%" fill="{_PAPER}"/>{"".join(rows)}</svg>\n'
    )
    if path is not None:
        _write(svg, Path(path), scale)
    return svg


def _write(svg: str, path: Path, scale: float) -> None:
    suffix = path.suffix.lower()
    if suffix not in (".svg", ".png"):
        raise ActionletError(f"a film strip is written as .svg or .png, not as '{path.name}'")
    data = svg.encode()
    if suffix == ".png":
        try:
            import vl_convert
        except ImportError as error:
            raise MissingExtraError("vl-convert-python", "report", "a film strip as PNG") from error
        data = vl_convert.svg_to_png(svg, scale=scale)
    with replacing(path) as (file,):
        file.write(data)


def _row(
    shown: Figure, count: int, view: str, title: str | None, plan: bool
) -> tuple[str, tuple[float, float]]:
    """Drawing of one motion, and its width and height in pixels."""
    frames = np.unique(np.linspace(0, len(shown.facing) - 1, count).round().astype(int))
    camera = _camera(float(shown.facing[0]), *VIEWS[view])
    grounds = _grounds(shown, camera)
    flat = {name: _project(places, camera) for name, places in shown.places.items()}
    deep = {name: places @ camera.towards for name, places in shown.places.items()}
    # Each figure stands on the one ground line, however far towards the eye it has come.
    for places in flat.values():
        places[:, 1] -= grounds
    middle = flat["pelvis"][:, 0]
    spans = [
        [min(flat[n][f, 0] for n in flat) - middle[f], max(flat[n][f, 0] for n in flat) - middle[f]]
        for f in frames
    ]
    before, after = min(low for low, _ in spans), max(high for _, high in spans)
    pitch = after - before + 0.08
    steps = np.diff(middle[frames])
    is_travelling = len(steps) > 0 and steps.min() > 0.8 * pitch
    columns = middle[frames] - middle[frames[0]] if is_travelling else np.arange(len(frames)) * pitch
    ground = 0.0
    tops = [max(flat[n][f, 1] for n in flat) for f in frames]
    high = max(max(tops) + 0.12, ground + 0.3)
    lowest = min(min(flat[n][f, 1] for n in flat) for f in frames)
    base = min(ground, lowest)
    left = 0.05 - before
    head = 22.0 if title else 4.0

    def at(x: float, y: float, shift: float = 0.0) -> tuple[float, float]:
        return (x + shift + left) * _SCALE, head + (high - y) * _SCALE

    width = (columns[-1] + left + after + 0.05) * _SCALE
    parts = (
        [f'<text x="0" y="13" font-size="13" font-weight="600" fill="{_INK}">{_text(title)}</text>']
        if title
        else []
    )
    x0, y0 = at(-left, ground)
    parts.append(f'<path d="M{x0:.1f} {y0:.1f}H{width:.1f}" stroke="{_INK}" stroke-width="1"/>')
    if not is_travelling:
        shared = np.interp(np.linspace(0, 1, 60), np.linspace(0, 1, len(frames)), columns)
        moving = np.linspace(0, len(middle) - 1, 60).round().astype(int)
        trail = [at(x, y) for x, y in zip(shared, flat["pelvis"][moving, 1], strict=True)]
    else:
        trail = [at(x - middle[0], y) for x, y in flat["pelvis"][:: max(1, len(middle) // 80)]]
    line = "L".join(f"{x:.1f} {y:.1f}" for x, y in trail)
    standing = _standing(shown)
    for frame, column in zip(frames, columns, strict=True):
        shift = column - middle[frame]
        parts.append(_body(flat, deep, frame, shown.height, partial(at, shift=shift)))
        for k, side in enumerate(_SIDES):
            for point in ("heel", "ball"):
                if standing[f"{side}_{point}"][frame]:
                    x, y = at(flat[f"{side}_{point}"][frame, 0] + shift, ground)
                    parts.append(
                        f'<rect x="{x - 6:.1f}" y="{y + 2 + 4 * k:.1f}" width="12" height="3" rx="1" '
                        f'fill="{_COLOURS[side]}"/>'
                    )
        x, y = at(column, base)
        seconds = frame * shown.frame_time
        parts.append(
            f'<text x="{x:.1f}" y="{y + 24:.1f}" font-size="10" fill="{_INK}" text-anchor="middle">'
            f"{seconds:.2f} s</text>"
        )
    parts.append(f'<path d="M{line}" fill="none" stroke="{_PATH}" stroke-width="1" stroke-dasharray="3 3"/>')
    bottom = at(0, base)[1] + 30
    if plan:
        drawing, tall = _plan(shown, frames, standing, width - 64)
        note = f'<text x="0" y="10" font-size="10" fill="{_INK}">from above</text>'
        parts.append(
            f'<g transform="translate(0 {bottom:.1f})">{note}<g transform="translate(64 0)">{drawing}</g></g>'
        )
        bottom += tall
    return "".join(parts), (width, bottom + 8)


def _camera(facing: float, around: float, above: float) -> _Camera:
    turn, rise = facing - np.radians(around), np.radians(above)
    level = np.array([np.sin(turn), 0.0, np.cos(turn)])
    towards = np.cos(rise) * level + np.sin(rise) * np.array([0.0, 1.0, 0.0])
    right = np.cross([0.0, 1.0, 0.0], level)
    return _Camera(right, np.cross(towards, right), towards)


def _project(places: Floats, camera: _Camera) -> Floats:
    return np.stack([places @ camera.right, places @ camera.up], axis=-1)


def _grounds(shown: Figure, camera: _Camera) -> Floats:
    """(F,) height in the picture of the ground below the pelvis."""
    below = shown.places["pelvis"] * np.array([1.0, 0.0, 1.0]) + np.array([0.0, shown.ground, 0.0])
    return np.asarray(below @ camera.up, np.float64)


def _body(
    flat: dict[str, Floats],
    deep: dict[str, Floats],
    frame: int,
    height: float,
    at: Callable[[float, float], tuple[float, float]],
) -> str:
    """The limbs of one figure, the farthest first."""
    shapes = []
    for limb in LIMBS:
        points = [(name, radius * height) for name, radius in limb.points if name in flat]
        if not points:
            continue
        depth = float(np.mean([deep[name][frame] for name, _ in points]))
        depth -= 0.1 * height * (points[0][0] == "neck")  # the head hides it
        circles = np.array([[*at(*flat[name][frame]), radius * _SCALE] for name, radius in points])
        hull = outline(circles)
        d = "L".join(f"{x:.1f} {y:.1f}" for x, y in hull)
        shapes.append(
            (depth, f'<path d="M{d}Z" fill="{_COLOURS[limb.side]}" stroke="{_PAPER}" stroke-width="0.8"/>')
        )
    return "".join(shape for _, shape in sorted(shapes, key=lambda one: one[0]))


def _standing(shown: Figure) -> dict[str, NDArray[np.bool_]]:
    """(F,) whether each point of the feet stands on the ground."""
    found = {}
    for side in _SIDES:
        for point in ("heel", "ball"):
            places = shown.places[f"{side}_{point}"]
            speed = np.zeros(len(places))
            if len(places) > 1 and shown.frame_time > 0:
                speed = np.linalg.norm(np.gradient(places, shown.frame_time, axis=0), axis=-1)
            low = places[:, 1] - 0.013 * shown.height - shown.ground < _NEAR
            found[f"{side}_{point}"] = low & (speed < _SLOW)
    return found


def _plan(
    shown: Figure, frames: NDArray[np.intp], standing: dict[str, NDArray[np.bool_]], width: float
) -> tuple[str, float]:
    """Path and feet from above, the way that the body faces first to the right; its height in pixels."""
    facing = shown.facing[0]
    ahead, aside = np.array([np.sin(facing), np.cos(facing)]), np.array([np.cos(facing), -np.sin(facing)])

    def flat(places: Floats) -> Floats:
        level = places[:, [0, 2]] - shown.places["pelvis"][0, [0, 2]]
        return np.stack([level @ ahead, -(level @ aside)], axis=-1)

    path = flat(shown.places["pelvis"])
    feet = {name: flat(shown.places[name]) for name in standing}
    everything = np.concatenate([path, *feet.values()])
    low, high = everything.min(axis=0) - 0.06, everything.max(axis=0) + 0.06
    scale = min(_SCALE, width / (high[0] - low[0]), 2.2 * _SCALE / (high[1] - low[1]))

    def line(points: Floats) -> str:
        moved = (points - low) * scale
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in moved)

    every = max(1, len(path) // 200)
    parts = [f'<path d="{line(path[::every])}" fill="none" stroke="{_PATH}" stroke-width="1.2"/>']
    for side in _SIDES:
        on = standing[f"{side}_heel"] | standing[f"{side}_ball"]
        for begin, end in _runs(on):
            half = (begin + end) // 2
            both = np.stack([feet[f"{side}_heel"][half], feet[f"{side}_ball"][half]])
            parts.append(
                f'<path d="{line(both)}" stroke="{_COLOURS[side]}" stroke-width="{0.05 * scale:.1f}" '
                'stroke-linecap="round"/>'
            )
    for frame in frames:
        x, y = (path[frame] - low) * scale
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="{_PATH}"/>')
    return "".join(parts), float((high[1] - low[1]) * scale)


def _runs(on: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last frame of each time on the ground."""
    edges = np.diff(np.concatenate([[False], on, [False]]).astype(int))
    begins, ends = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    return [(int(a), int(b) - 1) for a, b in zip(begins, ends, strict=True)]


def _text(words: str) -> str:
    return words.replace("&", "&amp;").replace("<", "&lt;")
