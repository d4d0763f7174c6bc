"""Where anatomy has joint centres: the papers' equations, their symmetry, their independence of the axes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gmr.markers.anatomy import Acromion, Body, Cervical, Chord, Harrington, Lumbar, Midpoint, Offset, Rule

Array = NDArray[np.float64]

POINTS = {
    "LASI": np.array([0.12, 0.0, 0.0]), "RASI": np.array([-0.12, 0.0, 0.0]),
    "LPSI": np.array([0.05, 0.0, -0.15]), "RPSI": np.array([-0.05, 0.0, -0.15]),
    "C7": np.array([0.0, 0.4, -0.07]), "CLAV": np.array([0.0, 0.34, 0.06]),
    "LSHO": np.array([0.2, 0.42, 0.0]), "RSHO": np.array([-0.2, 0.42, 0.0]),
    "knee": np.array([0.15, -0.4, 0.0]), "wand": np.array([0.2, -0.2, 0.02]),
    "hip": np.array([0.09, -0.08, -0.05]),
}  # fmt: skip
"""A body that stands along +Y and faces +Z, in metres."""

ASIS, PSIS = ("LASI", "RASI"), ("LPSI", "RPSI")
RULES: list[Rule] = [
    Midpoint(of=("LASI", "LPSI")),
    Offset(of="C7", by=(0.01, -0.02, 0.03)),
    Harrington(side="left", asis=ASIS, psis=PSIS),
    Harrington(side="right", leg=("hip", "knee"), asis=ASIS, psis=PSIS),
    Lumbar(asis=ASIS, psis=PSIS),
    Cervical(back="C7", front="CLAV"),
    Acromion(of="LSHO", across=("LSHO", "RSHO")),
    Chord(of="knee", joint="hip", plane="wand", offset=0.05),
]


def body(turn: Rotation | None = None, step: float = 0.0, legs: float | None = None) -> Body:
    turn = turn or Rotation.identity()
    points = {name: turn.apply(place) + step for name, place in POINTS.items()}
    return Body(points, turn.as_matrix(), lambda _one, _other: legs)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: type(rule).__name__)
@given(seed=st.integers(0, 10**6))
def test_a_centre_goes_with_the_body(rule: Rule, seed: int) -> None:
    turn = Rotation.random(rng=np.random.default_rng(seed))
    here, there = rule.guess(body(legs=0.9)), rule.guess(body(turn, 2.0, legs=0.9))
    np.testing.assert_allclose(there.place, turn.apply(here.place) + 2.0, atol=1e-12)
    carried = turn.as_matrix() @ here.covariance @ turn.as_matrix().T
    np.testing.assert_allclose(there.covariance, carried, atol=1e-12)


def test_the_hip_is_where_the_equations_of_one_variable_have_it() -> None:
    """Width 240 mm, depth 150 mm: 45.9 mm behind, 82.9 mm below, 86.5 mm aside of the middle."""
    place = Harrington(side="left", asis=ASIS, psis=PSIS).place(body())
    np.testing.assert_allclose(1000 * place, [0.33 * 240 + 7.3, -0.30 * 240 - 10.9, -0.24 * 150 - 9.9])


def test_the_hip_is_where_the_equations_of_three_variables_have_it() -> None:
    place = Harrington(side="right", leg=("hip", "knee"), asis=ASIS, psis=PSIS).place(body(legs=0.9))
    aside, up = 0.28 * 150 + 0.16 * 240 + 7.9, -0.16 * 240 - 0.04 * 900 - 7.1
    np.testing.assert_allclose(1000 * place, [-aside, up, -0.24 * 150 - 9.9])


def test_hips_of_a_symmetrical_pelvis_are_symmetrical() -> None:
    left, right = (Harrington(side=side, asis=ASIS, psis=PSIS).place(body()) for side in ("left", "right"))
    np.testing.assert_allclose(right, left * [-1, 1, 1])


def test_the_lumbar_joint_is_behind_and_above_the_middle_of_the_spines() -> None:
    place = Lumbar(asis=ASIS, psis=PSIS).place(body())
    np.testing.assert_allclose(place, [0, 0.149 * 0.24, -0.2765 * 0.24])


def test_the_neck_is_between_back_and_front_and_above_their_line() -> None:
    place = Cervical(back="C7", front="CLAV").place(body())
    line = POINTS["CLAV"] - POINTS["C7"]
    step = place - POINTS["C7"]
    assert np.linalg.norm(step) == pytest.approx(0.54 * np.linalg.norm(line))
    angle = np.degrees(np.arccos(step @ line / np.linalg.norm(step) / np.linalg.norm(line)))
    assert angle == pytest.approx(11)
    assert place[1] > (POINTS["C7"] + 0.54 * line)[1]


def test_the_shoulder_is_below_the_acromion() -> None:
    place = Acromion(of="LSHO", across=("LSHO", "RSHO")).place(body())
    np.testing.assert_allclose(place, [0.2, 0.42 - 0.17 * 0.4, 0.0])


@given(offset=st.floats(0.02, 0.08))
def test_from_a_chord_marker_and_joint_above_are_at_a_right_angle(offset: float) -> None:
    place = Chord(of="knee", joint="hip", plane="wand", offset=offset).place(body())
    to_marker, to_hip = POINTS["knee"] - place, POINTS["hip"] - place
    assert np.linalg.norm(to_marker) == pytest.approx(offset)
    assert to_marker @ to_hip == pytest.approx(0, abs=1e-12)
    assert place[0] < POINTS["knee"][0]  # inward of a marker on the left side
    normal = np.cross(POINTS["wand"] - POINTS["knee"], POINTS["hip"] - POINTS["knee"])
    assert (place - POINTS["knee"]) @ normal == pytest.approx(0, abs=1e-12)
