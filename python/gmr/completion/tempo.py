"""The features of clips played at another pace, from those at their own, without reading anything again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.matching.database import Database

__all__ = ["Rows", "rows_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """R frames of a clip that can be found.

    Attributes:
        features: (R, D) float32, scaled as the database's.
        seconds: how long the clip lasts at this pace.
    """

    features: NDArray[np.float32]
    seconds: float


def rows_of(database: Database, clip: int, factor: float = 1.0) -> Rows:
    """The frames of a clip played ``factor`` times as fast.

    A pose stays, a velocity is ``factor`` times what it was, and the path ahead reaches ``factor`` times as
    far into the clip; between frames it is interpolated. Built anew at that pace, a clip has these
    features but for the smoothing of its root.
    """
    rows = database.clip_rows(clip)
    features, candidate = database.features[rows], database.candidates[rows]
    seconds = (rows.stop - rows.start - 1) / database.rate / factor
    if factor == 1.0:
        return Rows(np.ascontiguousarray(features[candidate]), seconds)
    scale = database.normalization
    raw = features.astype(np.float64) * scale.scale + scale.offset
    slices = database.schema.slices()
    last, frame = rows.stop - rows.start - 1, np.arange(rows.stop - rows.start)
    reach = np.ones(len(raw), bool)
    for group in database.schema.groups:
        columns = slices[group.name]
        if group.measure == "velocity":
            raw[:, columns] *= factor
        if group.joint is not None:
            continue
        for number, time in enumerate(group.times):
            at = frame + time * database.rate * factor
            reach &= (at >= 0) & (at <= last)
            first = columns.start + 2 * number
            raw[:, first : first + 2] = _seen(database, rows, np.clip(at, 0, last), group.measure)
    scaled = ((raw - scale.offset) / scale.scale).astype(np.float32)
    return Rows(np.ascontiguousarray(scaled[reach]), seconds)


def _seen(database: Database, rows: slice, at: NDArray[np.float64], measure: str) -> NDArray[np.float64]:
    """(R, 2) the root at a (fractional) frame of the clip, seen from each frame: its place or its facing."""
    heading, ground = database.headings[rows], database.ground[rows]
    frame = np.arange(len(heading))
    turn = np.interp(at, frame, heading) - heading
    if measure == "root_facing":
        return np.stack([np.sin(turn), np.cos(turn)], axis=1)
    east, north = (np.interp(at, frame, ground[:, axis]) - ground[:, axis] for axis in (0, 1))
    cosine, sine = np.cos(heading), np.sin(heading)
    return np.stack([east * cosine - north * sine, east * sine + north * cosine], axis=1)
