"""What a file does not say, guessed from the body in it: which way is up, and how long its unit is.

The unit is told by the legs where they are known, for they have one length whatever the body does; else by
its height. A guess is shown as a guess, never used silently.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from gmr.body.joints import find_joints, named_roles
from gmr.body.measures import leg_length, up_axis
from gmr.errors import DatasetError
from gmr.tpose import without_leading_tpose
from gmr.units import UNITS

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton

__all__ = ["GUESSED_UNITS", "BodyGuess", "UnitGuess", "UpGuess", "guess_body", "unit_of_legs"]

_SAMPLES = 200
_SHORTEST, _TALLEST = 1.0, 2.4
"""Metres between which a standing human is looked for, child to giant."""
_USUAL = 1.7
STATURE_PER_LEG = 1 / 0.491
"""Stature over the length of thigh and shin. Source: Winter, "Biomechanics and Motor Control of Human
Movement", segment lengths after Drillis and Contini: 0.245 and 0.246 of the stature."""

GUESSED_UNITS = ("m", "cm", "mm", "in", "ft", "cmu")
"""Names of the units that a file may turn out to be in."""

_HIGH = re.compile(r"head|neck", re.IGNORECASE)
_LOW = re.compile(r"foot|toe|ankle", re.IGNORECASE)


@dataclass(frozen=True)
class UpGuess:
    """The axis that points up: "+Y", "-Z", ...; ``sure`` where the joints tell, else the longest side."""

    axis: str
    sure: bool


@dataclass(frozen=True)
class UnitGuess:
    """A unit with which the body is a human's.

    Args:
        name: of the unit.
        metres: per unit.
        body_metres: how tall that makes the body.
        by: what told it: the length of the legs, or the height of the upright body.
    """

    name: str
    metres: float
    body_metres: float
    by: Literal["legs", "height"]


@dataclass(frozen=True)
class BodyGuess:
    """The body of a motion, as far as it can be told; None where it cannot.

    Args:
        up: which way is up.
        height: of the upright body in file units, from the lowest to the highest joint in its tallest frames.
        unit: the unit with which the body is nearest to a usual human.
    """

    up: UpGuess | None
    height: float | None
    unit: UnitGuess | None


def guess_body(motion: Motion) -> BodyGuess:
    """Looks at up to 200 frames from all over the recording; a T-pose in front of it is left out."""
    recorded = without_leading_tpose(motion)
    positions = recorded[:: max(1, recorded.frame_count // _SAMPLES)].positions()
    positions = positions[np.isfinite(positions).all(axis=(1, 2))]
    if not len(positions):
        return BodyGuess(None, None, None)
    skeleton = motion.skeleton.home or motion.skeleton
    roles = _roles(skeleton, positions)
    up = UpGuess(up_axis(positions, roles), sure=True) if roles else _up(skeleton.names, positions)
    if up is None:
        return BodyGuess(None, None, None)
    height = float(np.quantile(np.ptp(positions[..., "XYZ".index(up.axis[1])], axis=1), 0.9))
    leg = leg_length(skeleton, positions, roles) if roles else 0.0
    return BodyGuess(up, height, unit_of_legs(leg) if leg > 0 else _unit(height, "height"))


def unit_of_legs(leg: float) -> UnitGuess | None:
    """The unit with which legs of ``leg`` file units, hip to ankle, are nearest to a usual human's; None
    where they are a human's in none of :data:`GUESSED_UNITS`."""
    return _unit(leg * STATURE_PER_LEG, "legs")


def _roles(skeleton: Skeleton, positions: NDArray[Any]) -> Mapping[str, int] | None:
    """The joints of the body; by their names alone where it lies or crawls, which no evaluation takes."""
    try:
        return find_joints(skeleton, positions).roles
    except DatasetError:
        return named_roles(skeleton)


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


def _unit(stature: float, by: Literal["legs", "height"]) -> UnitGuess | None:
    """The unit with which ``stature`` is nearest to a human's."""
    fitting = [
        UnitGuess(name, UNITS[name], stature * UNITS[name], by)
        for name in GUESSED_UNITS
        if _SHORTEST <= stature * UNITS[name] <= _TALLEST
    ]
    return min(fitting, key=lambda guess: abs(math.log(guess.body_metres / _USUAL)), default=None)
