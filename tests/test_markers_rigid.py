"""Rigid fits against an independent implementation, and what templates must keep."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gmr.markers.rigid import find_template, fit_poses
from gmr.quaternions import from_matrices, matrices

Array = NDArray[np.float64]

seeds = st.integers(0, 2**32 - 1)


def cluster(rng: np.random.Generator, count: int) -> Array:
    """Some markers that are not on one line."""
    while True:
        points = rng.uniform(-0.2, 0.2, (count, 3))
        if np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1] > 0.05:
            return np.asarray(points, np.float64)


def moved(rng: np.random.Generator, points: Array, frames: int) -> tuple[Array, Array, Array]:
    """The cluster in some frames, with the rotations and places that brought it there."""
    turns = Rotation.random(frames, rng=rng).as_matrix()
    places = rng.uniform(-3, 3, (frames, 3))
    return points @ np.swapaxes(turns, 1, 2) + places[:, None], turns, places


@given(seed=seeds, count=st.integers(3, 7), noise=st.sampled_from([0.0, 0.002, 0.02]))
def test_a_pose_is_the_one_that_scipy_finds(seed: int, count: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    points = cluster(rng, count)
    positions, _, _ = moved(rng, points, 4)
    positions += rng.normal(scale=noise, size=positions.shape)
    fit = fit_poses(points, positions)
    assert fit.known.all()
    for frame in range(4):
        world, local = positions[frame], points
        turn, _ = Rotation.align_vectors(world - world.mean(axis=0), local - local.mean(axis=0))
        found = Rotation.from_matrix(fit.rotations[frame])
        assert (turn.inv() * found).magnitude() < 1e-6
        np.testing.assert_allclose(
            fit.origins[frame], world.mean(axis=0) - turn.apply(local.mean(axis=0)), atol=1e-6
        )


@given(seed=seeds, count=st.integers(3, 6))
def test_a_mirrored_cluster_is_turned_and_never_mirrored(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = cluster(rng, count)
    fit = fit_poses(points, (points * [-1.0, 1.0, 1.0])[None])
    np.testing.assert_allclose(np.linalg.det(fit.rotations), 1.0, atol=1e-12)


@given(seed=seeds, count=st.integers(4, 6))
def test_markers_that_are_not_seen_have_no_say(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = cluster(rng, count)
    positions, _, _ = moved(rng, points, 5)
    positions += rng.normal(scale=0.003, size=positions.shape)
    hidden = positions.copy()
    hidden[:, 0] = np.nan
    with_gap, without = fit_poses(points, hidden), fit_poses(points[1:], positions[:, 1:])
    np.testing.assert_allclose(with_gap.rotations, without.rotations, atol=1e-9)
    np.testing.assert_allclose(with_gap.origins, without.origins, atol=1e-9)
    assert np.isnan(with_gap.residuals[:, 0]).all()


@given(seed=seeds, count=st.integers(3, 6))
def test_the_template_of_a_rigid_cluster_is_its_shape(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = cluster(rng, count)
    positions, _, _ = moved(rng, points, 12)
    template = find_template(positions)
    assert template is not None
    assert np.nanmax(fit_poses(template.points, positions).residuals) < 1e-9
    apart = np.linalg.norm(template.points[:, None] - template.points[None], axis=2)
    np.testing.assert_allclose(apart, np.linalg.norm(points[:, None] - points[None], axis=2), atol=1e-9)


def test_a_template_is_whole_although_no_frame_is() -> None:
    rng = np.random.default_rng(5)
    points = cluster(rng, 5)
    positions, _, _ = moved(rng, points, 30)
    for frame in range(30):
        positions[frame, frame % 5] = np.nan
    template = find_template(positions)
    assert template is not None
    assert np.isfinite(template.points).all()
    assert np.nanmax(fit_poses(template.points, positions).residuals) < 1e-9


def test_noise_in_the_template_averages_out() -> None:
    rng = np.random.default_rng(6)
    points = cluster(rng, 5)
    positions, _, _ = moved(rng, points, 400)
    template = find_template(positions + rng.normal(scale=0.004, size=positions.shape))
    assert template is not None
    fit = fit_poses(template.points, points[None])
    assert np.nanmax(fit.residuals) < 0.0025


@pytest.mark.parametrize("count", [1, 2])
def test_fewer_than_three_markers_have_no_template(count: int) -> None:
    assert find_template(np.zeros((5, count, 3))) is None


def test_markers_on_one_line_have_no_pose() -> None:
    line = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.3, 0.0, 0.0]])
    assert find_template(np.repeat(line[None], 4, axis=0)) is None
    assert not fit_poses(line, line[None]).known.any()


@given(seed=seeds)
def test_quaternions_of_matrices_turn_as_they_do(seed: int) -> None:
    turns = Rotation.random(20, rng=np.random.default_rng(seed)).as_matrix()
    np.testing.assert_allclose(matrices(from_matrices(turns)), turns, atol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_quaternions_of_half_turns_are_whole(axis: int) -> None:
    half = -np.eye(3)
    half[axis, axis] = 1
    np.testing.assert_allclose(np.abs(from_matrices(half)), np.eye(4)[axis])
