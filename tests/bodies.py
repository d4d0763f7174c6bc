"""Bodies and angles for tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from gmr.actionlets import Body

Floats = NDArray[np.float64]

heights = st.floats(1.2, 2.3)
sexes = st.sampled_from(["male", "female", "average"])
bodies = st.builds(Body.of, heights, sexes, st.none(), st.booleans())
seeds = st.integers(0, 2**32 - 1)


def in_range(body: Body, seed: int, frames: int = 20) -> Floats:
    """(F, D) angles drawn from all of the ranges, as much as 30 degrees or metres of 0.3 where there is none;
    sideways angles of shoulders keep off the right angle, at which flexion and rotation are one."""
    rng = np.random.default_rng(seed)
    low = np.where(np.isfinite(body.low), body.low, -0.3)
    high = np.where(np.isfinite(body.high), body.high, 0.3)
    angles = low + (high - low) * rng.random((frames, body.dof_count))
    for side in ("left", "right"):
        sideways = angles[:, body.column(f"{side}_shoulder.abduction")]
        sideways[np.abs(sideways - np.pi / 2) < 1e-3] += 0.01
    return np.asarray(angles, np.float64)


def alone(body: Body, name: str, value: float) -> Floats:
    """(1, D) one degree of freedom alone."""
    angles = np.zeros((1, body.dof_count))
    angles[0, body.column(name)] = value
    return angles
