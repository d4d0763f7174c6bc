"""The trials of an evaluation on other processes or on a cluster: the same bits as in this one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.cluster import results
from gmr.evaluation.scenario import Trial
from gmr.evaluation.simulation import Simulation, profile_of
from gmr.matching.database import Database
from gmr.matching.trial import Profile, Status, Tracking, TrialLog, run_trials

__all__ = ["Runs", "simulated_elsewhere"]

_TOGETHER: Final = 9
"""Trials of a job: some tens of milliseconds of work, so that sending it costs little beside."""


@dataclass(frozen=True, slots=True)
class Runs:
    """What all runs are made of: T trials, each once for every tracking."""

    database: Database
    trials: tuple[Trial, ...]
    profiles: tuple[Profile, ...]
    trackings: tuple[Tracking, ...]

    @classmethod
    def of(cls, simulation: Simulation) -> Runs:
        """As a simulation asked it."""
        return cls(simulation.database, simulation.trials, simulation.profiles, tuple(simulation.logs))


def simulated_elsewhere(
    database: Database,
    trials: Sequence[Trial],
    trackings: Sequence[Tracking],
    *,
    workers: int | None,
    cluster: str | None,
    progress: Callable[[int, int], object],
) -> Simulation:
    """As :func:`gmr.evaluation.simulation.simulated`, some trials at a time on each worker.

    Args:
        database: what is played and searched; sent to each worker once.
        trials: what is asked for.
        trackings: of "time" and "velocity".
        workers, cluster: as for :func:`gmr.cluster.results`.
        progress: called with the number of runs done and of all runs.
    """
    asked = Runs(database, tuple(trials), tuple(profile_of(trial) for trial in trials), tuple(trackings))
    firsts = range(0, len(trials), _TOGETHER)
    jobs = [(tracking, first) for tracking in trackings for first in firsts]
    found: dict[tuple[Tracking, int], TrialLog] = {}
    runs, done = len(trials) * len(trackings), 0
    progress(0, runs)
    with closing(results(_some, jobs, workers=workers, cluster=cluster, shared=asked)) as coming:  # type: ignore[type-var]
        for number, log in coming:
            found[jobs[number]] = log
            done += len(log)
            progress(done, runs)
    logs = {tracking: _joined([found[tracking, first] for first in firsts]) for tracking in trackings}
    return Simulation(database, tuple(trials), logs)


def _some(asked: Runs, job: tuple[Tracking, int]) -> TrialLog:
    """The log of one job."""
    tracking, first = job
    return run_trials(asked.database, asked.profiles[first : first + _TOGETHER], tracking=tracking, threads=1)


_FILL: Final = {"row": -1, "status": Status.NONE}
"""What stands behind the end of a shorter trial where that is not NaN."""


def _joined(logs: Sequence[TrialLog]) -> TrialLog:
    """The trials of some logs as those of one."""
    steps = max(log.row.shape[1] for log in logs)

    def column(name: str) -> NDArray[Any]:
        parts = [getattr(log, name) for log in logs]
        if parts[0].ndim == 2:
            fill = _FILL.get(name, np.nan)
            parts = [
                np.pad(part, ((0, 0), (0, steps - part.shape[1])), constant_values=fill) for part in parts
            ]
        whole = np.concatenate(parts)
        whole.flags.writeable = False
        return whole

    names = [name for name in TrialLog.__dataclass_fields__ if name not in ("rate", "tracking", "profiles")]
    profiles = tuple(profile for log in logs for profile in log.profiles)
    return TrialLog(logs[0].rate, logs[0].tracking, profiles, **{name: column(name) for name in names})
