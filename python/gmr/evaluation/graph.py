"""The transition graph: clips as nodes, and how often playing goes from one to another as weights.

Source: the paper's section 3.3.2 and its Figures 3 and 10.
"""

from __future__ import annotations

import numpy as np

from gmr.evaluation.frames import Frames
from gmr.evaluation.transitions import FORCED_END, INTER_CLIP, INTRA_CLIP, Transitions
from gmr.table import Table

__all__ = ["graph_table"]


def graph_table(
    dataset: str, scenario: str, tracking: str, transitions: Transitions, frames: Frames
) -> Table:
    """One row an edge, from clip to clip (a clip to itself too); see :class:`Tables` for the columns."""
    ends = np.stack([frames.clip[transitions.from_row], frames.clip[transitions.to_row]], axis=1)
    edges, which, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    edges, which = edges.reshape(-1, 2), which.ravel()
    left = np.bincount(edges[:, 0], count, len(frames.clip_names))

    def of(kind: int) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
        return np.bincount(which[transitions.kind == kind], minlength=len(edges))

    names = np.array(frames.clip_names, object)
    return Table(
        {
            "dataset": np.full(len(edges), dataset, object),
            "scenario": np.full(len(edges), scenario, object),
            "tracking": np.full(len(edges), tracking, object),
            "from_clip": names[edges[:, 0]],
            "to_clip": names[edges[:, 1]],
            "count": count,
            "share": count / left[edges[:, 0]],
            "inter_clip": of(INTER_CLIP),
            "intra_clip": of(INTRA_CLIP),
            "forced_end": of(FORCED_END),
            "discontinuity_mean": np.bincount(which, transitions.discontinuity, len(edges)) / count,
        }
    )
