"""What a file does not say, guessed from the body in it: which way is up, and how long its unit is.

A guess is shown as a guess, never used silently.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.tpose import without_leading_tpose
from gmr.units import UNITS

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["UnitGuess", "UpGuess", "body_height", "guess_unit", "guess_up"]

_SAMPLES = 200
_TALL, _SHORT = 2.2, 1.2
"""Metres between which a standing human is looked for, child to giant."""
_USUAL = 1.7
_GUESSED_UNITS = ("m", "cm", "mm", "in", "ft", "cmu")
_HIGH = re.compile(r"head|neck", re.IGNORECASE)
_LOW = re.compile(r"foot|toe|ankle", re.IGNORECASE)


@dataclass(frozen=True)
class UpGuess:
    """The axis that points up: "+Y", "-Z", ...; ``sure`` where head and feet tell, else the longest side."""

    axis: str
    sure: bool


@dataclass(frozen=True)
class UnitGuess:
    """A unit with which the body has a human's height."""

    name: str
    metres: float
    body_metres: float


def guess_up(motion: Motion) -> UpGuess | None:
    """Which axis points up: from feet to head where joints are named so, else the longest of the body.

    Returns:
        None where there are no frames, or the body has no extent.
    """
    positions = _sampled(motion)
    if not len(positions):
        return None
    names = motion.skeleton.names
    high = [joint for joint, name in enumerate(names) if _HIGH.search(name)]
    low = [joint for joint, name in enumerate(names) if _LOW.search(name)]
    if high and low:
        upwards = np.median(positions[:, high].mean(axis=1) - positions[:, low].mean(axis=1), axis=0)
        axis = int(np.abs(upwards).argmax())
        return UpGuess(f"{'+' if upwards[axis] > 0 else '-'}{'XYZ'[axis]}", sure=True)
    extents = np.median(np.ptp(positions, axis=1), axis=0)
    return UpGuess(f"+{'XYZ'[int(extents.argmax())]}", sure=False) if extents.max() > 0 else None


def body_height(motion: Motion, axis: int = 1) -> float:
    """Height of the upright body in file units: from the lowest to the highest joint, in its tallest frames.

    Args:
        motion: any; a T-pose in front is left out.
        axis: 0, 1, 2 for x, y, z up.
    """
    positions = _sampled(motion)
    if not len(positions):
        return math.nan
    return float(np.quantile(np.ptp(positions[..., axis], axis=1), 0.9))


def guess_unit(motion: Motion) -> UnitGuess | None:
    """The unit with which the body is nearest to a human's usual height; None where no unit makes it one."""
    up = guess_up(motion)
    if up is None:
        return None
    height = body_height(motion, "XYZ".index(up.axis[1]))
    fitting = [
        UnitGuess(name, UNITS[name], height * UNITS[name])
        for name in _GUESSED_UNITS
        if _SHORT <= height * UNITS[name] <= _TALL
    ]
    return min(fitting, key=lambda guess: abs(math.log(guess.body_metres / _USUAL)), default=None)


def _sampled(motion: Motion) -> NDArray[Any]:
    """(<= 200, J, 3) positions of finite frames from all over the recording."""
    recorded = without_leading_tpose(motion)
    positions = recorded[:: max(1, recorded.frame_count // _SAMPLES)].positions()
    return positions[np.isfinite(positions).all(axis=(1, 2))]
