"""What the character asked for in some trials and what it got: the queries of its searches, made again from
the log.

A query is the pose of the row that would come next, with the path ahead that is wanted; see the core's
controller. Those of a trial's last second look beyond the log and are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.matching.database import Database
from gmr.matching.trial import Status, Tracking, TrialLog

__all__ = ["Queries", "queries_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Queries:
    """Q searches.

    Attributes:
        features: (Q, D) float32, scaled as the database's.
        cost: (Q,) squared distance of the row that was shown.
    """

    features: NDArray[np.float32]
    cost: NDArray[np.float64]

    def some(self, most: int) -> Queries:
        """At most so many of them, evenly spread."""
        if len(self.cost) <= most:
            return self
        chosen = (np.arange(most) * len(self.cost)) // most
        return Queries(self.features[chosen], self.cost[chosen])


def queries_of(
    database: Database, log: TrialLog, trials: NDArray[np.intp], tracking: Tracking | None = None
) -> Queries:
    """The searches of the recorded part of some trials.

    Args:
        database: that the log is of.
        log: the trials.
        trials: (K,) which of them.
        tracking: what the path ahead aims at; as in the trials where left out.
    """
    ahead = round(max(time for group in database.schema.groups for time in group.times) * log.rate)
    features, costs = [], []
    for trial in trials.tolist():
        step = np.arange(log.recorded_from[trial] + 1, log.lengths[trial] - ahead)
        step = step[np.isin(log.status[trial, step], (Status.KEPT, Status.JUMPED))]
        features.append(_asked(database, log, trial, step, tracking or log.tracking))
        costs.append(log.cost_pose[trial, step].astype(np.float64) + log.cost_trajectory[trial, step])
    if not features:
        return Queries(np.zeros((0, database.schema.dims), np.float32), np.zeros(0))
    return Queries(np.concatenate(features), np.concatenate(costs))


def _asked(
    database: Database, log: TrialLog, trial: int, step: NDArray[np.int64], tracking: Tracking
) -> NDArray[np.float32]:
    """(Q, D) the queries at some steps of a trial: the continuing rows' features, with the path wanted."""
    query: NDArray[np.float32] = database.features[log.row[trial, step - 1] + 1].copy()
    scale = database.normalization
    slices = database.schema.slices()
    for group in database.schema.groups:
        if group.joint is not None:
            continue
        for number, time in enumerate(group.times):
            if time <= 0:
                continue
            x, z, turn = _target(log, trial, step, round(time * log.rate), tracking)
            wanted = (np.sin(turn), np.cos(turn)) if group.measure == "root_facing" else (x, z)
            first = slices[group.name].start + 2 * number
            for column, values in enumerate(wanted, start=first):
                query[:, column] = (values.astype(np.float32) - scale.offset[column]) / scale.scale[column]
    return query


def _target(
    log: TrialLog, trial: int, step: NDArray[np.int64], ahead: int, tracking: Tracking
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Where the root should be after so many steps, and how much it should have turned, in its own frame."""
    if tracking == "velocity":
        speed, rate = log.ref_speed[trial, step], log.ref_turn_rate[trial, step]
        turn = rate * ahead / log.rate
        way = speed * ahead / log.rate * np.sinc(turn / 2 / np.pi)
        return way * np.sin(turn / 2), way * np.cos(turn / 2), turn
    heading = log.heading[trial, step]
    east = log.ref_x[trial, step + ahead] - log.x[trial, step]
    north = log.ref_z[trial, step + ahead] - log.z[trial, step]
    cosine, sine = np.cos(heading), np.sin(heading)
    turn = log.ref_heading[trial, step + ahead] - heading
    return east * cosine - north * sine, east * sine + north * cosine, turn
