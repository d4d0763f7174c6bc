"""Legs whose feet stand on their footprints and swing from one to the next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.footing import Standing
from gmr.actionlets.travel.keeping import kept_in_range
from gmr.actionlets.travel.leg import Leg, leg_angles, placed, unlocked
from gmr.actionlets.travel.limits import squashed, unsquashed
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.rocking import Rocking
from gmr.actionlets.travel.sole import yaw_of
from gmr.actionlets.travel.swinging import cleared, led_over
from gmr.actionlets.travel.turns import dots, picked, seen_from, turned, turned_back

__all__ = ["stepped"]

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]

_HIP_ROTATION, _KNEE = 2, 3

_LEG_TURNS = 0.8
"""Share of a foot's correction in yaw that the hip gives; the ankle gives the rest."""


def stepped(
    planned: Floats,
    pelvis: Floats,
    both: Sequence[Standing | Rocking],
    root: Floats,
    heading: Floats,
    fps: float,
    wanted: NDArray[np.bool_] | None = None,
    lifts: int = 1,
) -> Floats:
    """(F, D) the planned angles with legs that keep their feet where they belong and their ranges of motion.

    On the ground the legs reach for their footprints. In the air the angles are corrected by what leads from
    the corrections before to those after, and by what keeps the foot over the ground. Both corrections are
    led over before angles are squashed into their ranges, so that angles and their speeds are continuous.

    Args:
        planned: (F, D) radians.
        pelvis: (F, 3, 3) its turn in the frame of the heading.
        both: the legs with their footprints.
        root: (F, 3) the pelvis in the world.
        heading: (F,) radians.
        fps: frames a second.
        wanted: (F,) the frames that are wanted; None: all. In others the legs are anyhow.
        lifts: how often feet in the air are lifted over the ground.
    """
    found = planned.copy()
    for stood in both:
        one = stood.one
        columns, limits = one.leg.columns, one.leg.limits
        plan = planned.T[columns].T
        legs, offsets = plan.copy(order="K"), np.zeros_like(plan)
        rows = np.arange(len(one.frames)) if wanted is None else one.edges()
        on = one.frames[rows]
        if len(on):
            above = picked(pelvis, on), root[on], heading[on]
            if isinstance(stood, Rocking):
                standing = stood.angles(rows, *above)
            else:
                standing = _on_ground(stood, rows, picked(plan, on), *above)
                standing = kept_in_range(one, rows, standing, *above)
            legs[on] = standing
            offsets[on] = unsquashed(standing, *limits) - picked(plan, on)
        if len(one.air.frames):
            led_over(offsets, one.air, fps)
            some: slice | NDArray[np.bool_] = slice(None) if wanted is None else wanted[one.air.frames]
            air = one.air.frames[some]
            free = picked(plan, air) + picked(offsets, air)
            for _ in range(lifts):
                swung = _swung(one.leg, free, one.air.rise[some], picked(pelvis, air), root[air])
            legs[air] = swung
        found[:, columns] = legs
    return found


def _swung(leg: Leg, free: Floats, rise: Floats, pelvis: Floats, root: Floats) -> Floats:
    """(m, K) angles of a leg in the air within their ranges: no foot touches the ground and no knee locks.

    Args:
        leg: the leg.
        free: (m, K) the angles before their ranges and the ground are looked at; what keeps the foot over
            the ground is added to them.
        rise: (m,) see :class:`Air`.
        pelvis, root: (m, 3, 3) and (m, 3) as for :func:`stepped`.
    """
    free[:, _KNEE] = unlocked(free[:, _KNEE])
    angles = squashed(free, *leg.limits)
    foot = placed(leg, angles)
    up = pelvis[:, 1]
    heel, toe = foot.ankle + turned(foot.foot, leg.heel), foot.ankle + turned(foot.foot, leg.toe)
    height = root[:, 1]
    lift = cleared(dots(up, heel) + height, dots(up, toe) + height, rise)
    low = np.flatnonzero(lift > 0)
    if len(low):
        way = foot.ankle[low] + lift[low, None] * up[low]
        foot_kept = None if leg.rigid else picked(foot.foot, low)
        more = leg_angles(leg, way, angles[low, _HIP_ROTATION], foot_kept) - picked(angles, low)
        free[low] += more
        angles[low] = squashed(free[low], *leg.limits)
    return angles


def _on_ground(
    stood: Standing, rows: Rows, planned: Floats, pelvis: Floats, root: Floats, heading: Floats
) -> Floats:
    """(m, K) angles of a leg that stands on its footprints, in some of its frames on the ground."""
    one, leg = stood.one, stood.one.leg
    foot = picked(stood.foot, rows)
    way = stood.end[rows] - root
    way[:, ::2] = level(way[:, ::2], -heading)
    way = turned_back(pelvis, way)
    yaw = yaw_of(foot) - yaw_of(picked(one.nominal.foot, one.frames[rows]))
    rotation = planned[:, _HIP_ROTATION] + leg.hip_signs[2] * _LEG_TURNS * yaw
    low, high = leg.limits
    rotation = squashed(rotation, low[_HIP_ROTATION], high[_HIP_ROTATION])
    return leg_angles(leg, way, rotation, seen_from(pelvis, foot))
