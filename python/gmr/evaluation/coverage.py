"""Which speeds and turn rates the clips themselves contain, whatever a controller makes of them.

Source: the paper's section 3.3.3 and its Figures 1 and 6: means over a one-second window that slides through
every clip. Windows never reach from one clip into the next.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.coverage_cells import Bins, cells_of
from gmr.evaluation.frames import Frames
from gmr.table import Table

__all__ = ["Bins", "Density", "coverage_table", "density", "symmetry"]


def coverage_table(dataset: str, frames: Frames) -> Table:
    """Speed and turn rate of every window of one second.

    A window is centred on a frame, reaches half a second to both sides, and moves on by one frame; a clip
    shorter than that gives a single window, its whole length. A clip of one frame gives none.

    Returns:
        One row a window. ``speed`` is the length of the path per second, ``turn_rate_deg`` the net turn per
        second; ``forward_speed`` and ``left_speed`` are the parts of the movement along and across the facing
        direction, which tell walking backwards from walking forwards; ``weight`` is the time the row stands
        for: the weights of a clip's rows add up to the clip's duration.
    """
    centre, first, last = _windows(frames)
    followed = frames.has_next
    seconds = (last - first) / frames.rate
    count = np.bincount(frames.clip[centre], minlength=len(frames.clip_names))
    duration = np.maximum(np.diff(frames.starts) - 1, 0) / frames.rate
    clip = frames.clip[centre]

    def mean(per_step: NDArray[np.float64]) -> NDArray[np.float64]:
        total = np.concatenate([[0.0], np.cumsum(np.where(followed, per_step, 0.0))])
        return np.asarray((total[last] - total[first]) / seconds)

    return Table(
        {
            "dataset": np.full(len(centre), dataset, object),
            "clip": frames.names[centre],
            "frame": frames.frame[centre],
            "speed": mean(np.hypot(frames.displacement[:, 0], frames.displacement[:, 1])),
            "turn_rate_deg": np.degrees(mean(frames.turn)),
            "seconds": frames.seconds[centre],
            "forward_speed": mean(frames.displacement[:, 1]),
            "left_speed": mean(frames.displacement[:, 0]),
            "weight": duration[clip] / count[clip],
        }
    )


def _windows(frames: Frames) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Rows of the middle, first and last frame of every window."""
    half = round(frames.rate / 2)
    row = np.arange(len(frames))
    starts = frames.starts
    start, end = starts[frames.clip], starts[frames.clip + 1] - 1
    short = end - start < 2 * half
    whole = ~short & (row - half >= start) & (row + half <= end)
    single = short & (end > start) & (row == (start + end) // 2)
    centre = row[whole | single]
    first = np.where(short[centre], start[centre], centre - half)
    last = np.where(short[centre], end[centre], centre + half)
    return centre, first, last


@dataclass(frozen=True, slots=True)
class Density:
    """A coverage map of V speeds by W turn rates.

    Attributes:
        speed_edges: (V + 1,) m/s.
        turn_rate_edges_deg: (W + 1,) degrees/s, symmetrical about 0.
        seconds: (V, W) of the dataset in each cell.
        clips: (V, W) number of clips in each cell.
        blurred: (V, W) the seconds, smoothed; what the blur carries over the edge of the map is lost.
    """

    speed_edges: NDArray[np.float64]
    turn_rate_edges_deg: NDArray[np.float64]
    seconds: NDArray[np.float64]
    clips: NDArray[np.int64]
    blurred: NDArray[np.float64]


def density(coverage: Table, bins: Bins | None = None) -> Density:
    """Count the windows of a coverage table into cells.

    Args:
        coverage: from :func:`coverage_table`.
        bins: the cells and the blur.
    """
    bins = bins or Bins()
    cells = cells_of(coverage, bins)
    size = int(np.prod(cells.shape))
    clip, clip_count = _numbered(coverage["clip"])
    present = np.unique(cells.cell * clip_count + clip) // max(clip_count, 1)
    seconds = np.bincount(cells.cell, coverage["weight"], size).astype(np.float64).reshape(cells.shape)
    clips = np.bincount(present, minlength=size).reshape(cells.shape)
    blurred = _blur(_blur(seconds, bins.blur).T, bins.blur).T
    return Density(cells.speed_edges, cells.turn_rate_edges_deg, seconds, clips, blurred)


def _numbered(names: NDArray[np.object_]) -> tuple[NDArray[np.int64], int]:
    """(N,) a number for each name, and how many names there are; quick where names come in runs."""
    if len(names) == 0:
        return np.zeros(0, np.int64), 0
    first = np.flatnonzero(np.concatenate([[True], names[1:] != names[:-1]]))
    number: dict[str, int] = {}
    numbers = [number.setdefault(name, len(number)) for name in names[first].tolist()]
    return np.repeat(numbers, np.diff(first, append=len(names))), len(number)


def symmetry(density: Density) -> float:
    """How alike left and right turns are covered, from 0 to 1.

    Returns:
        1 where every cell has the same seconds on both sides, 0 where the one side has only what the other
        lacks, NaN where nothing turns. The cells about straight ahead do not count.
    """
    middle = density.seconds.shape[1] // 2
    left = density.seconds[:, middle + 1 :]
    right = density.seconds[:, :middle][:, ::-1]
    either = np.maximum(left, right).sum()
    return float(np.minimum(left, right).sum() / either) if either > 0 else float("nan")


def _blur(values: NDArray[np.float64], sigma: float) -> NDArray[np.float64]:
    """Smooth along the first axis by a Gaussian cut off at three standard deviations."""
    if sigma <= 0:
        return values
    reach = int(np.ceil(3 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    padded = np.pad(values, ((reach, reach), (0, 0)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, len(kernel), axis=0)
    return np.asarray(windows @ kernel)
