"""Every trial as it was played, to be drawn: the rows shown one after the other, and their poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import FORCED, JUMPED
from gmr.evaluation.scenario import Trial
from gmr.evaluation.simulation import Simulation
from gmr.matching.trial import TrialLog

__all__ = ["PlayedTrial", "Replays", "replays_of"]


@dataclass(frozen=True, slots=True, eq=False)
class PlayedTrial:
    """One trial of T steps, from its start to its end.

    Attributes:
        trial: what was asked for.
        tracking: "time" or "velocity".
        row: (T,) row of the frame shown.
        jumped: (T,) bool, whether the step was entered by a jump.
        x, z, heading: (T,) the root on the ground, metres and radians.
        ref_x, ref_z: (T,) the planned path at the same time.
    """

    trial: Trial
    tracking: str
    row: NDArray[np.int64]
    jumped: NDArray[np.bool_]
    x: NDArray[np.float64]
    z: NDArray[np.float64]
    heading: NDArray[np.float64]
    ref_x: NDArray[np.float64]
    ref_z: NDArray[np.float64]

    @property
    def offset(self) -> NDArray[np.float64]:
        """(T,) distance from the planned path at the same time, metres."""
        return np.asarray(np.hypot(self.x - self.ref_x, self.z - self.ref_z))


@dataclass(frozen=True, slots=True, eq=False)
class Replays:
    """The trials of an evaluation in the order of its table, and what they were played from.

    Attributes:
        trials: as they were played.
        frames: the N rows of the dataset.
        positions: (N, J, 3) float32, the joints seen from the root of their row: metres, Y up, +Z ahead.
        parents: (J,) int32, index of each joint's parent, -1 for a root.
        joint_names: the J names.
    """

    trials: tuple[PlayedTrial, ...]
    frames: Frames
    positions: NDArray[np.float32]
    parents: NDArray[np.int32]
    joint_names: tuple[str, ...]


def replays_of(simulation: Simulation, frames: Frames) -> Replays:
    """All trials of a simulation, in the order of the table of trials; the arrays are views of the logs."""
    database = simulation.database
    return Replays(
        tuple(
            _played(trial, tracking, log, index)
            for tracking, log in simulation.logs.items()
            for index, trial in enumerate(simulation.trials)
        ),
        frames,
        database.positions,
        database.skeleton.parents.astype(np.int32),
        database.skeleton.names,
    )


def _played(trial: Trial, tracking: str, log: TrialLog, index: int) -> PlayedTrial:
    steps = slice(0, int(log.lengths[index]))
    return PlayedTrial(
        trial,
        tracking,
        log.row[index, steps],
        np.isin(log.status[index, steps], (JUMPED, FORCED)),
        *(values[index, steps] for values in (log.x, log.z, log.heading, log.ref_x, log.ref_z)),
    )
