"""Made-up datasets and trials with known answers, for the tests of the evaluation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.frames import Frames
from gmr.evaluation.log import FORCED, JUMPED, PLAYED_ON, Log
from gmr.evaluation.scenario import Trial

RATE = 60.0


class Arc(NamedTuple):
    """A clip that keeps one speed (m/s) and one turn rate (degrees/s)."""

    seconds: float
    speed: float
    turn_rate_deg: float = 0.0
    mirrored: bool = False
    backwards: bool = False


def frames_of(clips: Mapping[str, Arc]) -> Frames:
    """The frames of arcs, clip after clip."""
    lengths = [round(arc.seconds * RATE) + 1 for arc in clips.values()]
    frame = np.concatenate([np.arange(length) for length in lengths]).astype(np.int32)
    clip = np.repeat(np.arange(len(clips)), lengths).astype(np.int32)
    forward = np.array([(-1 if arc.backwards else 1) * arc.speed / RATE for arc in clips.values()])
    turn = np.array([np.radians(arc.turn_rate_deg) / RATE for arc in clips.values()])
    return Frames(
        clip_names=tuple(clips),
        mirrored=np.array([arc.mirrored for arc in clips.values()]),
        clip=clip,
        frame=frame,
        seconds=frame / RATE,
        displacement=np.stack([np.zeros(len(clip)), forward[clip]], axis=1),
        turn=turn[clip],
        rate=RATE,
    )


class Gait(NamedTuple):
    """How a character goes when asked for something: the speed (m/s) and turn rate (degrees/s) it reaches."""

    speed: float
    turn_rate_deg: float


def walked(
    trials: Sequence[Trial],
    frames: Frames,
    answer: Callable[[float, float], Gait] = Gait,
    rows: NDArray[np.int64] | None = None,
) -> Log:
    """The log of a character that answers every request with a speed and a turn rate of its own.

    Args:
        trials: what it is asked for.
        frames: the dataset that it plays.
        answer: speed and turn rate reached, from those asked for.
        rows: (T, S) the frames shown; the dataset's from the first on, round and round, where not given.
    """
    lengths = np.array([round(trial.seconds * RATE) + 1 for trial in trials])
    steps = int(lengths.max())
    asked = np.stack([_requests(trial, steps) for trial in trials])
    requests, which = np.unique(asked.reshape(-1, 2), axis=0, return_inverse=True)
    given = np.array([answer(*request) for request in requests.tolist()])[which].reshape(asked.shape)
    x, z, heading = _path(given)
    ref_x, ref_z, ref_heading = _path(asked)
    if rows is None:
        rows = np.tile(np.arange(steps) % len(frames), (len(trials), 1))
    jumped = np.zeros(rows.shape, bool)
    jumped[:, 1:] = (rows[:, 1:] != rows[:, :-1] + 1) | ~frames.has_next[rows[:, :-1]]
    forced = jumped.copy()
    forced[:, 1:] &= ~frames.has_next[rows[:, :-1]]
    searched = np.where(jumped, 1.0, np.nan)
    columns = {
        "lengths": lengths,
        "recorded_from": np.array([round(trial.recorded_from * RATE) for trial in trials]),
        "x": x,
        "z": z,
        "heading": (heading + np.pi) % (2 * np.pi) - np.pi,
        "ref_x": ref_x,
        "ref_z": ref_z,
        "ref_heading": ref_heading,
        "ref_speed": asked[:, :, 0],
        "ref_turn_rate": np.radians(asked[:, :, 1]),
        "ref_drift": np.zeros(asked.shape[:2]),
        "row": rows,
        "status": np.where(forced, FORCED, np.where(jumped, JUMPED, PLAYED_ON)),
        "cost_pose": 0.25 * searched,
        "cost_trajectory": 0.5 * searched,
        "discontinuity": 0.03 * searched,
    }
    return Log.of(columns, RATE)


def _requests(trial: Trial, steps: int) -> NDArray[np.float64]:
    """(steps, 2) speed and turn rate asked for on the way from each step; the last ones on and on."""
    wanted = [
        (segment.speed, segment.turn_rate_deg)
        for segment in trial.segments
        for _ in range(round(segment.seconds * RATE))
    ]
    return np.array(wanted + [wanted[-1]] * (steps - len(wanted)))


def _path(speeds: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """x, z and heading of a root that makes each step along the mean of its headings before and after."""
    way, turn = speeds[:, :-1, 0] / RATE, np.radians(speeds[:, :-1, 1]) / RATE
    heading = np.cumsum(turn, axis=1)
    middle = heading - turn / 2
    ways = (way * np.sin(middle), way * np.cos(middle), turn)
    x, z, heading = (np.pad(np.cumsum(each, axis=1), ((0, 0), (1, 0))) for each in ways)
    return x, z, heading
