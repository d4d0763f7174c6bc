"""What a character is asked to do in a trial: the planned speeds and turn rates, and which part is recorded.

Source: the paper's section 3.4 and its grid (section 4.2). Every trial first runs straight along the tangent
of its circle, then turns for a while until it has settled, and only then is recorded.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

__all__ = [
    "DEFAULT_SPEEDS",
    "DEFAULT_TURN_RATES_DEG",
    "PRESETS",
    "Pacing",
    "Segment",
    "Trial",
    "constant_trials",
]

DEFAULT_SPEEDS: Final = tuple(1 + 0.25 * step for step in range(9))
"""The paper's speeds, metres per second."""

DEFAULT_TURN_RATES_DEG: Final = tuple(25.0 * step for step in range(-4, 5))
"""The paper's turn rates, degrees per second, positive to the left."""

SLOWEST: Final = 0.01
FASTEST: Final = 100.0
"""Metres per second; a slower character would take days for a run-up of ten metres, none is faster."""

MOST_TRIALS: Final = 2_000
"""More would not fit into the memory of a small machine: with its figures a trial takes 0.7 MB."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of a planned path: ``seconds`` long, at one speed (m/s) and one turn rate (degrees/s)."""

    seconds: float
    speed: float
    turn_rate_deg: float


@dataclass(frozen=True, slots=True)
class Trial:
    """One simulated walk.

    Attributes:
        scenario: the kind of trial: "constant", or another that is added beside it.
        speed: the speed that names the trial, m/s.
        turn_rate_deg: the turn rate that names the trial, degrees/s.
        segments: the planned path, from the start; where one segment ends the next begins.
        recorded_from: seconds from the start after which the trial is recorded, to its end.
    """

    scenario: str
    speed: float
    turn_rate_deg: float
    segments: tuple[Segment, ...]
    recorded_from: float

    @property
    def seconds(self) -> float:
        """Length of the whole trial."""
        return math.fsum(segment.seconds for segment in self.segments)


@dataclass(frozen=True, slots=True)
class Pacing:
    """How long the parts of a constant trial last, in seconds: straight run-up, settling, recording."""

    run_up: float
    settle: float
    record: float


def _one_pace_for_all(speed: float, turn_rate_deg: float) -> Pacing:
    return Pacing(run_up=3.0, settle=2.0, record=30.0)


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


def constant_trials(
    speeds: Sequence[float] = DEFAULT_SPEEDS,
    turn_rates_deg: Sequence[float] = DEFAULT_TURN_RATES_DEG,
    preset: str = "even",
) -> tuple[Trial, ...]:
    """The grid of trials that keep one speed and one turn rate (the paper's first scenario).

    Args:
        speeds: metres per second, from 0.01 to 100.
        turn_rates_deg: degrees per second, positive to the left, within 720.
        preset: "even": 3 s of run-up, 2 s to settle, 30 s recorded, whatever the turn rate;
            "mig2022": the durations of the paper's authors.

    Returns:
        One trial for every pair, turn rates running fastest, both ascending.

    Raises:
        ValueError: no speed or no turn rate, one that is not finite or given twice, a speed that is not from
            0.01 to 100, too many pairs, or an unknown preset.
    """
    if preset not in PRESETS:
        raise ValueError(f"unknown preset {preset!r}; known are {', '.join(PRESETS)}")
    _check("speed", speeds, lambda speed: SLOWEST <= speed <= FASTEST, f"from {SLOWEST:g} to {FASTEST:g} m/s")
    _check("turn rate", turn_rates_deg, lambda rate: abs(rate) <= 720, "within 720 degrees/s")
    if len(speeds) * len(turn_rates_deg) > MOST_TRIALS:
        raise ValueError(
            f"{len(speeds)} speeds times {len(turn_rates_deg)} turn rates are more than {MOST_TRIALS:,} "
            "trials; take wider steps"
        )
    return tuple(
        _constant_trial(float(speed), float(turn_rate), PRESETS[preset])
        for speed in sorted(speeds)
        for turn_rate in sorted(turn_rates_deg)
    )


def _constant_trial(speed: float, turn_rate_deg: float, pacing: Callable[[float, float], Pacing]) -> Trial:
    pace = pacing(speed, turn_rate_deg)
    segments = (
        Segment(pace.run_up, speed, 0.0),
        Segment(pace.settle + pace.record, speed, turn_rate_deg),
    )
    return Trial("constant", speed, turn_rate_deg, segments, pace.run_up + pace.settle)


def _check(what: str, values: Sequence[float], allowed: Callable[[float], bool], limit: str) -> None:
    if not len(values):
        raise ValueError(f"there must be at least one {what}")
    for value in values:
        if not (math.isfinite(value) and allowed(value)):
            raise ValueError(f"a {what} must be {limit}; {value:g} is not")
    if len(set(values)) < len(values):
        raise ValueError(f"a {what} is given twice in {', '.join(f'{value:g}' for value in values)}")
