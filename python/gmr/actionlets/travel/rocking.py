"""Legs with rigid ankles: shank and foot are one bone, which rocks over heel and toes.

Such a leg lies in one plane, with the line from heel to toes on the ground. In it, with ``p`` the pitch of
the foot, the knee moves along two arcs: about the heel while the toes point up, about the tip of the toes
while they point down. They meet at the flat foot, in a valley::

    K(p) = (z + r sin(a - p), r cos(a - p)),  z: heel or toes,  r, a: from there to the knee of the flat foot

On the knee stands the thigh, ``t`` long, under a hip at ``u`` along the line: ``v = K_v + sqrt(t^2 - (u -
K_u)^2)``. So where the path and the pitch are given, the height of the pelvis follows, and nothing slides.
The other way round, a height tells the pitch only while the knee is in front of the line from hip to contact:
bent by 24 degrees at least, once the heel is off the ground. A straighter leg can hardly be longer or
shorter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.footing import Footing
from gmr.actionlets.travel.leg import BENT, Leg, law, leg_reach
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.sole import pitch_of
from gmr.actionlets.travel.turns import about_y, about_z, angles_of, bent, seen_from, times
from gmr.editing.easing import smooth_step

__all__ = ["Rocking", "rocking"]

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]

_STRAIGHTEST = np.radians(2.0)
"""Bend of the knee that a foot's pitch leaves, in radians."""

_LANDS = 0.08
"""Metres behind the footprint up to which the knee of a leg that has landed reaches for the ground."""

_YIELDS, _YIELDING = np.radians(22.0), np.radians(12.0)
"""Radians of the planned knee from which on it gives way to the height of the pelvis, and over which."""

_FOLLOWS = np.radians(10.0)
"""How many more radians those of a knee are that follows from path and pitch, until it gives way."""

_DESCENT = 0.3
"""Metres that a hip may be higher for each one behind the place at which its foot becomes flat."""

_FREE = 0.05
"""Metres that the hip may be higher where the knee gives way by half."""

_SOFT, _GIVES = np.radians(2.0), 0.003
"""Radians of pitch and metres over which these limits set in."""

_LIES, _LYING = np.radians(50.0), np.radians(20.0)
"""Radians from upright from which on a planned thigh lies, and over which."""


@dataclass(frozen=True, eq=False)
class Rocking:
    """A leg with a rigid ankle in its n frames on the ground."""

    one: Footing
    pitch: Floats
    """(n,) of the foot, as planned and with a knee that stays bent."""
    yields: Floats
    """(n,) share by which the knee gives way to the height of the pelvis; else that follows from the foot."""
    deep: Floats
    """(n,) share by which the planned thigh lies; then the length of the leg tells the height."""
    length: Floats
    """(n,) of the planned leg, metres from where the foot touches the ground to the hip."""

    @property
    def stiff(self) -> Floats:
        """(n,) share by which the leg tells the height of the pelvis and does not give way."""
        return np.asarray(1 - self.yields, np.float64)

    def held(self, hip: Floats, _: Floats | None = None) -> Floats:
        """(n,) height of the pelvis at which the leg ends in a foot of its pitch.

        Args:
            hip: (n, 3) the hip: x and z in the world, its height from the pelvis.
            _: the bend that legs with ankles keep; these do not choose it.
        """
        ahead, aside = _seen(self.one, hip)
        leg = self.one.leg
        across = ahead - np.where(self.pitch < 0, leg.toe[2], leg.heel[2])
        deep = np.sqrt(np.maximum(self.length**2 - across**2, (self.length / 5) ** 2))
        up, _ = _over_knee(leg, self.pitch, ahead)
        return _upright(up + self.deep * (deep - up), aside) - hip[:, 1]

    def highest(self, hip: Floats, _: Floats | None = None) -> Floats:
        """(n,) height that the leg allows the pelvis where its knee is to give way to it; else inf."""
        leg = self.one.leg
        ahead, aside = _seen(self.one, hip)
        behind = np.maximum(_in_line(leg) - ahead, 0)
        flat = _over_knee(leg, np.zeros(1), np.full(1, _in_line(leg)))[0]
        most = np.minimum(_reach(leg, leg.heel, ahead), flat + _DESCENT * behind)
        most = np.where(behind > 0, most, _reach(leg, leg.toe, ahead))
        found = _upright(most, aside) - hip[:, 1] + _FREE * (1 / np.maximum(self.yields, 1e-9) - 1)
        return np.where(self.yields > 0, found, np.inf)

    def lowest(self, hip: Floats) -> Floats:
        """(n,) height below which the leg does not let the pelvis; -inf where its knee gives way."""
        found = self.held(hip) - _FREE * (1 / np.maximum(self.stiff, 1e-9) - 1)
        return np.where(self.stiff > 0, found, -np.inf)

    def angles(self, rows: Rows, pelvis: Floats, root: Floats, heading: Floats) -> Floats:
        """(m, 4) hip flexion, abduction, rotation and knee, in some of the frames on the ground.

        The foot is in its place on the ground or straight above it.

        Args:
            rows: (m,) which of the frames.
            pelvis: (m, 3, 3) its turn in the frame of the heading.
            root: (m, 3) the pelvis in the world.
            heading: (m,) radians.
        """
        one, leg = self.one, self.one.leg
        hip = root + one.hip[one.frames[rows]]
        hip[:, ::2] += level(one.hip[one.frames[rows]][:, ::2], heading) - one.hip[one.frames[rows]][:, ::2]
        ahead, aside = _seen(one, hip, rows)
        up = np.hypot(hip[:, 1], aside)
        pitch = self._given_way(rows, ahead, up)
        up, lean = _over_knee(leg, pitch, ahead, up)
        turn = _thigh(lean, aside, _upright(up, aside), one.yaw[rows] - heading)
        hips = np.stack(angles_of(seen_from(pelvis, turn)), axis=1) * leg.hip_signs
        return np.column_stack([hips, -leg.knee_sign * (pitch + lean)])

    def _given_way(self, rows: Rows, ahead: Floats, up: Floats) -> Floats:
        """(m,) pitch of feet under hips at (m,) places along their lines and over them."""
        leg, pitch, yields = self.one.leg, self.pitch[rows], self.yields[rows]
        heel, toe = (_pitch(leg, point, ahead, up) for point in (leg.heel, leg.toe))
        # A straight leg reaches for the ground where its hip is higher than the planned pitch has it: in
        # front of the body as far as it is long, behind it as far as hip, knee and toes are in line.
        lands = smooth_step(-ahead / _LANDS) * smooth_step(1 + pitch / _SOFT)
        straight = lands * np.maximum(heel - pitch, 0)
        behind = _pitch(leg, leg.toe, ahead, up, -1.0)
        straight += (1 - lands) * np.minimum(behind - pitch, 0)
        on_heel = (heel >= 0) & (ahead < _in_line(leg))
        given_way = np.where(on_heel, heel, np.minimum(toe, 0)) - pitch
        return np.asarray(pitch + (1 - yields) * straight + yields * given_way, np.float64)


def rocking(one: Footing, knee: Floats, flight: Floats, root: Floats, heading: Floats) -> Rocking:
    """A leg with a rigid ankle over its footprints.

    Args:
        one: with footprints.
        knee: (F,) the planned knee in radians.
        flight: (F,) how near a flight is, 0 to 1: there the knee gives way.
        root: (F, 3) the pelvis over the ground.
        heading: (F,) radians.
    """
    on = one.frames
    hip = one.hip[on]
    hip[:, ::2] = root[on][:, ::2] + level(hip[:, ::2], heading[on])
    ahead, _ = _seen(one, hip)
    pitch = _bent(one, ahead)
    follows = -(pitch + _over_knee(one.leg, pitch, ahead)[1])
    bent_by = np.maximum(knee[on], follows - _FOLLOWS)
    yields = np.maximum(smooth_step((bent_by - _YIELDS) / _YIELDING), flight[on])
    lean = -(pitch_of(one.nominal.foot[on]) + knee[on])
    length = _length(one.leg, pitch, lean)
    return Rocking(one, pitch, yields, yields * smooth_step((np.abs(lean) - _LIES) / _LYING), length)


def _length(leg: Leg, pitch: Floats, lean: Floats) -> Floats:
    """(n,) metres from the contact of a foot to a hip whose thigh leans forward by (n,) radians."""
    ahead, high = _knee(leg, pitch)
    thigh = _sizes(leg)[0]
    ahead = ahead + thigh * np.sin(lean) - np.where(pitch < 0, leg.toe[2], leg.heel[2])
    return np.asarray(np.hypot(ahead, high + thigh * np.cos(lean)), np.float64)


def _bent(one: Footing, ahead: Floats) -> Floats:
    """(n,) pitch of feet that leaves the knee bent, under hips that are so far ahead."""
    leg = one.leg
    thigh, _ = _sizes(leg)
    most = np.empty_like(ahead)
    front = ahead > -thigh * np.sin(_STRAIGHTEST)
    for point, there in ((leg.heel, ~front), (leg.toe, front)):
        radius, angle = _arc(leg, point)
        bend = _STRAIGHTEST + angle
        reach = np.sqrt(thigh**2 + radius**2 + 2 * thigh * radius * np.cos(bend))
        # The angle at the contact between the ways to hip and knee, by the law of sines.
        between = np.arcsin(thigh * np.sin(bend) / reach)
        over = np.arcsin(np.clip((ahead - point[2]) / reach, -1, 1))
        most = np.where(there, angle - over - between, most)
    nominal = pitch_of(one.nominal.foot[one.frames])
    return one.sole.settled(most - _above(most - nominal, _SOFT))


def _seen(one: Footing, hip: Floats, rows: Rows | slice = slice(None)) -> tuple[Floats, Floats]:
    """(m,) how far a hip is ahead of the footprint, along it, and to its left."""
    way = level(hip[:, ::2] - one.place[rows], -one.yaw[rows])
    return way[:, 1], way[:, 0]


def _sizes(leg: Leg) -> tuple[float, float]:
    """Length of the thigh, and height of the knee over a flat foot."""
    return -float(leg.thigh[1]), -float(leg.shank[1] + leg.heel[1])


def _arc(leg: Leg, point: Floats) -> tuple[float, float]:
    """Radius of the knee's way about a point of the sole, and radians by which the knee of the flat foot is
    ahead of it."""
    high = _sizes(leg)[1]
    return float(np.hypot(point[2], high)), float(np.arctan2(-point[2], high))


def _in_line(leg: Leg) -> float:
    """How far a hip is ahead of a flat foot whose toes, knee and hip are nearly in line."""
    return -_sizes(leg)[0] * float(np.sin(BENT - _arc(leg, leg.toe)[1]))


def _knee(leg: Leg, pitch: Floats) -> tuple[Floats, Floats]:
    """(n,) how far the knee is ahead of the footprint, and over the ground."""
    arcs = [(point[2], *_arc(leg, point)) for point in (leg.toe, leg.heel)]
    at, radius, angle = np.where(pitch[:, None] < 0, *arcs).T
    return at + radius * np.sin(angle - pitch), radius * np.cos(angle - pitch)


def _over_knee(leg: Leg, pitch: Floats, ahead: Floats, up: Floats | float = np.inf) -> tuple[Floats, Floats]:
    """(n,) height of a hip whose thigh stands on its knee, and radians by which the thigh leans forward.

    Args:
        pitch: (n,) of the foot.
        ahead: (n,) how far the hip is ahead of the footprint.
        up: (n,) its height; where that is below the knee, so is the hip.
    """
    knee, high = _knee(leg, pitch)
    thigh = _sizes(leg)[0]
    across = np.clip((ahead - knee) / thigh, -1, 1)
    along = np.sqrt(1 - across * across) * np.where(up < high, -1, 1)
    return high + thigh * along, np.arctan2(across, along)


def _reach(leg: Leg, point: Floats, ahead: Floats) -> Floats:
    """(n,) height of a hip over a point of the sole, with the leg as long as it may be there."""
    end = law(leg, point)
    bend = BENT + max(_arc(leg, point)[1], 0.0)
    most = leg_reach(end, bend)
    return np.asarray(np.sqrt(np.maximum(most**2 - (ahead - point[2]) ** 2, (most / 5) ** 2)), np.float64)


def _pitch(leg: Leg, point: Floats, ahead: Floats, up: Floats, side: float = 1.0) -> Floats:
    """(n,) pitch of a foot on its heel or toes, with the knee in front of the line from there to the hip, or
    behind it where ``side`` is -1."""
    reach = _reach(leg, point, ahead)
    radius, angle = _arc(leg, point)
    thigh = _sizes(leg)[0]
    high = reach - _above(reach - up, _GIVES)
    way = np.hypot(ahead - point[2], high)
    between = np.arccos(np.clip((radius**2 + way**2 - thigh**2) / (2 * radius * way), -1, 1))
    return np.asarray(angle - np.arctan2(ahead - point[2], high) - side * between, np.float64)


def _thigh(lean: Floats, aside: Floats, up: Floats, yaw: Floats) -> Floats:
    """(n, 3, 3) turn of a thigh in the frame of the heading.

    Args:
        lean: (n,) radians forward, in the plane of the leg.
        aside, up: (n,) the hip from the line of the footprint: to the left of it and over it.
        yaw: (n,) of the footprint from the heading.
    """
    return bent(times(about_y(yaw), about_z(-np.arctan2(aside, up))), lean)


def _upright(way: Floats, aside: Floats) -> Floats:
    """(n,) height of what is so far from a line on the ground, and so far beside it."""
    return np.asarray(np.sqrt(np.maximum(way**2 - aside**2, (way / 5) ** 2)), np.float64)


def _above(values: Floats, least: float) -> Floats:
    """(n,) values softly kept above ``least``, as they are from twice that on."""
    x = np.maximum(values, 0)
    return np.asarray(np.where(x < 2 * least, least + x * x / (4 * least), values), np.float64)
