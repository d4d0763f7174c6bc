"""Stretches without a pose: bridged by slerp where short, left where long or at an edge."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from gmr.markers.bridging import bridge_rotations, bridge_vectors, stretches

seeds = st.integers(0, 10**6)


def gone(frames: int, first: int, length: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    known = np.ones(frames, np.bool_)
    known[first : first + length] = False
    return known


@given(seed=seeds, first=st.integers(1, 20), length=st.integers(1, 12))
def test_a_bridge_is_the_slerp_of_scipy(seed: int, first: int, length: int) -> None:
    turns = Rotation.random(40, rng=np.random.default_rng(seed))
    rotations = turns.as_quat()
    known = gone(40, first, length)
    rotations[~known] = np.nan
    found = Rotation.from_quat(bridge_rotations(rotations, stretches(known, 12)))
    ends = [first - 1, first + length]
    expected = Slerp(ends, turns[ends])(np.arange(first, first + length))
    apart = (expected.inv() * found[first : first + length]).magnitude()
    assert np.max(apart) < 1e-7
    assert np.max((turns[known].inv() * found[known]).magnitude()) < 1e-7


@given(seed=seeds)
def test_successive_quaternions_are_on_one_side(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(np.cumsum(rng.normal(scale=0.3, size=(80, 3)), axis=0))
    signs = rng.choice([-1.0, 1.0], 80)[:, None]
    rotations = turns.as_quat() * signs
    rotations[[3, 50, 51]] = np.nan
    found = bridge_rotations(rotations, ())
    held = found[np.isfinite(found).all(axis=1)]
    assert ((held[1:] * held[:-1]).sum(axis=1) >= 0).all()


@given(seed=seeds, first=st.integers(1, 20), length=st.integers(1, 12))
def test_vectors_are_bridged_by_a_line(seed: int, first: int, length: int) -> None:
    rng = np.random.default_rng(seed)
    line = rng.normal(size=3) + np.arange(40)[:, None] * rng.normal(size=3)
    vectors = line.copy()
    known = gone(40, first, length)
    vectors[~known] = np.nan
    np.testing.assert_allclose(bridge_vectors(vectors, stretches(known, 12)), line, atol=1e-9)


@given(first=st.integers(0, 30), length=st.integers(1, 30), longest=st.integers(0, 12))
def test_what_is_long_or_at_an_edge_is_never_bridged(first: int, length: int, longest: int) -> None:
    length = min(length, 40 - first)
    known = gone(40, first, length)
    (stretch,) = stretches(known, longest)
    inside = first > 0 and first + length < 40
    assert (stretch.became == "bridged") == (inside and length <= longest)
    vectors = np.where(known[:, None], np.ones((40, 3)), np.nan)
    bridged = bridge_vectors(vectors, (stretch,))
    assert np.isnan(bridged).any() == (stretch.became == "unknown")
