"""From what a caller names to the trials that are run: scenarios by name, by file, or as they are given."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, TypeAlias

from gmr.evaluation.scenario import FASTEST, MOST_TRIALS, SCENARIOS, Segment, Trial
from gmr.evaluation.scenarios.on_grid import OnGrid
from gmr.evaluation.scenarios.path_points import PathPoints
from gmr.evaluation.scenarios.protocol import Scenario
from gmr.evaluation.scenarios.slalom import Slalom
from gmr.evaluation.scenarios.splines import Splines
from gmr.evaluation.scenarios.start_stop import StartStop
from gmr.evaluation.scenarios.strafe import Strafe

__all__ = ["NAMED", "asked_trials", "scenarios_of"]

MOST_SECONDS: Final = 35.0 * MOST_TRIALS
"""Of trials, each as long as the longest: that many steps are kept."""

STEEPEST: Final = 720.0
"""Degrees per second."""

Asked: TypeAlias = "str | os.PathLike[str] | Scenario"


def scenarios_of(asked: Asked | Sequence[Asked], grid: OnGrid, seed: int = 0) -> tuple[Scenario, ...]:
    """The scenarios that are asked for.

    The grid's come first. Where none of them is asked for, the constant one is added: a dataset is judged by
    it.

    Args:
        asked: of each its name, a file of path points, or the scenario itself.
        grid: whose speeds, turn rates and pacing the named scenarios take.
        seed: of the random splines.

    Raises:
        ValueError: an unknown name, a name twice, or none at all.
        FormatError: a file that is no list of path points.
    """
    found = [_scenario(one, grid, seed) for one in _each(asked)]
    names = [scenario.name for scenario in found]
    if not found or len(set(names)) < len(names):
        raise ValueError(f"give each scenario once, and at least one; known are {_known()}")
    first = [scenario for scenario in found if scenario.name in SCENARIOS] or [replace(grid, name="constant")]
    return (*first, *(scenario for scenario in found if scenario.name not in SCENARIOS))


def asked_trials(scenarios: Sequence[Scenario]) -> tuple[Trial, ...]:
    """The trials of the scenarios in turn.

    Those of a scenario that is no grid have the scenario's name, and a path each, numbered where not named.

    Raises:
        ValueError: a trial that cannot be run, or too many of them.
        TypeError: something that is no trial.
    """
    trials = tuple(trial for scenario in scenarios for trial in _trials_of(scenario))
    longest = max(trial.seconds for trial in trials)
    if len(trials) > MOST_TRIALS or len(trials) * longest > MOST_SECONDS:
        raise ValueError(
            f"{len(trials):,} trials of up to {longest:,.0f} s are too many; give at most {MOST_TRIALS:,}, "
            f"and {MOST_SECONDS:,.0f} s if all were as long as the longest: wider steps, fewer scenarios or "
            "shorter paths"
        )
    return trials


def _each(asked: Asked | Sequence[Asked]) -> tuple[Asked, ...]:
    if isinstance(asked, Sequence) and not isinstance(asked, str):
        return tuple(asked)
    return (asked,)


def _slalom(grid: OnGrid, seed: int) -> Slalom:
    steep = sorted({abs(rate) for rate in grid.turn_rates_deg} - {0.0})
    if not steep:
        raise ValueError("a slalom needs a turn rate other than 0 among those asked for")
    return Slalom(_some(grid.speeds, 3), _some(steep, 2))


def _splines(grid: OnGrid, seed: int) -> Splines:
    speeds, rates = grid.speeds, grid.turn_rates_deg
    return Splines(seed=seed, speeds=(min(speeds), max(speeds)), turn_rates_deg=(min(rates), max(rates)))


NAMED: Final[dict[str, Callable[[OnGrid, int], Scenario]]] = {
    **{name: lambda grid, seed, name=name: replace(grid, name=name) for name in SCENARIOS},  # type: ignore[misc]
    "start-stop": lambda grid, seed: StartStop(_some(grid.speeds, 5)),
    "slalom": _slalom,
    "strafe": lambda grid, seed: Strafe(_some(grid.speeds, 3)[:2]),
    "splines": _splines,
}
"""Scenarios by name, from the grid and a seed."""


def _scenario(asked: Asked, grid: OnGrid, seed: int) -> Scenario:
    if isinstance(asked, str) and asked in NAMED:
        return NAMED[asked](grid, seed)
    if isinstance(asked, os.PathLike) or (isinstance(asked, str) and asked.lower().endswith(".csv")):
        return PathPoints.read(Path(asked), speeds=_some(grid.speeds, 3))
    if isinstance(asked, str):
        raise ValueError(f"unknown scenario {asked!r}; known are {_known()}")
    if not (isinstance(getattr(asked, "name", None), str) and callable(getattr(asked, "trials", None))):
        raise TypeError(f"a scenario has a name and trials(); {asked!r:.60} has not")
    return asked


def _known() -> str:
    return f"{', '.join(NAMED)} and files of path points (.csv)"


def _some(values: Iterable[float], most: int) -> tuple[float, ...]:
    """At most so many of the values, the lowest and the highest among them, ascending."""
    rising = sorted(values)
    count = min(most, len(rising))
    return tuple(
        float(rising[round(place * (len(rising) - 1) / max(count - 1, 1))]) for place in range(count)
    )


def _trials_of(scenario: Scenario) -> tuple[Trial, ...]:
    trials = tuple(scenario.trials())
    if not trials:
        raise ValueError(f"scenario {scenario.name!r} has no trials; give at least one")
    if isinstance(scenario, OnGrid):
        return trials
    if not scenario.name.strip() or scenario.name in SCENARIOS:
        raise ValueError(f"a scenario of its own cannot be called {scenario.name!r}; give it another name")
    named = tuple(_named(scenario, number, trial) for number, trial in enumerate(trials, start=1))
    if len({trial.path for trial in named}) < len(named):
        raise ValueError(f"two trials of scenario {scenario.name!r} have the same path; name each once")
    return named


def _named(scenario: Scenario, number: int, trial: Trial) -> Trial:
    if not isinstance(trial, Trial):
        raise TypeError(f"trial {number} of scenario {scenario.name!r} is no Trial but {trial!r:.60}")
    path = trial.path or f"path {number}"
    where = f"scenario {scenario.name!r}, {path}"
    for place, segment in enumerate(trial.segments, start=1):
        _check(f"{where}, segment {place}", segment)
    if not 0 <= trial.recorded_from < trial.seconds:
        raise ValueError(
            f"{where} is recorded from {trial.recorded_from:g} s on, but lasts {trial.seconds:g} s; record "
            "from 0 s or later, and before its end"
        )
    return Trial.along(scenario.name, path, trial.segments, trial.recorded_from)


@dataclass(frozen=True, slots=True)
class _Bound:
    """What a number of a segment may be."""

    low: float
    high: float
    unit: str


_BOUNDS: Final = {
    "seconds": _Bound(1e-6, 3600.0, "s"),
    "speed": _Bound(0.0, FASTEST, "m/s"),
    "turn_rate_deg": _Bound(-STEEPEST, STEEPEST, "degrees/s"),
    "drift_deg": _Bound(-180.0, 180.0, "degrees"),
}


def _check(where: str, segment: Segment) -> None:
    for name, bound in _BOUNDS.items():
        value = getattr(segment, name)
        if not (math.isfinite(value) and bound.low <= value <= bound.high):
            what = name.removesuffix("_deg").replace("_", " ")
            raise ValueError(
                f"{where}: {what} is {value:g}; give {bound.low:g} to {bound.high:g} {bound.unit}"
            )
