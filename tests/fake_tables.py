"""The tables of single trials of a made-up evaluation."""

from __future__ import annotations

from typing import Any

import numpy as np

from gmr.evaluation.timeline import QUARTER
from gmr.table import Table

KEYS = ("dataset", "scenario", "tracking", "speed", "turn_rate_deg")


def fake_tables(trials: Table, clips: list[str], random: np.random.Generator) -> dict[str, Table]:
    """Segments, timeline, errors and graph that fit a table of trials; switches every 5 s, 30 s recorded."""
    return {
        "segments": _segments(trials.take(np.isfinite(trials["switched_speed"])), random),
        "timeline": _timeline(trials, random),
        "error_bins": Table.joined([_bins(trials, name, width) for name, width in _WIDTHS.items()]),
        "error_fits": Table.joined([_fits(trials, name) for name in _WIDTHS]),
        "graph": _graph(trials, clips, random),
    }


_WIDTHS = {"speed": 0.1, "turn_rate_deg": 5.0}


def _repeated(trials: Table, times: int) -> dict[str, Any]:
    return {name: np.repeat(trials[name], times) for name in KEYS}


def _segments(trials: Table, random: np.random.Generator) -> Table:
    number = np.tile(np.arange(6), len(trials))
    own, other = np.repeat(trials["speed"], 6), np.repeat(trials["switched_speed"], 6)
    target, n = np.where(number % 2, other, own), len(number)
    settled = np.where(random.random(n) < 0.7, random.uniform(0.5, 4, n), np.nan)
    return Table(
        _repeated(trials, 6)
        | {
            "segment": number,
            "from_speed": np.where(number, np.where(number % 2, own, other), np.nan),
            "to_speed": target,
            "start": 5.0 * number,
            "seconds": np.full(n, 5.0),
            "speed_error": random.normal(0, 0.3, n),
            "turn_rate_error_deg": random.normal(0, 4, n),
            "speed_deviation": random.uniform(0.1, 0.6, n),
            "turn_rate_deviation_deg": random.uniform(4, 30, n),
            "offset_mean": random.uniform(0.1, 2, n),
            "rise_time": np.where(number, settled / 2, np.nan),
            "overshoot": np.where(number, random.uniform(0, 0.4, n), np.nan),
            "settling_time": np.where(number, settled, np.nan),
        }
    )


def _timeline(trials: Table, random: np.random.Generator) -> Table:
    rows = round(30 / QUARTER)
    seconds = np.tile(np.arange(rows) * QUARTER, len(trials))
    own, other = np.repeat(trials["speed"], rows), np.repeat(trials["switched_speed"], rows)
    asked = np.where(np.isfinite(other) & (seconds // 5 % 2 == 1), other, own)
    cost = random.gamma(2, asked)
    return Table(
        _repeated(trials, rows)
        | {
            "seconds": seconds,
            "asked_speed": asked,
            "played_speed": 0.9 * asked + random.normal(0, 0.1, len(asked)),
            "played_turn_rate_deg": np.repeat(trials["turn_rate_deg"], rows),
            "offset": random.uniform(0, 1, len(asked)),
            "search_cost": cost,
            "search_cost_pose": 0.4 * cost,
            "search_cost_trajectory": 0.6 * cost,
            "jumps": random.integers(0, 3, len(asked)),
        }
    )


def _bins(trials: Table, quantity: str, width: float) -> Table:
    place = np.arange(-8, 9)
    share = np.exp(-0.5 * (place / 3) ** 2)
    n = len(place)
    return Table(
        _repeated(trials, n)
        | {
            "error_of": np.full(n * len(trials), quantity, object),
            "from": np.tile((place - 0.5) * width, len(trials)),
            "to": np.tile((place + 0.5) * width, len(trials)),
            "share": np.tile(share / share.sum(), len(trials)),
        }
    )


def _fits(trials: Table, quantity: str) -> Table:
    width, n = _WIDTHS[quantity], len(trials)
    two = np.arange(n) % 2 == 1
    return Table(
        _repeated(trials, 1)
        | {
            "error_of": np.full(n, quantity, object),
            "components": 1 + two,
            "share_1": np.where(two, 0.7, 1.0),
            "mean_1": np.full(n, -width),
            "deviation_1": np.full(n, 3 * width),
            "share_2": np.where(two, 0.3, np.nan),
            "mean_2": np.where(two, 2 * width, np.nan),
            "deviation_2": np.where(two, 2 * width, np.nan),
        }
    )


def _graph(trials: Table, clips: list[str], random: np.random.Generator) -> Table:
    n = 3 * len(clips)
    count = random.integers(1, 50, n)
    return Table(
        {
            "dataset": np.full(n, trials["dataset"][0], object),
            "scenario": np.full(n, trials["scenario"][0], object),
            "tracking": np.full(n, trials["tracking"][0], object),
            "from_clip": np.array(clips, object)[random.integers(0, len(clips), n)],
            "to_clip": np.array(clips, object)[random.integers(0, len(clips), n)],
            "count": count,
            "share": np.full(n, 1 / 3),
            "inter_clip": count,
            "intra_clip": np.zeros(n, int),
            "forced_end": np.zeros(n, int),
            "discontinuity_mean": random.uniform(0.01, 0.1, n),
        }
    )
