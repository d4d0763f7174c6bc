"""Feature rows of real motion in any number, and queries on them: near the data, and far from it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr.bench.inputs import data_folder
from gmr.demo import demo_folder
from gmr.matching import Database
from gmr.motion import Motion

__all__ = ["FeatureRows", "dense_rows", "feature_rows", "hard_queries", "near_queries"]

Floats = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class FeatureRows:
    """Rows of a motion database."""

    features: Floats
    """(N, D), clip after clip."""
    is_trajectory: NDArray[np.bool_]
    """(D,) which numbers tell the future; the others tell the pose."""
    source: str
    """The set that they were made of."""


def _motions() -> tuple[dict[str, Motion], str]:
    folder = data_folder("locomotion")
    return gmr.read_folder(folder or demo_folder()), "locomotion" if folder else "shipped clips"


@cache
def _real(rate: float = 60.0) -> tuple[FeatureRows, NDArray[np.int32]]:
    """Candidate rows of the locomotion set below GMR_DATA, else of the shipped clips, and their clips."""
    motions, name = _motions()
    database = Database.build(motions, mirror=True, rate=rate)
    found = database.candidates
    source = name if rate == 60.0 else f"{rate:.0f} fps"
    return FeatureRows(database.features[found], database.is_trajectory, source), database.clips[found]


@cache
def feature_rows(count: int) -> FeatureRows:
    """So many rows: the first of the real ones, then further bodies at further instants.

    A further body is the whole set once more, each row between its frame and the next of the clip by the
    same random fraction, each column scaled by a random factor of 0.9 to 1.1: as dense and as curved as the
    real rows, and nowhere equal to them. Repeating or jittering rows would give an easier or a shapeless set.
    """
    real, clips = _real()
    rng = np.random.default_rng(1)
    followed = np.flatnonzero(clips[1:] == clips[:-1])
    parts, made = [real.features], len(real.features)
    while made < count:
        fraction = rng.random()
        between = (1 - fraction) * real.features[followed] + fraction * real.features[followed + 1]
        parts.append((between * rng.uniform(0.9, 1.1, real.features.shape[1])).astype(np.float32))
        made += len(followed)
    features = np.ascontiguousarray(np.concatenate(parts)[:count])
    return FeatureRows(features, real.is_trajectory, real.source)


def dense_rows(count: int) -> FeatureRows:
    """About so many rows, closer together: the real clips at a higher frame rate, at most 1,000 fps."""
    sixty, _ = _real()
    rows, _ = _real(min(1000.0, round(60.0 * count / len(sixty.features))))
    return rows


def near_queries(rows: FeatureRows, count: int) -> Floats:
    """What a controller asks: the pose of a row, the future of one up to ten frames away, a little noise."""
    rng = np.random.default_rng(2)
    poses = rng.integers(0, len(rows.features), count)
    futures = np.clip(poses + rng.integers(-10, 11, count), 0, len(rows.features) - 1)
    noise = rng.normal(0, 0.05, (count, rows.features.shape[1]))
    return np.ascontiguousarray(_mixed(rows, poses, futures) + noise, np.float32)


def hard_queries(rows: FeatureRows, count: int) -> Floats:
    """The pose of one row and the future of any other: mostly what no body does, far from all rows."""
    rng = np.random.default_rng(3)
    poses, futures = rng.integers(0, len(rows.features), (2, count))
    return np.ascontiguousarray(_mixed(rows, poses, futures))


def _mixed(rows: FeatureRows, poses: NDArray[np.int64], futures: NDArray[np.int64]) -> Floats:
    return np.where(rows.is_trajectory, rows.features[futures], rows.features[poses])
