"""The path: where speed and turn rate lead."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["led", "level"]

Floats = NDArray[np.float64]


def led(speed: Floats, turn_rate: Floats, fps: float) -> tuple[Floats, Floats]:
    """Places and headings of something that goes forward where it heads.

    Between two frames it goes along an arc: the chord of one that turns by ``a`` is ``sin(a/2) / (a/2)`` of
    it long and points along its middle heading.

    Args:
        speed: (F,) metres a second.
        turn_rate: (F,) radians a second, to the left.
        fps: frames a second.

    Returns:
        (F, 2) x and z in metres from the origin, (F,) headings in radians from 0.
    """
    heading = _summed(turn_rate) / fps
    turn = np.diff(heading)
    middle = (heading[1:] + heading[:-1]) / 2
    chord = (speed[1:] + speed[:-1]) / (2 * fps) * np.sinc(turn / (2 * np.pi))
    place = np.zeros((len(speed), 2))
    place[1:, 0], place[1:, 1] = np.cumsum(chord * np.sin(middle)), np.cumsum(chord * np.cos(middle))
    return place, heading


def level(vectors: Floats, heading: Floats | float) -> Floats:
    """(F, 2) x and z of (F, 2) level vectors turned by (F,) headings; by minus the heading to turn back."""
    c, s = np.cos(heading), np.sin(heading)
    x, z = vectors[..., 0], vectors[..., 1]
    return np.asarray(np.array([x * c + z * s, z * c - x * s]).T, np.float64)


def _summed(rates: Floats) -> Floats:
    """Trapezoidal sums from 0."""
    found = np.zeros(len(rates))
    found[1:] = np.cumsum((rates[1:] + rates[:-1]) / 2)
    return found
