"""Feet that slide while they are down, and how hard a jump jerks the body: what a player sees first.

Both are measured on the poses that are shown, jumps smoothed, and beside them on the clips' own frames, so
that what the recordings bring is told from what the jumps add. Source: van Basten and Egges, "Evaluating
distance metrics for animation blending" (2009), foot skating; the jerk is the joints' third difference.

Both are of the database's rate, 60 steps a second. A third difference magnifies what trembles from frame to
frame by the cube of the rate, so that of 120 frames a second is some times as large; and the way along the
ground is measured over a twelfth of a second, or a toe that trembles on the spot would go half a metre.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.editing.contacts import resting
from gmr.matching.database import Database
from gmr.matching.trial import TrialLog, trial_positions
from gmr.threads import thread_count

__all__ = ["STRADDLING", "Ground", "Shown", "ground_of", "jerk_about", "shown", "slid_while"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

_UP: Final = np.array([0.0, 1.0, 0.0])
STRADDLING: Final = 3
"""Third differences that reach over one and the same step."""

_SLIDES_OVER: Final = 1 / 12
"""Seconds over which the way of a foot along the ground is measured, five steps."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """The feet of N rows in their clips.

    Attributes:
        feet: (K,) joints looked at: the ball of each foot, or the ankle where there are no toes.
        body: (J,) the hips and the joints below them.
        down: (N, K) whether the foot is on the ground; see :func:`gmr.editing.contacts`.
        slid: (N, K) metres that it slides to the next row, as of :func:`slid_while`; 0 where it is not down
            in both.
        jerk: (N,) m/s^3, as of :func:`jerk_about`; NaN at the ends of a clip.
    """

    feet: NDArray[np.int64]
    body: NDArray[np.int64]
    down: Flags
    slid: Floats
    jerk: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """T trials of S steps as they are shown.

    Attributes:
        down: (T, S, K) whether the frames shown at this step and at the next both have the foot down.
        slide: (T, S) metres that the feet that are down slide to the next step, together; see
            :func:`slid_while`.
        own: (T, S) the same of the frames shown, in their clips.
        jerk: (T, S) m/s^3, as of :func:`jerk_about`; NaN at the ends of a trial.
    """

    down: Flags
    slide: Floats
    own: Floats
    jerk: Floats

    def take(self, trials: NDArray[np.int64]) -> Shown:
        """Those of some trials."""
        return Shown(*(getattr(self, field.name)[trials] for field in fields(self)))


def ground_of(database: Database) -> Ground:
    """Where the feet of a database are down, and what its clips bring of slide and jerk."""
    joints = database.joints.described(database.skeleton)
    index = database.skeleton.names.index
    feet = [index(joints.get(f"{side}_toe", joints[f"{side}_foot"])) for side in ("left", "right")]
    body = _below(index(joints["hips"]), database.skeleton.parents)
    down = np.zeros((len(database), len(feet)), bool)
    slid = np.zeros(down.shape)
    jerk = np.full(len(database), np.nan)
    for clip in range(len(database.clip_names)):
        rows = database.clip_rows(clip)
        places = _in_the_world(database, rows)
        jerk[rows] = jerk_about(places[:, body], database.rate)
        for foot, runs in enumerate(resting(places[:, feet], _UP, 1 / database.rate)):
            for first, end in runs:
                down[rows.start + first : rows.start + end, foot] = True
        stands = down[rows][:-1] & down[rows][1:]
        slid[rows][:-1] = slid_while(stands, places[:, feet], database.rate)
    return Ground(np.array(feet), body, down, slid, jerk)


def shown(database: Database, ground: Ground, trial_log: TrialLog, threads: int) -> Shown:
    """Slide and jerk at every step of every trial.

    Args:
        database: what was played.
        ground: of the database.
        trial_log: the trials.
        threads: 0 for all cores; the answer does not depend on it.
    """
    joints = np.union1d(ground.body, ground.feet)
    feet, body = np.searchsorted(joints, ground.feet), np.searchsorted(joints, ground.body)
    shape = trial_log.row.shape
    found = Shown(
        np.zeros((*shape, len(feet)), bool), np.zeros(shape), np.zeros(shape), np.full(shape, np.nan)
    )

    def measure(trial: int) -> None:
        length = int(trial_log.lengths[trial])
        row = trial_log.row[trial, :length]
        places = trial_positions(database, trial_log, trial, joints=joints.tolist())
        down = ground.down[row[:-1]] & ground.down[row[1:]]
        found.down[trial, : length - 1] = down
        slid = slid_while(down, places[:, feet], database.rate)
        found.slide[trial, : length - 1] = slid.sum(axis=1)
        found.own[trial, : length - 1] = np.where(down, ground.slid[row[:-1]], 0).sum(axis=1)
        found.jerk[trial, :length] = jerk_about(places[:, body], database.rate)

    with ThreadPoolExecutor(thread_count(threads) or os.cpu_count()) as pool:
        for _ in pool.map(measure, range(len(trial_log))):
            pass
    return found


def slid_while(down: Flags, places: NDArray[np.floating], rate: float) -> Floats:
    """How far feet slide along the ground from each step to the next while they are down.

    The way of a step is that of the twelfth of a second about it, shared among its steps, as far as the foot
    is down in it: a foot that slides evenly goes as far as its path is long, one that trembles on the spot
    hardly anywhere.

    Args:
        down: (S - 1, K) whether a foot is down at a step and at the next.
        places: (S, K, 3) metres.
        rate: steps per second.

    Returns:
        (S - 1, K) metres; 0 where the foot is not down.
    """
    half = max(round((_SLIDES_OVER * rate - 1) / 2), 0)
    steps = np.arange(len(down))[:, None]
    first = np.maximum.accumulate(np.where(down, 0, steps + 1), axis=0)
    last = np.minimum.accumulate(np.where(down, len(down), steps)[::-1], axis=0)[::-1]
    begin, end = np.maximum(steps - half, first), np.minimum(steps + 1 + half, last)
    ground = places[..., ::2].astype(np.float64)
    feet = np.arange(down.shape[1])
    ways = np.linalg.norm(ground[end, feet] - ground[np.minimum(begin, end), feet], axis=-1)
    return np.asarray(np.where(down, ways / np.maximum(end - begin, 1), 0.0))


def jerk_about(places: NDArray[np.floating], rate: float) -> Floats:
    """How hard joints jerk about each step: the mean of their third differences, of three the largest.

    Args:
        places: (S, J, 3) metres.
        rate: steps per second.

    Returns:
        (S,) m/s^3: of the three third differences that reach over the way from the step before to this one
        the largest, so of six steps (a twelfth of a second at 60); NaN where there are not three.
    """
    third = np.diff(places, n=3, axis=0)
    each = np.sqrt(np.einsum("sjc,sjc->sj", third, third)).mean(axis=1, dtype=np.float64) * rate**3
    about = np.full(len(places), np.nan)
    if len(each) >= STRADDLING:
        windows = np.lib.stride_tricks.sliding_window_view(each, STRADDLING)
        about[STRADDLING : STRADDLING + len(windows)] = windows.max(axis=1)
    return about


def _below(joint: int, parents: NDArray[np.int32]) -> NDArray[np.int64]:
    """A joint and all that hang on it."""
    found = {joint}
    for child, parent in enumerate(parents.tolist()):
        if parent in found:
            found.add(child)
    return np.array(sorted(found))


def _in_the_world(database: Database, rows: slice) -> Floats:
    """(F, J, 3) places in the world of the clip."""
    places = database.positions[rows].astype(np.float64)
    sin, cos = (turn(database.headings[rows])[:, None] for turn in (np.sin, np.cos))
    x, z = places[..., 0].copy(), places[..., 2].copy()
    places[..., 0] = x * cos + z * sin + database.ground[rows, :1]
    places[..., 2] = z * cos - x * sin + database.ground[rows, 1:]
    return places
