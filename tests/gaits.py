"""A rough gait from textbook angles, to walk and run with: extremes of hip, knee and ankle over the cycle,
joined by the cosine bell of an actionlet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets import Body
from gmr.actionlets.travel import Plan

Floats = NDArray[np.float64]
Extremes = list[tuple[float, float]]

# Phase from the heel's contact and degrees; hips as thighs from the vertical. Perry and Burnfield, Gait
# Analysis, 2nd ed., 2010, figures 4 to 6; Novacheck, "The biomechanics of running" (1998), figure 5.
_WALK: dict[str, Extremes] = {
    "hip.flexion": [(0.0, 24), (0.52, -19), (0.85, 27)],
    "knee.flexion": [(0.0, 5), (0.14, 17), (0.40, 6), (0.72, 60)],
    "ankle.flexion": [(0.0, 0), (0.07, -6), (0.45, 10), (0.63, -18), (0.82, 2)],
}
_RUN: dict[str, Extremes] = {
    "hip.flexion": [(0.0, 28), (0.44, -20), (0.84, 38)],
    "knee.flexion": [(0.0, 15), (0.14, 40), (0.36, 18), (0.68, 95)],
    "ankle.flexion": [(0.0, 5), (0.16, 20), (0.40, -22), (0.70, 0)],
}


def bell(times: Floats, points: list[tuple[float, float]]) -> Floats:
    """Angles in radians through (seconds, degrees)."""
    at, angles = np.array([p[0] for p in points]), np.radians([p[1] for p in points])
    k = np.clip(np.searchsorted(at, times, side="right") - 1, 0, len(at) - 2)
    x = np.clip((times - at[k]) / (at[k + 1] - at[k]), 0, 1)
    return np.asarray(angles[k] + (angles[k + 1] - angles[k]) * (x - np.sin(2 * np.pi * x) / (2 * np.pi)))


def gait(
    body: Body, speed: float, turn_rate: float, seconds: float = 3.0, fps: float = 120.0, runs: bool = False
) -> tuple[Floats, Plan]:
    """(F, D) planned angles and the plan of a body that walks or runs; radians a second to the left."""
    extremes = _RUN if runs else _WALK
    if runs:
        period, duty = 0.74 - 0.02 * speed, float(np.interp(speed, [2, 5], [0.42, 0.30]))
        scale = float(np.interp(speed, [2, 3, 5], [0.7, 0.9, 1.3]))
    else:
        period = float(np.interp(speed, [0.3, 0.8, 1.4, 2.0, 2.5], [1.8, 1.3, 1.08, 0.94, 0.84]))
        duty = float(np.interp(speed, [0.3, 1.4, 2.5], [0.68, 0.62, 0.57]))
        scale = float(np.interp(speed, [0.3, 0.8, 1.4, 2.5], [0.45, 0.75, 1.0, 1.3]))
    times = np.arange(round(seconds * fps) + 1) / fps
    angles = np.zeros((len(times), body.dof_count))
    cycles = range(-2, int(seconds / period) + 3)
    contacts = {}
    for side, phase in (("left", 0.0), ("right", 0.5)):
        for motion, points in extremes.items():
            name = f"{side}_{motion}"
            if name in body.columns:
                size = scale if motion == "hip.flexion" else 1.0
                track = [((c + at - phase) * period, size * value) for c in cycles for at, value in points]
                angles[:, body.column(name)] = bell(times, track)
        angles[:, body.column(f"{side}_elbow.flexion")] = np.radians(90 if runs else 15)
        contacts[side] = np.array([((c - phase) * period, (c - phase + duty) * period) for c in cycles])
    return angles, Plan(contacts, np.array([[0.0, speed]]), np.array([[0.0, turn_rate]]))


def mirrored(body: Body, angles: Floats, plan: Plan) -> tuple[Floats, Plan]:
    """The same seen in a mirror at x = 0."""
    found = np.empty_like(angles)
    for column, name in enumerate(body.names):
        other = name
        if name.startswith(("left_", "right_")):
            side, rest = name.split("_", 1)
            other = f"{'right' if side == 'left' else 'left'}_{rest}"
        sign = -1.0 if name.endswith(_SIDED) and name == other else 1.0
        found[:, body.column(other)] = sign * angles[:, column]
    contacts = {"left": plan.contacts["right"], "right": plan.contacts["left"]}
    return found, Plan(contacts, plan.speed, plan.turn_rate * np.array([1.0, -1.0]), plan.travel)


_SIDED = (".lateral", ".rotation", ".sway", ".obliquity")
