"""A film strip: markers and the skeleton fitted to them, from the left side and from the front.

Plain SVG, so that it needs nothing to be installed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.markers.gaps import seen

if TYPE_CHECKING:
    from gmr.markers.fit import MarkerFit

__all__ = ["film_strip"]

Array = NDArray[np.float64]

_FONT: Final = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
_CELL: Final = 144
"""Width of a frame, pixels."""
_METRE: Final = 118
"""Pixels of a metre."""
_TOP: Final = 62
_MARGIN: Final = 14
_GAP: Final = 40
"""Pixels between the rows."""
_LEFT, _RIGHT, _MIDDLE = "#1f5f99", "#c2550a", "#4d555e"
_INK, _SOFT, _LINE = "#16191d", "#4d555e", "#d9dde2"
_VIEWS: Final = ("from its left", "from the front")


@dataclass(frozen=True, slots=True)
class _View:
    """Where a point in metres is in the picture.

    Args:
        across: (3,) direction in the world that is to the right.
        middle: metres along it that are at ``x``.
        floor: metres that are at ``ground``.
    """

    across: Array
    middle: float
    x: float
    floor: float
    ground: float

    def __call__(self, point: Array) -> tuple[float, float]:
        right, up = float(point @ self.across) - self.middle, float(point[1]) - self.floor
        return self.x + right * _METRE, self.ground - up * _METRE


def film_strip(fit: MarkerFit, count: int = 6) -> str:
    """SVG of some frames, evenly spread over those in which the whole body is known.

    Args:
        fit: of markers to a motion.
        count: frames to draw, at least 1.

    Raises:
        GmrError: no frame shows the whole body.
    """
    unit = fit.motion.unit or 1.0
    joints = fit.motion.positions(dtype=np.float64) * unit
    whole = np.flatnonzero(seen(joints).all(axis=1))
    if not len(whole):
        raise GmrError("no frame shows the whole body, so there is nothing to draw; fill the gaps first")
    frames = whole[np.unique(np.linspace(0, len(whole) - 1, max(1, count)).round().astype(int))]
    joints, markers = joints[frames], fit.markers.positions[frames] * unit
    low, high = (float(edge(joints[..., 1])) for edge in (np.min, np.max))
    floor = low if low < 0 or low > 0.5 else 0.0
    tall = (max(high, float(np.nanmax(markers[..., 1], initial=0.0))) - floor) * _METRE + 12
    width, height = _MARGIN * 2 + _CELL * len(frames), _TOP + 2 * tall + 2 * _GAP
    drawn = [*_head(fit, len(frames), width, height)]
    for row, across in enumerate(_directions(fit)):
        ground = _TOP + (row + 1) * tall + row * _GAP
        drawn.append(_line((_MARGIN, ground), (width - _MARGIN, ground), _LINE, 1))
        drawn.append(_text(_MARGIN, ground + 31, _VIEWS[row], _INK))
        for column, frame in enumerate(frames.tolist()):
            x = _MARGIN + (column + 0.5) * _CELL
            view = _View(across, float(joints[column, 0] @ across), x, floor, ground)
            drawn += _figure(fit, joints[column], markers[column], view)
            drawn.append(_text(x, ground + 15, f"{frame * fit.motion.frame_time:.2f} s", _SOFT, "middle"))
    return "\n".join([*drawn, "</svg>", ""])


def _head(fit: MarkerFit, count: int, width: float, height: float) -> Iterator[str]:
    frames = "1 frame" if count == 1 else f"{count} frames"
    residual = float(np.nanmean(fit.residuals))
    title = f"{frames}: markers and the skeleton fitted to them, {residual:.1f} mm apart in the mean"
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height:.0f}" width="{width}" '
        f'height="{height:.0f}" font-family="{_FONT}" role="img">'
    )
    yield f"<title>{title}</title>"
    yield f'<rect width="{width}" height="{height:.0f}" fill="#ffffff"/>'
    yield f'<text x="{_MARGIN}" y="24" font-size="15" font-weight="600" fill="{_INK}">{title}</text>'
    sides = zip(("left", "right", "middle"), (_LEFT, _RIGHT, _MIDDLE), strict=True)
    key = ", ".join(f'<tspan fill="{colour}">{side}</tspan>' for side, colour in sides)
    yield f'<text x="{_MARGIN}" y="44" font-size="12" fill="{_SOFT}">{key}; dots are markers</text>'


def _directions(fit: MarkerFit) -> tuple[Array, Array]:
    """What is drawn to the right in each row: the way the body faces, and its left, level with the floor."""
    root = next(iter(fit.segments.values())).fit
    forward = np.nanmean(root.rotations[:, :, 2], axis=0) * np.array([1.0, 0.0, 1.0])
    if np.linalg.norm(forward) < 0.1:
        forward = np.array([0.0, 0.0, 1.0])
    forward /= np.linalg.norm(forward)
    # Seen from its left, a body faces to the left of the picture; seen from the front, its left is right.
    return -forward, np.asarray(np.cross(np.array([0.0, 1.0, 0.0]), forward), np.float64)


def _figure(fit: MarkerFit, joints: Array, markers: Array, view: _View) -> Iterator[str]:
    """Bones and markers of one frame in one view."""
    skeleton = fit.motion.skeleton
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            yield _line(view(joints[parent]), view(joints[joint]), _colour(skeleton.names[joint]), 2.4)
    for marker in markers[seen(markers)]:
        x, y = view(marker)
        yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.5" fill="{_INK}" fill-opacity="0.75"/>'


def _colour(joint: str) -> str:
    return _LEFT if joint.startswith("Left") else _RIGHT if joint.startswith("Right") else _MIDDLE


def _line(start: tuple[float, float], end: tuple[float, float], colour: str, width: float) -> str:
    return (
        f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" '
        f'stroke="{colour}" stroke-width="{width}" stroke-linecap="round"/>'
    )


def _text(x: float, y: float, text: str, colour: str, anchor: str = "start") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="11" fill="{colour}" text-anchor="{anchor}">{text}</text>'
    )
