"""Legs on the ground that stay within their ranges of motion while their feet stay where they stand.

A foot that would bend the ankle sideways by more than it can rolls over its edge, about the line from heel to
toes. One whose leg would go too far back, or bend the ankle too far up, raises its heel about the tip of the
toes. Angles are led to their limits as :mod:`gmr.actionlets.travel.limits` squashes them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.footing import Footing
from gmr.actionlets.travel.leg import leg_angles, placed, toe_leg_angles
from gmr.actionlets.travel.limits import MARGIN, near, squashed
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.sole import pitch_of
from gmr.actionlets.travel.turns import picked, seen_from, times, turned_back

__all__ = ["kept_in_range"]

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]

_HIP, _ROTATION, _ANKLE, _INVERSION = 0, 2, 4, 5
_ROLLS, _RISES = 2, 3
"""Steps in which a foot's roll and its pitch are found, to some hundredths of a degree."""

_SLOPES, _USUAL = (0.3, 4.0), 1.25
"""Radians that hip or ankle turn for each radian of the foot, as far as that is believed, and mostly."""
_MOST = np.radians(70.0)
"""Radians that a foot is turned, at most."""


def kept_in_range(
    one: Footing,
    frames: Rows,
    angles: Floats,
    pelvis: Floats,
    root: Floats,
    heading: Floats,
) -> Floats:
    """(n, 7) angles of a leg on the ground, led into its ranges of motion.

    Args:
        one: the leg.
        frames: (n,) which of its frames on the ground these are.
        angles: (n, 7) with which the foot stands on its footprints, see :func:`leg_angles`; the hip's
            rotation stays.
        pelvis: (n, 3, 3) its turn in the frame of the heading.
        root: (n, 3) the pelvis in the world.
        heading: (n,) radians.
    """
    low, high = one.leg.limits
    rows = np.flatnonzero(near(angles, low, high)[:, [_HIP, _ANKLE, _INVERSION]].any(axis=1))
    if not len(rows):
        return angles
    found = angles.copy()
    stood = _Stood(
        one, frames[rows], angles[rows, _ROTATION], picked(pelvis, rows), root[rows], heading[rows]
    )
    found[rows] = stood.led(angles[rows])
    return found


@dataclass(frozen=True, eq=False, slots=True)
class _Stood:
    """m frames of a leg on the ground."""

    one: Footing
    rows: Rows
    rotation: Floats
    pelvis: Floats
    root: Floats
    heading: Floats

    def led(self, angles: Floats) -> Floats:
        """(m, 7) the angles with hip extension, ankle flexion and inversion squashed."""
        low, high = self.one.leg.limits
        pitch, roll, found = self.one.pitch[self.rows], np.zeros(len(self.rows)), angles.copy()
        wanted = squashed(angles, low, high)
        sideways = np.flatnonzero(near(angles, low, high)[:, _INVERSION])
        if len(sideways):
            part = self._some(sideways)
            roll[sideways], found[sideways] = part._rolled(found[sideways], wanted[sideways, _INVERSION])
        back = np.flatnonzero(found[:, _HIP] < low[_HIP] + MARGIN)
        if len(back):
            part = self._some(back)
            pitch[back], found[back] = part._raised(roll[back], found[back], wanted[back, _HIP])
        bent = np.flatnonzero(near(found, low, high)[:, _ANKLE])
        if len(bent):
            ankle = found[bent, _ANKLE:]
            ankle[:, 0] = squashed(found[bent], low, high)[:, _ANKLE]
            found[bent] = self._some(bent)._bent(pitch[bent], ankle)
        return found

    def _angles(self, pitch: Floats, roll: Floats) -> Floats:
        """(m, 7) of a foot that stands with that pitch and roll."""
        end, foot = self.one.planted(self.heading, pitch, roll, self.rows)
        return leg_angles(self.one.leg, self._way(end), self.rotation, seen_from(self.pelvis, foot))

    def _hip(self, pitch: Floats, roll: Floats) -> Floats:
        """(m,) its hip's flexion alone."""
        end, _ = self.one.planted(self.heading, pitch, roll, self.rows)
        return leg_angles(self.one.leg, self._way(end), self.rotation, None)[:, _HIP]

    def _way(self, end: Floats) -> Floats:
        """(m, 3) a place in the world in the frame of the pelvis."""
        way = end - self.root
        way[:, ::2] = level(way[:, ::2], -self.heading)
        return turned_back(self.pelvis, way)

    def _rolled(self, found: Floats, wanted: Floats) -> tuple[Floats, Floats]:
        """Roll of feet with the wanted inversion, which it changes nearly radian for radian."""
        pitch, sign = self.one.pitch[self.rows], self.one.leg.ankle_signs[1]
        roll = sign * _secant(
            lambda rolled: self._angles(pitch, sign * rolled)[:, _INVERSION],
            wanted,
            found[:, _INVERSION],
            _ROLLS,
        )
        return roll, self._angles(pitch, roll)

    def _raised(self, roll: Floats, found: Floats, wanted: Floats) -> tuple[Floats, Floats]:
        """Pitch of feet with which the hips extend as wanted."""
        pitch = self.one.pitch[self.rows]
        rise = _secant(lambda raised: self._hip(pitch - raised, roll), wanted, found[:, _HIP], _RISES)
        return pitch - rise, self._angles(pitch - rise, roll)

    def _bent(self, pitch: Floats, ankle: Floats) -> Floats:
        """(m, 7) angles of legs whose ankles are bent as wanted: the foot takes the pitch that goes with it,
        about its heel while the toes point up, else about the tip of the toes."""
        found = self._about(pitch, ankle)
        over = np.flatnonzero((pitch > 0) & (self._pitch(found) < 0))
        if len(over):
            found[over] = self._some(over)._about(np.zeros(len(over)), ankle[over])
        return found

    def _about(self, pitch: Floats, ankle: Floats) -> Floats:
        """(m, 7) the same about the point on which a foot of that pitch stands."""
        leg = self.one.leg
        point = np.where(pitch[:, None] > 0, leg.heel, leg.toe)
        touch = self._way(self.one.touched(np.where(pitch > 0, pitch, -1e-9), self.rows))
        return toe_leg_angles(leg, touch, point, self.rotation, ankle)

    def _pitch(self, angles: Floats) -> Floats:
        """(m,) radians that the toes point up."""
        return pitch_of(times(self.pelvis, placed(self.one.leg, angles).foot))

    def _some(self, which: NDArray[np.intp]) -> _Stood:
        """Some of the frames."""
        return _Stood(
            self.one,
            self.rows[which],
            self.rotation[which],
            picked(self.pelvis, which),
            self.root[which],
            self.heading[which],
        )


def _secant(of: Callable[[Floats], Floats], wanted: Floats, at: Floats, steps: int) -> Floats:
    """(m,) numbers, 0 to 70 degrees or as far below 0, with which a function has the wanted values.

    Args:
        of: rises about as fast as its argument; ``steps - 1`` times it is asked.
        wanted: (m,)
        at: (m,) its values at 0.
    """
    x, lacks, slope = np.zeros(len(at)), wanted - at, np.full(len(at), _USUAL)
    for step in range(steps):
        further: Floats = np.minimum(np.maximum(x + lacks / slope, -_MOST), _MOST)
        if step + 1 == steps:
            return further
        left, way = wanted - of(further), further - x
        moved = np.abs(way) > 1e-9
        slope[moved] = np.clip((lacks - left)[moved] / way[moved], *_SLOPES)
        x, lacks = further, left
    return x
