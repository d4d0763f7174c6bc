"""All trials of a dataset as the page's player needs them.

Trials share most of what they show, so the page holds every frame once, thinned and in whole millimetres,
and of a trial only which rows it shows: the root goes where the rows take it, and the plan is a formula. All
numbers are differences of differences, small ones therefore, in one deflated stream that browsers inflate.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.figures.trial_maps import set_label
from gmr.evaluation.figures.wording import asked_of, short_names
from gmr.evaluation.replay import worst_trial
from gmr.evaluation.replays import PlayedTrial, Replays
from gmr.evaluation.report.replay import drawn_parents, head_of, on_a_bone, replay_sentence, sides
from gmr.evaluation.result import Evaluation

__all__ = ["film_of", "packed_film"]

MOST_BYTES: Final = 4_000_000
"""Of a dataset before it is deflated; the trials that stray least are left out where all would take more."""

_MILLIMETRE: Final = 1e-3
_STEPS: Final = 2.0**-17
"""Metres and radians of the root's way from row to row: a step is up to a quarter of either."""
_STRIDE: Final = 2
"""Every second row is held, 30 poses a second; the player fills in between."""
_HALF_LIFE: Final = 0.1
"""Of the smoothing, seconds, as in :func:`gmr.matching.trial.trial_positions`."""


def film_of(evaluation: Evaluation) -> dict[str, Any] | None:
    """The trials of an evaluation for the page's JSON; None where it does not hold them."""
    if evaluation.replays is None:
        return None
    hips, worst = evaluation.summary.joints.get("hips"), worst_trial(evaluation.measured.trials)
    return packed_film(evaluation.replays, evaluation.dataset, hips, worst)


def packed_film(replays: Replays, dataset: str, hips: str | None, worst: int) -> dict[str, Any]:
    """The trials for the page's JSON.

    Poses are within a millimetre of the dataset's at every second row, along straight lines between.

    Args:
        replays: the trials.
        dataset: its name.
        hips: name of the joint that the body hangs on. What is above it, a root that may stand anywhere, is
            not drawn.
        worst: index of the trial that is shown first.
    """
    parents = drawn_parents(replays.parents, replays.joint_names, hips)
    joints = np.flatnonzero(on_a_bone(parents))
    chosen = _within(MOST_BYTES, replays, len(joints), worst)
    trials = [replays.trials[index] for index in chosen]
    held = _held(trials, replays)
    layout, packed = _deflated(
        {
            "poses": _poses(replays, held, joints),
            "ways": _ways(replays, held),
            **_runs(trials, held),
        }
    )
    place = np.full(len(parents) + 1, -1)
    place[joints] = np.arange(len(joints))
    names = [replays.joint_names[joint] for joint in joints.tolist()]
    sets = list(dict.fromkeys((played.trial.scenario, played.tracking) for played in trials))
    place_of = {each: number for number, each in enumerate(sets)}
    clips, clip = np.unique(replays.frames.clip[held.first], return_inverse=True)
    return {
        "dataset": dataset,
        "rate": replays.frames.rate,
        "stride": _STRIDE,
        "unit": _MILLIMETRE,
        "wayUnit": _STEPS,
        "halfLife": _HALF_LIFE,
        "parents": place[parents[joints]].tolist(),
        "sides": sides(tuple(names)),
        "head": [int(place[joint]) for joint in head_of(replays, parents)],
        "ranges": {
            "rows": held.length.tolist(),
            "clip": clip.reshape(-1).tolist(),
            "seconds": np.round(replays.frames.seconds[held.first], 4).tolist(),
        },
        "clips": short_names([replays.frames.clip_names[number] for number in clips.tolist()]),
        "layout": layout,
        "packed": packed,
        "sets": [set_label(*each) for each in sets],
        "trials": [
            {
                **_told(played, index, replays.frames.rate),
                "set": place_of[played.trial.scenario, played.tracking],
            }
            for played, index in zip(trials, chosen, strict=True)
        ],
        "first": chosen.index(worst),
        "leftOut": len(replays.trials) - len(chosen),
    }


def _told(played: PlayedTrial, index: int, rate: float) -> dict[str, Any]:
    """What is told of a trial, and where it starts and is asked to go."""
    trial = played.trial
    recorded = min(round(trial.recorded_from * rate), len(played.row) - 1)
    return {
        "index": index,
        "label": asked_of(trial),
        "away": round(float(played.offset[recorded:].mean()), 3),
        "sentence": replay_sentence(played),
        "start": [float(played.x[0]), float(played.z[0]), float(played.heading[0])],
        "segments": [
            [
                segment.seconds,
                segment.speed,
                float(np.radians(segment.turn_rate_deg)),
                float(np.radians(segment.drift_deg)),
            ]
            for segment in trial.segments
        ],
    }


def _within(most: int, replays: Replays, joints: int, worst: int) -> list[int]:
    """Indices, ascending, of the trials that fit into ``most`` bytes, those that stray farthest first."""
    away = np.array([float(played.offset.mean()) for played in replays.trials])
    away[worst] = np.inf
    shown = np.zeros(len(replays.frames), bool)
    chosen: list[int] = []
    left = float(most)
    for index in np.argsort(-away, kind="stable").tolist():
        played = replays.trials[index]
        new = np.unique(played.row[~shown[played.row]])
        left -= len(new) * (joints * 6 / _STRIDE + 6) + np.count_nonzero(_breaks(played)) * 6
        if left < 0 and chosen:
            break
        shown[new] = True
        chosen.append(index)
    return sorted(chosen)


@dataclass(frozen=True, slots=True)
class _Held:
    """The rows that the page holds, in R ranges, none across clips.

    Attributes:
        first, length: (R,) first row of each range, and how many it has.
        number: (N,) place of each row of the dataset among those held; only meant for those.
        shown: (K,) the rows held.
        samples: (M,) the rows whose poses are held.
        fresh: (M,) bool, whether a sample is the first of its range.
    """

    first: NDArray[np.int64]
    length: NDArray[np.int64]
    number: NDArray[np.int64]
    shown: NDArray[np.int64]
    samples: NDArray[np.int64]
    fresh: NDArray[np.bool_]


def _held(trials: Sequence[PlayedTrial], replays: Replays) -> _Held:
    """What the trials show, with the row after each, which smoothing asks for, and with short gaps closed."""
    frames = replays.frames
    shown = np.zeros(len(frames), bool)
    for played in trials:
        shown[played.row] = True
    shown[1:] |= shown[:-1] & frames.has_next[:-1]
    rows = np.flatnonzero(shown)
    new = np.append(True, (np.diff(rows) > 2 * _STRIDE) | (np.diff(frames.clip[rows]) != 0))
    first = rows[new]
    length = rows[np.append(np.flatnonzero(new)[1:], len(rows)) - 1] - first + 1
    ranges = [np.arange(start, start + many) for start, many in zip(first, length, strict=True)]
    thinned = [np.append(range_[:-1:_STRIDE], range_[-1]) for range_ in ranges]
    held = np.concatenate(ranges)
    number = np.zeros(len(frames), np.int64)
    number[held] = np.arange(len(held))
    fresh = np.concatenate([np.arange(len(range_)) == 0 for range_ in thinned])
    return _Held(first, length, number, held, np.concatenate(thinned), fresh)


def _poses(replays: Replays, held: _Held, joints: NDArray[np.int64]) -> NDArray[np.int64]:
    """Second differences over time within each range, a coordinate after the other."""
    places = replays.positions[held.samples][:, joints].reshape(len(held.samples), -1)
    values = np.rint(places.astype(np.float64) / _MILLIMETRE).astype(np.int64)
    first = np.diff(values, axis=0, prepend=0)
    first[held.fresh] = values[held.fresh]
    second = np.diff(first, axis=0, prepend=0)
    after = np.append(False, held.fresh[:-1])
    second[held.fresh | after] = first[held.fresh | after]
    return second.T.reshape(-1)


def _ways(replays: Replays, held: _Held) -> NDArray[np.int64]:
    """(left, forward, turn) of the root to the next row, rounded so that sums along a range stay true."""
    frames = replays.frames
    way = np.column_stack([frames.displacement[held.shown], frames.turn[held.shown]])
    until = np.rint(np.cumsum(way, axis=0) / _STEPS).astype(np.int64)
    return np.diff(np.diff(until, axis=0, prepend=0), axis=0, prepend=0).T.reshape(-1)


def _breaks(played: PlayedTrial) -> NDArray[np.bool_]:
    """(T,) whether the row shown does not go on from the one before."""
    fresh = played.jumped.copy()
    fresh[1:] |= np.diff(played.row) != 1
    fresh[:1] = True
    return fresh


def _runs(trials: Sequence[PlayedTrial], held: _Held) -> dict[str, NDArray[np.int64]]:
    """Unbroken runs of rows: how many a trial has, how many steps each, and the row that it starts from."""
    starts = [np.flatnonzero(_breaks(played)) for played in trials]
    steps = [np.diff(start, append=len(played.row)) for start, played in zip(starts, trials, strict=True)]
    rows = [held.number[played.row[start]] for start, played in zip(starts, trials, strict=True)]
    return {
        "runs": np.array([len(start) for start in starts]),
        "steps": np.concatenate(steps),
        "rows": np.concatenate(rows),
    }


def _deflated(columns: dict[str, NDArray[np.int64]]) -> tuple[list[list[Any]], str]:
    """Whole numbers as their low bytes, then their next ones, signs in the last bit, deflated and in base64.

    Returns:
        ``[name, how many, bytes of each]`` of every column, and the text.
    """
    layout: list[list[Any]] = []
    stream = b""
    for name, values in columns.items():
        unsigned = ((values << 1) ^ (values >> 63)).astype("<u8")
        width = max(1, -(-int(unsigned.max(initial=0)).bit_length() // 8))
        planes = unsigned.view(np.uint8).reshape(-1, 8)[:, :width].T
        layout.append([name, len(values), width])
        stream += planes.tobytes()
    return layout, base64.b64encode(zlib.compress(stream, 9)).decode("ascii")
