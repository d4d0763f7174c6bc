"""Where figures stand, where the ground is, and where the eye is put."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gmr.view.figure import Figure

__all__ = ["Layout", "laid_out"]

Floats = NDArray[np.float64]

_GAP = 0.4
"""Between two figures, as a share of the taller one's height."""
_NEAR_GROUND = 0.3
"""Share of a figure's height within which its lowest joint counts as standing on y = 0."""
_EYE = np.array([0.5, 0.3, 1.0])
"""From what is looked at to the eye, where things spread along X: across, and a little from above."""
_FIELD = np.deg2rad(45.0)
_ASPECT = 1.3
_FILLED = 0.98
"""Share of the screen that everything fills."""
_HEADROOM = 0.1
"""For names, as a share of the height."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Metres, Y up."""

    places: tuple[Floats, ...]
    """(3,) by what each figure is moved."""
    ground: float
    """Height of the ground."""
    low: Floats
    """(3,) lowest corner of everything."""
    high: Floats
    """(3,) highest corner of everything."""
    field: float = float(_FIELD)
    """Vertical field of view in radians."""

    @property
    def centre(self) -> Floats:
        """(3,) what is looked at."""
        return (self.low + self.high) / 2

    @property
    def eye(self) -> Floats:
        """(3,) from where everything is seen, names above included, on a screen that is at least as wide as
        :data:`_ASPECT`."""
        along_x, up, along_z = self.high - self.low
        back = _EYE if along_x >= along_z else _EYE[::-1]
        back = back / np.linalg.norm(back)
        right = np.cross([0.0, 1.0, 0.0], back)
        right /= np.linalg.norm(right)
        top = self.high + np.array([0.0, up * _HEADROOM, 0.0])
        corners = np.stack(np.meshgrid(*zip(self.low, top, strict=True)), -1)
        away = corners.reshape(-1, 3) - self.centre
        slope = np.tan(self.field / 2) * _FILLED
        across = np.abs(away @ right) / (slope * _ASPECT)
        upward = np.abs(away @ np.cross(back, right)) / slope
        distance = float((np.maximum(across, upward) + away @ back).max())
        return np.asarray(self.centre + back * max(distance, 1e-3), np.float64)

    @property
    def cell(self) -> float:
        """Metres between the lines of the ground: 1, or a power of ten that suits what stands on it."""
        size = float(np.max(self.high - self.low))
        if 0.5 <= size <= 100:
            return 1.0
        return float(10.0 ** np.floor(np.log10(max(size, 1e-6) / 2)))


def laid_out(figures: Sequence[Figure], *, overlay: bool = False) -> Layout:
    """Figures side by side, so that their ways do not cross; with ``overlay`` where they are.

    They stand in a row along X or along Z, whichever makes the shorter row: people who walk along Z are put
    beside each other, and so are people who walk along X.
    """
    boxes = np.array([figure.box for figure in figures], np.float64)
    heights = boxes[:, 1, 1] - boxes[:, 0, 1]
    lows = boxes[:, 0, 1]
    stands = np.abs(lows) <= _NEAR_GROUND * np.maximum(heights, 1e-6)
    ground = 0.0 if stands.all() else float(lows.min())
    places = np.zeros((len(figures), 3))
    if not overlay and len(figures) > 1:
        gap = _GAP * float(heights.max())
        widths = boxes[:, 1] - boxes[:, 0]
        axis = 0 if widths[:, 0].sum() <= widths[:, 2].sum() else 2
        across = 2 - axis
        starts = np.cumsum(widths[:, axis] + gap) - widths[:, axis] - gap
        row = float((widths[:, axis] + gap).sum() - gap)
        places[:, axis] = starts - row / 2 - boxes[:, 0, axis]
        places[:, across] = -boxes[:, :, across].mean(axis=1)
    moved = boxes + places[:, None]
    low, high = moved[:, 0].min(axis=0), moved[:, 1].max(axis=0)
    low[1] = min(low[1], ground)
    return Layout(tuple(places), ground, low, high)
