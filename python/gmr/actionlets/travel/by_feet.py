"""Planted feet carry the root: where it is and heads, from where they stand and how the body stands on
them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.footing import Footing
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.plan import Stance
from gmr.actionlets.travel.sole import yaw_of

__all__ = ["carried_by_feet"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class _Stood:
    """What a stance tells about the root."""

    stance: Stance
    weights: Floats
    """(n,) by which it is heard."""
    at: Floats
    """(2,) the footprint."""
    yaw: float
    """Its direction."""
    heading: Floats
    """(n,) heading that it tells."""
    place: Floats
    """(n, 2) the ankle, from the footprint; before the footprint's yaw."""
    arm: Floats
    """(n, 2) the ankle from the pelvis, in the frame of the heading."""


def carried_by_feet(
    footings: Sequence[Footing], led: tuple[Floats, Floats], centre: Floats, fps: float
) -> tuple[Floats, Floats, list[Footing]]:
    """Root and heading of a body whose feet stand where they once were put down.

    A foot is put down where the nominal foot is at that moment. From then on it tells root and heading; two
    feet are heard by their loads. In flight the centre of mass goes on as speed and turn rate say.

    Args:
        footings: the legs, without footprints yet.
        led: (F, 2) places and (F,) headings to which speed and turn rate would lead.
        centre: (F, 2) the centre of mass from the pelvis, in the frame of the heading; looked at where
            flights begin and end.
        fps: frames a second.

    Returns:
        (F, 2) x and z of the pelvis, (F,) headings, and the legs with footprints.
    """
    path, course = led
    told: list[_Stood] = []
    rolls = [one.rolled()[0] for one in footings]
    loads = [one.loads(fps) for one in footings]
    every = sorted(
        (stance.first, leg, k) for leg, one in enumerate(footings) for k, stance in enumerate(one.stances)
    )
    for first, leg, k in every:
        heard = [one for one in told if one.stance.first < first <= one.stance.last]
        if heard:
            at, facing = _root(heard, first)
        elif told and min(one.stance.first for one in told) < first:
            off = max(one.stance.last for one in told if one.stance.first < first)
            at, facing = _root([one for one in told if one.stance.last == off], off)
            at, facing = _flown(at, facing, led, centre, off, first)
        else:
            at, facing = path[first], float(course[first])
        told.append(_put_down(footings[leg], k, rolls[leg], loads[leg], at, facing))
    ground, heading = _whole(told, path, course)
    found = []
    for leg, one in enumerate(footings):
        mine = [stood for (_, which, _), stood in zip(every, told, strict=True) if which == leg]
        place = one.spread(np.array([stood.at for stood in mine]).reshape(-1, 2))
        found.append(replace(one, place=place, yaw=one.spread(np.array([stood.yaw for stood in mine]))))
    return ground, heading, found


def _put_down(one: Footing, k: int, roll: Floats, loads: Floats, at: Floats, facing: float) -> _Stood:
    """A foot that is put down where it nominally is, under a pelvis at ``at`` that faces ``facing``."""
    stance = one.stances[k]
    start = int(one.starts[k])
    end = start + stance.last - stance.first + 1
    place = roll[start:end]
    yaws = yaw_of(one.nominal.foot[stance.frames])
    arm = one.nominal.ankle[stance.frames][:, ::2]
    yaw = facing + float(yaws[0])
    print_ = at + level(arm[0], facing) - level(place[0], yaw)
    return _Stood(stance, loads[start:end], print_, yaw, yaw - yaws, place, arm)


def _root(heard: Sequence[_Stood], frame: int) -> tuple[Floats, float]:
    """Where the pelvis is in a frame and which way it faces."""
    weights = np.array([one.weights[frame - one.stance.first] for one in heard])
    weights /= weights.sum()
    facing = float(
        sum(w * one.heading[frame - one.stance.first] for w, one in zip(weights, heard, strict=True))
    )
    at = np.zeros(2)
    for weight, one in zip(weights, heard, strict=True):
        k = frame - one.stance.first
        at += weight * _pelvis(one, slice(k, k + 1), np.array([facing]))[0]
    return at, facing


def _pelvis(one: _Stood, frames: slice, heading: Floats) -> Floats:
    """(n, 2) where the pelvis of a body is that faces ``heading`` and stands on that foot."""
    stood = one.at + level(one.place[frames], np.full(len(heading), one.yaw))
    return np.asarray(stood - level(one.arm[frames], heading), np.float64)


def _flown(
    at: Floats, facing: float, led: tuple[Floats, Floats], centre: Floats, off: int, down: int
) -> tuple[Floats, float]:
    """Where a pelvis comes down that went off, whose centre of mass went on as the path does."""
    path, course = led
    way = level(path[down] - path[off], facing - float(course[off]))
    facing_then = facing + float(course[down] - course[off])
    before, after = level(centre[off], facing), level(centre[down], facing_then)
    return at + before + way - after, facing_then


def _whole(told: Sequence[_Stood], path: Floats, course: Floats) -> tuple[Floats, Floats]:
    """(F, 2) and (F,) root and heading; linear in flight, as the path goes before and after all stances."""
    total, heading = np.zeros(len(path)), np.zeros(len(path))
    place = np.zeros_like(path)
    for one in told:
        total[one.stance.frames] += one.weights
        heading[one.stance.frames] += one.weights * one.heading
    on = np.flatnonzero(total > 0)
    heading = np.interp(np.arange(len(path)), on, heading[on] / total[on])
    for one in told:
        frames = one.stance.frames
        place[frames] += one.weights[:, None] * _pelvis(one, slice(None), heading[frames])
    place[on] /= total[on, None]
    for axis in (0, 1):
        place[:, axis] = np.interp(np.arange(len(path)), on, place[on, axis])
    first, last = int(on[0]), int(on[-1])
    for end, edge in ((slice(0, first), first), (slice(last + 1, None), last)):
        facing = heading[edge] - course[edge]
        place[end] = place[edge] + level(path[end] - path[edge], np.full(len(path[end]), facing))
        heading[end] = course[end] + facing
    return place, heading
