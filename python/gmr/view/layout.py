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
_EYE = np.array([0.5, 0.4, 1.0])
"""From what is looked at to the eye, where X lies across the screen: aside, and a little from above."""
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
    boxes: Floats
    """(K, 2, 3) the lowest and the highest corner of where each figure comes, in its place."""
    across: int
    """The axis, X (0) or Z (2), that lies across the screen: that of the row, or of a single figure's way."""
    field: float = float(_FIELD)
    """Vertical field of view in radians."""

    @property
    def low(self) -> Floats:
        """(3,) lowest corner of everything, the ground included."""
        low = self.boxes[:, 0].min(axis=0)
        return np.array([low[0], min(low[1], self.ground), low[2]])

    @property
    def high(self) -> Floats:
        """(3,) highest corner of everything."""
        return np.asarray(self.boxes[:, 1].max(axis=0), np.float64)

    @property
    def centre(self) -> Floats:
        """(3,) what is looked at: straight ahead of the eye, as far as the middle of everything."""
        back = self._back
        return np.asarray(self.eye - back * ((self.eye - (self.low + self.high) / 2) @ back), np.float64)

    @property
    def eye(self) -> Floats:
        """(3,) the nearest place from where everything is seen, names above included, on a screen that is at
        least as wide as :data:`_ASPECT`."""
        back = self._back
        right = np.cross([0.0, 1.0, 0.0], back)
        right /= np.linalg.norm(right)
        over = np.cross(back, right)
        slope = np.tan(self.field / 2) * _FILLED
        (aside, far), (above, far_above) = (
            _between(self._corners @ axis, self._corners @ back, slope * aspect)
            for axis, aspect in ((right, _ASPECT), (over, 1.0))
        )
        return np.asarray(right * aside + over * above + back * max(far, far_above), np.float64)

    @property
    def _back(self) -> Floats:
        """(3,) unit vector from what is looked at to the eye."""
        back = _EYE if self.across == 0 else _EYE[::-1]
        return np.asarray(back / np.linalg.norm(back), np.float64)

    @property
    def _corners(self) -> Floats:
        """(8 K, 3) of the figures' boxes, with room for names above."""
        low, high = self.boxes[:, 0], self.boxes[:, 1].copy()
        high[:, 1] += (self.high - self.low)[1] * _HEADROOM
        which = np.stack(np.meshgrid(*3 * [[False, True]]), -1).reshape(-1, 1, 3)
        return np.where(which, high, low).reshape(-1, 3)

    @property
    def cell(self) -> float:
        """Metres between the lines of the ground: 1, or a power of ten that suits what stands on it."""
        size = float(np.max(self.high - self.low))
        if 0.5 <= size <= 100:
            return 1.0
        return float(10.0 ** np.floor(np.log10(max(size, 1e-6) / 2)))


def _between(aside: Floats, near: Floats, slope: float) -> tuple[float, float]:
    """Where across, and how far back at least, an eye sees all points between two lines of a slope.

    Of points at ``aside`` (N,) across and ``near`` (N,) towards the eye, those between the lines satisfy
    ``|aside - a| <= slope (b - near)``.
    """
    one, other = (aside + slope * near).max(), (slope * near - aside).max()
    return float(one - other) / 2, max(float(one + other) / (2 * slope), float(near.max()) + 1e-3)


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
    size = np.ptp(boxes.reshape(-1, 3), axis=0)
    axis = 0 if size[0] >= size[2] else 2
    if not overlay and len(figures) > 1:
        gap = _GAP * float(heights.max())
        widths = boxes[:, 1] - boxes[:, 0]
        axis = 0 if widths[:, 0].sum() <= widths[:, 2].sum() else 2
        along = 2 - axis
        starts = np.cumsum(widths[:, axis] + gap) - widths[:, axis] - gap
        row = float((widths[:, axis] + gap).sum() - gap)
        places[:, axis] = starts - row / 2 - boxes[:, 0, axis]
        places[:, along] = -boxes[:, :, along].mean(axis=1)
    return Layout(tuple(places), ground, boxes + places[:, None], axis)
