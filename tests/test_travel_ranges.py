"""Laws of bodies that travel within their ranges of motion, and of the squashing that keeps them there."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asked_takes import checked_take
from gmr.actionlets import Body, Score, Track, library
from gmr.actionlets.travel import Plan, carried
from gmr.actionlets.travel.limits import MARGIN, squashed, unsquashed
from gmr.actionlets.travel.sole import pitch_of
from gmr.actionlets.travel.turns import about_y, about_z, pitched

SHIPPED = tuple(library())
WALKING = ("walk", "start", "stop", "run", "jog", "sneak", "march", "jump", "walk_and_sit")
LOW, HIGH = np.array([-0.5]), np.array([0.7])
angles = st.floats(-20, 20)


@given(
    name=st.sampled_from((*WALKING, *SHIPPED)),
    shares=st.lists(st.sampled_from((0.0, 0.3, 0.5, 0.8, 1.0)), min_size=4, max_size=4),
    seed=st.integers(0, 2**20),
    variation=st.sampled_from((0.0, 0.6, 1.0)),
)
@settings(max_examples=20)
def test_every_motion_of_the_library_keeps_the_ranges_of_motion_and_its_feet(
    name: str, shares: list[float], seed: int, variation: float
) -> None:
    report = checked_take(name, shares, 60, seed, None, variation).report
    assert max(report.beyond_deg.values(), default=0.0) < 0.1
    assert report.lowest_mm > -1.5
    assert report.off_mm < 0.1


@pytest.mark.parametrize("turn_rate", [-90.0, 45.0, 90.0])
def test_a_walk_that_turns_on_the_spot_steps(turn_rate: float) -> None:
    """A foot that stayed where it is would twist the hip by the whole turn."""
    report = library()["walk"].take(4, 60, speed=0, turn_rate=turn_rate).report
    assert len(report.stances) >= 5
    assert not report.beyond_deg
    assert report.turn_rate_deg == pytest.approx(turn_rate, abs=1)


def test_a_squat_beyond_the_ankles_raises_the_heels() -> None:
    """Shins that lean by 60 degrees over feet that stand still: the ankles bend 40, the heels do the rest."""
    body = Body.of()
    deep = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]
    score = Score(
        {
            f"{side}_{dof}": Track.through([(time, share * np.radians(most)) for time, share in deep])
            for side in ("left", "right")
            for dof, most in (("hip.flexion", 60), ("knee.flexion", 120), ("ankle.flexion", 39))
        }
    )
    planted, still = np.array([[0.0, 2.0]]), np.array([[0.0, 0.0]])
    plan = Plan({"left": planted, "right": planted}, still, still, travel="feet")
    found = carried(body, score.sample(120, body.names), plan)
    assert not found.report.beyond_deg
    assert found.report.slide_mm < 0.1
    assert found.report.lowest_mm > -0.1


@given(x=angles, y=angles)
def test_squashed_angles_keep_their_order_and_their_limits(x: float, y: float) -> None:
    low, high = squashed(np.array([min(x, y)]), LOW, HIGH), squashed(np.array([max(x, y)]), LOW, HIGH)
    assert LOW < low <= high < HIGH
    if LOW + MARGIN <= x <= HIGH - MARGIN:
        assert squashed(np.array([x]), LOW, HIGH) == x


@pytest.mark.parametrize("seed", [313205, 5, 12])
def test_however_high_a_jump_is_its_hips_stay_in_range(seed: int) -> None:
    report = library()["jump"].take(None, 60, seed, None, 1.0, height=0.5).report
    assert not report.beyond_deg
    assert report.slide_mm < 1


@given(x=st.floats(-0.9, 1.1))
def test_unsquashing_undoes_squashing(x: float) -> None:
    back = unsquashed(squashed(np.array([x]), LOW, HIGH), LOW, HIGH)
    assert back == pytest.approx(x, abs=1e-6)


@given(edge=st.sampled_from((LOW + MARGIN, HIGH - MARGIN)))
def test_squashing_begins_with_the_slope_and_the_curvature_of_the_identity(edge: np.ndarray) -> None:
    step = 1e-4
    around = squashed(edge + step * np.array([-1.0, 0.0, 1.0]), LOW, HIGH)
    assert np.diff(around) == pytest.approx(step, rel=1e-5)


@given(yaw=st.floats(-1, 1), pitch=st.floats(-2, 2), roll=st.floats(-0.4, 0.4))
def test_the_pitch_of_a_rolled_foot_is_told_past_upright(yaw: float, pitch: float, roll: float) -> None:
    turns = [turn(np.array([angle])) for turn, angle in ((about_y, yaw), (pitched, pitch), (about_z, roll))]
    foot = turns[0] @ turns[1] @ turns[2]
    assert pitch_of(foot)[0] == pytest.approx(pitch, abs=0.1)
