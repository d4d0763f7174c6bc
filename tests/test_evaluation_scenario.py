"""The trials that are asked for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gmr.evaluation import metrics
from gmr.evaluation.scenario import Switching, constant_trials, planned_trials
from gmr.evaluation.transitions import transitions_of
from gmr.evaluation.trials import trials_table
from locomotion import Arc, Gait, frames_of, walked

WALK = frames_of({"a.bvh": Arc(9.0, 1.0)})


def test_the_grid_is_the_papers_81_pairs_in_order() -> None:
    trials = constant_trials()
    pairs = [(trial.speed, trial.turn_rate_deg) for trial in trials]
    assert len(pairs) == 81
    assert pairs == sorted(pairs)
    assert pairs[0] == (1.0, -100.0)
    assert pairs[-1] == (3.0, 100.0)


def test_every_trial_of_the_grid_is_paced_alike() -> None:
    for trial in constant_trials():
        run_up, circle = trial.segments
        assert (run_up.seconds, run_up.turn_rate_deg) == (3.0, 0.0)
        assert (circle.seconds, circle.turn_rate_deg) == (32.0, trial.turn_rate_deg)
        assert {run_up.speed, circle.speed} == {trial.speed}
        assert trial.recorded_from == 5.0


def test_the_authors_run_up_is_ten_metres_and_straight_trials_are_short() -> None:
    for trial in constant_trials(preset="mig2022"):
        assert trial.segments[0].seconds * trial.speed == pytest.approx(10)
        recorded = trial.seconds - trial.recorded_from
        assert recorded == pytest.approx(25 if trial.turn_rate_deg else 5)


def test_as_many_steps_are_recorded_as_the_recording_lasts() -> None:
    trials = constant_trials((1.0, 3.0), (0.0, 50.0), preset="mig2022")
    log = walked(trials, frames_of({"a.bvh": Arc(9.0, 1.0)}))
    np.testing.assert_array_equal(log.recorded.sum(axis=1), [301, 1501, 301, 1501])
    np.testing.assert_array_equal(log.moving.sum(axis=1), [300, 1500, 300, 1500])
    assert np.flatnonzero(log.recorded[0]).tolist() == list(range(600, 901))


def test_both_scenarios_are_the_papers_162_trials() -> None:
    trials = planned_trials()
    assert [trial.scenario for trial in trials] == ["constant"] * 81 + ["switching"] * 81
    assert trials[:81] == constant_trials()
    pairs = [[(trial.speed, trial.turn_rate_deg) for trial in part] for part in (trials[:81], trials[81:])]
    assert pairs[0] == pairs[1]
    assert all(trial.seconds == 35.0 for trial in trials)


@settings(max_examples=25, deadline=None)
@given(
    st.floats(0.5, 4.0),
    st.sampled_from([0.7, 1.0, 3.0, 5.0, 7.0]),
    st.sampled_from([0.0, 50.0]),
    st.sampled_from(["even", "mig2022"]),
)
def test_the_speed_asked_for_alternates_from_the_first_recorded_second_on(
    speed: float, every: float, turn_rate: float, preset: str
) -> None:
    (trial,) = planned_trials(("switching",), (speed,), (turn_rate,), preset, Switching(4.5, every))
    log = walked((trial,), WALK)
    asked = log.ref_speed[log.recorded]
    stretch = (np.arange(len(asked)) / 60 + 1e-9) // every
    # Where a stretch is no whole number of steps, the step at the switch may belong to either.
    clear = np.abs((np.arange(len(asked)) / 60 + every / 2) % every - every / 2) > 1.01 / 60
    clear[-1] = False
    np.testing.assert_array_equal(asked[clear], np.where(stretch % 2, 4.5, speed)[clear])
    assert stretch.max() >= 4
    before = log.ref_speed[0, : round(trial.recorded_from * 60)]
    assert (before == speed).all()


def test_the_recording_of_a_switching_trial_lasts_as_long_as_of_a_constant_one() -> None:
    for preset in ("even", "mig2022"):
        for constant, switching in zip(
            planned_trials(("constant",), preset=preset),
            planned_trials(("switching",), preset=preset),
            strict=True,
        ):
            assert switching.recorded_from == constant.recorded_from
            if constant.turn_rate_deg or preset == "even":
                assert switching.seconds == pytest.approx(constant.seconds)
            else:
                assert switching.seconds - switching.recorded_from == pytest.approx(25)


def test_errors_that_cancel_over_two_speeds_are_still_told() -> None:
    trials = planned_trials(("switching",), (2.0,), (0.0,))
    log = walked(trials, WALK, lambda speed, turn: Gait(3.0, turn))
    table = trials_table("set", trials, "time", log, transitions_of(log, WALK), WALK)
    np.testing.assert_allclose(table["speed_error"], 0, atol=1e-9)
    np.testing.assert_allclose(table["speed_error_share"], 0.5)
    np.testing.assert_allclose(table["switched_speed"], 4)
    np.testing.assert_allclose(table["switch_every"], 5)
    share = metrics.worst_share(metrics.path_speed(log) - 1.5, log.ref_speed, log.moving)
    np.testing.assert_allclose(share, -0.625)


@pytest.mark.parametrize(
    ("speeds", "turn_rates", "preset", "says"),
    [
        ((), (0.0,), "even", "at least one speed"),
        ((1.0,), (), "even", "at least one turn rate"),
        ((0.0,), (0.0,), "even", "from 0.01 to 100 m/s; 0 is not"),
        ((1e30,), (0.0,), "even", "1e.30 is not"),
        ((1e-9,), (0.0,), "mig2022", "1e-09 is not"),
        ((-1.0,), (0.0,), "even", "-1 is not"),
        ((float("nan"),), (0.0,), "even", "nan is not"),
        ((1.0,), (float("inf"),), "even", "inf is not"),
        ((1.0, 1.0), (0.0,), "even", "given twice"),
        (tuple(range(1, 101)), tuple(range(100)), "even", "wider steps"),
        ((1.0,), (0.0,), "mig2023", "even, mig2022"),
    ],
)
def test_a_grid_that_makes_no_sense_is_refused(
    speeds: tuple[float, ...], turn_rates: tuple[float, ...], preset: str, says: str
) -> None:
    with pytest.raises(ValueError, match=says):
        constant_trials(speeds, turn_rates, preset)
