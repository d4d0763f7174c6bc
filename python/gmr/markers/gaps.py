"""Gaps: runs of frames in which a marker is not seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gmr.markers.recording import Markers

__all__ = ["Gap", "gaps", "runs", "seen"]


@dataclass(frozen=True, slots=True)
class Gap:
    """A run of frames in which a marker is not seen.

    Args:
        marker: its label.
        index: its place among the markers, for labels may repeat.
        first: the first frame without it.
        length: how many frames.
        seconds: how long that is.
        at_edge: whether the recording begins or ends with it, so that nothing can be filled in.
    """

    marker: str
    index: int
    first: int
    length: int
    seconds: float
    at_edge: bool


def gaps(markers: Markers) -> tuple[Gap, ...]:
    """All gaps, marker by marker, in time order."""
    found = []
    for index, label in enumerate(markers.labels):
        for first, length in runs(~markers.visible[:, index]):
            at_edge = first == 0 or first + length == markers.frame_count
            found.append(Gap(label, index, first, length, length * markers.frame_time, at_edge))
    return tuple(found)


def seen(places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(...) whether all three coordinates of (..., 3) places are there."""
    return np.asarray(np.isfinite(places).all(axis=-1), np.bool_)


def runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The first index and the length of every run of True in a 1-D mask."""
    padded = np.zeros(len(mask) + 2, np.int8)
    padded[1:-1] = mask
    steps = np.diff(padded)
    starts, stops = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1)
    return list(zip(starts.tolist(), (stops - starts).tolist(), strict=True))
