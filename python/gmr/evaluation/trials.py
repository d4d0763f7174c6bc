"""The table of the trials: one row each, every figure of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation import metrics
from gmr.evaluation.frames import Frames
from gmr.evaluation.log import Log
from gmr.evaluation.metrics import mean_where, percentile_where, rms_where
from gmr.evaluation.scenario import Trial
from gmr.evaluation.transitions import FORCED_END, INTER_CLIP, INTRA_CLIP, Transitions
from gmr.table import Table

__all__ = ["facing_error_deg", "speed_error_share", "trials_table"]


def trials_table(
    dataset: str,
    trials: Sequence[Trial],
    tracking: str,
    log: Log,
    transitions: Transitions,
    frames: Frames,
) -> Table:
    """The figures of every trial over its recorded steps; metres, seconds, degrees.

    Args:
        dataset: name of the dataset.
        trials: what was asked for.
        tracking: "time" or "velocity".
        log: what happened.
        transitions: of the same log.
        frames: the dataset's frames.
    """
    asked = {
        "dataset": np.full(len(trials), dataset, object),
        "scenario": np.array([trial.scenario for trial in trials], object),
        "tracking": np.full(len(trials), tracking, object),
        "speed": np.array([trial.speed for trial in trials]),
        "turn_rate_deg": np.array([trial.turn_rate_deg for trial in trials]),
    }
    offsets = metrics.offset(log)
    return Table(
        asked
        | _accuracy(log)
        | {
            "offset_mean": mean_where(offsets, log.recorded),
            "offset_rms": rms_where(offsets, log.recorded),
            "offset_p95": percentile_where(offsets, log.recorded, 95.0),
            "offset_max": percentile_where(offsets, log.recorded, 100.0),
            "offset_final": _last(offsets, log.recorded),
        }
        | _changes(log, transitions)
        | _accuracy_over_a_second(log)
        | _parts_of_the_offset(log, offsets)
        | _kinds(log, transitions)
        | {
            "clip_count": _clips_played(log, frames),
            "seconds": log.moving.sum(axis=1) / log.rate,
            "speed_error_share": speed_error_share(trials, log),
            **_switches(trials),
            "path": np.array([trial.path for trial in trials], object),
            "slowest_speed": np.array([trial.slowest for trial in trials]),
            "drift_deg": np.array([trial.drift_deg for trial in trials], np.float64),
            "facing_error_deg": facing_error_deg(log),
        }
    )


def facing_error_deg(log: Log) -> NDArray[np.float64]:
    """(T,) how far a trial faces from where it should, mean, degrees."""
    return np.degrees(mean_where(metrics.facing_error(log), log.recorded))


def _switches(trials: Sequence[Trial]) -> dict[str, NDArray[np.float64]]:
    """The other speed, and the seconds from switch to switch; NaN where there is none."""
    switches = [(trial.switching.speed, trial.switching.every) if trial.switching else () for trial in trials]
    pairs = np.array([pair or (np.nan, np.nan) for pair in switches], np.float64)
    return {"switched_speed": pairs[:, 0], "switch_every": pairs[:, 1]}


def speed_error_share(trials: Sequence[Trial], log: Log) -> NDArray[np.float64]:
    """At each speed asked for, the worst; on a path of many speeds, or of standing, in the mean of all."""
    speed = metrics.path_speed(log)
    on_grid = np.array([not trial.path for trial in trials])
    share = metrics.worst_share(speed, log.ref_speed, log.moving & on_grid[:, None])
    asked = np.array([trial.speed for trial in trials])
    error = metrics.static_error(speed, log.ref_speed, log.moving)
    mean = np.divide(error, asked, out=np.full(len(asked), np.nan), where=asked > 0)
    return np.asarray(np.where(on_grid, share, mean))


def _accuracy(log: Log) -> dict[str, NDArray[np.float64]]:
    speed, turn_rate = metrics.path_speed(log), metrics.turn_rate(log)
    return {
        "speed_error": metrics.static_error(speed, log.ref_speed, log.moving),
        "turn_rate_error_deg": np.degrees(metrics.static_error(turn_rate, log.ref_turn_rate, log.moving)),
        "speed_deviation": metrics.dynamic_error(speed, log.ref_speed, log.moving),
        "turn_rate_deviation_deg": np.degrees(
            metrics.dynamic_error(turn_rate, log.ref_turn_rate, log.moving)
        ),
    }


def _accuracy_over_a_second(log: Log) -> dict[str, NDArray[np.float64]]:
    speed, turn_rate = metrics.path_speed(log), metrics.turn_rate(log)
    slow_speed, whole = metrics.centred_mean(speed, log.moving, log.rate)
    slow_turn_rate, _ = metrics.centred_mean(turn_rate, log.moving, log.rate)
    return {
        "speed_mean": mean_where(speed, log.moving),
        "turn_rate_mean_deg": np.degrees(mean_where(turn_rate, log.moving)),
        "speed_deviation_1s": metrics.dynamic_error(slow_speed, log.ref_speed, whole),
        "turn_rate_deviation_1s_deg": np.degrees(
            metrics.dynamic_error(slow_turn_rate, log.ref_turn_rate, whole)
        ),
    }


def _parts_of_the_offset(log: Log, offsets: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    along, cross = metrics.along_and_cross_track(log)
    return {
        "offset_sum": np.where(log.recorded, offsets, 0.0).sum(axis=1),
        "along_track_mean": mean_where(along, log.recorded),
        "along_track_rms": rms_where(along, log.recorded),
        "cross_track_mean": mean_where(cross, log.recorded),
        "cross_track_rms": rms_where(cross, log.recorded),
    }


def _changes(log: Log, transitions: Transitions) -> dict[str, NDArray[np.float64]]:
    cost = log.cost_pose + log.cost_trajectory
    apart = np.full(log.row.shape, np.nan)
    apart[transitions.trial, transitions.step] = transitions.discontinuity
    return {
        "transitions_per_second": _per_second(log, transitions.per_trial(len(log.row))),
        "search_cost_mean": mean_where(cost, log.moving & ~np.isnan(cost)),
        "pose_discontinuity_mean": mean_where(apart, ~np.isnan(apart)),
    }


def _kinds(log: Log, transitions: Transitions) -> dict[str, NDArray[np.float64]]:
    def rate(kind: int) -> NDArray[np.float64]:
        return _per_second(log, transitions.per_trial(len(log.row), kind))

    searched = log.moving & ~np.isnan(log.cost_pose)
    return {
        "inter_clip_per_second": rate(INTER_CLIP),
        "intra_clip_per_second": rate(INTRA_CLIP),
        "forced_end_per_second": rate(FORCED_END),
        "search_cost_pose_mean": mean_where(log.cost_pose, searched),
        "search_cost_trajectory_mean": mean_where(log.cost_trajectory, searched),
    }


def _per_second(log: Log, count: NDArray[np.int64]) -> NDArray[np.float64]:
    seconds = log.moving.sum(axis=1) / log.rate
    return np.asarray(np.divide(count, seconds, out=np.full(len(count), np.nan), where=seconds > 0))


def _last(values: NDArray[np.float64], where: NDArray[np.bool_]) -> NDArray[np.float64]:
    last = where.shape[1] - 1 - np.argmax(where[:, ::-1], axis=1)
    return np.where(where.any(axis=1), values[np.arange(len(values)), last], np.nan)


def _clips_played(log: Log, frames: Frames) -> NDArray[np.int64]:
    return np.array(
        [len(np.unique(frames.clip[rows[played]])) for rows, played in zip(log.row, log.moving, strict=True)],
        np.int64,
    )
