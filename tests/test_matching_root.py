"""The simulation root: steady motion stays steady, and a file's own root is used only when it is one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import savgol_filter

from gmr import _core
from gmr.matching import Database
from gmr.motion import Motion
from gmr.quaternions import conjugate, multiply
from gmr.skeleton import Skeleton
from kept_poses import shown
from walkers import about_y, arc, body, walker

speeds = st.floats(-3.0, 5.0)
turn_rates = st.floats(-2.0, 2.0)
headings = st.floats(-20.0, 20.0)


@given(st.integers(1, 40), st.integers(0, 60), st.integers(0, 2**32 - 1))
def test_smoothing_is_scipys_savgol_filter(half: int, more: int, seed: int) -> None:
    window = 2 * half + 1
    samples = np.random.default_rng(seed).normal(size=window + more)
    expected = savgol_filter(samples, window, min(3, window - 1), mode="interp")
    np.testing.assert_allclose(_core.smooth(samples, window), expected, atol=1e-9)


@given(speeds, headings)
def test_a_straight_walk_has_exactly_its_speed_in_every_frame(speed: float, heading: float) -> None:
    database = Database.build([walker(2.0, speed, heading=heading)])
    velocity = database.displacements * database.rate
    np.testing.assert_allclose(velocity, np.broadcast_to([0.0, speed], velocity.shape), atol=1e-4)
    np.testing.assert_allclose(database.turns, 0.0, atol=1e-5)


@given(turn_rates, headings)
def test_a_turn_on_the_spot_has_exactly_its_rate_in_every_frame(turn_rate: float, heading: float) -> None:
    database = Database.build([walker(2.0, 0.0, turn_rate, heading=heading)])
    np.testing.assert_allclose(database.turns * database.rate, turn_rate, atol=3e-3)
    assert np.ptp(database.headings) == pytest.approx(abs(turn_rate) * 2.0, abs=1e-3)


@given(st.floats(0.5, 4.0), turn_rates)
def test_a_circle_keeps_speed_and_turn_rate_to_its_ends(speed: float, turn_rate: float) -> None:
    database = Database.build([walker(3.0, speed, turn_rate)])
    steps = np.hypot(*database.displacements.T) * database.rate
    np.testing.assert_allclose(steps, speed, rtol=0.02)
    np.testing.assert_allclose(database.turns * database.rate, turn_rate, atol=3e-3)


def with_root_joint(moves: bool, forward_turn: float = 0.0) -> Motion:
    """A walk on a circle with a joint above the hips: on the ground below them, or at the origin for ever."""
    inner = walker(4.0, 1.2, 0.5)
    skeleton = body()
    above = Skeleton.post_rotation(
        ["Reference", *skeleton.names],
        [-1, *(parent + 1 for parent in skeleton.parents.tolist())],
        np.concatenate([np.zeros((1, 3)), skeleton.offsets]),
        turning=range(skeleton.joint_count + 1),
    )
    frames = inner.frame_count
    t = np.arange(frames) / 60
    heading = (0.5 * t if moves else np.zeros(frames)) + forward_turn
    ground = arc(t, 1.2, 0.5, 0.0) if moves else np.zeros((frames, 2))
    root = about_y(heading)[:, None]
    rotations = np.concatenate([root, inner.rotations], axis=1)
    rotations[:, 1] = multiply(conjugate(root[:, 0]), inner.rotations[:, 0])
    away = inner.translations[:, 0] - np.stack([ground[:, 0], np.zeros(frames), ground[:, 1]], axis=1)
    cos, sin = np.cos(-heading), np.sin(-heading)
    local = np.stack(
        [cos * away[:, 0] + sin * away[:, 2], away[:, 1], -sin * away[:, 0] + cos * away[:, 2]], axis=1
    )
    translations = np.stack([np.stack([ground[:, 0], np.zeros(frames), ground[:, 1]], axis=1), local], axis=1)
    return Motion.from_pose(above, rotations, translations, 1 / 60, translated=[0, 1], unit=1.0, name="walk")


@pytest.mark.parametrize("forward_turn", [0.0, np.pi / 2, -np.pi / 2, np.pi])
def test_a_root_joint_that_goes_with_the_body_is_used_as_it_is(forward_turn: float) -> None:
    database = Database.build([with_root_joint(moves=True, forward_turn=forward_turn)])
    assert any("'Reference'" in note for note in database.notes)
    t = np.arange(len(database)) / 60
    np.testing.assert_allclose(database.ground, arc(t, 1.2, 0.5, 0.0), atol=1e-5)
    np.testing.assert_allclose(database.headings, 0.5 * t, atol=1e-5)


def test_a_root_joint_that_rests_at_the_origin_is_no_simulation_root() -> None:
    database = Database.build([with_root_joint(moves=False)])
    assert not any("'Reference'" in note for note in database.notes)
    np.testing.assert_allclose(np.hypot(*database.displacements.T) * 60, 1.2, rtol=0.02)


def test_a_joint_that_the_body_walks_away_from_is_carried_along() -> None:
    """Else its metres would count as pose, and blending two clips would fling the body about."""
    plain = Database.build([walker(4.0, 1.2, 0.5)], mirror=True)
    database = Database.build([with_root_joint(moves=False)], mirror=True)
    np.testing.assert_allclose(database.positions[:, 0], 0.0, atol=1e-6)
    np.testing.assert_allclose(database.positions[:, 1:], plain.positions, atol=1e-5)
    np.testing.assert_allclose(np.abs(database.core.rotations[:, 0, 3]), 1.0, atol=1e-6)
    for rows in (database.clip_rows(0), database.clip_rows(1)):
        np.testing.assert_allclose(shown(database, rows), database.positions[rows], atol=1e-5)


def test_a_body_without_width_has_no_facing() -> None:
    flat = np.zeros((5, 3, 3), np.float32)
    with pytest.raises(ValueError, match="no facing in any frame"):
        _core.simulation_root(flat, 0, [(1, 2)], 31, 61)
    with pytest.raises(ValueError, match="joints holds 3 elements where 8 are needed"):
        _core.simulation_root(flat, 0, [(1, 7)], 31, 61)
