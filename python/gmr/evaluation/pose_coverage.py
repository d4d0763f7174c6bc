"""Whether the clips of a movement can be blended: how near their poses come to each other, cell by cell.

Speed and turn rate alone do not tell a cell whose clips repeat each other from one whose clips, though they
go as fast and turn as much, never come near each other in pose: there a character cannot leave the clip that
it plays.

Source: the future work of the paper: coverage that also looks at the similarity of poses.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.evaluation.coverage_cells import Bins, Cells, cells_of
from gmr.evaluation.frames import Frames
from gmr.evaluation.pose_clusters import clustered, entropy
from gmr.matching.database import Database
from gmr.table import Table

__all__ = [
    *("ALONE", "BLENDABLE", "REDUNDANT", "THIN", "UNBLENDABLE"),
    *("BlendLimits", "Poses", "kinds_of", "pose_coverage", "poses_of"),
]

THIN: Final = "thin"
"""Too few seconds to judge."""
ALONE: Final = "alone"
"""No other clip goes like this, or nearly so."""
REDUNDANT: Final = "dense and redundant"
"""Nearly every pose is in another clip, too."""
BLENDABLE: Final = "dense and blendable"
"""Other clips come near enough to jump to."""
UNBLENDABLE: Final = "dense but unblendable"
"""Other clips go like this, but none in a pose like these."""


@dataclass(frozen=True, slots=True)
class BlendLimits:
    """What the cells are judged by.

    Attributes:
        dense: seconds from which on a cell is judged.
        redundant: metres to the nearest pose up to which, on average, a cell repeats other clips.
        unblendable: metres from which on, on average, other clips are too far away to jump to unseen.
    """

    dense: float = 1.0
    redundant: float = 0.02
    unblendable: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """The poses of N frames.

    Attributes:
        features: (N, P) float32, what a search compares of a pose: scaled positions and velocities.
        positions: (N, J, 3) float32, the joints from the hips on, seen from the simulation root, metres.
        recording: (N,) which recording a frame is of, ascending; a mirrored copy is of its original's.
    """

    features: NDArray[np.float32]
    positions: NDArray[np.float32]
    recording: NDArray[np.int64]


def poses_of(database: Database) -> Poses:
    """The poses of a database; what lies above the hips (a root on the ground) is no part of a pose."""
    return Poses(
        np.ascontiguousarray(database.features[:, ~database.is_trajectory]),
        database.positions[:, _from_hips_on(database.skeleton.parents, database.joints["hips"])],
        (np.cumsum(~database.mirrored) - 1)[database.clips],
    )


def pose_coverage(
    coverage: Table, frames: Frames, poses: Poses, bins: Bins | None = None, limits: BlendLimits | None = None
) -> Table:
    """How near the poses of each cell of the coverage map are to those of other clips, and how varied.

    For the pose in the middle of every one-second window of a cell, the nearest pose of another recording is
    looked for among the windows of the cell and of its 8 neighbours: exactly, by the pose features that the
    character searches by, without the path ahead. Neither the clip itself nor its mirrored copy counts.

    Args:
        coverage: the windows, from :func:`gmr.evaluation.coverage.coverage_table`.
        frames, poses: of the N frames that the windows were taken from.
        bins: the cells; their blur is of no use here.
        limits: what they are judged by.

    Returns:
        One row a cell that is not empty, by speed, then turn rate (its middle): ``seconds``; ``clips``,
        recordings in it; ``nearest_mean`` and ``nearest_p95``, metres, the mean distance of the joints
        between each pose and the nearest one found; ``entropy``, bits, of the shares of its time that fall
        to each of 32 clusters of all poses: 0 for one pose over and over, at most 5;
        ``feature_distance_mean``, the mean distance in scaled features; and ``kind``. Where no other
        recording is about, distances are NaN.
    """
    windows = cells_of(coverage, bins or Bins())
    row = _rows(coverage, frames)
    features = np.ascontiguousarray(poses.features[row])
    found, cost = _nearest_of_others(windows, features, poses.recording[row])
    metres = _joint_distance(poses.positions, row, np.where(found < 0, -1, row[found]))
    cluster = clustered(features)
    cells = list(windows)
    weight = coverage["weight"]
    table = {
        "dataset": np.full(len(cells), coverage["dataset"][0] if len(coverage) else "", object),
        "speed": windows.speed,
        "turn_rate_deg": windows.turn_rate_deg,
        "seconds": np.array([weight[cell].sum() for cell in cells]),
        "clips": np.array([len(np.unique(poses.recording[row[cell]])) for cell in cells], np.int64),
        "nearest_mean": np.array([_mean(metres[cell]) for cell in cells]),
        "nearest_p95": np.array([np.percentile(metres[cell], 95) for cell in cells]),
        "entropy": np.array([entropy(cluster[cell], weight[cell]) for cell in cells]),
        "feature_distance_mean": np.array([_mean(np.sqrt(cost[cell])) for cell in cells]),
    }
    return Table(
        {**table, "kind": kinds_of(table["seconds"], table["nearest_mean"], limits or BlendLimits())}
    )


def kinds_of(
    seconds: NDArray[np.float64], nearest: NDArray[np.float64], limits: BlendLimits
) -> NDArray[np.object_]:
    """What a cell of so many seconds and so many metres to the nearest pose of another clip is."""
    judged: NDArray[np.int64] = np.select(
        [
            seconds < limits.dense,
            np.isnan(nearest),
            nearest <= limits.redundant,
            nearest < limits.unblendable,
        ],
        [0, 1, 2, 3],
        4,
    )
    return np.take(np.array([THIN, ALONE, REDUNDANT, BLENDABLE, UNBLENDABLE], object), judged)


def _rows(coverage: Table, frames: Frames) -> NDArray[np.int64]:
    """The frame in the middle of every window."""
    start = dict(zip(frames.clip_names, frames.starts.tolist(), strict=False))
    clip = np.array([start[name] for name in coverage["clip"].tolist()], np.int64)
    return np.asarray(clip + coverage["frame"], np.int64)


def _nearest_of_others(
    cells: Cells, features: NDArray[np.float32], recording: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """(M,) window of another recording that is nearest to each of M windows, -1 where there is none, and the
    squared distance, NaN where there is none."""
    found, cost = np.full(len(features), -1, np.int64), np.full(len(features), np.nan)
    for cell, about in cells.with_neighbours():
        own = recording[about]
        exclude = np.stack([np.searchsorted(own, recording[cell], side) for side in _ENDS], axis=1)
        index = _core.Index(features[about])
        near, place = index.search(features[cell], 1, exclude=exclude.astype(np.uint32), threads=1)
        other = place[:, 0] >= 0
        found[cell[other]], cost[cell[other]] = about[place[other, 0]], near[other, 0]
    return found, cost


_ENDS: Final = ("left", "right")


def _joint_distance(
    positions: NDArray[np.float32], row: NDArray[np.int64], other: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(M,) mean distance of the joints between two rows, metres; NaN where the other is -1."""
    distance = np.full(len(row), np.nan)
    known = np.flatnonzero(other >= 0)
    for part in _parts(known):
        apart = positions[row[part]].astype(np.float64) - positions[other[part]]
        distance[part] = np.sqrt((apart**2).sum(axis=2)).mean(axis=1)
    return distance


def _parts(rows: NDArray[np.int64], most: int = 4096) -> Iterator[NDArray[np.int64]]:
    """Few enough at a time to stay in the cache."""
    for start in range(0, len(rows), most):
        yield rows[start : start + most]


def _mean(values: NDArray[np.float64]) -> float:
    """NaN where one value is."""
    return float(values.mean())


def _from_hips_on(parents: NDArray[np.int32], hips: int) -> NDArray[np.intp]:
    """The hips and all joints below them; parents come before their children."""
    below = np.zeros(len(parents), bool)
    for joint, parent in enumerate(parents.tolist()):
        below[joint] = joint == hips or (parent >= 0 and below[parent])
    return np.flatnonzero(below)
