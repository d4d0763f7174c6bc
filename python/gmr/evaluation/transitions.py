"""Transitions: the steps at which the frame shown is not the next one of its clip.

Source: the paper's section 3.3.2 and its Figures 3, 9 and 10.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import FORCED, Log
from gmr.table import Table

__all__ = [
    "FORCED_END",
    "INTER_CLIP",
    "INTRA_CLIP",
    "KINDS",
    "Transitions",
    "transitions_of",
    "transitions_table",
]

INTER_CLIP: Final = 0
INTRA_CLIP: Final = 1
FORCED_END: Final = 2
KINDS: Final = ("inter-clip", "intra-clip", "forced end")
"""To another clip; within the clip; because the clip was over, wherever to."""


@dataclass(frozen=True, slots=True)
class Transitions:
    """K transitions in the order of trials and steps.

    Attributes:
        trial: (K,) index of the trial.
        step: (K,) the step at which the new frame was shown first.
        from_row, to_row: (K,) rows of the last frame before and the first after.
        kind: (K,) index into ``KINDS``.
        discontinuity: (K,) mean distance of the joints between the pose left and the pose entered, metres.
    """

    trial: NDArray[np.int64]
    step: NDArray[np.int64]
    from_row: NDArray[np.int64]
    to_row: NDArray[np.int64]
    kind: NDArray[np.int64]
    discontinuity: NDArray[np.float64]

    def per_trial(self, trials: int, kind: int | None = None) -> NDArray[np.int64]:
        """(trials,) how many transitions each trial has, of one kind or of all."""
        chosen = self.trial if kind is None else self.trial[self.kind == kind]
        return np.bincount(chosen, minlength=trials)


def transitions_of(log: Log, frames: Frames) -> Transitions:
    """Find the transitions among the recorded steps."""
    before, after = log.row[:, :-1], log.row[:, 1:]
    plays_on = (after == before + 1) & frames.has_next[before]
    trial, step = np.nonzero(~plays_on & log.moving[:, 1:])
    step = step + 1
    from_row, to_row = log.row[trial, step - 1], log.row[trial, step]
    within = frames.clip[from_row] == frames.clip[to_row]
    forced = log.status[trial, step] == FORCED
    kind = np.where(forced, FORCED_END, np.where(within, INTRA_CLIP, INTER_CLIP))
    return Transitions(trial, step, from_row, to_row, kind, log.discontinuity[trial, step])


def transitions_table(
    dataset: str,
    scenario: str,
    tracking: str,
    transitions: Transitions,
    frames: Frames,
    seen: Mapping[str, NDArray[np.float64]] | None = None,
) -> Table:
    """One row for every pair of frames and kind: how often, and how far apart the two poses were.

    ``seen`` has further figures (K,) of every transition; the table has their means, NaN left out.
    """
    keys = np.stack([transitions.from_row, transitions.to_row, transitions.kind], axis=1)
    pairs, which, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    from_row, to_row, kind = pairs.reshape(-1, 3).T
    apart = np.bincount(which.ravel(), weights=transitions.discontinuity, minlength=len(pairs)) / count

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        known = np.isfinite(values)
        number = np.bincount(which.ravel()[known], minlength=len(pairs))
        total = np.bincount(which.ravel()[known], values[known], len(pairs))
        return np.asarray(np.divide(total, number, out=np.full(len(pairs), np.nan), where=number > 0))

    return Table(
        {
            "dataset": _repeated(dataset, len(pairs)),
            "scenario": _repeated(scenario, len(pairs)),
            "from_clip": frames.names[from_row],
            "from_frame": frames.frame[from_row],
            "to_clip": frames.names[to_row],
            "to_frame": frames.frame[to_row],
            "kind": np.array(KINDS, object)[kind],
            "count": count,
            "from_seconds": frames.seconds[from_row],
            "to_seconds": frames.seconds[to_row],
            "discontinuity_mean": apart,
            "tracking": _repeated(tracking, len(pairs)),
            **{name: mean(values) for name, values in (seen or {}).items()},
        }
    )


def _repeated(text: str, times: int) -> NDArray[np.object_]:
    return np.full(times, text, object)
