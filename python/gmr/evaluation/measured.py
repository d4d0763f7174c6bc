"""All tables of a simulation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from gmr.evaluation.coverage import coverage_table
from gmr.evaluation.coverage_symmetry import coverage_symmetry
from gmr.evaluation.distributions import error_bins_table, error_fits_table
from gmr.evaluation.footing import Ground, Shown, ground_of, shown
from gmr.evaluation.frames import Frames
from gmr.evaluation.graph import graph_table
from gmr.evaluation.log import Log
from gmr.evaluation.paths import paths_table
from gmr.evaluation.pose_coverage import pose_coverage, poses_of
from gmr.evaluation.result import Tables
from gmr.evaluation.scenario import Trial
from gmr.evaluation.seen import seen_at_transitions, seen_in_clips, seen_in_trials
from gmr.evaluation.segments import segments_table
from gmr.evaluation.simulation import Simulation, log_of
from gmr.evaluation.timeline import timeline_table
from gmr.evaluation.transitions import Transitions, transitions_of, transitions_table
from gmr.evaluation.trials import trials_table
from gmr.evaluation.usage import clips_table, play_counts, usage_table
from gmr.table import Table

__all__ = ["measured"]


def measured(dataset: str, simulation: Simulation, frames: Frames, threads: int = 0) -> Tables:
    """Measure every trial, scenario by scenario.

    Args:
        dataset: its name.
        simulation: the trials.
        frames: of the simulation's database.
        threads: 0 for all cores; the tables do not depend on it.
    """
    ground = ground_of(simulation.database)
    sets = list(_sets(simulation, frames, ground, threads))
    counts = [play_counts(part.log, frames) for part in sets]
    coverage = coverage_table(dataset, frames)
    return Tables(
        trials=Table.joined(
            [
                Table(
                    dict(
                        trials_table(dataset, part.trials, part.tracking, part.log, part.transitions, frames)
                    )
                    | seen_in_trials(part.log, part.transitions, part.shown)
                )
                for part in sets
            ]
        ),
        coverage=coverage,
        usage=Table.joined(
            [
                usage_table(dataset, part.scenario, part.tracking, played, frames)
                for part, played in zip(sets, counts, strict=True)
            ]
        ),
        transitions=Table.joined(
            [
                transitions_table(
                    dataset,
                    part.scenario,
                    part.tracking,
                    part.transitions,
                    frames,
                    seen_at_transitions(part.log, part.transitions, part.shown),
                )
                for part in sets
            ]
        ),
        clips=Table(
            dict(clips_table(dataset, np.sum(counts, axis=0), frames)) | seen_in_clips(ground, frames)
        ),
        pose_coverage=pose_coverage(coverage, frames, poses_of(simulation.database)),
        coverage_symmetry=coverage_symmetry(dataset, coverage),
        segments=Table.joined(
            [segments_table(dataset, part.trials, part.tracking, part.log) for part in sets]
        ),
        timeline=Table.joined(
            [timeline_table(dataset, part.trials, part.tracking, part.log, part.transitions) for part in sets]
        ),
        error_bins=Table.joined(
            [error_bins_table(dataset, part.trials, part.tracking, part.log) for part in sets]
        ),
        error_fits=Table.joined(
            [error_fits_table(dataset, part.trials, part.tracking, part.log) for part in sets]
        ),
        graph=Table.joined(
            [graph_table(dataset, part.scenario, part.tracking, part.transitions, frames) for part in sets]
        ),
        paths=Table.joined([paths_table(dataset, part.trials, part.tracking, part.log) for part in sets]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Set:
    """The trials of one tracking and one scenario."""

    tracking: str
    scenario: str
    trials: tuple[Trial, ...]
    log: Log
    transitions: Transitions
    shown: Shown


def _sets(simulation: Simulation, frames: Frames, ground: Ground, threads: int) -> Iterator[_Set]:
    """In the order of the rows of the table of trials."""
    scenario = np.array([trial.scenario for trial in simulation.trials])
    for tracking, trial_log in simulation.logs.items():
        log = log_of(trial_log)
        seen = shown(simulation.database, ground, trial_log, threads)
        for name in dict.fromkeys(scenario.tolist()):
            chosen = np.flatnonzero(scenario == name)
            part = log.take(chosen)
            trials = tuple(simulation.trials[place] for place in chosen.tolist())
            yield _Set(tracking, name, trials, part, transitions_of(part, frames), seen.take(chosen))
