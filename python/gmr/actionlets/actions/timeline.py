"""When the cycles of an action come, where its parameters may change while it goes on.

The phase is a number of cycles; it grows by 1 / period(t), and the period follows the parameters of that
time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.many_values import Values, within
from gmr.actionlets.actions.similarity import SPEED, WRITTEN, Pace, stepping
from gmr.actionlets.actions.tables import nearest
from gmr.actionlets.actions.units import LEAN, ActionUnit, Parameter
from gmr.actionlets.actions.values import monotone
from gmr.errors import ActionletError

__all__ = ["Moments", "Profile", "Timeline", "chosen_parameters"]

Floats = NDArray[np.float64]

Profile: TypeAlias = float | Sequence[tuple[float, float]]
"""A number, or (seconds, number) points between which the parameter goes smoothly."""

_STEP: Final = 1 / 60
_GRAVITY: Final = 9.81


@dataclass(frozen=True, eq=False)
class Moments:
    """When N phases are reached.

    Args:
        bounds: (N + 1,) where the moments of each begin; K at the end.
        owner: (K,) the number of the phase.
        cycles: (K,) the number of the cycle.
        seconds: (K,)
    """

    bounds: NDArray[np.int64]
    owner: NDArray[np.int64]
    cycles: NDArray[np.int64]
    seconds: Floats

    def of(self, number: int) -> dict[int, float]:
        """The seconds when one phase is reached, by the number of the cycle."""
        own = slice(self.bounds[number], self.bounds[number + 1])
        return dict(zip(self.cycles[own].tolist(), self.seconds[own].tolist(), strict=True))


@dataclass(frozen=True)
class Timeline:
    """The phase and the parameters over time.

    Args:
        times: (n,) seconds, rising; 0 is where the performance begins.
        phase: (n,) cycles.
        parameters: by name, (n,); the speed as it is looked up, see :class:`Pace` and :func:`stepping`.
        asked: (n,) speed along the path, metres a second; 0 for an action that has none.
        is_cyclic: whether there are cycles beside the first.
        steady: the parameters, where none of them changes; else None.
    """

    times: Floats
    phase: Floats
    parameters: Mapping[str, Floats]
    asked: Floats
    is_cyclic: bool
    steady: Mapping[str, float] | None

    @classmethod
    def of(
        cls, action: ActionUnit, chosen: Mapping[str, Profile], seconds: float, pace: Pace = WRITTEN
    ) -> Timeline:
        """The timeline of an action.

        Args:
            chosen: all its parameters.
            seconds: how long it is performed.
            pace: what its period or duration, and its speed, are multiplied with.
        """
        times = _grid(seconds, 2.0 * pace.period * action.span.highest if action.cyclic else 0.0)
        parameters = _parameters_at(times, action, chosen, seconds)
        asked = parameters.get(SPEED, np.zeros(len(times)))
        if SPEED in parameters:
            parameters[SPEED] = pace.speed * stepping(parameters)
        rates = 1 / (pace.period * np.broadcast_to(action.span.at(parameters), times.shape))
        between = np.diff(times) * (rates[1:] + rates[:-1]) / 2
        phase = np.concatenate([[0.0], np.cumsum(between)])
        begins = action.begins if action.cyclic else 0.0
        phase = phase - np.interp(0.0, times, phase) + begins
        changes = any((values != values[0]).any() for values in parameters.values())
        steady = None if changes else {name: float(values[0]) for name, values in parameters.items()}
        return cls(times, phase, parameters, asked, action.cyclic, steady)

    def moments(self, phases: Values, shift: Floats) -> Moments:
        """When each of some phases, put off by ``shift`` (N,), is reached in every cycle."""
        asked = shift + (phases.base if self.steady is None else phases.all_at(self.steady))
        begins, ends = self.phase[0] - asked, self.phase[-1] - asked
        numbers = phases.following if self.steady is None else []
        following = {number: self._ahead(phases, number, shift[number]) for number in numbers}
        for number, ahead in following.items():
            begins[number], ends[number] = ahead[0], ahead[-1]
        first, counts = np.zeros(len(asked), np.int64), np.ones(len(asked), np.int64)
        if self.is_cyclic:
            first = np.ceil(begins).astype(np.int64)
            counts = np.maximum(np.floor(ends).astype(np.int64) - first + 1, 0)
        owner = np.repeat(np.arange(len(asked)), counts)
        cycles = first[owner] + within(counts)
        seconds = np.interp(cycles + asked[owner], self.phase, self.times)
        bounds = np.concatenate([[0], np.cumsum(counts)])
        for number, ahead in following.items():
            own = slice(bounds[number], bounds[number + 1])
            seconds[own] = np.interp(cycles[own], ahead, self.times)
        return Moments(bounds, owner, cycles, seconds)

    def _ahead(self, phases: Values, number: int, shift: float) -> Floats:
        """(n,) cycles by which the timeline is ahead of a phase that follows the parameters."""
        which = np.full(len(self.times), number)
        ahead = self.phase - phases.at(which, self.parameters) - shift
        if (np.diff(ahead) > 0).all():
            return ahead
        # While a parameter changes fast, a phase that follows it may run ahead of time; it is met once.
        return np.maximum.accumulate(ahead + 1e-9 * np.arange(len(ahead)))

    def values(self, of: Values, which: NDArray[np.intp], times: Floats) -> Floats:
        """(K,) the values of the numbers ``which`` (K,) at times (K,)."""
        if self.steady is not None:
            return of.all_at(self.steady)[which]
        return of.at(which, {name: np.interp(times, self.times, self.parameters[name]) for name in of.names})


def _grid(seconds: float, margin: float) -> Floats:
    """(n,) times close to each other, 0 and ``seconds`` among them, a margin beyond both."""
    inner = np.linspace(0.0, seconds, max(int(np.ceil(seconds / _STEP)) + 1, 8))
    if not margin:
        return inner
    outer = np.linspace(0.0, margin, int(np.ceil(margin / _STEP)) + 2)[1:]
    return np.concatenate([-outer[::-1], inner, seconds + outer])


def chosen_parameters(
    action: str, parameters: Mapping[str, Parameter], given: Mapping[str, Profile]
) -> dict[str, Profile]:
    """All parameters of the action of that name: what is given, else what they are where nobody chooses.

    Raises:
        ActionletError: a name that the action does not have, or a number out of its range.
    """
    for name, value in given.items():
        if name not in parameters:
            raise ActionletError(f"action '{action}' has no parameter '{name}'. {nearest(name, parameters)}")
        _check_profile(action, parameters[name], value)
    return {name: given.get(name, parameter.default) for name, parameter in parameters.items()}


def _check_profile(action: str, parameter: Parameter, value: Profile) -> None:
    try:
        points = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.zeros((0, 0, 0))
    is_profile = points.ndim == 2 and points.shape[1] == 2 and len(points) >= 2
    if points.ndim and not (is_profile and (np.diff(points[:, 0]) > 0).all()):
        raise ActionletError(
            f"parameter '{parameter.name}' of '{action}' is {value!r}; give a number, or two points or more, "
            "[(0, 1.0), (2.5, 1.4)], with their seconds rising"
        )
    for number in np.atleast_1d(points[:, 1] if points.ndim else points):
        if not parameter.low <= number <= parameter.high:
            unit = f" {parameter.unit}" if parameter.unit else ""
            raise ActionletError(
                f"parameter '{parameter.name}' of '{action}' is {number:g}{unit}; its range is "
                f"{parameter.low:g} to {parameter.high:g}{unit}"
            )


def _parameters_at(
    times: Floats, action: ActionUnit, chosen: Mapping[str, Profile], seconds: float
) -> dict[str, Floats]:
    found = {name: _along(profile, times) for name, profile in chosen.items()}
    for name, points in action.courses.items():
        found[name] = found[name] * _factors(points, times, seconds)
    if action.derived:
        across = found["speed"] * np.radians(found["turn_rate"]) / _GRAVITY
        found[LEAN] = np.degrees(np.arctan(across))
    return found


def _along(profile: Profile, times: Floats) -> Floats:
    if isinstance(profile, int | float | np.number):
        return np.full(len(times), float(profile))
    seconds, values = np.asarray(profile, dtype=np.float64).T
    return monotone(seconds, values, times)


def _factors(points: Sequence[tuple[float, float]], times: Floats, seconds: float) -> Floats:
    """The course of a parameter; points counted from the end begin where those before them are over."""
    at = np.array([second if second >= 0 else seconds + second for second, _ in points])
    factors = np.array([factor for _, factor in points])
    if len(points) < 2:
        return np.full(len(times), factors[0])
    # A performance too short for all of it does it in the time that there is.
    at = np.maximum.accumulate(at + 1e-3 * np.arange(len(at)) / len(at))
    return monotone(at + 1e-9 * np.arange(len(at)), factors, times)
