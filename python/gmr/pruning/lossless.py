"""What can go from a dataset without a bit of any trial changing, and the proof.

A frame is needed when a trial shows it, when it tells what comes after one that is shown, or when the
features of a needed frame look at it: a second ahead, and as far around as the simulation root is smoothed.
All others can go: a search that found its frame among all finds it among fewer, and ties still go to the
lowest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.evaluation.elsewhere import Runs
from gmr.evaluation.result import Evaluation
from gmr.evaluation.simulation import Simulation
from gmr.matching.database import Database
from gmr.matching.root import HEADING_WINDOW, POSITION_WINDOW
from gmr.pruning.outcomes import Outcomes, same_bits
from gmr.pruning.part import Part, Range, ranges_of, recordings_of
from gmr.pruning.rerun import Again, logs_on

__all__ = ["lossless", "lossless_part", "prove", "simulation_of"]

LEAST_GAP = 0.5
"""Seconds of frames that nobody needs, at least, for a cut to be worth one more file."""


def lossless(evaluation: Evaluation, *, threads: int = 0) -> Part:
    """What must be left of a dataset for every trial of an evaluation to stay the same, bit by bit.

    It is proved on the spot: every trial is run again on what is left, and every step of it is compared.

    Args:
        evaluation: as :func:`gmr.evaluate` gives it.
        threads: 0 for all cores; the result does not depend on it.

    Returns:
        For every recording the ranges that are left: the frames that some trial needs, with those around them
        from which their features are measured, so that files cut there give the same features. Recordings
        that no trial needs are gone, and so are those that another one equals.

    Raises:
        GmrError: the evaluation was loaded and has no simulation; or a trial did change, which is a fault of
            gmr.
    """
    from gmr.pruning.outcomes import joined, outcomes_of

    simulation = simulation_of(evaluation)
    outcomes = joined([outcomes_of(log, simulation.trials) for log in simulation.logs.values()])
    left = lossless_part(simulation.database, outcomes)
    prove(simulation, left, threads)
    return left


def simulation_of(evaluation: Evaluation) -> Simulation:
    """The simulation behind an evaluation.

    Raises:
        GmrError: it has none.
    """
    if evaluation.simulation is None:
        raise GmrError(
            f"the evaluation of {evaluation.dataset} was loaded without its trials; evaluate the clips again"
        )
    return evaluation.simulation


def lossless_part(database: Database, outcomes: Outcomes) -> Part:
    """The part that :func:`lossless` gives, not yet proved."""
    shown = np.unique(outcomes.rows[outcomes.rows >= 0]).astype(np.int64)
    past, future = database.reach
    rim = 1 + round(max(HEADING_WINDOW, POSITION_WINDOW) * database.rate) // 2
    needed = np.zeros(len(database), bool)
    needed[shown] = True
    gap = round(LEAST_GAP * database.rate)
    ranges: dict[str, tuple[Range, ...]] = dict.fromkeys(database.duplicates, ())
    for recording in recordings_of(database):
        own = np.zeros(recording.frames, bool)
        for start in recording.starts:
            own |= needed[start : start + recording.frames]
        ranges[recording.name] = ranges_of(_around(own, past + rim, future + 2 + rim), gap)
        ranges[recording.name] = tuple(
            (first if first >= gap else 0, end if recording.frames - end >= gap else recording.frames)
            for first, end in ranges[recording.name]
        )
    return Part(database.rate, ranges)


def _around(rows: NDArray[np.bool_], before: int, after: int) -> NDArray[np.bool_]:
    """Those rows and so many before and after each."""
    change = np.zeros(len(rows) + 1, np.int64)
    at = np.flatnonzero(rows)
    np.add.at(change, np.maximum(at - before, 0), 1)
    np.add.at(change, np.minimum(at + after + 1, len(rows)), -1)
    return np.asarray(np.cumsum(change[:-1]) > 0)


def prove(simulation: Simulation, part: Part, threads: int = 0) -> None:
    """Run every trial on a part, and compare every bit of every step.

    Raises:
        GmrError: a run is another one.
    """
    asked = Runs.of(simulation)
    runs = np.arange(len(asked.profiles) * len(asked.trackings))
    logs = logs_on(asked, Again(part.rows(simulation.database), runs), threads)
    same = np.zeros(len(runs), bool) if logs is None else same_bits(simulation, logs)
    if not same.all():
        raise GmrError(
            f"{int((~same).sum())} of {len(runs)} trials change without the frames that none of them needs; "
            "this is a fault of gmr: please report it with the dataset"
        )
