"""Colours of figures, sides and weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["LEVELS", "SKIN", "TRAILS", "bone_colours", "figure_colour", "level_colours", "srgb"]

Colour = tuple[int, int, int]

_FIGURES: tuple[Colour, ...] = (
    (86, 132, 190), (214, 126, 44), (64, 152, 116), (178, 92, 150), (150, 140, 60), (110, 110, 190),
)  # fmt: skip
_LEFT: Colour = (226, 124, 24)
_RIGHT: Colour = (16, 138, 112)
_TOWARDS = 0.85
"""How far the colour of a side goes from that of the figure."""
SKIN: Colour = (205, 196, 184)
"""A skin whose material says nothing."""
TRAILS: tuple[Colour, ...] = ((60, 60, 70), (224, 138, 48), (46, 150, 130))
"""Root, left hand, right hand."""
LEVELS = 12
"""Steps in which weights are coloured."""
_RAMP = np.array([[128, 136, 152], [70, 130, 180], [94, 188, 158], [240, 214, 90], [222, 72, 48]], np.float64)
"""From weight 0 to weight 1."""


def figure_colour(number: int) -> Colour:
    """The colour of a figure, by its place among those shown."""
    return _FIGURES[number % len(_FIGURES)]


def bone_colours(sides: tuple[str, ...], number: int) -> NDArray[np.uint8]:
    """(B, 3) colours of bones: those of the left and of the right are told apart."""
    own = np.array(figure_colour(number), np.float64)
    towards = {"left": np.array(_LEFT), "right": np.array(_RIGHT), "": own}
    mixed = [own + (towards[side] - own) * _TOWARDS for side in sides]
    return np.array(mixed, np.float64).reshape(-1, 3).round().astype(np.uint8)


def level_colours() -> NDArray[np.uint8]:
    """(LEVELS, 3) from weight 0 to weight 1."""
    at = np.linspace(0, len(_RAMP) - 1, LEVELS)
    return np.stack([np.interp(at, np.arange(len(_RAMP)), _RAMP[:, k]) for k in range(3)], 1).astype(np.uint8)


def srgb(linear: ArrayLike) -> Colour:
    """Bytes of a linear colour from 0 to 1. Source: IEC 61966-2-1."""
    at = np.clip(np.asarray(linear, np.float64)[:3], 0.0, 1.0)
    coded = np.where(at <= 0.0031308, 12.92 * at, 1.055 * at ** (1 / 2.4) - 0.055)
    red, green, blue = (coded * 255).round().astype(int).tolist()
    return red, green, blue
