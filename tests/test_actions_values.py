"""Numbers that follow parameters: the curve is SciPy's, and never leaves the range of its points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from gmr.actionlets.actions.values import Curve, Value, monotone

numbers = st.floats(-100, 100)


@st.composite
def points(draw: st.DrawFn) -> tuple[list[float], list[float]]:
    steps = draw(st.lists(st.floats(0.01, 10), min_size=2, max_size=8))
    return list(np.cumsum(steps)), draw(st.lists(numbers, min_size=len(steps), max_size=len(steps)))


@given(points(), st.floats(0, 1))
def test_a_curve_stays_between_the_points_beside_it(
    given: tuple[list[float], list[float]], share: float
) -> None:
    at, gives = given
    x = at[0] + share * (at[-1] - at[0])
    piece = min(max(int(np.searchsorted(at, x)) - 1, 0), len(at) - 2)
    low, high = sorted(gives[piece : piece + 2])
    assert low - 1e-9 <= monotone(at, gives, x) <= high + 1e-9


@given(points())
def test_a_curve_goes_through_its_points_and_is_level_outside(given: tuple[list[float], list[float]]) -> None:
    at, gives = given
    np.testing.assert_allclose(monotone(at, gives, at), gives, atol=1e-9)
    np.testing.assert_allclose(monotone(at, gives, [at[0] - 5, at[-1] + 5]), [gives[0], gives[-1]], atol=1e-9)


def test_between_its_inner_points_a_curve_is_scipys() -> None:
    at, gives = [0.0, 0.5, 1.3, 2.0, 2.2, 3.0], [0.0, 9.0, 19.0, 23.0, 21.0, 21.5]
    x = np.linspace(0.5, 2.2, 100)
    np.testing.assert_allclose(monotone(at, gives, x), PchipInterpolator(at, gives)(x), atol=1e-12)


@given(points(), numbers, st.lists(st.floats(-200, 200), min_size=1, max_size=5))
def test_a_value_keeps_within_what_it_says(
    given: tuple[list[float], list[float]], base: float, asked: list[float]
) -> None:
    value = Value(
        base, (Curve("speed", tuple(given[0]), tuple(given[1])), Curve("mood", (0.0, 1.0), (0.0, -3.0)))
    )
    found = value.at({"speed": np.array(asked), "mood": 0.5})
    assert found.shape == (len(asked),)
    assert (found >= value.lowest - 1e-9).all()
    assert (found <= value.highest + 1e-9).all()


@given(points(), numbers)
def test_a_mirrored_value_is_the_value_of_the_other_sign(
    given: tuple[list[float], list[float]], turn_rate: float
) -> None:
    value = Value(1.0, (Curve("turn_rate", tuple(given[0]), tuple(given[1])),))
    mirrored = value.mirrored({"turn_rate"})
    assert mirrored.at({"turn_rate": -turn_rate}) == pytest.approx(
        value.at({"turn_rate": turn_rate}), abs=1e-9
    )
    assert value.mirrored({"speed"}) == value
