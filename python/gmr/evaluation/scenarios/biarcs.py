"""Smooth paths of circular arcs through points: biarcs.

Between two points with given headings lie two arcs that meet in one direction; of all such pairs this is the
one whose tangents are equally long. On a circle both arcs are the circle's. Source: Bolton, "Biarc curves",
Computer-Aided Design 7 (1975). Headings are radians, 0 along +z, growing towards +x.
"""

from __future__ import annotations

import math
from typing import NamedTuple

__all__ = ["Arc", "Place", "biarc", "circle_heading", "wrapped"]

_SAME = 1e-12


class Place(NamedTuple):
    """A point on the ground in metres and a heading there."""

    x: float
    z: float
    heading: float

    def moved(self, arc: Arc, share: float = 1.0) -> Place:
        """The place at the end of an arc, or of a share of it."""
        half = arc.turn * share / 2
        chord = arc.length * share * (math.sin(half) / half if half else 1.0)
        way = self.heading + half
        return Place(self.x + chord * math.sin(way), self.z + chord * math.cos(way), self.heading + 2 * half)


class Arc(NamedTuple):
    """A piece of a circle: its length in metres and what the heading turns by, in radians."""

    length: float
    turn: float


def biarc(start: Place, end: Place) -> tuple[Arc, Arc]:
    """The two arcs from one place to another that is not in the same point."""
    x, z = _joint(start, end)
    first = _arc(start, x, z)
    return first, _arc(start.moved(first), end.x, end.z)


def _joint(start: Place, end: Place) -> tuple[float, float]:
    """Where the two arcs meet: half-way between the ends of tangents of length d."""
    vx, vz = end.x - start.x, end.z - start.z
    ax, az, bx, bz = *_direction(start.heading), *_direction(end.heading)
    apart = 2 * (1 - (ax * bx + az * bz))
    along = vx * (ax + bx) + vz * (az + bz)
    square = vx * vx + vz * vz
    if apart < _SAME:
        return (start.x + end.x) / 2, (start.z + end.z) / 2
    # The positive root, written so that nothing cancels.
    root = math.sqrt(along * along + apart * square)
    d = square / (along + root) if along >= 0 else (root - along) / apart
    return (start.x + end.x + d * (ax - bx)) / 2, (start.z + end.z + d * (az - bz)) / 2


def _arc(start: Place, x: float, z: float) -> Arc:
    """The arc that leaves a place and ends in a point."""
    half = wrapped(math.atan2(x - start.x, z - start.z) - start.heading)
    chord = math.hypot(x - start.x, z - start.z)
    return Arc(chord * (half / math.sin(half) if half else 1.0), 2 * half)


def circle_heading(
    before: tuple[float, float], here: tuple[float, float], after: tuple[float, float], at: int = 0
) -> float:
    """The heading of the circle through three points: at the first (-1), the middle (0) or the last (1)."""
    first, second = _chord(before, here), _chord(here, after)
    bend = wrapped(second[1] - first[1])
    half = math.atan2(first[0] * math.sin(bend), second[0] + first[0] * math.cos(bend))
    return (first[1] - half, first[1] + half, second[1] + bend - half)[at + 1]


def _chord(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    x, z = other[0] - one[0], other[1] - one[1]
    return math.hypot(x, z), math.atan2(x, z)


def _direction(heading: float) -> tuple[float, float]:
    return math.sin(heading), math.cos(heading)


def wrapped(angle: float) -> float:
    """The same angle between -pi and pi."""
    return angle - 2 * math.pi * round(angle / (2 * math.pi))
