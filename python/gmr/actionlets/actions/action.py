"""An action of a library: what it is, which parameters it takes, and how it is performed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.anatomy import Anatomy
from gmr.actionlets.actions.parts import Courses
from gmr.actionlets.actions.performance import Performance
from gmr.actionlets.actions.plan import Plan, performed
from gmr.actionlets.actions.similarity import SPEED, Pace, leg_ratio, pace, stepping
from gmr.actionlets.actions.timeline import Profile, Timeline, chosen_parameters
from gmr.actionlets.actions.units import MOST_SECONDS, SIDES, ActionUnit, Parameter
from gmr.actionlets.actions.unrolling import Unrolled
from gmr.actionlets.actions.variation import Pool, Variable
from gmr.actionlets.actions.written import Written
from gmr.errors import ActionletError

if TYPE_CHECKING:
    from gmr.actionlets.actions.taking import Take
    from gmr.actionlets.body import Body
    from gmr.motion import Motion

__all__ = ["Action", "SingleAction"]

_SECONDS = 4.0
"""How long what goes on is performed where neither the caller nor its file says."""


@dataclass(frozen=True)
class Action(ABC):
    """What a library calls an action; :meth:`motion` is what most want of it.

    Args:
        name: its name.
        about: what it is, in a sentence.
        words: words that describe it, for corpora and searches.
        aliases: other names of it.
        parameters: its parameters by name: range, default, unit.
    """

    name: str
    about: str
    words: tuple[str, ...]
    aliases: tuple[str, ...]
    parameters: Mapping[str, Parameter]

    @abstractmethod
    def plan(
        self,
        chosen: Mapping[str, Profile],
        seconds: float | None,
        seed: int,
        variation: float,
        begins: float | None = None,
        size: float = 1.0,
    ) -> Plan:
        """What is to be done when; arguments as in :meth:`perform`, ``chosen`` complete.

        Args:
            begins: the phase with which it begins; None: as its file says.
            size: as in :meth:`perform`.
        """

    def perform(
        self,
        parameters: Mapping[str, Profile] | None = None,
        seconds: float | None = None,
        seed: int = 0,
        variation: float = 0.0,
        size: float = 1.0,
    ) -> Performance:
        """The action as one score, with contacts, speed and turn rate.

        Args:
            parameters: by name a number, or (seconds, number) points that it goes through; the default
                where it is not named.
            seconds: how long; what is done once rests afterwards. None: as its file says, its duration, or 4.
            seed, variation: another performer, 0 (as written) to 1 (as different as one still calls it so);
                the same numbers give the same performance on every machine.
            size: length of the legs by those of the reference body: shorter ones take more and shorter steps
                at the same speed (:mod:`gmr.actionlets.actions.similarity`).

        Raises:
            ActionletError: an unknown parameter, one out of its range, or too little or too much time.
        """
        chosen = chosen_parameters(self.name, self.parameters, parameters or {})
        if not 0 <= variation <= 1:
            raise ActionletError(f"a variation of {variation:g} cannot be; give 0 (as written) to 1")
        if seconds is not None and not 0 < seconds <= MOST_SECONDS:
            raise ActionletError(
                f"{seconds:g} s of '{self.name}' cannot be; give more than 0 and at most {MOST_SECONDS:,.0f}"
            )
        if not (np.isfinite(size) and size > 0):
            raise ActionletError(f"legs of {size:g} times the usual length cannot be; give more than 0")
        plan = self.plan(chosen, seconds, seed, variation, size=size)
        return performed(plan, self.name, chosen, seed, variation)

    def take(
        self,
        seconds: float | None = None,
        fps: float = 120.0,
        seed: int = 0,
        body: Body | None = None,
        variation: float = 0.0,
        **parameters: Profile,
    ) -> Take:
        """A body that performs the action: the motion, what is labelled in it, and what it had to give up.

        Args:
            body: who; a man of 1.75 m where it is None.
            parameters: as in :meth:`perform`, by name.

        Raises:
            ActionletError: as :meth:`perform`, or ``fps`` is no rate.
        """
        from gmr.actionlets.actions.taking import check_frames, taken

        check_frames(self.name, seconds or 0.0, fps)
        return taken(self.perform(parameters, seconds, seed, variation, leg_ratio(body)), body, fps)

    def motion(
        self,
        seconds: float | None = None,
        fps: float = 120.0,
        seed: int = 0,
        body: Body | None = None,
        variation: float = 0.0,
        **parameters: Profile,
    ) -> Motion:
        """The motion of :meth:`take` alone."""
        return self.take(seconds, fps, seed, body, variation, **parameters).motion


@dataclass(frozen=True)
class SingleAction(Action):
    """An action of joint, limb and group actions, put together and checked.

    Args:
        unit: as its file writes it.
        courses: the extremes of each degree of freedom.
        ranges: by degree of freedom its range of motion; degrees, metres for the root's lengths.
        factors: by degree of freedom, radians (or metres) in one of those.
        pool: actionlets from which variations choose others of the same type.
    """

    unit: ActionUnit
    courses: Courses
    ranges: Mapping[str, tuple[float, float]]
    factors: Mapping[str, float]
    pool: Pool

    @classmethod
    def of(cls, unit: ActionUnit, courses: Courses, anatomy: Anatomy, pool: Pool) -> SingleAction:
        """The action with the units of the body's degrees of freedom."""
        degree = float(np.radians(1.0))
        factors = {dof: 1.0 if dof in anatomy.lengths else degree for dof in courses}
        ranges = {dof: anatomy.ranges[dof] for dof in courses}
        card = unit.name, unit.about, unit.words, unit.aliases, unit.parameters
        return cls(*card, unit, courses, ranges, factors, pool)

    def plan(
        self,
        chosen: Mapping[str, Profile],
        seconds: float | None,
        seed: int,
        variation: float,
        begins: float | None = None,
        size: float = 1.0,
    ) -> Plan:
        """What is to be done when."""
        change = self._variable.varied(seed, variation)
        going = self.pace(size, change.tempo)
        unit = self.unit if begins is None else replace(self.unit, begins=begins)
        lasts = self._seconds(seconds, unit, chosen, going)
        timeline = Timeline.of(unit, chosen, lasts, going)
        unrolled = Unrolled(self._written, change, timeline)
        return Plan(
            seconds=lasts,
            knots=unrolled.knots(),
            contacts=unrolled.contacts(),
            speed=_profile(timeline, timeline.asked, lasts),
            turn_rate=_profile(
                timeline, np.radians(timeline.parameters.get("turn_rate", np.zeros(1))), lasts
            ),
            travel=unit.travel,
            labels=unrolled.labels(lasts),
            phase=float(np.interp(lasts, timeline.times, timeline.phase)) if unit.cyclic else None,
        )

    def pace(self, size: float, tempo: float = 1.0) -> Pace:
        """How legs perform it that are ``size`` times as long as the reference body's."""
        found = pace(self.unit, size)
        return found._replace(period=tempo * found.period)

    def period(self, chosen: Mapping[str, Profile], size: float) -> float:
        """Seconds of a cycle with the parameters of the end."""
        return self.pace(size).period * float(self.unit.span.at(self._at_the_end(chosen, size)))

    def standing(
        self, chosen: Mapping[str, Profile], phases: NDArray[np.float64], size: float
    ) -> NDArray[np.bool_]:
        """(2, n) whether the left and the right foot are on the ground at phases of the cycle, with the
        parameters of the end."""
        values = self._at_the_end(chosen, size)
        found = np.zeros((len(SIDES), len(phases)), dtype=bool)
        for side, row in zip(SIDES, found, strict=True):
            for begin, end in self.unit.contacts[side]:
                first, last = float(begin.at(values)), float(end.at(values))
                row |= (phases - first) % 1.0 <= last - first
        return found

    @cached_property
    def _written(self) -> Written:
        return Written.of(self.unit, self.courses, self.ranges, self.factors)

    @cached_property
    def _variable(self) -> Variable:
        return Variable.of(self.unit, self._written, self.ranges, self.pool)

    def _at_the_end(self, chosen: Mapping[str, Profile], size: float) -> dict[str, float]:
        values = {name: float(np.ravel(profile)[-1]) for name, profile in chosen.items()}
        values |= dict.fromkeys(self.unit.derived, 0.0)
        if SPEED in values:
            values[SPEED] = self.pace(size).speed * float(stepping(values))
        return values

    def _seconds(
        self, asked: float | None, unit: ActionUnit, chosen: Mapping[str, Profile], going: Pace
    ) -> float:
        lasts = 0.0 if unit.cyclic else _duration(unit, chosen, going)
        if asked is None:
            return max(unit.seconds or 0.0, lasts) or _SECONDS
        if asked < lasts - 1e-9:
            raise ActionletError(
                f"'{self.name}' takes {lasts:.3g} s with these parameters; give that many seconds or more "
                "(it rests afterwards), or none"
            )
        return asked


def _duration(unit: ActionUnit, chosen: Mapping[str, Profile], going: Pace) -> float:
    """Seconds that it takes to be done once; with parameters that change, at most."""
    longest = Timeline.of(unit, chosen, 1.5 * going.period * unit.span.highest, going)
    return float(np.interp(1.0, longest.phase, longest.times))


def _profile(timeline: Timeline, values: NDArray[np.float64], seconds: float) -> NDArray[np.float64]:
    """(n, 2) seconds and values of a timeline, from 0 to the end."""
    if np.ptp(values) == 0:
        return np.array([[0.0, values[0]], [seconds, values[0]]])
    inside = (timeline.times > 0) & (timeline.times < seconds)
    times = np.concatenate([[0.0], timeline.times[inside], [seconds]])
    return np.column_stack([times, np.interp(times, timeline.times, values)])
