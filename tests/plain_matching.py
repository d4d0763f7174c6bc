"""A second implementation of a trial, for made-up walkers: plain NumPy in float64, after docs/evaluation.md.

The features come from the formulas that the walkers are made by (:mod:`walker`) instead of from a file; the
search looks at every row.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from locomotion import RATE, Arc

AHEAD = np.array([20, 40, 60])
EVERY = 6
NEAR = 20
RUN_UP = 180
"""In frames: when a row looks at the way ahead, from search to search, what is no candidate about the row
that plays, and the straight line at the beginning of a trial."""

_WEIGHTS = (0.75, 0.75, 1.0, 1.0, 1.0, 1.0, 1.5)
_WIDTHS = (3, 3, 3, 3, 3, 6, 6)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Walk:
    """Where a root is at every step: x, z, heading; and the row that is shown there."""

    place: Array
    row: NDArray[np.int64]


def arc_ahead(seconds: Array, speed: float, turn_rate: float) -> Array:
    """(..., 3) x, z and heading on a circle or a straight line, from the origin along +z (radians)."""
    half = turn_rate * seconds / 2
    chord = speed * seconds * np.sinc(half / np.pi)
    return np.stack([chord * np.sin(half), chord * np.cos(half), 2 * half], axis=-1)


def planned(seconds: Array, speed: float, turn_rate: float) -> Array:
    """(..., 3) where the plan of a constant trial has the root: straight for 3 s, then on the circle."""
    straight = np.minimum(seconds, RUN_UP / RATE)
    place = arc_ahead(seconds - straight, speed, turn_rate)
    place[..., 1] += speed * straight
    return place


def seen_from(place: Array, other: Array) -> Array:
    """(..., 3) a place in the frame of another: to the left, forward, heading."""
    x, z, heading = np.moveaxis(other - place, -1, 0)
    sin, cos = np.sin(place[..., 2]), np.cos(place[..., 2])
    return np.stack([x * cos - z * sin, x * sin + z * cos, heading], axis=-1)


def future(places: Array) -> Array:
    """(..., 12) the last features of a row: ground positions ahead, then directions faced."""
    facing = np.stack([np.sin(places[..., 2]), np.cos(places[..., 2])], axis=-1)
    both = [each.reshape(*each.shape[:-2], -1) for each in (places[..., :2], facing)]
    return np.concatenate(both, axis=-1)


def rows_of(arc: Arc) -> Array:
    """(F, 27) the features of a clip, not scaled yet."""
    turn = np.radians(arc.turn_rate_deg)
    t = np.arange(round(arc.seconds * RATE) + 1) / RATE
    phase = 2 * np.pi * (0.7 + 0.3 * arc.speed) * t
    swing = np.minimum(12 + 12 * arc.speed, 40)
    hips = 0.93 + 0.015 * np.cos(2 * phase)
    joints = [_foot(phase, swing, sign, hips) for sign in (1, -1)] + [np.stack([0 * t, hips, 0 * t], axis=-1)]
    spins = np.array([0.0, -turn, 0.0])
    along = np.array([0.0, 0.0, arc.speed])
    velocities = [np.gradient(joint, 1 / RATE, axis=0) + np.cross(joint, spins) + along for joint in joints]
    ahead = future(arc_ahead(AHEAD / RATE, arc.speed, turn))
    return np.concatenate([*joints[:2], *velocities, np.tile(ahead, (len(t), 1))], axis=1)


def _foot(phase: Array, swing: float, sign: int, hips: Array) -> Array:
    """(F, 3) an ankle in the frame of the root: thigh and shin are 42 cm, and swing about the x axis."""
    thigh = np.radians(-sign * swing * np.sin(phase))
    shin = thigh + np.radians(5 + swing * (1 + sign * np.cos(phase)) / 2)
    down = np.cos(thigh) + np.cos(shin)
    back = np.sin(thigh) + np.sin(shin)
    return np.stack([np.full(len(phase), 0.09 * sign), hips - 0.05 - 0.42 * down, -0.42 * back], axis=-1)


def walked(clips: Sequence[Arc], speed: float, turn_rate_deg: float, seconds: float) -> Walk:
    """A constant trial with a dataset of these clips, tracking its path in time."""
    turn = np.radians(turn_rate_deg)
    raw = [rows_of(clip) for clip in clips]
    clip = np.repeat(np.arange(len(clips)), [len(rows) for rows in raw])
    ends = np.cumsum([len(rows) for rows in raw])
    last = np.repeat(ends, np.diff(ends, prepend=0)) - 1
    every = np.arange(len(clip))
    candidate = every + AHEAD[-1] <= last
    rows = np.concatenate(raw)
    scale = _scale(rows[candidate])
    moves = [arc_ahead(np.array(1 / RATE), each.speed, np.radians(each.turn_rate_deg)) for each in clips]

    def wanted(step: int, place: Array) -> Array:
        return future(seen_from(place, planned((step + AHEAD) / RATE, speed, turn)))

    def cost(query: Array, whose: NDArray[np.int64]) -> Array:
        return np.asarray((((rows[whose] - query) / scale) ** 2).sum(axis=1))

    steps = round(seconds * RATE)
    places, shown, due = np.zeros((steps + 1, 3)), np.zeros(steps + 1, np.int64), 0
    possible = np.flatnonzero(candidate)
    start = (((rows[possible, 15:] - wanted(0, places[0])) / scale[15:]) ** 2).sum(axis=1)
    row = int(possible[np.argmin(start)])
    for step in range(steps + 1):
        ended = row == last[row]
        if ended or due == 0 or step == RUN_UP:
            due = EVERY
            query = np.concatenate([rows[row, :15], wanted(step, places[step])])
            other = np.flatnonzero(candidate & ((clip != clip[row]) | (np.abs(every - row) > NEAR)))
            costs = cost(query, other)
            best = int(np.argmin(costs))
            if ended or costs[best] < cost(query, np.array([row]))[0]:
                row = int(other[best])
        due -= 1
        shown[step] = row
        if step < steps:
            x, z, heading = places[step]
            left, forward, turned = moves[clip[row]]
            places[step + 1] = (
                x + left * np.cos(heading) + forward * np.sin(heading),
                z - left * np.sin(heading) + forward * np.cos(heading),
                heading + turned,
            )
        row = min(row + 1, int(last[row]))
    return Walk(places, shown)


def _scale(rows: Array) -> Array:
    """(27,) the mean standard deviation of each group over its weight."""
    edges = np.cumsum(_WIDTHS)[:-1]
    spreads = [group.mean() for group in np.split(rows.std(axis=0), edges)]
    return np.repeat(np.array(spreads) / _WEIGHTS, _WIDTHS)
