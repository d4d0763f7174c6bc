"""The centre of mass, in the frame of the heading."""

from __future__ import annotations

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
    return _moment(body, angles, [name for name in _joints(body) if not name.endswith(_LEG)])


def legs_moment(body: Body, angles: Floats) -> Floats:
    """(F, 3) what the legs add to it."""
    return _moment(body, angles, [name for name in _joints(body) if name.endswith(_LEG)])


def _joints(body: Body) -> list[str]:
    skeleton = body.skeleton
    return [name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True) if not end]


def _moment(body: Body, angles: Floats, chosen: list[str]) -> Floats:
    """(F, 3) sum of share of mass times place of the chosen segments, which hang on the pelvis."""
    skeleton, names = body.skeleton, _joints(body)
    columns, axes, signs = turning(body.dofs, tuple(names))
    segments = {segment.joint: segment for segment in body.segments}
    signed = angles * signs
    places: dict[str, Floats] = {}
    frames: dict[str, Floats] = {}
    found = np.zeros((len(angles), 3))
    for name in ["pelvis", *(name for name in chosen if name != "pelvis")]:
        slot, joint = names.index(name), skeleton.names.index(name)
        parent = skeleton.parents[joint]
        turn = _turn(signed, columns[slot].tolist(), axes[slot].tolist())
        if parent < 0:
            places[name], frames[name] = np.zeros((len(angles), 3)), turn
        else:
            above = skeleton.names[parent]
            offset = np.asarray(skeleton.offsets[joint], np.float64)
            places[name] = places[above] + turned(frames[above], offset)
            frames[name] = frames[above] @ turn
        if name in chosen:
            segment = segments[name]
            found += segment.mass * (places[name] + turned(frames[name], np.array(segment.centre)))
    return found


def _turn(signed: Floats, columns: list[int], axes: list[int]) -> Floats:
    """(F, 3, 3) a joint's turns about its axes in their order."""
    still = np.zeros(len(signed))
    by = [signed[:, column] if column >= 0 else still for column in columns]
    if axes == [0, 2, 1]:
        return about_x(by[0]) if columns[1] < 0 and columns[2] < 0 else product(by[0], by[1], by[2])
    found = np.broadcast_to(np.eye(3), (len(signed), 3, 3))
    for axis, angle in zip(axes, by, strict=True):
        found = found @ product(*(angle if axis == which else still for which in (0, 2, 1)))
    return found
