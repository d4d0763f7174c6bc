"""What became of some runs: what they showed, what they needed, and how well they did.

A run is a trial in one tracking; run ``k * T + i`` is trial ``i`` of the ``k``-th tracking, as in the
evaluation's table of trials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.regions import Limits
from gmr.evaluation.scenario import Trial
from gmr.evaluation.simulation import Simulation, log_of
from gmr.evaluation.trials import facing_error_deg, speed_error_share
from gmr.matching.database import Database
from gmr.matching.trial import Status, TrialLog

__all__ = ["Outcomes", "Score", "joined", "needed_rows", "outcomes_of", "same_bits"]

LIMITS = Limits()


@dataclass(frozen=True, slots=True)
class Score:
    """How well a dataset does in R runs.

    Attributes:
        offset: metres, mean of the mean distance from the path, over the runs of constant speed and turn rate
            that are steered along a timed path, as on the report's map (where there is none: over all that
            are timed); NaN where none is.
        held: how many runs do what they are asked, as the verdict has it.
        runs: R.
    """

    offset: float
    held: int
    runs: int

    def worse_than(self, other: Score) -> float:
        """How much worse this is, in metres: the offset's growth, and half a metre, the offset within which a
        trial holds, for each run that no longer holds, shared among all runs."""
        lost = LIMITS.offset * (other.held - self.held) / max(self.runs, 1)
        return lost + (0.0 if np.isnan(self.offset) else self.offset - other.offset)


@dataclass(frozen=True, slots=True, eq=False)
class Outcomes:
    """R runs of at most S steps.

    Attributes:
        rows: (R, S) int32, the row shown at each step, -1 after the end.
        landed: (R, S) whether the row was found by a search, at the start or by a jump.
        offset: (R,) mean distance from the timed path, metres; NaN where there is none to keep to.
        steady: (R,) whether one speed and one turn rate are asked for throughout.
        held: (R,) whether the run does what it is asked.
    """

    rows: NDArray[np.int32]
    landed: NDArray[np.bool_]
    offset: NDArray[np.float64]
    steady: NDArray[np.bool_]
    held: NDArray[np.bool_]

    @property
    def score(self) -> Score:
        """How well they do together."""
        timed = ~np.isnan(self.offset)
        counted = timed & self.steady if (timed & self.steady).any() else timed
        offset = float(self.offset[counted].mean()) if counted.any() else float("nan")
        return Score(offset, int(self.held.sum()), len(self.held))

    def put(self, runs: NDArray[np.intp], other: Outcomes) -> Outcomes:
        """These with some runs, by their numbers, replaced by others."""
        changed: dict[str, NDArray[Any]] = {}
        for name in Outcomes.__dataclass_fields__:
            values = getattr(self, name).copy()
            if values.ndim == 2:
                values[runs, : getattr(other, name).shape[1]] = getattr(other, name)
            else:
                values[runs] = getattr(other, name)
            changed[name] = values
        return replace(self, **changed)


def outcomes_of(log: TrialLog, trials: Sequence[Trial]) -> Outcomes:
    """What became of the trials of a log."""
    seen = log_of(log)
    share = speed_error_share(trials, seen)
    turn = metrics.turn_rate(seen)
    turn_error = np.degrees(metrics.static_error(turn, seen.ref_turn_rate, seen.moving))
    timed = log.tracking == "time"
    offset = np.full(len(log), np.nan)
    if timed:
        offset = metrics.mean_where(metrics.offset(seen), seen.recorded)
    ahead = np.array([trial.drift_deg == 0 for trial in trials], bool)
    held = LIMITS.held(share, turn_error, offset, timed, np.where(ahead, 0.0, facing_error_deg(seen)))
    landed = (log.status == Status.JUMPED) | (log.status == Status.FORCED_AT_END)
    if landed.shape[1]:
        landed[:, 0] = True
    steady = np.array([trial.scenario == "constant" for trial in trials], bool)
    return Outcomes(log.row.astype(np.int32), landed, offset, steady, held)


def joined(parts: Sequence[Outcomes]) -> Outcomes:
    """Runs one after the other; shorter ones are filled up."""
    steps = max(part.rows.shape[1] for part in parts)

    def filled(values: NDArray[Any], fill: Any) -> NDArray[Any]:
        missing = np.full((len(values), steps - values.shape[1]), fill, values.dtype)
        return np.concatenate([values, missing], axis=1)

    return Outcomes(
        rows=np.concatenate([filled(part.rows, -1) for part in parts]),
        landed=np.concatenate([filled(part.landed, False) for part in parts]),
        offset=np.concatenate([part.offset for part in parts]),
        steady=np.concatenate([part.steady for part in parts]),
        held=np.concatenate([part.held for part in parts]),
    )


def needed_rows(database: Database, outcomes: Outcomes) -> NDArray[np.bool_]:
    """(R, N) the rows without which a run could not be the same.

    They are the rows shown; the two after each, for the one that continues it is what a search weighs the
    others against, and the one after that tells that the clip goes on; and all that the features of a row
    found by a search look at, else it could not be found. Whatever else goes, every search finds what it
    found: the best of many is the best of any part of them that holds it, ties to the lowest row included.
    """
    past, future = database.reach
    last = np.array([end - 1 for _, end in database.core.clip_ranges], np.int64)
    needed = np.zeros((len(outcomes.rows), len(database)), bool)
    for run, (rows, landed) in enumerate(zip(outcomes.rows, outcomes.landed, strict=True)):
        shown = np.unique(rows[rows >= 0]).astype(np.int64)
        ends = last[database.clips[shown]]
        for ahead in (0, 1, 2):
            needed[run, np.minimum(shown + ahead, ends)] = True
        found = np.unique(rows[landed & (rows >= 0)]).astype(np.int64)
        for offset in range(-past, future + 1):
            needed[run, found + offset] = True
    return needed


def same_bits(simulation: Simulation, logs: Sequence[TrialLog]) -> NDArray[np.bool_]:
    """(R,) whether each run of other logs, one a tracking, is that of a simulation, bit by bit."""
    return np.concatenate(
        [_same(before, after) for before, after in zip(simulation.logs.values(), logs, strict=True)]
    )


_COMPARED = (
    *("x", "z", "heading", "ref_x", "ref_z", "ref_heading", "ref_speed", "ref_turn_rate"),
    "ref_drift",
    *("row", "status", "cost_pose", "cost_trajectory", "discontinuity"),
)


def _same(before: TrialLog, after: TrialLog) -> NDArray[np.bool_]:
    same = (before.lengths == after.lengths) & (before.recorded_from == after.recorded_from)
    for name in _COMPARED:
        one, other = (np.ascontiguousarray(getattr(log, name)) for log in (before, after))
        same &= (one.view(f"u{one.itemsize}") == other.view(f"u{other.itemsize}")).all(axis=1)
    return np.asarray(same)
