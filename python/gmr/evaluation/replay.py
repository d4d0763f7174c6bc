"""One trial to look at: the one that went worst."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import FORCED, JUMPED, Log
from gmr.evaluation.metrics import offset
from gmr.evaluation.result import Replay
from gmr.evaluation.scenario import Trial
from gmr.matching.database import Database
from gmr.matching.trial import TrialLog, trial_positions
from gmr.table import Table

__all__ = ["replay_of", "worst_trial"]


def worst_trial(trials: Table) -> int:
    """Index of the trial farthest from its path on the average, else from its speed (no path tracked)."""
    if np.any(trials["tracking"] == "velocity"):
        return int(np.argmax(np.abs(trials["speed_error"]) / trials["speed"]))
    return int(np.argmax(trials["offset_mean"]))


def replay_of(
    database: Database, trial_log: TrialLog, log: Log, frames: Frames, trials: Sequence[Trial], index: int
) -> Replay:
    """The trial number ``index`` from its start to its end, as it was played."""
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
        speed=trials[index].speed,
        turn_rate_deg=trials[index].turn_rate_deg,
        tracking=trial_log.tracking,
    )
