"""One trial to look at: the one that went worst."""

from __future__ import annotations

import numpy as np

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import FORCED, JUMPED
from gmr.evaluation.metrics import offset
from gmr.evaluation.regions import judged
from gmr.evaluation.result import Replay
from gmr.evaluation.simulation import Simulation, log_of
from gmr.matching.trial import trial_positions
from gmr.table import Table

__all__ = ["replay_of", "worst_trial"]


def worst_trial(trials: Table) -> int:
    """Row of the trial farthest from its path on the average, else from its speed (no path tracked).

    It is one of those that the verdict judges: see :func:`gmr.evaluation.regions.judged`.
    """
    rows = np.flatnonzero(judged(trials))
    column = "offset_mean" if trials["tracking"][rows[0]] == "time" else "speed_error_share"
    return int(rows[np.argmax(np.abs(trials[column][rows]))])


def replay_of(simulation: Simulation, frames: Frames, row_of_trial: int) -> Replay:
    """One trial from its start to its end, as it was played.

    Args:
        simulation: the trials.
        frames: of its database.
        row_of_trial: the trial's row in the evaluation's table of trials.
    """
    trial, trial_log, index = simulation[row_of_trial]
    database, log = simulation.database, log_of(trial_log)
    steps = slice(0, int(trial_log.lengths[index]))
    row = log.row[index, steps]
    return Replay(
        positions=trial_positions(database, trial_log, index),
        parents=database.skeleton.parents.astype(np.int32),
        joint_names=database.skeleton.names,
        path=np.stack([log.x[index, steps], log.z[index, steps]], axis=1),
        reference=np.stack([log.ref_x[index, steps], log.ref_z[index, steps]], axis=1),
        offset=offset(log)[index, steps],
        clip=frames.clip[row],
        frame=frames.frame[row],
        jumped=np.isin(log.status[index, steps], (JUMPED, FORCED)),
        clip_names=frames.clip_names,
        rate=frames.rate,
        speed=trial.speed,
        turn_rate_deg=trial.turn_rate_deg,
        tracking=trial_log.tracking,
        scenario=trial.scenario,
    )
