"""Joint centres: exact where the motion tells, anatomy's where it does not, weighed between."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gmr.markers.centres import Centre, Guess, joint_centre
from gmr.markers.rigid import RigidFit, fit_poses

Array = NDArray[np.float64]

seeds = st.integers(0, 2**32 - 1)
CLUSTER = np.array([[0.05, 0.0, 0.02], [-0.05, -0.1, 0.03], [0.02, -0.2, -0.05], [0.06, -0.15, 0.0]])
FRAMES = 60


def part(turns: Rotation, places: Array, noise: float, rng: np.random.Generator) -> RigidFit:
    positions = CLUSTER @ np.swapaxes(turns.as_matrix(), 1, 2) + places[:, None]
    return fit_poses(CLUSTER, positions + rng.normal(scale=noise, size=positions.shape))


def joint(seed: int, relative: Rotation, noise: float = 0.0) -> tuple[RigidFit, RigidFit, Array, Array]:
    """Two parts that hang together, and where their joint is in each."""
    rng = np.random.default_rng(seed)
    in_parent, in_child = rng.uniform(-0.3, 0.3, (2, 3))
    turns = Rotation.random(FRAMES, rng=rng)
    places = rng.uniform(-2, 2, (FRAMES, 3))
    below = turns * relative
    centre = turns.apply(in_parent) + places
    parent = part(turns, places, noise, rng)
    child = part(below, centre - below.apply(in_child), noise, rng)
    return parent, child, in_parent, in_child


def ball(seed: int, degrees: float) -> Rotation:
    rng = np.random.default_rng(seed + 1)
    return Rotation.from_rotvec(np.radians(rng.uniform(-degrees, degrees, (FRAMES, 3))))


def hinge(axis: Array, degrees: float) -> Rotation:
    return Rotation.from_rotvec(np.radians(np.linspace(0, degrees, FRAMES))[:, None] * axis)


def guess(place: Array, within: float = 0.008) -> Guess:
    return Guess(np.asarray(place, np.float64), np.eye(3) * within**2, "a rule")


@given(seed=seeds, degrees=st.floats(5, 90))
def test_a_ball_joint_without_noise_is_found_exactly(seed: int, degrees: float) -> None:
    parent, child, in_parent, in_child = joint(seed, ball(seed, degrees))
    found = joint_centre(parent, child, None)
    np.testing.assert_allclose(found.in_parent, in_parent, atol=1e-8)
    np.testing.assert_allclose(found.in_child, in_child, atol=1e-8)
    assert found.gap < 1e-8


@given(seed=seeds)
def test_a_wrong_rule_does_not_move_what_the_motion_tells_exactly(seed: int) -> None:
    parent, child, in_parent, _ = joint(seed, ball(seed, 40))
    found = joint_centre(parent, child, guess(in_parent + np.array([0.02, -0.01, 0.01])))
    np.testing.assert_allclose(found.in_parent, in_parent, atol=1e-6)
    assert found.apart == pytest.approx(np.linalg.norm([0.02, -0.01, 0.01]), abs=1e-6)
    assert found.weight > 0.999


@given(seed=seeds)
def test_along_the_axis_of_a_hinge_anatomy_has_the_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    axis = Rotation.random(rng=rng).apply([1.0, 0.0, 0.0])
    parent, child, in_parent, _ = joint(seed, hinge(axis, 70))
    across = np.cross(axis, rng.normal(size=3))
    step = 0.015 * axis + 0.01 * across / np.linalg.norm(across)
    found = joint_centre(parent, child, guess(in_parent + step))
    np.testing.assert_allclose(found.in_parent, in_parent + 0.015 * axis, atol=1e-6)
    assert found.weight == pytest.approx(2 / 3, abs=0.01)


def test_without_relative_motion_anatomy_has_the_say() -> None:
    parent, child, in_parent, _ = joint(3, Rotation.identity(FRAMES))
    found = joint_centre(parent, child, guess(in_parent + 0.02))
    np.testing.assert_allclose(found.in_parent, in_parent + 0.02)
    assert found.functional is None
    assert found.weight == 0


@given(seed=seeds, noise=st.floats(0.0005, 0.003))
def test_the_more_a_joint_moves_the_more_its_motion_weighs(seed: int, noise: float) -> None:
    def weight(degrees: float) -> float:
        parent, child, in_parent, _ = joint(seed, ball(seed, degrees), noise)
        return joint_centre(parent, child, guess(in_parent)).weight

    assert weight(5) < weight(20) < weight(60)


@given(seed=seeds)
def test_soft_parts_leave_the_say_to_anatomy(seed: int) -> None:
    def off(noise: float) -> float:
        parent, child, in_parent, _ = joint(seed, ball(seed, 12), noise)
        return joint_centre(parent, child, guess(in_parent)).weight

    assert off(0.0005) > off(0.005) > off(0.02)
    assert off(0.02) < 0.1


@given(seed=seeds)
def test_a_centre_does_not_depend_on_where_the_laboratory_is(seed: int) -> None:
    def found(turn: Rotation, step: Array) -> Centre:
        parent, child, in_parent, _ = joint(seed, ball(seed, 25), 0.002)
        moved = [
            RigidFit(
                fit.points,
                np.asarray(turn.as_matrix() @ fit.rotations, np.float64),
                np.asarray(turn.apply(fit.origins) + step, np.float64),
                fit.known,
                fit.residuals,
            )
            for fit in (parent, child)
        ]
        return joint_centre(moved[0], moved[1], guess(in_parent + 0.01))

    here = found(Rotation.identity(), np.zeros(3))
    there = found(Rotation.random(rng=np.random.default_rng(seed)), np.array([3.0, -1.0, 2.0]))
    np.testing.assert_allclose(there.in_parent, here.in_parent, atol=1e-9)
    assert there.gap == pytest.approx(here.gap, abs=1e-9)


def test_the_functional_centre_is_the_least_squares_one_of_both_parts() -> None:
    parent, child, _, _ = joint(11, ball(11, 30), 0.004)
    found = joint_centre(parent, child, None)
    rows = np.concatenate([parent.rotations, -child.rotations], axis=2).reshape(-1, 6)
    both, *_ = np.linalg.lstsq(rows, (child.origins - parent.origins).reshape(-1), rcond=None)
    np.testing.assert_allclose(found.in_parent, both[:3], atol=1e-9)
    np.testing.assert_allclose(found.in_child, both[3:], atol=1e-9)


def test_too_few_frames_without_a_rule_are_refused() -> None:
    parent, child, _, _ = joint(2, ball(2, 30))

    def few(fit: RigidFit) -> RigidFit:
        return RigidFit(fit.points, fit.rotations[:4], fit.origins[:4], fit.known[:4], fit.residuals[:4])

    with pytest.raises(ValueError, match="4 frames show both parts"):
        joint_centre(few(parent), few(child), None)
