"""Legs whose feet stand on their footprints and swing from one to the next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.footing import Footing, Standing
from gmr.actionlets.travel.leg import leg_angles, place_foot, rigid_leg_angles, unlocked
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.sole import yaw_of
from gmr.actionlets.travel.swinging import cleared, led_over
from gmr.actionlets.travel.turns import turned, turned_back

__all__ = ["stepped"]

Floats = NDArray[np.float64]

_LEG_TURNS = 0.8
"""Share of a foot's correction in yaw that the hip gives; the ankle gives the rest."""


def stepped(
    planned: Floats, pelvis: Floats, both: Sequence[Standing], root: Floats, heading: Floats, fps: float
) -> Floats:
    """(F, D) the planned angles with legs that keep their feet where they belong.

    On the ground the legs reach for their footprints. In the air the angles are corrected by what leads from
    the corrections before to those after, and by what keeps the foot over the ground.

    Args:
        planned: (F, D) radians.
        pelvis: (F, 3, 3) its turn in the frame of the heading.
        both: the legs with their footprints.
        root: (F, 3) the pelvis in the world.
        heading: (F,) radians.
        fps: frames a second.
    """
    found = planned.copy()
    for stood in both:
        one = stood.one
        columns = one.leg.columns
        plan = planned[:, columns]
        offsets = np.zeros_like(plan)
        on = one.frames
        if len(on):
            offsets[on] = _on_ground(stood, plan[on], pelvis[on], root[on], heading[on]) - plan[on]
        led_over(offsets, one.air, fps)
        found[:, columns] = plan + offsets
        if len(one.air.frames):
            _swing_clear(found, one, pelvis, root)
    return found


def _swing_clear(found: Floats, one: Footing, pelvis: Floats, root: Floats) -> None:
    """Bends the legs in the air so that no foot touches the ground and no knee locks."""
    leg, air = one.leg, one.air.frames
    angles = found[air]
    angles[:, leg.knee_column] = unlocked(angles[:, leg.knee_column])
    foot = place_foot(leg, angles)
    turn = pelvis[air]
    up = turn[:, 1]
    heel, toe = foot.ankle + turned(foot.foot, leg.heel), foot.ankle + turned(foot.foot, leg.toe)
    height = root[air, 1]
    lift = cleared((up * heel).sum(axis=1) + height, (up * toe).sum(axis=1) + height, one.air.rise)
    low = np.flatnonzero(lift > 0)
    if len(low):
        way = foot.ankle[low] + lift[low, None] * up[low]
        rotation = angles[low, leg.hip_columns[2]]
        wanted = None if leg.rigid else foot.foot[low]
        angles[low[:, None], leg.columns] = leg_angles(leg, way, rotation, wanted)
    found[air] = angles


def _on_ground(stood: Standing, planned: Floats, pelvis: Floats, root: Floats, heading: Floats) -> Floats:
    """(n, K) angles of a leg that stands on its footprints."""
    one = stood.one
    way = stood.end - root
    way[:, ::2] = level(way[:, ::2], -heading)
    way = turned_back(pelvis, way)
    if one.leg.rigid:
        yaw = one.yaw - heading - yaw_of(stood.foot)
        planned = planned + np.outer(one.leg.hip_signs[2] * yaw, [0, 0, 1, 0])
        return rigid_leg_angles(one.leg, way, stood.tip, planned)
    yaw = yaw_of(stood.foot) - yaw_of(one.nominal.foot[one.frames])
    rotation = planned[:, 2] + one.leg.hip_signs[2] * _LEG_TURNS * yaw
    return leg_angles(one.leg, way, rotation, pelvis.swapaxes(1, 2) @ stood.foot)
