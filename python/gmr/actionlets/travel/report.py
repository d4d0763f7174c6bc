"""What a body that travels was asked for and what it does, measured on the finished angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.flight import GRAVITY, flights
from gmr.actionlets.travel.leg import place_foot
from gmr.actionlets.travel.legs import legs_of, pelvis_shift, pelvis_turn, sole_of
from gmr.actionlets.travel.mass import mass_from_pelvis
from gmr.actionlets.travel.path import level
from gmr.actionlets.travel.plan import SIDES, Planned, Stance, asked, stances
from gmr.actionlets.travel.sole import pitch_of, yaw_of
from gmr.actionlets.travel.turns import pitched, times, turned

if TYPE_CHECKING:
    from gmr.actionlets.body import Body

__all__ = ["FlightFound", "Report", "StanceFound", "measured"]

Floats = NDArray[np.float64]


_LIFTED = 1.0
"""Millimetres above its place from which on it is said of a foot."""


@dataclass(frozen=True, slots=True)
class StanceFound:
    """A foot on the ground.

    Args:
        side: "left" or "right".
        begin: seconds.
        end: seconds.
        slide_mm: way that the lower of heel and toes goes along the ground.
        pivot_deg: degrees that the foot turns about the vertical.
        lifted_mm: height of the lower of heel and toes over the ground, at most: with rigid ankles a foot may
            land late, straight above its place, and leave early.
    """

    side: str
    begin: float
    end: float
    slide_mm: float
    pivot_deg: float
    lifted_mm: float


@dataclass(frozen=True, slots=True)
class FlightFound:
    """No foot on the ground.

    Args:
        begin: seconds, when the last foot leaves.
        end: seconds, when the first foot lands.
        off_mm: how far the centre of mass is from the parabola through its ends, at most.
    """

    begin: float
    end: float
    off_mm: float


@dataclass(frozen=True, eq=False)
class Report:
    """What was asked and what came of it.

    Args:
        speed_asked: mean, m/s.
        speed: mean of the root's speed forward, m/s.
        feet_speed: mean speed at which the planned feet pass below the pelvis while they are on the ground,
            m/s; where it is not the speed asked, legs are corrected.
        turn_rate_asked_deg: mean, degrees a second to the left.
        turn_rate_deg: of the heading.
        stances: in time.
        flights: in time.
        lowest_mm: lowest point of heels and toes over the ground.
        corrections_deg: largest change of each planned degree of freedom that changed, degrees.
        beyond_deg: how far degrees of freedom leave their range of motion, degrees; only those that do.
    """

    speed_asked: float
    speed: float
    feet_speed: float
    turn_rate_asked_deg: float
    turn_rate_deg: float
    stances: tuple[StanceFound, ...]
    flights: tuple[FlightFound, ...]
    lowest_mm: float
    corrections_deg: Mapping[str, float]
    beyond_deg: Mapping[str, float]

    @property
    def slide_mm(self) -> float:
        """The longest slide of all stances."""
        return max((stance.slide_mm for stance in self.stances), default=0.0)

    @property
    def lifted_mm(self) -> float:
        """How far a foot is over the ground in a stance, at most."""
        return max((stance.lifted_mm for stance in self.stances), default=0.0)

    @property
    def off_mm(self) -> float:
        """The largest distance of the centre of mass from its parabolas."""
        return max((flight.off_mm for flight in self.flights), default=0.0)

    def __str__(self) -> str:
        pivot = max((stance.pivot_deg for stance in self.stances), default=0.0)
        lines = [
            f"speed {self.speed:.3f} m/s, asked {self.speed_asked:.3f}, of the planned feet "
            f"{self.feet_speed:.3f}; turn rate {self.turn_rate_deg:.1f} degrees a second, "
            f"asked {self.turn_rate_asked_deg:.1f}",
            f"{len(self.stances)} stances slide {self.slide_mm:.2f} mm at most and pivot {pivot:.1f} degrees "
            f"at most; lowest point of the feet {self.lowest_mm:.2f} mm",
            f"{len(self.flights)} flights leave the parabola by {self.off_mm:.2f} mm at most",
        ]
        if self.lifted_mm > _LIFTED:
            lines.insert(2, f"in a stance a foot is {self.lifted_mm:.0f} mm above its place at most")
        for what, found in (("corrected by", self.corrections_deg), ("beyond its range by", self.beyond_deg)):
            worst = sorted(found.items(), key=lambda item: -item[1])[:6]
            lines += (
                [f"{what}: " + ", ".join(f"{name} {value:.1f}" for name, value in worst)] if worst else []
            )
        return "\n".join(lines)


def measured(
    body: Body,
    planned: Floats,
    angles: Floats,
    root: Floats,
    heading: Floats,
    plan: Planned,
    fps: float,
    start: float,
) -> Report:
    """The report of a body that travels.

    Args:
        body: D degrees of freedom.
        planned: (F, D) planned angles.
        angles: (F, D) corrected angles.
        root: (F, 3) metres, without sway, heave and surge.
        heading: (F,) radians.
        plan: what was asked.
        fps: frames a second.
        start: seconds at the first frame.
    """
    count = len(angles)
    times = start + np.arange(count) / fps
    shift = pelvis_shift(body, angles)
    pelvis = root + _in_world(shift, heading)
    heels, toes, yaws = _feet(body, angles, pelvis, heading)
    every = stances(plan, count, fps, start)
    on_ground = np.zeros(count, bool)
    found = []
    for stance in every:
        at = stance.frames
        on_ground[at] = True
        yaw = np.unwrap(yaws[stance.leg][at])
        found.append(
            StanceFound(
                SIDES[stance.leg],
                times[stance.first],
                times[stance.last],
                1000 * _slide(heels[stance.leg][at], toes[stance.leg][at], yaw),
                float(np.degrees(np.ptp(yaw))),
                1000 * float(np.minimum(heels[stance.leg][at][:, 1], toes[stance.leg][at][:, 1]).max()),
            )
        )
    span = max(count - 1, 1) / fps
    forward = np.stack([np.sin(heading), np.cos(heading)], axis=1)
    ways = ((root[1:] - root[:-1])[:, ::2] * (forward[1:] + forward[:-1]) / 2).sum()
    changed = np.degrees(np.abs(angles - planned).max(axis=0))
    beyond = np.degrees(np.maximum(body.low - angles, angles - body.high).max(axis=0))
    return Report(
        float(asked(plan.speed, times, "speed").mean()),
        float(ways / span),
        _feet_speed(body, planned, every, fps),
        float(np.degrees(asked(plan.turn_rate, times, "turn_rate").mean())),
        float(np.degrees(heading[-1] - heading[0]) / span),
        tuple(found),
        _flights(body, angles, pelvis, heading, on_ground, times, fps) if on_ground.any() else (),
        1000 * float(min(points[..., 1].min() for points in (*heels, *toes))),
        {name: float(c) for name, c in zip(body.names, changed, strict=True) if c > 0.05},
        {name: float(b) for name, b in zip(body.names, beyond, strict=True) if b > 0.05},
    )


def _feet(
    body: Body, angles: Floats, pelvis: Floats, heading: Floats
) -> tuple[list[Floats], list[Floats], list[Floats]]:
    """(F, 3) heel and toes in the world and (F,) yaw of each foot."""
    turn = pelvis_turn(body, angles)
    heels: list[Floats] = []
    toes: list[Floats] = []
    yaws: list[Floats] = []
    for leg in legs_of(body):
        foot = place_foot(leg, angles)
        for point, found in ((leg.heel, heels), (leg.toe, toes)):
            found.append(pelvis + _in_world(turned(turn, foot.ankle + turned(foot.foot, point)), heading))
        yaws.append(heading + yaw_of(times(turn, foot.foot)))
    return heels, toes, yaws


def _feet_speed(body: Body, planned: Floats, every: Sequence[Stance], fps: float) -> float:
    """Mean speed backwards, from the pelvis, of the footprints on which the planned feet would roll, in the
    middle half of each stance."""
    turn, legs = pelvis_turn(body, planned), legs_of(body)
    soles = [sole_of(leg) for leg in legs]
    feet = [place_foot(leg, planned) for leg in legs]
    way, steps = 0.0, 0
    for stance in every:
        foot, at = feet[stance.leg], stance.frames
        pitch = soles[stance.leg].settled(pitch_of(times(turn[at], foot.foot[at])))
        point, ground = soles[stance.leg].contact(pitch)
        rolled = ground[:, 1] - turned(pitched(pitch), point)[:, 2]
        place = turned(turn[at], foot.ankle[at])[:, 2] - rolled
        quarter = len(place) // 4
        way += float(place[quarter] - place[-1 - quarter])
        steps += len(place) - 1 - 2 * quarter
    return way * fps / steps if steps else 0.0


def _slide(heel: Floats, toe: Floats, yaw: Floats) -> float:
    """Metres that the lower of heel and toes goes along the ground; that of a flat foot which goes less.

    Where contact passes from the one to the other between two frames, as it does without sliding when a foot
    rolls fast, the places of both on the ground are a foot's length apart.
    """
    ways = [np.linalg.norm(np.diff(point[:, ::2], axis=0), axis=1) for point in (heel, toe)]
    least = np.minimum(*ways)
    lower = (heel[1:, 1] + heel[:-1, 1]) - (toe[1:, 1] + toe[:-1, 1])
    way = np.where(np.abs(lower) < 1e-9, least, np.where(lower < 0, ways[0], ways[1]))
    on_heel = heel[:, 1] < toe[:, 1]
    facing, size = (yaw[1:] + yaw[:-1]) / 2, np.linalg.norm(toe[0] - heel[0])
    foot = size * np.stack([np.sin(facing), np.cos(facing)], axis=1)
    for passes, one, other, sign in (
        (on_heel[:-1] & ~on_heel[1:], heel, toe, 1),
        (~on_heel[:-1] & on_heel[1:], toe, heel, -1),
    ):
        apart = (other[1:] - one[:-1])[:, ::2] - sign * foot
        way = np.where(passes, np.minimum(least, np.linalg.norm(apart, axis=1)), way)
    return float(way.sum())


def _flights(
    body: Body,
    angles: Floats,
    pelvis: Floats,
    heading: Floats,
    on_ground: NDArray[np.bool_],
    times: Floats,
    fps: float,
) -> tuple[FlightFound, ...]:
    air = flights(on_ground)
    found = []
    for off, down in zip(air.off.tolist(), air.down.tolist(), strict=True):
        at = slice(off, down + 1)
        centre = mass_from_pelvis(body, angles[at])
        path = pelvis[at] + _in_world(centre, heading[at])
        time = times[at] - times[off]
        fall = path + np.outer(GRAVITY / 2 * time**2, [0.0, 1.0, 0.0])
        straight = fall[0] + (time / time[-1])[:, None] * (fall[-1] - fall[0])
        most = float(np.linalg.norm(fall - straight, axis=1).max())
        found.append(FlightFound(float(times[off]), float(times[down]), 1000 * most))
    return tuple(found)


def _in_world(vectors: Floats, heading: Floats) -> Floats:
    found = np.array(vectors)
    found[:, ::2] = level(found[:, ::2], heading)
    return found
