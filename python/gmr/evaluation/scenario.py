"""What a character is asked to do in a trial: the planned speeds and turn rates, and which part is recorded.

Source: the paper's section 3.4 and its grid (section 4.2). Every trial first runs straight along the tangent
of its circle, then turns for a while until it has settled, and only then is recorded. A scenario says what
is asked for while it is: one speed throughout, or two in turn. Other scenarios, which are no grid, are in
:mod:`gmr.evaluation.scenarios`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Self, TypeAlias

__all__ = [
    "DEFAULT_SPEEDS",
    "DEFAULT_TURN_RATES_DEG",
    "MOST_TRIALS",
    "PRESETS",
    "RUN_UP",
    "SCENARIOS",
    "SWITCHED_SPEED",
    "SWITCH_EVERY",
    "Pacing",
    "Segment",
    "Switching",
    "Trial",
    "constant_trials",
    "planned_trials",
]

DEFAULT_SPEEDS: Final = tuple(1 + 0.25 * step for step in range(9))
"""The paper's speeds, metres per second."""

DEFAULT_TURN_RATES_DEG: Final = tuple(25.0 * step for step in range(-4, 5))
"""The paper's turn rates, degrees per second, positive to the left."""

SWITCHED_SPEED: Final = 4.0
SWITCH_EVERY: Final = 5.0
"""The paper's other speed, metres per second, and its seconds from switch to switch (section 4.2)."""

LEAST_STRETCHES: Final = 5
"""Stretches at one speed in a switching trial, at least: two there and back, and the speed it began with."""

SHORTEST_STRETCH: Final = 0.5
LONGEST_STRETCH: Final = 60.0
"""Seconds from one switch to the next."""

SLOWEST: Final = 0.01
FASTEST: Final = 100.0
"""Metres per second; a slower character would take days for a run-up of ten metres, none is faster."""

RUN_UP: Final = 3.0
"""Seconds straight ahead before a trial begins to do what it is about."""

MOST_TRIALS: Final = 2_000
"""More would not fit into the memory of a small machine: with its figures a trial takes 0.7 MB."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of a planned path: ``seconds`` long, at one speed (m/s) and one turn rate (degrees/s).

    ``drift_deg`` is the angle from where the character faces to where it goes, degrees, positive to the left:
    0 is ahead, 90 sideways to the left, 180 backwards.
    """

    seconds: float
    speed: float
    turn_rate_deg: float
    drift_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Trial:
    """One simulated walk.

    Attributes:
        scenario: the kind of trial, one of ``SCENARIOS`` or the name of another scenario.
        speed: the speed that names the trial, m/s; of a trial that is no cell of the grid the mean.
        turn_rate_deg: the turn rate that names the trial, degrees/s; likewise.
        segments: the planned path, from the start; where one segment ends the next begins.
        recorded_from: seconds from the start after which the trial is recorded, to its end.
        switching: how the speed switches while it is recorded; None where it does not.
        path: what tells the trial from the others of its scenario; "" in a cell of the grid, which speed and
            turn rate tell.
    """

    scenario: str
    speed: float
    turn_rate_deg: float
    segments: tuple[Segment, ...]
    recorded_from: float
    switching: Switching | None = None
    path: str = ""

    @classmethod
    def along(
        cls, scenario: str, path: str, segments: Sequence[Segment], recorded_from: float = RUN_UP
    ) -> Self:
        """A trial that is no cell of a grid: its speed and turn rate are the means while it is recorded.

        Args:
            scenario: the name of the scenario.
            path: what tells the trial from the others of the scenario.
            segments: the planned path.
            recorded_from: seconds from the start after which it is recorded.
        """
        parts = list(_recorded(segments, recorded_from))
        seconds = math.fsum(part.seconds for part in parts) or math.nan
        return cls(
            scenario,
            math.fsum(part.seconds * part.speed for part in parts) / seconds,
            math.fsum(part.seconds * part.turn_rate_deg for part in parts) / seconds,
            tuple(segments),
            recorded_from,
            path=path,
        )

    @property
    def seconds(self) -> float:
        """Length of the whole trial."""
        return math.fsum(segment.seconds for segment in self.segments)

    @property
    def drift_deg(self) -> float:
        """The one drift that is asked for while it is recorded, degrees; NaN where there are several."""
        drifts = {part.drift_deg for part in _recorded(self.segments, self.recorded_from)}
        return drifts.pop() if len(drifts) == 1 else math.nan

    @property
    def slowest(self) -> float:
        """The lowest speed asked for while it is recorded, m/s; NaN where nothing is."""
        return min((part.speed for part in _recorded(self.segments, self.recorded_from)), default=math.nan)


def _recorded(segments: Sequence[Segment], start: float) -> Iterator[Segment]:
    """What is left of the segments after ``start`` seconds."""
    before = 0.0
    for segment in segments:
        after = before + segment.seconds
        if after > start + 1e-9:
            yield replace(segment, seconds=after - max(before, start))
        before = after


@dataclass(frozen=True, slots=True)
class Switching:
    """How the speed switches: to ``speed`` (m/s) and back, each time after ``every`` seconds."""

    speed: float = SWITCHED_SPEED
    every: float = SWITCH_EVERY


@dataclass(frozen=True, slots=True)
class Pacing:
    """How long the parts of a constant trial last, in seconds: straight run-up, settling, recording."""

    run_up: float
    settle: float
    record: float


def _one_pace_for_all(speed: float, turn_rate_deg: float) -> Pacing:
    return Pacing(run_up=RUN_UP, settle=2.0, record=30.0)


def _as_the_authors_did(speed: float, turn_rate_deg: float) -> Pacing:
    """Ten metres of run-up, and there the clock starts. A circle settles for 5 s and ends at 30 s; a straight
    line, with nothing to settle, ends at 5 s.
    """
    run_up = 10.0 / speed
    if turn_rate_deg == 0.0:
        return Pacing(run_up, settle=0.0, record=5.0)
    return Pacing(run_up, settle=5.0, record=25.0)


PRESETS: Final[Mapping[str, Callable[[float, float], Pacing]]] = {
    "even": _one_pace_for_all,
    "mig2022": _as_the_authors_did,
}
"""The pacing of a trial from its speed (m/s) and turn rate (degrees/s), by name."""


def planned_trials(
    scenarios: Sequence[str] = ("constant", "switching"),
    speeds: Sequence[float] = DEFAULT_SPEEDS,
    turn_rates_deg: Sequence[float] = DEFAULT_TURN_RATES_DEG,
    preset: str = "even",
    switching: Switching | None = None,
) -> tuple[Trial, ...]:
    """The grid of trials in every scenario.

    Args:
        scenarios: of ``SCENARIOS``; each gets the whole grid, in this order.
        speeds: metres per second, from 0.01 to 100.
        turn_rates_deg: degrees per second, positive to the left, within 720.
        preset: "even": 3 s of run-up, 2 s to settle, 30 s recorded, whatever the turn rate;
            "mig2022": the durations of the paper's authors.
        switching: the other speed of the switching scenario; the paper's by default.

    Returns:
        One trial for every scenario and pair, scenario by scenario, turn rates running fastest, ascending.

    Raises:
        ValueError: no scenario, speed or turn rate, one that is unknown, not finite or given twice, a speed
            that is not from 0.01 to 100, switches too close or too far apart, too many pairs, or an unknown
            preset.
    """
    if preset not in PRESETS:
        raise ValueError(f"unknown preset {preset!r}; known are {', '.join(PRESETS)}")
    if unknown := [name for name in scenarios if name not in SCENARIOS]:
        raise ValueError(f"unknown scenario {unknown[0]!r}; known are {', '.join(SCENARIOS)}")
    if not scenarios or len(set(scenarios)) < len(scenarios):
        raise ValueError(f"give each scenario once, and at least one; known are {', '.join(SCENARIOS)}")
    switches = switching or Switching()
    for name, values in (("speed", speeds), ("switched speed", [switches.speed])):
        _check(
            name, values, lambda speed: SLOWEST <= speed <= FASTEST, f"from {SLOWEST:g} to {FASTEST:g} m/s"
        )
    _check("turn rate", turn_rates_deg, lambda rate: abs(rate) <= 720, "within 720 degrees/s")
    _check(
        "time between switches",
        [switches.every],
        lambda seconds: SHORTEST_STRETCH <= seconds <= LONGEST_STRETCH,
        f"from {SHORTEST_STRETCH:g} to {LONGEST_STRETCH:g} s",
    )
    if len(scenarios) * len(speeds) * len(turn_rates_deg) > MOST_TRIALS:
        each = f" in each of {len(scenarios)} scenarios" if len(scenarios) > 1 else ""
        fewer = ", or one scenario" if len(scenarios) > 1 else ""
        raise ValueError(
            f"{len(speeds)} speeds times {len(turn_rates_deg)} turn rates{each} are more than "
            f"{MOST_TRIALS:,} trials; take wider steps{fewer}"
        )
    return tuple(
        SCENARIOS[scenario](float(speed), float(turn_rate), PRESETS[preset], switches)
        for scenario in scenarios
        for speed in sorted(speeds)
        for turn_rate in sorted(turn_rates_deg)
    )


def constant_trials(
    speeds: Sequence[float] = DEFAULT_SPEEDS,
    turn_rates_deg: Sequence[float] = DEFAULT_TURN_RATES_DEG,
    preset: str = "even",
) -> tuple[Trial, ...]:
    """The grid of trials that keep one speed and one turn rate (the paper's first scenario)."""
    return planned_trials(("constant",), speeds, turn_rates_deg, preset)


Pace: TypeAlias = Callable[[float, float], Pacing]


def _constant(speed: float, turn_rate_deg: float, pacing: Pace, switching: Switching) -> Trial:
    """One speed throughout."""
    pace = pacing(speed, turn_rate_deg)
    turning = Segment(pace.settle + pace.record, speed, turn_rate_deg)
    segments = (Segment(pace.run_up, speed, 0.0), turning)
    return Trial("constant", speed, turn_rate_deg, segments, pace.run_up + pace.settle)


def _switching(speed: float, turn_rate_deg: float, pacing: Pace, switching: Switching) -> Trial:
    """The speed of the trial and the switched one in turn; the paper's second scenario (section 3.4).

    A recording that is too short for that, as the authors' of straight lines, is made longer.
    """
    pace = pacing(speed, turn_rate_deg)
    record = max(pace.record, LEAST_STRETCHES * switching.every)
    begun = [switching.every * number for number in range(math.ceil(record / switching.every - 1e-9))]
    stretches = [
        Segment(min(switching.every, record - start), (speed, switching.speed)[number % 2], turn_rate_deg)
        for number, start in enumerate(begun)
    ]
    first = Segment(pace.settle + stretches[0].seconds, speed, turn_rate_deg)
    segments = (Segment(pace.run_up, speed, 0.0), first, *stretches[1:])
    return Trial("switching", speed, turn_rate_deg, segments, pace.run_up + pace.settle, switching)


SCENARIOS: Final[Mapping[str, Callable[[float, float, Pace, Switching], Trial]]] = {
    "constant": _constant,
    "switching": _switching,
}
"""A trial from its speed (m/s), its turn rate (degrees/s) and its pacing, by name."""


def _check(what: str, values: Sequence[float], allowed: Callable[[float], bool], limit: str) -> None:
    if not len(values):
        raise ValueError(f"there must be at least one {what}")
    for value in values:
        if not (math.isfinite(value) and allowed(value)):
            raise ValueError(f"a {what} must be {limit}; {value:g} is not")
    if len(set(values)) < len(values):
        raise ValueError(f"a {what} is given twice in {', '.join(f'{value:g}' for value in values)}")
