"""How often each frame and each clip was played, those that never were included.

Source: the paper's section 3.3.2 (frame popularity) and its Figure 9.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import Log
from gmr.table import Table

__all__ = ["clips_table", "play_counts", "plays", "usage_table"]


def play_counts(log: Log, frames: Frames) -> NDArray[np.int64]:
    """(N,) at how many recorded steps each frame was played."""
    return np.bincount(log.row[log.moving], minlength=len(frames))


def usage_table(
    dataset: str, scenario: str, tracking: str, counts: NDArray[np.int64], frames: Frames
) -> Table:
    """One row a frame of the dataset, in the order of the clips; ``count`` is 0 where it was never played."""
    return Table(
        {
            "dataset": np.full(len(frames), dataset, object),
            "scenario": np.full(len(frames), scenario, object),
            "clip": frames.names,
            "frame": frames.frame,
            "count": counts,
            "seconds": frames.seconds,
            "tracking": np.full(len(frames), tracking, object),
        }
    )


def plays(usage: Table) -> Table:
    """How often each frame was played in all scenarios and trackings of a usage table.

    Returns:
        One row a frame, in the order of the clips: ``clip``, ``frame``, ``count``, ``seconds``.
    """
    number = {name: place for place, name in enumerate(dict.fromkeys(usage["clip"].tolist()))}
    clip = np.fromiter((number[name] for name in usage["clip"].tolist()), np.int64, len(usage))
    frame = usage["frame"].astype(np.int64)
    _, first, which = np.unique(
        clip * (frame.max(initial=0) + 1) + frame, return_index=True, return_inverse=True
    )
    total = np.bincount(which.ravel(), usage["count"], len(first)).astype(np.int64)
    rows = usage.take(first)
    return Table({"clip": rows["clip"], "frame": rows["frame"], "count": total, "seconds": rows["seconds"]})


def clips_table(dataset: str, counts: NDArray[np.int64], frames: Frames) -> Table:
    """One row a clip: its length, how it moves on the average, and how much of it was played.

    Returns:
        ``played_seconds`` over all trials, ``played_share`` of the time of all trials, ``used_share`` of the
        clip's own frames that were shown at least once.
    """
    clips = len(frames.clip_names)
    rows = np.diff(frames.starts)
    seconds = np.maximum(rows - 1, 0) / frames.rate

    def total(per_row: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.bincount(frames.clip, per_row, clips).astype(np.float64)

    def per_second(per_step: NDArray[np.float64]) -> NDArray[np.float64]:
        way = total(np.where(frames.has_next, per_step, 0.0))
        return np.asarray(np.divide(way, seconds, out=np.zeros(clips), where=seconds > 0))

    played = total(counts.astype(np.float64))
    return Table(
        {
            "dataset": np.full(clips, dataset, object),
            "clip": np.array(frames.clip_names, object),
            "seconds": seconds,
            "frames": rows,
            "mirrored": frames.mirrored,
            "speed_mean": per_second(np.hypot(frames.displacement[:, 0], frames.displacement[:, 1])),
            "turn_rate_mean_deg": np.degrees(per_second(frames.turn)),
            "played_seconds": played / frames.rate,
            "played_share": played / max(played.sum(), 1.0),
            "used_share": total((counts > 0).astype(np.float64)) / np.maximum(rows, 1),
        }
    )
