"""What a file does not say, guessed from the body in it: which way is up, and how long its unit is.

A guess is shown as a guess, never used silently.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.tpose import without_leading_tpose
from gmr.units import UNITS

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["BodyGuess", "UnitGuess", "UpGuess", "guess_body"]

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


@dataclass(frozen=True)
class BodyGuess:
    """The body of a motion, as far as it can be told; None where it cannot.

    Args:
        up: which way is up.
        height: of the upright body in file units, from the lowest to the highest joint in its tallest frames.
        unit: the unit with which the body is nearest to a human's usual height.
    """

    up: UpGuess | None
    height: float | None
    unit: UnitGuess | None


def guess_body(motion: Motion) -> BodyGuess:
    """Looks at up to 200 frames from all over the recording; a T-pose in front of it is left out."""
    recorded = without_leading_tpose(motion)
    positions = recorded[:: max(1, recorded.frame_count // _SAMPLES)].positions()
    positions = positions[np.isfinite(positions).all(axis=(1, 2))]
    up = _up(motion.skeleton.names, positions) if len(positions) else None
    if up is None:
        return BodyGuess(None, None, None)
    height = float(np.quantile(np.ptp(positions[..., "XYZ".index(up.axis[1])], axis=1), 0.9))
    return BodyGuess(up, height, _unit(height))


def _up(names: Sequence[str], positions: NDArray[Any]) -> UpGuess | None:
    """From feet to head where joints are named so, else the longest side; None for a body without extent."""
    high = [joint for joint, name in enumerate(names) if _HIGH.search(name)]
    low = [joint for joint, name in enumerate(names) if _LOW.search(name)]
    if high and low:
        upwards = np.median(positions[:, high].mean(axis=1) - positions[:, low].mean(axis=1), axis=0)
        axis = int(np.abs(upwards).argmax())
        return UpGuess(f"{'+' if upwards[axis] > 0 else '-'}{'XYZ'[axis]}", sure=True)
    extents = np.median(np.ptp(positions, axis=1), axis=0)
    return UpGuess(f"+{'XYZ'[int(extents.argmax())]}", sure=False) if extents.max() > 0 else None


def _unit(height: float) -> UnitGuess | None:
    """The unit with which ``height`` is a human's."""
    fitting = [
        UnitGuess(name, UNITS[name], height * UNITS[name])
        for name in _GUESSED_UNITS
        if _SHORT <= height * UNITS[name] <= _TALL
    ]
    return min(fitting, key=lambda guess: abs(math.log(guess.body_metres / _USUAL)), default=None)
