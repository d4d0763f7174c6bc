"""The trials as they were simulated: the database, what was asked for, and every step of what happened."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import Log
from gmr.evaluation.scenario import Trial
from gmr.matching.database import Database
from gmr.matching.trial import Profile, Segment, Tracking, TrialLog, run_trials

__all__ = ["Simulation", "frames_of", "log_of", "profile_of", "simulated"]

_COLUMNS: Final = (
    *("lengths", "recorded_from", "x", "z", "heading", "ref_x", "ref_z", "ref_heading", "ref_speed"),
    *("ref_turn_rate", "ref_drift", "row", "status", "cost_pose", "cost_trajectory", "discontinuity"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """T trials, each run once for every tracking.

    Attributes:
        database: what was played and searched.
        trials: the T that were asked for.
        logs: what happened, by tracking; each log has the T trials in their order.

    Row ``k * T + i`` of the evaluation's table of trials is trial ``i`` of the ``k``-th log.
    """

    database: Database
    trials: tuple[Trial, ...]
    logs: dict[Tracking, TrialLog]

    def __getitem__(self, row: int) -> tuple[Trial, TrialLog, int]:
        """What row ``row`` of the table of trials asked for, and its log with the trial's place in it."""
        number, place = divmod(row, len(self.trials))
        return self.trials[place], list(self.logs.values())[number], place

    @property
    def profiles(self) -> tuple[Profile, ...]:
        """(T,) the trials as the core runs them."""
        return next(iter(self.logs.values())).profiles


def simulated(
    database: Database,
    trials: Sequence[Trial],
    trackings: Sequence[Tracking],
    *,
    threads: int,
    progress: Callable[[int, int], object],
) -> Simulation:
    """Run all trials in every tracking.

    Args:
        database: what is played and searched.
        trials: what is asked for.
        trackings: of "time" and "velocity".
        threads: 0 for all cores; the logs do not depend on it.
        progress: called with the number of runs done and of all runs.
    """
    profiles = [profile_of(trial) for trial in trials]
    runs = len(trials) * len(trackings)
    logs: dict[Tracking, TrialLog] = {}
    for tracking in trackings:
        before = len(trials) * len(logs)
        logs[tracking] = run_trials(
            database,
            profiles,
            tracking=tracking,
            threads=threads,
            progress=lambda done, of, before=before: progress(before + done, runs),  # type: ignore[misc]
        )
    return Simulation(database, tuple(trials), logs)


def log_of(log: TrialLog) -> Log:
    """The log of trials in the form that is measured."""
    columns: dict[str, Any] = {name: getattr(log, name) for name in _COLUMNS}
    return Log.of(columns, log.rate)


def frames_of(database: Database) -> Frames:
    """The frames of a database in the form that is measured."""
    return Frames(
        clip_names=database.clip_names,
        mirrored=database.mirrored,
        clip=database.clips,
        frame=database.frames,
        seconds=database.seconds,
        displacement=database.displacements.astype(np.float64),
        turn=database.turns.astype(np.float64),
        rate=database.rate,
    )


def profile_of(trial: Trial) -> Profile:
    """A trial as the core runs it."""
    return Profile(
        tuple(
            Segment(
                segment.seconds,
                segment.speed,
                float(np.radians(segment.turn_rate_deg)),
                float(np.radians(segment.drift_deg)),
            )
            for segment in trial.segments
        ),
        trial.recorded_from,
    )
