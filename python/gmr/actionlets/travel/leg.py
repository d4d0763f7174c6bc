"""A leg: where its angles put the foot, and which angles put the foot where it is wanted.

Both in closed form. The hip turns by flexion, abduction and rotation, the knee is a hinge. Of the four angles
the rotation is chosen; the knee follows from the distance of hip and ankle by the law of cosines, abduction
and flexion from the direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.turns import angles_of, bent, dots, product, seen_from, times, turned

__all__ = [
    "BENT",
    "Law",
    "Leg",
    "Placed",
    "law",
    "leg_angles",
    "leg_reach",
    "lengths",
    "place_foot",
    "placed",
    "toe_leg_angles",
    "unlocked",
]

Floats = NDArray[np.float64]

BENT = np.radians(3.0)
"""Bend of the knee, in radians, below which the ground is not asked of a leg: nearer to straight, a
millimetre turns the knee by ten degrees."""

_IN_AIR = np.radians(1.5)
"""The same of a leg in the air."""

_STRAIGHTEST = np.radians(0.35)
"""Bend of the knee that a leg comes near to, where it is asked to be longer than it is."""


@dataclass(frozen=True, eq=False)
class Leg:
    """One leg of a body, in metres, as far as travelling needs it."""

    side: str
    """"left" or "right"."""
    hip: Floats
    """(3,) the hip from the pelvis, at rest."""
    thigh: Floats
    """(3,) the knee from the hip, at rest."""
    shank: Floats
    """(3,) the ankle from the knee, at rest."""
    heel: Floats
    """(3,) lowest point of the heel from the ankle, at rest."""
    toe: Floats
    """(3,) tip of the toes from the ankle, at rest, as low as the heel."""
    hip_columns: tuple[int, int, int]
    """Columns of hip flexion, abduction and rotation in the table of angles."""
    hip_signs: Floats
    """(3,) -1 where the angle turns against X, Z or Y."""
    knee_column: int
    knee_sign: float
    ankle_columns: tuple[int, int, int] | None
    """Columns of ankle flexion, inversion and rotation; None for a rigid ankle."""
    ankle_signs: Floats
    limits: tuple[Floats, Floats]
    """(K,) lowest and highest angles of ``columns``; infinite with a rigid ankle."""

    @property
    def rigid(self) -> bool:
        """Whether the ankle does not move."""
        return self.ankle_columns is None

    @property
    def columns(self) -> list[int]:
        """Columns of hip flexion, abduction, rotation, knee and ankle flexion, inversion, rotation."""
        return [*self.hip_columns, self.knee_column, *(self.ankle_columns or ())]

    @cached_property
    def law(self) -> Law:
        """Of hip, knee and ankle."""
        return law(self, np.zeros(3))


class Law(NamedTuple):
    """Law of cosines across a hinge: the square of the distance of hip and end is ``fixed + swing
    cos(bend)``."""

    fixed: Floats
    """(...,) square metres."""
    swing: Floats
    """(...,) square metres."""
    straight: Floats
    """(...,) radians about X from the knee at rest to the knee that is bent by 0: hip, knee and end in
    line."""


def law(leg: Leg, tip: Floats) -> Law:
    """The law of cosines of a leg that ends in (..., 3) a point of a foot that goes with the shank, given
    from the ankle at rest."""
    tx, ty, tz = leg.thigh.tolist()
    sx, sy, sz = (leg.shank + tip).T
    p, q = ty * sy + tz * sz, tz * sy - ty * sz
    squares = tx * tx + ty * ty + tz * tz + sx * sx + sy * sy + sz * sz
    return Law(squares + 2 * tx * sx, 2 * np.hypot(p, q), np.arctan2(q, p))


@dataclass(frozen=True, eq=False, slots=True)
class Placed:
    """A foot in the frame of the pelvis or of the heading."""

    ankle: Floats
    """(F, 3)"""
    foot: Floats
    """(F, 3, 3)"""


def place_foot(leg: Leg, angles: Floats) -> Placed:
    """Where (F, D) angles put the foot, in the frame of the pelvis."""
    return placed(leg, angles[:, leg.columns])


def placed(leg: Leg, angles: Floats) -> Placed:
    """Where (F, K) angles of ``leg.columns`` put the foot, in the frame of the pelvis."""
    flexion, abduction, rotation = angles[:, :3].T * leg.hip_signs[:, None]
    hip = product(flexion, abduction, rotation)
    lower = bent(hip, leg.knee_sign * angles[:, 3])
    ankle = leg.hip + turned(hip, leg.thigh) + turned(lower, leg.shank)
    if leg.ankle_columns is None:
        return Placed(ankle, lower)
    x, z, y = angles[:, 4:].T * leg.ankle_signs[:, None]
    return Placed(ankle, times(lower, product(x, z, y)))


def leg_reach(law: Law, bend: Floats | float) -> Floats:
    """Distance of hip and end, in metres, with the knee ``bend`` radians from straight."""
    return np.asarray(np.sqrt(law.fixed + law.swing * np.cos(bend)), np.float64)


def leg_angles(leg: Leg, ankle: Floats, rotation: Floats, foot: Floats | None) -> Floats:
    """Angles that bring the ankle to a place, with a chosen rotation of the hip.

    Args:
        leg: the leg.
        ankle: (F, 3) in the frame of the pelvis. Where it is too far, the leg nearly straightens towards it.
        rotation: (F,) the hip's rotation in radians.
        foot: (F, 3, 3) wanted turn of the foot in the frame of the pelvis; None for a rigid ankle, or where
            the ankle is not asked for.

    Returns:
        (F, 7) hip flexion, abduction, rotation, knee, ankle flexion, inversion, rotation; (F, 4) without
        foot.
    """
    way = ankle - leg.hip
    hinge = leg.knee_sign * leg.law.straight + _bend(leg.law, lengths(way))
    found = _hip_angles(leg, way, hinge, rotation, np.zeros(3))
    if foot is None:
        return found
    lower = bent(product(*(found[:, :3] * leg.hip_signs).T), leg.knee_sign * hinge)
    ankles = np.array(angles_of(seen_from(lower, foot))) * leg.ankle_signs[:, None]
    return np.concatenate([found.T, ankles]).T


def toe_leg_angles(leg: Leg, touch: Floats, point: Floats, rotation: Floats, ankle: Floats) -> Floats:
    """Angles that bring a point of the foot to a place, with chosen angles of the ankle.

    Shank and foot are one bone then, so the knee follows from the distance of the hip and that point.

    Args:
        leg: the leg.
        touch: (n, 3) where the point is wanted, in the frame of the pelvis.
        point: (n, 3) the point from the ankle, in the frame of the foot.
        rotation: (n,) the hip's rotation in radians.
        ankle: (n, 3) ankle flexion, inversion and rotation in radians.

    Returns:
        (n, 7) as :func:`leg_angles`.
    """
    x, z, y = (ankle * leg.ankle_signs).T
    tip = turned(product(x, z, y), point)
    end = law(leg, tip)
    way = touch - leg.hip
    hinge = leg.knee_sign * end.straight + _bend(end, lengths(way))
    return np.concatenate([_hip_angles(leg, way, hinge, rotation, tip).T, ankle.T]).T


def unlocked(knee: Floats) -> Floats:
    """(n,) bend of the knee in radians, softly kept above 1.5 degrees: ``k`` from 3 degrees on."""
    x = np.maximum(knee, 0)
    return np.asarray(np.where(x < 2 * _IN_AIR, _IN_AIR + x * x / (4 * _IN_AIR), knee), np.float64)


def lengths(vectors: Floats) -> Floats:
    """(n,) lengths of (n, 3) vectors."""
    return np.asarray(np.sqrt(dots(vectors, vectors)), np.float64)


def _hip_angles(leg: Leg, way: Floats, hinge: Floats, rotation: Floats, tip: Floats) -> Floats:
    """(n, 4) hip and knee whose leg's end lies in the direction of (n, 3) ways."""
    turn = leg.knee_sign * hinge
    c, s = np.cos(turn), np.sin(turn)
    sx, sy, sz = (leg.shank + tip).T
    x = leg.thigh[0] + sx
    y = leg.thigh[1] + sy * c - sz * s
    z = leg.thigh[2] + sy * s + sz * c

    # (x, y, z) is the end from the hip before the hip turns: Ry, then Rz, then Rx bring it to ``way``.
    ry = leg.hip_signs[2] * rotation
    c, s = np.cos(ry), np.sin(ry)
    x, z = x * c + z * s, z * c - x * s
    upright = np.hypot(x, y)
    aside = np.minimum(np.maximum(way[:, 0] / upright, -1), 1)
    rz = -np.arccos(aside) - np.arctan2(y, x)
    y = -upright * np.sqrt(1 - aside * aside)
    # The angle from (y, z) to the way.
    rx = np.arctan2(y * way[:, 2] - z * way[:, 1], y * way[:, 1] + z * way[:, 2])
    return np.array([leg.hip_signs[0] * rx, leg.hip_signs[1] * rz, rotation, hinge]).T


def _bend(law: Law, distance: Floats) -> Floats:
    """(F,) radians of the knee from straight by the law of cosines, softly kept from straightening."""
    near, end = leg_reach(law, _IN_AIR), leg_reach(law, _STRAIGHTEST)
    over = np.maximum(distance - near, 0) / (end - near)
    soft = np.where(over > 0, end - (end - near) * np.exp(-over), distance)
    return np.asarray(
        np.arccos(np.minimum(np.maximum((soft * soft - law.fixed) / law.swing, -1), 1)), np.float64
    )
