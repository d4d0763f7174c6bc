"""The laws of the two-bone solver: lengths stay, what is within reach is reached, the plane is kept."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from gmr.editing import TwoBone, two_bone
from gmr.editing.easing import blend_weights, eased, smooth_above
from gmr.quaternions import rotated

Floats = NDArray[np.float64]

NO_HINGE = np.zeros(3)
coordinates = st.floats(-3, 3, allow_nan=False, allow_subnormal=False)
points = arrays(np.float64, (5, 4, 3), elements=coordinates)


def limbs(at: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Top, middle, end and target of five limbs whose bones have a length."""
    top, middle, end, target = np.moveaxis(at, 1, 0).copy()
    for one, other in ((top, middle), (middle, end)):
        other[np.linalg.norm(other - one, axis=1) < 0.05] += [0.3, 0.2, 0.1]
    end[np.linalg.norm(end - middle, axis=1) < 0.05] += [0.1, 0.3, 0.2]
    return top, middle, end, target


def lengths(top: Floats, middle: Floats, end: Floats) -> tuple[Floats, Floats]:
    return np.linalg.norm(middle - top, axis=1), np.linalg.norm(end - middle, axis=1)


@given(points)
def test_bones_keep_their_lengths_and_what_is_within_reach_is_reached(at: Floats) -> None:
    top, middle, end, target = limbs(at)
    l1, l2 = lengths(top, middle, end)
    found = two_bone(top, middle, end, target, NO_HINGE)
    np.testing.assert_allclose(lengths(top, found.middle, found.end), (l1, l2), rtol=1e-12)
    way = np.linalg.norm(target - top, axis=1)
    lacking = np.maximum(np.maximum(way - (l1 + l2), np.abs(l1 - l2) - way), 0)
    np.testing.assert_allclose(found.missed, lacking, rtol=0, atol=1e-9)


@given(points)
def test_the_turns_are_those_of_the_bones(at: Floats) -> None:
    top, middle, end, target = limbs(at)
    found = two_bone(top, middle, end, target, NO_HINGE)
    np.testing.assert_allclose(np.linalg.norm(found.upper, axis=1), 1, rtol=1e-12)
    np.testing.assert_allclose(top + rotated(found.upper, middle - top), found.middle, atol=1e-12)
    np.testing.assert_allclose(found.middle + rotated(found.lower, end - middle), found.end, atol=1e-12)


@given(points)
def test_a_target_at_the_end_turns_nothing(at: Floats) -> None:
    top, middle, end, _ = limbs(at)
    found = two_bone(top, middle, end, end, NO_HINGE)
    assert (found.upper == [0, 0, 0, 1]).all()
    assert (found.lower == [0, 0, 0, 1]).all()
    np.testing.assert_allclose(found.missed, 0, atol=1e-12)


@given(points)
def test_the_plane_of_the_bend_turns_with_the_way_to_the_target(at: Floats) -> None:
    """The normal is carried by the shortest rotation between the two ways, as SciPy makes it."""
    top, middle, end, target = limbs(at)
    normal = np.cross(middle - top, end - middle)
    sizes = np.linalg.norm(middle - top, axis=1) * np.linalg.norm(end - middle, axis=1)
    found = two_bone(top, middle, end, target, NO_HINGE)
    for k in range(len(top)):
        old, new = end[k] - top[k], target[k] - top[k]
        bend = np.linalg.norm(np.cross(found.middle - top, found.end - found.middle)[k]) / sizes[k]
        well = min(np.linalg.norm(old), np.linalg.norm(new)) > 0.05
        if not well or np.linalg.norm(normal[k]) < 0.02 * sizes[k] or bend < 0.02:
            continue
        across = np.cross(old, new)
        angle = np.arctan2(np.linalg.norm(across), old @ new)
        if not 1e-6 < angle < np.pi - 1e-3:
            continue
        carried = Rotation.from_rotvec(across / np.linalg.norm(across) * angle).apply(normal[k])
        now = np.cross(found.middle - top, found.end - found.middle)[k]
        cosine = carried @ now / np.linalg.norm(carried) / np.linalg.norm(now)
        assert cosine > 1 - 1e-8


def test_no_pose_of_the_limb_is_nearer_to_a_target_out_of_reach() -> None:
    """An optimiser that knows nothing of triangles finds no better pose."""
    top, middle, end = np.zeros((1, 3)), np.array([[0.0, -0.4, 0.05]]), np.array([[0.0, -0.8, 0.0]])
    target = np.array([[0.5, -0.9, 0.3]])
    found = two_bone(top, middle, end, target, NO_HINGE)

    def distance(angles: Floats) -> float:
        upper, lower = (Rotation.from_rotvec(part) for part in (angles[:3], angles[3:]))
        at = upper.apply(middle[0]) + lower.apply(end[0] - middle[0])
        return float(np.linalg.norm(at - target[0]))

    best = minimize(
        distance, np.full(6, 0.1), method="Nelder-Mead", options={"maxiter": 8000, "fatol": 1e-12}
    )
    assert found.missed[0] == pytest.approx(best.fun, abs=1e-6)


def test_a_straight_limb_bends_about_its_hinge() -> None:
    top, middle, end = np.zeros((1, 3)), np.array([[0.0, -1.0, 0.0]]), np.array([[0.0, -2.0, 0.0]])
    hinge = np.array([[-1.0, 0.0, 0.0]])
    found = two_bone(top, middle, end, np.array([[0.0, -1.8, 0.0]]), hinge)
    bend = np.cross(found.middle - top, found.end - found.middle)[0]
    np.testing.assert_allclose(bend / np.linalg.norm(bend), hinge[0], atol=1e-12)
    assert found.missed[0] < 1e-12


@pytest.mark.parametrize("target", [(0, 0, 0), (0, 2, 0), (0, -2, 0), (0, 1e-300, 0), (0, 1e9, 0)])
def test_nothing_is_undefined_where_the_triangle_is_none(target: tuple[float, float, float]) -> None:
    found: TwoBone = two_bone(
        np.zeros((1, 3)),
        np.array([[0.0, -1.0, 0.0]]),
        np.array([[0.0, -2.0, 0.0]]),
        np.array([target]),
        NO_HINGE,
    )
    for array in (found.upper, found.lower, found.middle, found.end, found.missed):
        assert np.isfinite(array).all()
    np.testing.assert_allclose(lengths(np.zeros((1, 3)), found.middle, found.end), 1, rtol=1e-12)


values = st.lists(st.floats(0, 10), min_size=1, max_size=40).map(np.array)


@given(values, st.integers(0, 12))
def test_a_smooth_curve_above_is_nowhere_below_and_ends_within_its_width(curve: Floats, width: int) -> None:
    found = smooth_above(curve, width)
    assert (found >= curve).all()
    assert found.max() <= curve.max() * (1 + 1e-12)
    for frame in np.flatnonzero(found > curve):
        assert curve[max(frame - width, 0) : frame + width + 1].max() > 0


@given(st.integers(3, 20), st.integers(1, 12), st.data())
def test_what_holds_in_intervals_is_led_on_with_a_continuous_slope(
    length: int, blend: int, data: st.DataObject
) -> None:
    first, gap = data.draw(st.integers(0, 10)), data.draw(st.integers(1, 30))
    intervals = [(first, first + length), (first + length + gap, first + 2 * length + gap)]
    curve = np.cumsum(data.draw(arrays(np.float64, (90, 2), elements=st.floats(-1, 1))), axis=0)
    found = eased(curve, intervals, blend)
    inside = np.zeros(90, bool)
    near = np.zeros(90, bool)
    for start, end in intervals:
        inside[start:end] = True
        near[max(start - blend, 0) : end + blend] = True
    np.testing.assert_array_equal(found[inside], curve[inside])
    assert (found[~near] == 0).all()
    # From value v and slope s a cubic of n frames leaves by (2 s + 3 v / n) / n at most in its first frame.
    end = first + length
    if gap > 2 * blend and blend > 1:
        slope = curve[end - 1] - curve[end - 2]
        left = found[end] - found[end - 1] - slope
        bound = (2 * np.abs(slope) + 3 * np.abs(curve[end - 1]) / blend) / blend
        assert (np.abs(left) <= bound + 1e-12).all()


def test_blending_weights_rise_and_fall_smoothly() -> None:
    weights = blend_weights(60, 25, 30, 10)
    assert (weights[25:30] == 1).all()
    assert (weights[:15] == 0).all()
    assert (weights[40:] == 0).all()
    assert (np.diff(weights[15:26]) > 0).all()
    assert np.abs(np.diff(weights, 2)).max() < 0.06
