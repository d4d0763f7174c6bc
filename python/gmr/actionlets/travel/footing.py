"""A foot and the ground: where each stance has its footprint, and where the foot is in every frame of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.heel_rise import risen
from gmr.actionlets.travel.height import room
from gmr.actionlets.travel.leg import Leg, Placed, lengths
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.plan import Stance
from gmr.actionlets.travel.slopes import spread
from gmr.actionlets.travel.sole import Sole, pitch_of, yaw_of
from gmr.actionlets.travel.swinging import Air, in_air
from gmr.actionlets.travel.turns import about_y, about_z, bent, pitched, times, turned
from gmr.editing.easing import smooth_step

__all__ = ["Footing", "Standing", "footing", "with_footprints"]

Floats = NDArray[np.float64]

_LOADING = 0.12
"""Seconds within which a foot that lands takes the body over."""

_HANDED_ON = 0.95
"""Share of its load that a foot on its toes has handed on."""

_TURNED = np.radians(15.0)
_TURNED_MOST = np.radians(30.0)
"""Radians between foot and pelvis from which a foot that rests on its heel or toes pivots, and that it does
not exceed then."""


@dataclass(frozen=True, eq=False, slots=True)
class Footing:
    """A leg and all its stances, n frames together."""

    leg: Leg
    sole: Sole
    nominal: Placed
    """(F,) the nominal foot in the frame of the heading, from the pelvis."""
    hip: Floats
    """(F, 3) the hip, in the same way."""
    stances: tuple[Stance, ...]
    air: Air
    """Its frames in the air."""
    frames: NDArray[np.intp]
    """(n,) frames on the ground."""
    starts: NDArray[np.intp]
    """Where each stance begins among them."""
    over: Floats
    """(n,) share of the stance that is over; 1 where the foot did not land in this motion."""
    pitch: Floats
    """(n,) radians that the toes point up."""
    place: Floats
    """(n, 2) the footprint: x and z on the ground under the ankle of the flat foot."""
    yaw: Floats
    """(n,) the footprint's direction in radians, 0 along +Z, positive to the left."""

    def spread(self, values: Floats) -> Floats:
        """(n, ...) one value of each stance, in each of its frames."""
        return np.repeat(values, _counts(self.stances), axis=0)

    def edges(self) -> NDArray[np.intp]:
        """Which of the frames on the ground are among the first or last three of their stances."""
        counts = _counts(self.stances)
        since = spread(counts)
        until = np.repeat(counts, counts) - 1 - since
        return np.flatnonzero(np.minimum(since, until) < 3)

    def rolled(self) -> tuple[Floats, Floats]:
        """(n, 2) x and z from the footprint and (n,) height of the ankle of a foot that rolls, before its
        yaw."""
        point, ground = self.sole.contact(self.pitch)
        arm = turned(pitched(self.pitch), point)
        return ground - arm[:, ::2], -arm[:, 1]

    def standing(self, heading: Floats) -> Standing:
        """Where the leg ends in its stances, under (F,) headings."""
        on = self.frames
        hip, nominal = self.hip[on], self.nominal
        end, foot = self.planted(heading[on], self.pitch)
        return Standing(self, end, foot, lengths(nominal.ankle[on] - hip))

    def touched(self, pitch: Floats, rows: NDArray[np.intp] | slice = slice(None)) -> Floats:
        """(m, 3) where the sole touches the ground in the world, in some of the frames on the ground."""
        _, ground = self.sole.contact(pitch)
        touch = self.place[rows] + level(ground, self.yaw[rows])
        return np.array([touch[:, 0], np.zeros(len(touch)), touch[:, 1]]).T

    def planted(
        self,
        facing: Floats,
        pitch: Floats,
        roll: Floats | None = None,
        rows: NDArray[np.intp] | slice = slice(None),
    ) -> tuple[Floats, Floats]:
        """Where a foot has its ankle that stands on its footprint.

        Args:
            facing: (m,) heading.
            pitch: (m,) radians that the toes point up.
            roll: (m,) radians about the line from heel to toes; None: 0.
            rows: which of the frames on the ground these are.

        Returns:
            (m, 3) the ankle in the world and (m, 3, 3) the turn of the foot in the frame of the heading.
        """
        point, ground = self.sole.contact(pitch)
        yaw = self.yaw[rows] - facing
        foot = bent(about_y(yaw + _pivot(yaw, pitch)), -pitch)
        if roll is not None:
            foot = times(foot, about_z(roll))
        arm = turned(foot, point)
        end = -arm
        end[:, ::2] = self.place[rows] + level(ground, self.yaw[rows]) - level(arm[:, ::2], facing)
        return end, foot

    def loads(self, fps: float) -> Floats:
        """(n,) share of the body that the foot carries: smoothly taken over and handed on.

        A foot on its toes hands the body on: where it puts the ankle says little about the pelvis.
        """
        handed_on = _HANDED_ON * smooth_step(-self.pitch / np.radians(20.0))
        return _loads(self.stances, fps) * (1 - handed_on)

    def with_heels(self, root: Floats, heading: Floats) -> Footing:
        """The heels risen where a leg would be too short for a pelvis at (F, 3) ``root``."""
        if self.leg.rigid or not len(self.frames):
            return self
        hip = root[self.frames] + self.hip[self.frames]
        hip[:, ::2] = root[self.frames][:, ::2] + level(self.hip[self.frames][:, ::2], heading[self.frames])
        return replace(self, pitch=risen(self.leg, self.place, self.yaw, hip, self.pitch))


@dataclass(frozen=True, eq=False, slots=True)
class Standing:
    """Where the ankle of a leg is in its stances.

    Args:
        one: the leg, n frames on the ground.
        end: (n, 3) the ankle in the world.
        foot: (n, 3, 3) turn of the foot in the frame of the heading.
        length: (n,) nominal metres from the hip.
    """

    one: Footing
    end: Floats
    foot: Floats
    length: Floats

    def held(self, hip: Floats, bend: Floats) -> Floats:
        """(n,) height of the pelvis at which the leg keeps its nominal length.

        Args:
            hip: (n, 3) the hip: x and z in the world, its height from the pelvis.
            bend: (n,) radians of the knee at least.
        """
        return room(self.one.leg.law, hip, self.end, bend, self.length)

    def highest(self, hip: Floats, bend: Floats) -> Floats:
        """(n,) height that the leg allows the pelvis."""
        return room(self.one.leg.law, hip, self.end, bend)

    @property
    def stiff(self) -> Floats:
        """(n,) share by which the leg tells the height of the pelvis and does not give way: none."""
        return np.zeros(len(self.one.frames))

    def lowest(self, hip: Floats) -> Floats:
        """(n,) height below which the leg does not let the pelvis: -inf, for its knee bends."""
        return np.full(len(hip), -np.inf)


def footing(
    leg: Leg, sole: Sole, nominal: Placed, hip: Floats, stances: Sequence[Stance], fps: float
) -> Footing:
    """The stances of a leg, without footprints yet: they are all at the origin."""
    counts = _counts(stances)
    since = spread(counts)
    on = np.repeat(np.array([stance.first for stance in stances], np.intp), counts) + since
    pitch = sole.settled(pitch_of(nominal.foot[on]))
    starts = np.cumsum(counts) - counts
    lands = np.repeat(np.array([stance.lands for stance in stances], np.bool_), counts)
    over = np.where(lands, since / np.repeat(np.maximum(counts - 1, 1), counts), 1.0)
    place, yaw = np.zeros((len(on), 2)), np.zeros(len(on))
    air = in_air(stances, len(hip), fps)
    return Footing(leg, sole, nominal, hip, tuple(stances), air, on, starts, over, pitch, place, yaw)


def with_footprints(one: Footing, ground: Floats, heading: Floats) -> Footing:
    """The footprints that the nominal foot fits best, mostly in the middle of each stance.

    Each frame tells a footprint, from which a foot would have rolled to where it nominally is. The nominal
    foot of a body that changes its speed drifts over the ground, so the mean of them is taken, weighted by a
    raised cosine over the stance.

    Args:
        one: without footprints.
        ground: (F, 2) x and z of the pelvis.
        heading: (F,) radians.
    """
    if not one.stances:
        return one
    on = one.frames
    weights = _raised_cosines(_counts(one.stances))
    nominal_yaw = heading[on] + yaw_of(one.nominal.foot[on])
    yaw = one.spread(np.add.reduceat(weights * nominal_yaw, one.starts))
    forward, _ = one.rolled()
    places = ground[on] + level(one.nominal.ankle[on][:, ::2], heading[on]) - level(forward, yaw)
    place = one.spread(np.add.reduceat(weights[:, None] * places, one.starts, axis=0))
    return replace(one, place=place, yaw=yaw)


def _counts(stances: Sequence[Stance]) -> NDArray[np.intp]:
    """(g,) frames of each stance."""
    return np.array([stance.last - stance.first + 1 for stance in stances], np.intp)


def _raised_cosines(counts: NDArray[np.intp]) -> Floats:
    """(n,) weights that rise and fall over each of some stances and sum to 1 in it."""
    weights = 1 - np.cos(2 * np.pi * (spread(counts) + 1) / np.repeat(counts + 1, counts))
    sums = np.add.reduceat(weights, np.cumsum(counts) - counts)
    return np.asarray(weights / np.repeat(sums, counts), np.float64)


def _pivot(yaw: Floats, pitch: Floats) -> Floats:
    """(n,) radians that a foot turns on heel or toes, so that the leg is not twisted more than it can."""
    over = np.maximum(np.abs(yaw) - _TURNED, 0)
    kept = over * over / (over + _TURNED_MOST - _TURNED)
    return np.asarray(-np.sign(yaw) * kept * smooth_step(np.abs(pitch) / np.radians(10.0)), np.float64)


def _loads(stances: Sequence[Stance], fps: float) -> Floats:
    """(n,) share of the body that a foot takes over when it lands and hands on when it leaves."""
    counts = _counts(stances)
    since = spread(counts)
    until = np.repeat(counts, counts) - 1 - since
    ramps = np.repeat(np.maximum(np.minimum(_LOADING * fps, (counts - 1) / 2), 1.0), counts)
    lands, leaves = (
        np.repeat(np.array(ends, np.bool_), counts)
        for ends in ([stance.lands for stance in stances], [stance.leaves for stance in stances])
    )
    up, down = np.where(lands, since / ramps, 1.0), np.where(leaves, until / ramps, 1.0)
    return smooth_step(np.minimum(up, down)) + 1e-9
