"""The frame of a motion in which its body stands best: its rest, where it has none of its own."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

__all__ = ["standing_frame"]

Floats = NDArray[np.float64]

_SIDES = ("left", "right")


def standing_frame(places: Floats, begins: Mapping[str, int]) -> int:
    """Index of the frame that stands best.

    Legs straight and upright, trunk upright over the hips, hips and shoulders parallel: the sum of what the
    cosines lack of 1, over what there is of these.

    Args:
        places: (F, J, 3) of the joints, +Y up.
        begins: joint in which each part of the body begins.
    """

    def of(part: str) -> Floats | None:
        return places[:, begins[part]] if part in begins else None

    up = np.array([0.0, 1.0, 0.0])
    lacking = np.zeros(len(places))
    for side in _SIDES:
        hip, knee, foot = (of(f"{side}_{part}") for part in ("up_leg", "leg", "foot"))
        for above, below in ((hip, knee), (knee, foot)):
            if above is not None and below is not None:
                lacking += 1 - _cosine(above - below, up)
    hips, shoulders = (_pair(of(f"left_{part}"), of(f"right_{part}")) for part in ("up_leg", "arm"))
    if hips is not None and shoulders is not None:
        lacking += 1 - _cosine(shoulders[0] + shoulders[1] - hips[0] - hips[1], up)
        lacking += 1 - _cosine(hips[0] - hips[1], shoulders[0] - shoulders[1])
    elif (head := of("head")) is not None and hips is not None:
        lacking += 1 - _cosine(2 * head - hips[0] - hips[1], up)
    return int(lacking.argmin())


def _pair(left: Floats | None, right: Floats | None) -> tuple[Floats, Floats] | None:
    return None if left is None or right is None else (left, right)


def _cosine(one: Floats, other: Floats) -> Floats:
    size = np.linalg.norm(one, axis=-1) * np.linalg.norm(other, axis=-1)
    return np.asarray((one * other).sum(axis=-1) / np.maximum(size, 1e-12), np.float64)
