"""What a player sees first, as figures: feet that slide while they are down, and the jerk at jumps.

Per trial, per clip and per transition, always beside what the clips themselves bring.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.footing import STRADDLING, Ground, Shown
from gmr.evaluation.frames import Frames
from gmr.evaluation.log import Log
from gmr.evaluation.metrics import mean_where
from gmr.evaluation.transitions import Transitions

__all__ = ["seen_at_transitions", "seen_in_clips", "seen_in_trials"]

Floats = NDArray[np.float64]

_SETTLED_AFTER: Final = 0.5
"""Seconds after a jump that it answers for: five half-lives of the smoothing."""


def seen_in_trials(log: Log, transitions: Transitions, shown: Shown) -> dict[str, Floats]:
    """Columns (T,) of the trials: mm that a foot slides while it is down, per stance; and jerk, m/s^3.

    ``foot_slide_own_mm`` is the slide of the frames shown in their own clips, over the same stances: what it
    falls short of ``foot_slide_mm`` was added by jumps.
    """
    counted = shown.down & log.moving[..., None]
    begins = counted.copy()
    begins[:, 1:] &= ~counted[:, :-1]
    stances = begins.sum(axis=(1, 2))

    def per_stance(way: Floats) -> Floats:
        return _ratio(1000 * np.where(log.moving, way, 0.0).sum(axis=1), stances)

    jumped = np.zeros(log.row.shape, bool)
    jumped[transitions.trial, transitions.step] = True
    near = jumped.copy()
    for away in range(1, 2 * STRADDLING):
        near[:, away:] |= jumped[:, :-away]
        near[:, :-away] |= jumped[:, away:]
    known = log.moving & np.isfinite(shown.jerk)
    return {
        "foot_slide_mm": per_stance(shown.slide),
        "foot_slide_own_mm": per_stance(shown.own),
        "stances_per_second": _ratio(stances.astype(np.float64), log.moving.sum(axis=1) / log.rate),
        "jerk_at_jumps": mean_where(shown.jerk, known & jumped),
        "jerk_between_jumps": mean_where(shown.jerk, known & ~near),
    }


def seen_in_clips(ground: Ground, frames: Frames) -> dict[str, Floats | NDArray[np.int64]]:
    """Columns (C,) of the clips as they were recorded: mm per stance, stances, jerk, m/s^3, and how long a
    stance lasts.
    """
    clips = len(frames.clip_names)
    down = np.zeros(ground.down.shape, bool)
    down[:-1] = ground.down[:-1] & ground.down[1:] & frames.has_next[:-1, None]
    begins = down.copy()
    begins[1:] &= ~(down[:-1] & frames.has_next[:-1, None])
    stances = np.bincount(frames.clip, begins.sum(axis=1), clips).astype(np.int64)
    way = np.bincount(frames.clip, np.where(down, ground.slid, 0).sum(axis=1), clips)
    known = np.isfinite(ground.jerk)
    jerk = np.bincount(frames.clip[known], ground.jerk[known], clips)
    return {
        "foot_slide_mm": _ratio(1000 * way, stances),
        "stances": stances,
        "jerk_mean": _ratio(jerk, np.bincount(frames.clip[known], minlength=clips)),
        "stance_seconds": _ratio(np.bincount(frames.clip, down.sum(axis=1), clips) / frames.rate, stances),
    }


def seen_at_transitions(log: Log, transitions: Transitions, shown: Shown) -> dict[str, Floats]:
    """Columns (K,) of the transitions: mm of slide that each adds, both feet together, and jerk, m/s^3.

    It answers for the half second from it on, or until the next.
    """
    added = np.where(log.moving, shown.slide - shown.own, 0.0)
    total = np.concatenate([np.zeros((len(added), 1)), np.cumsum(added, axis=1)], axis=1)
    trial, first = transitions.trial, transitions.step - 1
    followed = np.append(trial[1:] == trial[:-1], False) if len(trial) else np.zeros(0, bool)
    following = np.where(followed, np.append(first[1:], 0), added.shape[1]) if len(trial) else first
    end = np.minimum(following, np.minimum(first + round(_SETTLED_AFTER * log.rate), added.shape[1]))
    return {
        "foot_slide_added_mm": 1000 * (total[trial, end] - total[trial, first]),
        "jerk_mean": shown.jerk[trial, transitions.step],
    }


def _ratio(total: NDArray[np.number], number: NDArray[np.number]) -> Floats:
    return np.asarray(np.divide(total, number, out=np.full(len(total), np.nan), where=number > 0))
