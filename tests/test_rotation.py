"""Euler orders, their inverse and slerp against SciPy."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from gmr import _core

ORDERS = [axes for axes in product(range(3), repeat=3) if axes[0] != axes[1] != axes[2]]
ANGLES = st.one_of(st.floats(-720, 720), st.sampled_from([-180.0, -90.0, 0.0, 90.0, 180.0, 1e5, 1e-9]))


def euler(rows: NDArray[np.float64], axes: NDArray[np.uint8], dtype: Any = np.float64) -> NDArray[Any]:
    """Rotations of slots whose angles stand side by side in the rows."""
    columns = np.arange(axes.size, dtype=np.int32).reshape(axes.shape)
    out = np.empty((len(rows), len(axes), 4), dtype)
    _core.euler_to_quaternions(rows, columns, axes, out)
    return out


def scipy_euler(degrees: NDArray[np.float64], axes: tuple[int, ...]) -> NDArray[np.float64]:
    """The same rotations, of one slot."""
    return Rotation.from_euler("".join("XYZ"[axis] for axis in axes), degrees, degrees=True).as_quat()


def angle_between(a: NDArray[Any], b: NDArray[Any]) -> float:
    """The largest angle in radians between rotations, signs aside."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    nearer = np.minimum(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))
    return float(2 * nearer.max())


@pytest.mark.parametrize("axes", ORDERS)
@given(degrees=st.lists(st.tuples(ANGLES, ANGLES, ANGLES), min_size=1, max_size=40))
def test_all_twelve_orders_compose_as_scipys_do(
    axes: tuple[int, ...], degrees: list[tuple[float, ...]]
) -> None:
    rows, turning = np.array(degrees), np.array([axes], np.uint8)
    expected = scipy_euler(rows, axes)
    assert angle_between(euler(rows, turning)[:, 0], expected) < 1e-12
    assert angle_between(euler(rows, turning, np.float32)[:, 0], expected) < 2e-6


@pytest.mark.parametrize("axes", ORDERS)
@given(degrees=st.lists(st.tuples(ANGLES, ANGLES, ANGLES), min_size=1, max_size=40))
def test_angles_of_all_twelve_orders_name_the_same_rotation(
    axes: tuple[int, ...], degrees: list[tuple[float, ...]]
) -> None:
    rotations = scipy_euler(np.array(degrees), axes)
    angles = _core.quaternions_to_euler(rotations[:, None], np.array([axes], np.uint8))
    assert angle_between(scipy_euler(angles[:, 0], axes), rotations) < 1e-7


@pytest.mark.parametrize("axes", ORDERS)
def test_angles_of_a_smooth_motion_come_back_themselves(axes: tuple[int, ...]) -> None:
    frames = np.linspace(0, 1, 200)[:, None]
    middle = 90 if axes[0] == axes[2] else 0
    degrees = [20, middle - 60, -40] + frames * [700, 120, -500]
    rotations = euler(degrees, np.array([axes], np.uint8))
    back = _core.quaternions_to_euler(rotations, np.array([axes], np.uint8))
    np.testing.assert_allclose(back[:, 0], degrees, atol=1e-9)


def test_axes_that_do_not_reach_every_rotation_are_refused() -> None:
    with pytest.raises(ValueError, match=r"slot 1 turns about the axes \[0, 0, 1\]"):
        _core.quaternions_to_euler(np.ones((2, 2, 4)), np.array([[0, 1, 2], [0, 0, 1]], np.uint8))


def test_columns_and_axes_that_do_not_exist_are_refused() -> None:
    out = np.empty((4, 1, 4))
    axes = np.array([[0, 1, 2]], np.uint8)
    for columns, wrong, message in [
        ([[0, 1, 3]], axes, "rotation_columns holds 3 at place 2, but there are 3"),
        ([[0, 1, -2]], axes, "rotation_columns holds -2"),
        ([[0, 1, 2]], np.array([[0, 1, 3]], np.uint8), "rotation_axes holds 3 at place 2"),
        ([[0, 1, 2], [0, 1, 2]], axes, "rotation_axes"),
    ]:
        with pytest.raises(ValueError, match=message):
            _core.euler_to_quaternions(np.zeros((4, 3)), np.array(columns, np.int32), wrong, out)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@given(seed=st.integers(0, 2**32), frames=st.integers(2, 12), slots=st.integers(1, 4))
def test_resampling_is_scipys_slerp_with_signs_that_never_jump(
    dtype: Any, seed: int, frames: int, slots: int
) -> None:
    rng = np.random.default_rng(seed)
    rotations = rng.normal(size=(frames, slots, 4))
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    times = np.sort(rng.uniform(0, frames - 1, 30))
    found = _core.slerp_frames(rotations.astype(dtype), times)
    assert found.dtype == dtype
    for slot in range(slots):
        expected = Slerp(np.arange(frames), Rotation.from_quat(rotations[:, slot]))(times).as_quat()
        assert angle_between(found[:, slot], expected) < (1e-5 if dtype == np.float32 else 1e-9)
    assert ((found[1:] * found[:-1]).sum(-1) >= 0).all()


def test_whole_times_give_the_frames_and_times_beyond_hold_the_ends() -> None:
    rotations = np.random.default_rng(1).normal(size=(4, 2, 4))
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    found = _core.slerp_frames(rotations, np.array([-2.0, 0.0, 1.0, 2.0, 3.0, 9.0]))
    np.testing.assert_array_equal(np.abs(found), np.abs(rotations[[0, 0, 1, 2, 3, 3]]))
