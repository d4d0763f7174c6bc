"""The heel rises where a leg that pushes off would else be too short."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.leg import Leg, leg_reach
from gmr.actionlets.travel.path import level
from gmr.editing.easing import smooth_step

__all__ = ["risen"]

Floats = NDArray[np.float64]

_KEPT = np.radians(12.0)
"""Bend of the knee, in radians, from which on the heel rises instead of the knee straightening."""

_SOFT = np.radians(5.0)
"""Radians over which the rise sets in."""

_MOST = np.radians(70.0)


def risen(leg: Leg, place: Floats, yaw: Floats, hip: Floats, pitch: Floats) -> Floats:
    """(n,) pitch of a foot whose heel rises as far as the leg needs to reach the ground.

    The ankle goes along a circle about the tip of the toes. With ``r`` its radius, ``p`` the distance from
    hip to toes in the plane of the foot, ``l`` beside it and ``d`` the length of the leg, the law of cosines
    tells where on the circle the leg is long enough: ``cos(a - h) = (p^2 + l^2 + r^2 - d^2) / 2 r p``, where
    ``a`` is how high the ankle stands over the toes and ``h`` the hip. Only a hip in front of its ankle
    raises the heel.

    Args:
        leg: the leg.
        place: (n, 2) the footprint, under the ankle of the flat foot.
        yaw: (n,) its direction.
        hip: (n, 3) the hip in the world.
        pitch: (n,) radians that the toes point up.
    """
    way = level(hip[:, ::2] - place, -yaw) - leg.toe[::2]
    up, ahead, aside = hip[:, 1], way[:, 1], way[:, 0]
    radius, low = np.hypot(leg.toe[1], leg.toe[2]), np.arctan2(-leg.toe[1], leg.toe[2])
    inner = np.hypot(up, ahead)
    cosine = (inner**2 + aside**2 + radius**2 - leg_reach(leg.law, _KEPT) ** 2) / (2 * radius * inner)
    needed = np.arctan2(up, -ahead) - np.arccos(np.clip(cosine, -1, 1)) - low
    x = np.clip(np.minimum(needed, _MOST) + pitch, -_SOFT, None)
    more = np.where(x < _SOFT, (x + _SOFT) ** 2 / (4 * _SOFT), x)
    passed = smooth_step((ahead + leg.toe[2]) / (leg.toe[2] / 2))
    return np.asarray(np.where(pitch > 0, pitch, pitch - passed * more), np.float64)
