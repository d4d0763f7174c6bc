"""Trials: a character sent along a reference path by motion matching, every step logged.

The whole simulation runs in the core; here are its inputs and outputs with names and types. Metres, seconds,
radians; the ground plane is (x, z), heading 0 looks along +Z and grows counter-clockwise seen from above.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Literal, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.matching.database import Database
from gmr.threads import thread_count

__all__ = ["Profile", "Segment", "Status", "Tracking", "TrialLog", "run_trials", "trial_positions"]

Tracking: TypeAlias = Literal["time", "velocity"]

_NO_TIME = 1e-9
"""Share of a stretch that is rounding, not time."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of constant speed and turn rate.

    Attributes:
        duration: seconds, above 0.
        speed: metres a second along the way.
        turn_rate: radians a second, positive to the left.
        drift: radians from the heading, which way it faces, to the way that it goes, positive to the left: 0
            is ahead, pi backwards.
    """

    duration: float
    speed: float
    turn_rate: float
    drift: float = 0.0


@dataclass(frozen=True, slots=True)
class Profile:
    """What one trial asks for: segments one after the other, from the origin with heading 0.

    The reference path is continued at every switch, never re-centred.

    Attributes:
        segments: speed and turn rate, piece by piece; the last goes on where a query looks beyond its end.
        record_from: second from which the trial counts; what comes before is logged too.
    """

    segments: tuple[Segment, ...]
    record_from: float = 0.0

    @classmethod
    def constant(
        cls,
        speed: float,
        turn_rate: float,
        *,
        run_up: float = 3.0,
        settle: float = 2.0,
        record: float = 30.0,
    ) -> Self:
        """One speed and one turn rate: straight along the tangent, then turning, then turning and recorded.

        Args:
            speed: metres a second.
            turn_rate: radians a second.
            run_up: seconds straight ahead.
            settle: seconds of turning before the trial counts.
            record: seconds of turning that count.
        """
        straight, turning = Segment(run_up, speed, 0.0), Segment(settle + record, speed, turn_rate)
        return cls((straight, turning) if run_up > 0 else (turning,), run_up + settle)

    @classmethod
    def switching(
        cls,
        speed: float,
        switched_speed: float,
        turn_rate: float,
        *,
        every: float = 5.0,
        run_up: float = 3.0,
        settle: float = 2.0,
        record: float = 30.0,
    ) -> Self:
        """As :meth:`constant`, the recorded part alternating between two speeds, ``speed`` first.

        Args:
            speed: metres a second.
            switched_speed: the other speed, metres a second.
            turn_rate: radians a second.
            every: seconds from one switch to the next.
            run_up: seconds straight ahead.
            settle: seconds of turning before the trial counts.
            record: seconds that count; the last stretch is as long as there is time for.
        """
        if not every > 0:
            raise ValueError(f"a switch every {every} s is not possible; use more than 0 s")
        lead = cls.constant(speed, turn_rate, run_up=run_up, settle=settle, record=min(every, record))
        switches = math.ceil(record / every - _NO_TIME) - 1
        pieces = (
            Segment(min(every, record - i * every), (speed, switched_speed)[i % 2], turn_rate)
            for i in range(1, switches + 1)
        )
        return cls((*lead.segments, *pieces), lead.record_from)

    @property
    def duration(self) -> float:
        """Seconds from the start to the end."""
        return sum(segment.duration for segment in self.segments)


class Status(IntEnum):
    """How a step came to show its row."""

    PLAYED_ON = 0
    """The row after the one before, without a search."""
    KEPT = 1
    """The row after the one before, which no other beat."""
    JUMPED = 2
    """A row that cost less."""
    FORCED_AT_END = 3
    """The best of the other rows: the clip had ended."""
    NONE = 255
    """No step: the trial was over."""


@dataclass(frozen=True, slots=True)
class TrialLog:
    """Every step of every trial: arrays (trials, steps), from 0 s to the trial's end, both included.

    Trials may differ in length; what lies after the end of one is NaN, row -1 and :attr:`Status.NONE`.

    Attributes:
        rate: steps a second.
        tracking: what queries aimed at.
        profiles: what was asked for, one a trial.
        lengths: (trials,) int64, number of steps.
        recorded_from: (trials,) int64, the step at which recording begins; the ways from it on count.
        x, z: float64, where the root stood, as playback puts it (inertialisation smooths what is drawn only).
        heading: float64, not wrapped.
        ref_x, ref_z, ref_heading: float64, where it should have stood at that time.
        ref_speed, ref_turn_rate, ref_drift: float64, what was asked for at that time.
        row: int64, the database row shown.
        status: uint8, a :class:`Status`.
        cost_pose, cost_trajectory: float32, the row's squared weighted distance to the query over the pose
            features and over the trajectory features; NaN where nothing was searched.
        discontinuity: float32, mean distance in metres between the joints of the pose left and of the pose
            entered, each seen from its simulation root; NaN where there was no jump. A joint that only
            carries the hips (a root on the ground) does not count.
    """

    rate: float
    tracking: Tracking
    profiles: tuple[Profile, ...]
    lengths: NDArray[np.int64]
    recorded_from: NDArray[np.int64]
    x: NDArray[np.float64]
    z: NDArray[np.float64]
    heading: NDArray[np.float64]
    ref_x: NDArray[np.float64]
    ref_z: NDArray[np.float64]
    ref_heading: NDArray[np.float64]
    ref_speed: NDArray[np.float64]
    ref_turn_rate: NDArray[np.float64]
    ref_drift: NDArray[np.float64]
    row: NDArray[np.int64]
    status: NDArray[np.uint8]
    cost_pose: NDArray[np.float32]
    cost_trajectory: NDArray[np.float32]
    discontinuity: NDArray[np.float32]

    def __len__(self) -> int:
        """Number of trials."""
        return len(self.profiles)


def run_trials(
    database: Database,
    profiles: Iterable[Profile],
    *,
    tracking: Tracking = "time",
    search_every: float = 0.1,
    exclude_within: int = 20,
    transition_penalty: float = 0.0,
    tags: int = 0,
    weights: ArrayLike | None = None,
    threads: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> TrialLog:
    """Send a character along the path of every profile.

    It starts on the path, at the row whose future is nearest to what is asked for there. A search is also
    made at once when the speed or turn rate asked for switches, and is forced to jump at the end of a clip.
    The logs have the same bits whatever the number of threads and the machine.

    Args:
        database: what is played and searched.
        profiles: one a trial.
        tracking: "time" aims at where the reference will be (closed loop); "velocity" asks only for its speed
            and turn rate, from the character's own place and heading (open loop).
        search_every: seconds from a search to the next.
        exclude_within: rows of the playing clip at most this many frames from the next one are not jumped to.
        transition_penalty: added to the cost of every row but the next one; 0 or more.
        tags: bits that every row jumped to carries all of; 0 asks for none.
        weights: (D,) what squared differences are multiplied by, 0 or more; None: 1.
        threads: 0 for all cores.
        progress: called now and then with the number of trials done and of all trials; what it raises ends
            the run, as Ctrl-C does.

    Returns:
        The log of all trials.

    Raises:
        ValueError: a profile or a setting is out of bounds, or no row carries the tags.
    """
    asked = tuple(profiles)
    columns = _core.run_trials(
        database.core,
        [([(s.duration, s.speed, s.turn_rate, s.drift) for s in p.segments], p.record_from) for p in asked],
        tracking,
        search_every,
        exclude_within,
        transition_penalty,
        tags,
        thread_count(threads),
        progress,
        None if weights is None else np.asarray(weights, np.float32).tolist(),
    )
    for column in columns.values():
        column.flags.writeable = False
    return TrialLog(rate=database.rate, tracking=tracking, profiles=asked, **columns)


def trial_positions(
    database: Database,
    log: TrialLog,
    trial: int,
    *,
    half_life: float = 0.1,
    joints: Sequence[int] | None = None,
) -> NDArray[np.float32]:
    """World positions of the joints in one trial, every jump smoothed by inertialisation, the root's too.

    Args:
        database: the one that the trial was run on.
        log: the trials.
        trial: which of them.
        half_life: of the smoothing, in seconds.
        joints: indices of K joints; None for all.

    Returns:
        (T, K, 3) float32, metres, Y up.

    Raises:
        ValueError: the log is not of this database, or a joint is not there.
    """
    steps = slice(0, log.lengths[trial])
    placements = np.stack([log.x[trial, steps], log.z[trial, steps], log.heading[trial, steps]], axis=1)
    return _core.trial_positions(
        database.core, log.row[trial, steps], placements, half_life, None if joints is None else list(joints)
    )
