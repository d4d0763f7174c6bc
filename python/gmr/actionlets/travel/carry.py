"""From planned angles and contacts to a body that travels: feet that stand still, hips that follow the
path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.travel.by_feet import carried_by_feet
from gmr.actionlets.travel.by_turns import carried_by_turns
from gmr.actionlets.travel.flight import Flights, falling, flights, flying_soon, taken_up
from gmr.actionlets.travel.footing import Footing, Standing, footing, with_footprints
from gmr.actionlets.travel.height import carried_stiffly, held_up, kept_bend, lowered, passing
from gmr.actionlets.travel.leg import Placed, place_foot
from gmr.actionlets.travel.legs import legs_of, pelvis_shift, pelvis_turn, sole_of
from gmr.actionlets.travel.mass import mass_from_pelvis
from gmr.actionlets.travel.path import led, level
from gmr.actionlets.travel.plan import Planned, asked, kinds, stances
from gmr.actionlets.travel.report import Report, measured
from gmr.actionlets.travel.rocking import Rocking, rocking
from gmr.actionlets.travel.stepping import stepped
from gmr.actionlets.travel.turns import dots, times, turned
from gmr.editing.easing import smooth_above
from gmr.errors import ActionletError

if TYPE_CHECKING:
    from gmr.actionlets.body import Body

__all__ = ["Carried", "carried"]

Floats = NDArray[np.float64]

_Stood: TypeAlias = Standing | Rocking

_ROUNDS = 2
"""How often flights are made ballistic anew with the legs that follow from the round before."""

_LIFTS = 3
"""How often a rigid foot of a body that flies is lifted over the ground, for its toes sink while its knee
bends."""

_RISES, _STEADIES = 0.10, 0.16
"""Seconds before and after a rigid foot would sink within which the body rises, and those in which it rises
over a leg that stands stiffly."""


@dataclass(frozen=True, eq=False)
class Carried:
    """A body that travels; :func:`gmr.actionlets.posing.motion` makes a motion of it.

    Args:
        body: D degrees of freedom.
        angles: (F, D) radians and metres: the planned ones with corrected legs.
        root: (F, 3) metres: the pelvis without sway, heave and surge, which are in the angles.
        heading: (F,) radians, positive to the left.
        fps: frames a second.
        start: seconds at the first frame.
        planned: (F, D) the planned angles.
        plan: what was asked.
    """

    body: Body
    angles: Floats
    root: Floats
    heading: Floats
    fps: float
    start: float
    planned: Floats
    plan: Planned

    @cached_property
    def report(self) -> Report:
        """What was asked and what came of it, measured on the angles when it is first looked at."""
        return measured(
            self.body,
            self.planned,
            self.angles,
            self.root,
            self.heading,
            self.plan,
            self.fps,
            self.start,
        )


def carried(
    body: Body, angles: ArrayLike, plan: Planned, fps: float = 120.0, *, start: float = 0.0
) -> Carried:
    """Lets a body travel as planned.

    Args:
        body: D degrees of freedom.
        angles: (F, D) planned angles in radians, translations of the root in metres.
        plan: contacts, speed, turn rate and ``"path"`` or ``"feet"``, or which of them from when on.
        fps: frames a second.
        start: seconds at the first frame.

    Raises:
        ActionletError: a shape, a time or a kind of travel makes no sense; the message says which.
    """
    values = _checked(body, angles, plan, fps)
    count = len(values)
    times = start + np.arange(count) / fps
    path = led(asked(plan.speed, times, "speed"), asked(plan.turn_rate, times, "turn_rate"), fps)
    pelvis, shift = pelvis_turn(body, values), pelvis_shift(body, values)
    both = _footings(body, values, pelvis, plan, fps, start)
    how = kinds(plan.travel)
    place, heading = path
    ground = place + level(shift[:, ::2], heading)
    if any(kind == "feet" for _, kind in how):
        *by_feet, standing = carried_by_feet(both, path, _balance(body, values, both), fps)
        if len(how) > 1:
            ground, heading = carried_by_turns(how, times, (ground, heading), (by_feet[0], by_feet[1]))
        else:
            (ground, heading), both = by_feet, standing
    if len(how) > 1 or how[0][1] == "path":
        both = [with_footprints(one, ground, heading) for one in both]
    root, stood = _stood(values, both, ground, heading, fps)
    root[:, 1] = lowered(root[:, 1], _highest(stood, root, heading, fps), fps)
    found, root = _settled(body, values, pelvis, stood, root, heading, fps)
    if both[0].leg.rigid:
        root[:, 1] += _sunk(both, found, pelvis, root, fps)
    root[:, 1] -= shift[:, 1]
    root[:, ::2] -= level(shift[:, ::2], heading)
    return Carried(body, found, root, heading, fps, start, values, plan)


def _checked(body: Body, angles: ArrayLike, plan: Planned, fps: float) -> Floats:
    values = np.asarray(angles, np.float64)
    if values.ndim != 2 or values.shape[1] != body.dof_count or not len(values):
        raise ActionletError(
            f"angles have the shape {values.shape}; the {body.name} body needs (frames, {body.dof_count}), a "
            "column for each of body.dofs, and one frame at least"
        )
    if not np.isfinite(values).all():
        frame, column = np.argwhere(~np.isfinite(values))[0].tolist()
        raise ActionletError(
            f"{body.names[column]} is {values[frame, column]} in frame {frame}; give a number"
        )
    kinds(plan.travel)
    if not (np.isfinite(fps) and fps > 0):
        raise ActionletError(f"fps is {fps}; give the frames in a second, above 0")
    return values


def _footings(
    body: Body, values: Floats, pelvis: Floats, plan: Planned, fps: float, start: float
) -> list[Footing]:
    """Both legs with their stances."""
    every = stances(plan, len(values), fps, start)
    found = []
    for k, leg in enumerate(legs_of(body)):
        foot = place_foot(leg, values)
        nominal = Placed(turned(pelvis, foot.ankle), times(pelvis, foot.foot))
        own = [stance for stance in every if stance.leg == k]
        found.append(footing(leg, sole_of(leg), nominal, turned(pelvis, leg.hip), own, fps))
    if not any(one.stances for one in found):
        raise ActionletError(
            "no foot touches the ground in these frames: give the plan, or the action in its library file, "
            "contacts of 'left' or 'right'"
        )
    return found


def _balance(body: Body, values: Floats, both: Sequence[Footing]) -> Floats:
    """(F, 2) the centre of mass of the planned body from its pelvis, where flights begin and end; 0
    elsewhere."""
    found = np.zeros((len(values), 2))
    air = _air(both, len(values))
    ends = np.concatenate([air.off, air.down])
    if len(ends):
        found[ends] = mass_from_pelvis(body, values[ends])[:, ::2]
    return found


def _air(both: Sequence[Footing], count: int) -> Flights:
    on_ground = np.zeros(count, bool)
    for one in both:
        on_ground[one.frames] = True
    return flights(on_ground)


def _stood(
    values: Floats, both: Sequence[Footing], ground: Floats, heading: Floats, fps: float
) -> tuple[Floats, Sequence[_Stood]]:
    """(F, 3) the pelvis over its path, and the legs that hold it up."""
    if not both[0].leg.rigid:
        root = _upright([one.standing(heading) for one in both], ground, heading, fps)
        return root, [one.with_heels(root, heading).standing(heading) for one in both]
    root = np.zeros((len(ground), 3))
    root[:, ::2] = ground
    near = flying_soon(_air(both, len(ground)), len(ground), fps)
    stood = [rocking(one, values[:, one.leg.knee_column], near, root, heading) for one in both]
    root = _upright(stood, ground, heading, fps)
    lacks = np.maximum(_lowest(stood, root, heading) - root[:, 1], 0)
    root[:, 1] += smooth_above(lacks, max(round(_STEADIES * fps), 2))
    return root, stood


def _lowest(both: Sequence[_Stood], root: Floats, heading: Floats) -> Floats:
    """(F,) height below which legs on the ground do not let the pelvis; -inf where they give way."""
    lowest = np.full(len(root), -np.inf)
    for stood in both:
        on = stood.one.frames
        lowest[on] = np.maximum(lowest[on], stood.lowest(_hip(stood.one, root, heading)))
    return lowest


def _upright(both: Sequence[_Stood], ground: Floats, heading: Floats, fps: float) -> Floats:
    """(F, 3) the pelvis over its path, at the height at which the legs would keep their nominal bend."""
    root = np.zeros((len(ground), 3))
    root[:, ::2] = ground
    heights, loads, stiff = (np.zeros((len(ground), 2)) for _ in range(3))
    speed = passing(root, fps)
    for k, stood in enumerate(both):
        one = stood.one
        heights[one.frames, k] = stood.held(_hip(one, root, heading), _bend(one, speed))
        loads[one.frames, k] = one.loads(fps)
        stiff[one.frames, k] = stood.stiff
    if stiff.any():
        heights = carried_stiffly(heights, loads, stiff)
    root[:, 1] = held_up(heights, loads, fps)
    return root


def _hip(one: Footing, root: Floats, heading: Floats) -> Floats:
    """(n, 3) the hip of a leg on the ground: x and z in the world, its height from the pelvis."""
    hip = one.hip[one.frames]
    hip[:, ::2] = root[one.frames][:, ::2] + level(hip[:, ::2], heading[one.frames])
    return hip


def _bend(one: Footing, speed: Floats) -> Floats:
    """(n,) radians by which a leg on the ground stays bent."""
    return kept_bend(speed[one.frames], one.over)


def _highest(both: Sequence[_Stood], root: Floats, heading: Floats, fps: float) -> Floats:
    """(F,) height that the legs on the ground allow the pelvis; inf in flight."""
    highest = np.full(len(root), np.inf)
    speed = passing(root, fps)
    for stood in both:
        one = stood.one
        allowed = stood.highest(_hip(one, root, heading), _bend(one, speed))
        highest[one.frames] = np.minimum(highest[one.frames], allowed)
    found: Floats = np.maximum(highest, _lowest(both, root, heading))
    return found


def _settled(
    body: Body,
    values: Floats,
    pelvis: Floats,
    both: Sequence[_Stood],
    root: Floats,
    heading: Floats,
    fps: float,
) -> tuple[Floats, Floats]:
    """(F, D) angles and (F, 3) pelvis, in stance and flight."""
    air = _air([stood.one for stood in both], len(root))
    if not len(air):
        return stepped(values, pelvis, both, root, heading, fps), root
    frames = air.frames
    centre = _in_world(mass_from_pelvis(body, values[frames]), heading[frames])
    flying = np.zeros(len(root), bool)
    flying[frames] = True
    lifts = _LIFTS if both[0].one.leg.rigid else 1
    for number in range(_ROUNDS):
        moved = taken_up(root, air, centre, fps)
        over = np.maximum(moved[:, 1] - _highest(both, moved, heading, fps), 0)
        if over.any():
            root = root.copy()
            root[:, 1] = lowered(root[:, 1], root[:, 1] - over, fps)
            moved = taken_up(root, air, centre, fps)
        wanted = flying if number + 1 < _ROUNDS else None
        angles = stepped(values, pelvis, both, moved, heading, fps, wanted, lifts)
        centre = _in_world(mass_from_pelvis(body, angles[frames]), heading[frames])
    return angles, falling(moved, air, centre, fps)


def _sunk(both: Sequence[Footing], angles: Floats, pelvis: Floats, root: Floats, fps: float) -> Floats:
    """(F,) how far a body with rigid ankles has to rise so that no foot is below the ground, smooth."""
    lowest = np.full(len(root), np.inf)
    for one in both:
        foot = place_foot(one.leg, angles)
        for point in (one.leg.heel, one.leg.toe):
            height = dots(pelvis[:, 1], foot.ankle + turned(foot.foot, point)) + root[:, 1]
            lowest = np.minimum(lowest, height)
    return smooth_above(np.maximum(-lowest, 0), max(round(_RISES * fps), 2))


def _in_world(vectors: Floats, heading: Floats) -> Floats:
    vectors[:, ::2] = level(vectors[:, ::2], heading)
    return vectors
