"""The centre of mass, in the frame of the heading."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.body import Body
from gmr.actionlets.posing import turning
from gmr.actionlets.travel.turns import about_x, product, turned

__all__ = ["legs_moment", "trunk_moment"]

Floats = NDArray[np.float64]

_LEG = ("hip", "knee", "ankle")


def trunk_moment(body: Body, angles: Floats) -> Floats:
    """(F, 3) what all but the legs adds to the centre of mass from the pelvis, in the frame of the heading.

    Args:
        body: D degrees of freedom; its segments have masses that sum to 1.
        angles: (F, D) radians.
    """
    return _moment(_hanging(body)[0], angles)


def legs_moment(body: Body, angles: Floats) -> Floats:
    """(F, 3) what the legs add to it."""
    return _moment(_hanging(body)[1], angles)


class _Hung(NamedTuple):
    """A joint and the segment that it turns.

    Args:
        above: the number of the joint above, among those that hang together; -1 for the pelvis.
        offset: (3,) from the joint above.
        columns: of the angles about each axis, -1: none.
        signs: (3,) -1 where an angle turns against its axis.
        axes: about which it turns, in order.
        centre: (3,) of the segment, from the joint.
        mass: share of the body's; 0 where it is counted elsewhere.
    """

    above: int
    offset: Floats
    columns: list[int]
    signs: list[float]
    axes: list[int]
    centre: Floats
    mass: float


@lru_cache(maxsize=32)
def _hanging(body: Body) -> tuple[list[_Hung], list[_Hung]]:
    """The trunk with head and arms, and the legs: what hangs on the pelvis, which is the first of both."""
    skeleton = body.skeleton
    names = [name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True) if not end]
    columns, axes, signs = turning(body.dofs, tuple(names))
    segments = {segment.joint: segment for segment in body.segments}

    def hung(own: list[str], counted: bool) -> list[_Hung]:
        found = []
        for name in own:
            slot, joint = names.index(name), skeleton.names.index(name)
            parent = skeleton.parents[joint]
            found.append(
                _Hung(
                    -1 if parent < 0 else own.index(skeleton.names[parent]),
                    np.asarray(skeleton.offsets[joint], np.float64),
                    columns[slot].tolist(),
                    signs[columns[slot]].tolist(),
                    axes[slot].tolist(),
                    np.array(segments[name].centre),
                    segments[name].mass if counted or name != "pelvis" else 0.0,
                )
            )
        return found

    legs = [name for name in names if name.endswith(_LEG)]
    return hung([name for name in names if name not in legs], True), hung(["pelvis", *legs], False)


def _moment(joints: list[_Hung], angles: Floats) -> Floats:
    """(F, 3) sum of share of mass times place of the segments."""
    places: list[Floats] = []
    frames: list[Floats] = []
    found = np.zeros((len(angles), 3))
    for joint in joints:
        turn = _turn(joint, angles)
        if joint.above < 0:
            places.append(np.zeros((len(angles), 3)))
            frames.append(turn)
        else:
            above = frames[joint.above]
            places.append(places[joint.above] + turned(above, joint.offset))
            frames.append(above @ turn)
        if joint.mass:
            found += joint.mass * (places[-1] + turned(frames[-1], joint.centre))
    return found


def _turn(joint: _Hung, angles: Floats) -> Floats:
    """(F, 3, 3) a joint's turns about its axes in their order."""
    still = np.zeros(len(angles))
    by = [
        sign * angles[:, column] if column >= 0 else still
        for column, sign in zip(joint.columns, joint.signs, strict=True)
    ]
    if joint.axes == [0, 2, 1]:
        is_hinge = joint.columns[1] < 0 and joint.columns[2] < 0
        return about_x(by[0]) if is_hinge else product(by[0], by[1], by[2])
    found = np.broadcast_to(np.eye(3), (len(angles), 3, 3))
    for axis, angle in zip(joint.axes, by, strict=True):
        found = found @ product(*(angle if axis == which else still for which in (0, 2, 1)))
    return found
