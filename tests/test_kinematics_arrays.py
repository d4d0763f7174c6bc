"""`gmr.forward_kinematics`: plain arrays in, world positions out."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import gmr
from kinematics_oracle import random_case, world

QUARTER = float(np.sqrt(0.5))
ARM = ([-1, 0, 1], [[0, 0, 0], [0, 1, 0], [0, 1, 0]])


@given(
    st.integers(0, 2**32),
    st.integers(1, 12),
    st.integers(0, 20),
    st.integers(1, 3),
    st.sampled_from(["post", "pre"]),
)
def test_every_joint_is_where_the_formula_puts_it(
    seed: int, joints: int, frames: int, roots: int, order: Literal["post", "pre"]
) -> None:
    case = random_case(seed, max(joints, roots), frames, root_count=roots, pre=order == "pre")
    case.slots[:] = np.arange(len(case.parents)) if order == "pre" else case.parents
    expected, turned = world(case)
    lengths = np.random.default_rng(seed).uniform(0.5, 2, (*case.rotations.shape[:2], 1))
    found, rotations = gmr.forward_kinematics(
        case.parents, case.offsets, case.rotations * lengths, case.translations, order,
        translated=case.translated, world_rotations=True,
    )  # fmt: skip
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * case.height)
    if frames:
        for joint, above in enumerate(turned):
            own = Rotation.from_quat(case.rotations[:, joint])
            frame = above if order == "pre" else above * own
            cosines = np.abs((rotations[:, joint] * frame.as_quat()).sum(-1))
            np.testing.assert_allclose(cosines, 1, atol=1e-12)


def test_post_rotation_turns_what_hangs_below_and_pre_rotation_the_bone_above() -> None:
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
    turns[1] = [QUARTER, 0, 0, QUARTER]  # +Y to +Z
    post = gmr.forward_kinematics(*ARM, turns)
    pre = gmr.forward_kinematics(*ARM, turns, rotation_order="pre")
    np.testing.assert_allclose(post, [[0, 0, 0], [0, 1, 0], [0, 1, 1]], atol=1e-15)
    np.testing.assert_allclose(pre, [[0, 0, 0], [0, 0, 1], [0, 0, 2]], atol=1e-15)


def test_leading_dimensions_type_and_out_are_kept() -> None:
    rng = np.random.default_rng(3)
    turns = rng.normal(size=(2, 5, 3, 4)).astype(np.float32)
    places = rng.normal(size=(2, 5, 3))
    out = np.empty((2, 5, 2, 3), np.float32)
    found = gmr.forward_kinematics(*ARM, turns, places, joints=[2, 0], out=out)
    assert found is out
    np.testing.assert_array_equal(found[:, :, 1], places.astype(np.float32))
    one = gmr.forward_kinematics(*ARM, turns[1, 4], places[1, 4])
    assert one.dtype == np.float32
    np.testing.assert_array_equal(one[2], found[1, 4, 0])


def test_without_normalising_unit_rotations_give_the_same_to_rounding() -> None:
    case = random_case(5, 20, 33)
    exact = gmr.forward_kinematics(case.parents, case.offsets, case.rotations, normalize=False)
    scaled = gmr.forward_kinematics(case.parents, case.offsets, 3 * case.rotations)
    np.testing.assert_allclose(scaled, exact, rtol=0, atol=1e-13 * case.height)
    long = gmr.forward_kinematics(*ARM, np.tile([0.0, 0, QUARTER, QUARTER], (3, 1)) * 1.001, normalize=False)
    assert 1.0015 < np.linalg.norm(long[1] - long[0]) < 1.0025


def test_a_rotation_of_zeros_or_nan_spoils_what_hangs_below_it_in_that_frame_only() -> None:
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (4, 3, 1))
    turns[1, 1] = 0.0
    turns[2, 0, 3] = np.nan
    found = gmr.forward_kinematics(*ARM, turns)
    assert np.isnan(found).any(axis=-1).tolist() == [
        [False] * 3, [False, False, True], [False, True, True], [False] * 3
    ]  # fmt: skip


@pytest.mark.parametrize("threads", [0, 1, 2, 5])
def test_threads_do_not_change_a_bit(threads: int) -> None:
    case = random_case(11, 30, 5000)
    arguments = (case.parents, case.offsets, case.rotations.astype(np.float32))
    alone = gmr.forward_kinematics(*arguments, threads=1)
    np.testing.assert_array_equal(gmr.forward_kinematics(*arguments, threads=threads), alone)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parents": [-1, 0, 3]}, "parents holds 3, but there are 3 joints"),
        ({"parents": [1, 0, -1]}, "its own ancestor"),
        ({"parents": [-1.0, 0, 1]}, "parents must be whole numbers"),
        ({"parents": [-1, 0, 2**40]}, "parents holds 1099511627776, but there are 3"),
        ({"offsets": np.zeros((2, 3))}, r"offsets have shape \(2, 3\); 3 parents need \(3, 3\)"),
        ({"rotations": np.zeros((5, 2, 4))}, r"3 parents need \(..., 3, 4\)"),
        ({"rotations": np.zeros((5, 3, 4), complex)}, "rotations must be real numbers, not complex128"),
        ({"translations": np.zeros((4, 3))}, r"need \(5, 1, 3\) or \(5, 3\)"),
        (
            {"translated": [0, 7], "translations": np.zeros((5, 2, 3))},
            "translated holds 7",
        ),
        ({"joints": [3]}, "joints holds 3, but there are 3 joints"),
        ({"translated": [-1], "translations": np.zeros((5, 3))}, "translated holds -1"),
        ({"joints": [-1]}, "joints holds -1"),
        ({"rotation_order": "left"}, "'post' or 'pre', not 'left'"),
        ({"out": np.empty((5, 3, 3), np.float32)}, "out must be a writable, C-contiguous float64"),
    ],
)
def test_what_does_not_fit_is_refused_in_words(changes: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"parents": ARM[0], "offsets": ARM[1], "rotations": np.ones((5, 3, 4))}
    assert gmr.forward_kinematics(**good).shape == (5, 3, 3)
    with pytest.raises(gmr.GmrError, match=message):
        gmr.forward_kinematics(**(good | changes))
