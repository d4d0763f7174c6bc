"""Legs whose feet stand on their footprints and swing from one to the next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.footing import Footing
from gmr.actionlets.travel.leg import leg_angles, place_foot, rigid_leg_angles, unlocked
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.sole import yaw_of
from gmr.actionlets.travel.swinging import cleared, gaps, led_over, risen_share
from gmr.actionlets.travel.turns import turned, turned_back

__all__ = ["stepped"]

Floats = NDArray[np.float64]

_LEG_TURNS = 0.8
"""Share of a foot's correction in yaw that the hip gives; the ankle gives the rest."""


def stepped(
    planned: Floats, pelvis: Floats, both: Sequence[Footing], root: Floats, heading: Floats, fps: float
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
    for one in both:
        columns = one.leg.columns
        plan = planned[:, columns]
        offsets = np.zeros_like(plan)
        on = one.frames
        if len(on):
            offsets[on] = _on_ground(one, plan[on], pelvis[on], root[on], heading) - plan[on]
        led_over(offsets, one.stances, fps)
        new = plan + offsets
        found[:, columns] = new
        _swing_clear(found, one, pelvis, root, fps)
    return found


def _swing_clear(found: Floats, one: Footing, pelvis: Floats, root: Floats, fps: float) -> None:
    """Bends the legs in the air so that no foot touches the ground and no knee locks."""
    leg = one.leg
    between = gaps(one.stances, len(found))
    if not between:
        return
    air = np.concatenate([np.arange(frames.start, frames.stop) for _, _, frames in between])
    shares = [risen_share(before, after, at.stop - at.start, fps) for before, after, at in between]
    rise = np.concatenate(shares)
    angles = found[air]
    angles[:, leg.knee_column] = unlocked(angles[:, leg.knee_column])
    foot = place_foot(leg, angles)
    turn = pelvis[air]
    up = turn[:, 1]
    heel, toe = foot.ankle + turned(foot.foot, leg.heel), foot.ankle + turned(foot.foot, leg.toe)
    height = root[air, 1]
    lift = cleared((up * heel).sum(axis=1) + height, (up * toe).sum(axis=1) + height, rise)
    low = np.flatnonzero(lift > 0)
    if len(low):
        way = foot.ankle[low] + lift[low, None] * up[low]
        rotation = angles[low, leg.hip_columns[2]]
        wanted = None if leg.rigid else foot.foot[low]
        angles[low[:, None], leg.columns] = leg_angles(leg, way, rotation, wanted)
    found[air] = angles


def _on_ground(one: Footing, planned: Floats, pelvis: Floats, root: Floats, heading: Floats) -> Floats:
    """(n, K) angles of a leg that stands on its footprints."""
    end, foot = one.stood(heading)
    way = end - root
    way[:, ::2] = level(way[:, ::2], -heading[one.frames])
    way = turned_back(pelvis, way)
    if one.leg.rigid:
        yaw = one.yaw - heading[one.frames] - yaw_of(foot)
        planned = planned + np.outer(one.leg.hip_signs[2] * yaw, [0, 0, 1, 0])
        return rigid_leg_angles(one.leg, way, one.end()[0], planned)
    yaw = yaw_of(foot) - yaw_of(one.nominal.foot[one.frames])
    rotation = planned[:, 2] + one.leg.hip_signs[2] * _LEG_TURNS * yaw
    return leg_angles(one.leg, way, rotation, pelvis.swapaxes(1, 2) @ foot)
