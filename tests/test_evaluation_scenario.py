"""The trials that are asked for."""

from __future__ import annotations

import numpy as np
import pytest

from gmr.evaluation.scenario import constant_trials
from locomotion import Arc, frames_of, walked


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
