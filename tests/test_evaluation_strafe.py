"""Going sideways and backwards: the plan, the facing that is kept, and what is told of it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gmr
from gmr.evaluation import Segment, Strafe, Trial
from gmr.evaluation.path_sentences import path_sentences
from gmr.evaluation.paths import held_paths
from gmr.evaluation.regions import Limits
from gmr.evaluation.scenarios import asked_trials
from gmr.evaluation.simulation import log_of, profile_of
from gmr.matching import Database, Profile, TrialLog, run_trials
from gmr.matching import Segment as Stretch
from gmr.pruning.outcomes import outcomes_of
from gmr.table import Table
from walkers import walker

GRID = {"speeds": (1.0,), "turn_rates_deg": (0.0,)}
LEFT = Strafe((1.0,), (90.0,), record=5.0)


@pytest.fixture(scope="module")
def ahead() -> dict[str, gmr.Motion]:
    return {"ahead.bvh": walker(6, 1.0), "turns.bvh": walker(6, 1.0, 0.8)}


@pytest.fixture(scope="module")
def sideways(ahead: dict[str, gmr.Motion]) -> dict[str, gmr.Motion]:
    return {**ahead, "left.bvh": walker(8, 1.0, drift=np.pi / 2), "back.bvh": walker(8, 1.0, drift=np.pi)}


def strafed(clips: dict[str, gmr.Motion]) -> tuple[gmr.evaluation.Evaluation, Table]:
    found = gmr.evaluate(clips, scenarios=["constant", LEFT], **GRID)  # type: ignore[arg-type]
    trials = found.measured.trials
    return found, trials.take(trials["scenario"] == "strafe")


def log_along(*stretches: Stretch) -> TrialLog:
    return run_trials(Database.build({"a": walker(4, 1.0)}), [Profile(stretches)])


@settings(max_examples=15, deadline=None)
@given(st.floats(0.2, 3.0), st.floats(-1.5, 1.5), st.floats(-np.pi, np.pi))
def test_a_drift_turns_the_way_about_its_start_and_leaves_the_facing(
    speed: float, turn_rate: float, drift: float
) -> None:
    plain, turned = (log_along(Stretch(2.0, speed, turn_rate, angle)) for angle in (0.0, drift))
    np.testing.assert_array_equal(turned.ref_heading, plain.ref_heading)
    assert np.all(turned.ref_drift == drift)
    x = plain.ref_x * np.cos(drift) + plain.ref_z * np.sin(drift)
    z = plain.ref_z * np.cos(drift) - plain.ref_x * np.sin(drift)
    np.testing.assert_allclose([turned.ref_x, turned.ref_z], [x, z], atol=1e-9)


def test_every_direction_is_a_trial_of_its_own_that_faces_ahead() -> None:
    trials = asked_trials((Strafe(),))
    assert len(trials) == 14
    assert {trial.drift_deg for trial in trials} == {-135.0, -90.0, -45.0, 45.0, 90.0, 135.0, 180.0}
    assert {trial.path for trial in trials} >= {"1 m/s to the left", "2 m/s backwards"}
    assert all(segment.turn_rate_deg == 0 for trial in trials for segment in trial.segments)
    log = run_trials(Database.build({"a": walker(4, 1.0)}), [profile_of(trial) for trial in trials])
    for number, trial in enumerate(trials):
        last = log.lengths[number] - 1
        way = np.degrees(np.arctan2(log.ref_x[number, last], log.ref_z[number, last]))
        assert np.cos(np.radians(way - trial.drift_deg)) == pytest.approx(1.0)
        assert np.all(log.ref_heading[number, : last + 1] == 0)


def test_who_has_clips_that_go_sideways_strafes_and_keeps_its_facing(
    sideways: dict[str, gmr.Motion],
) -> None:
    found, trials = strafed(sideways)
    assert trials["drift_deg"].tolist() == [90.0]
    assert held_paths(trials, Limits()).all()
    assert trials["facing_error_deg"][0] < 5
    assert trials["offset_mean"][0] < 0.2
    assert abs(trials["cross_track_mean"][0]) < 0.2
    assert any(
        sentence.startswith("By direction it is off from path and facing by: to the left ")
        for sentence in found.verdict.sentences
    )


def test_who_only_walks_ahead_does_not_strafe(ahead: dict[str, gmr.Motion]) -> None:
    found, trials = strafed(ahead)
    assert not held_paths(trials, Limits()).any()
    assert any("'strafe' it does what is asked in 0 of 1 trial" in said for said in found.verdict.sentences)


def test_a_character_that_turns_to_where_it_goes_does_not_hold_however_near_it_is(
    sideways: dict[str, gmr.Motion],
) -> None:
    _, trials = strafed(sideways)
    for facing, holds in ((19.9, True), (20.1, False)):
        turned = Table({**dict(trials), "facing_error_deg": np.array([facing])})
        assert held_paths(turned, Limits()).tolist() == [holds]
    by_speed = Table({**dict(trials), "facing_error_deg": np.array([90.0]), "tracking": ["velocity"]})
    assert held_paths(by_speed, Limits()).all()


def test_pruning_judges_a_strafe_as_the_verdict_does(ahead: dict[str, gmr.Motion]) -> None:
    found, trials = strafed(ahead)
    assert found.simulation is not None
    for tracking, log in found.simulation.logs.items():
        assert tracking == "time"
        held = outcomes_of(log, found.simulation.trials).held
        assert held[-1] == held_paths(trials, Limits())[0]
        seen = log_of(log)
        assert np.all(seen.ref_drift[-1, : log.lengths[-1]] == np.pi / 2)


def test_the_sentence_tells_every_direction_the_nearest_first() -> None:
    part = Table(
        {
            "scenario": ["strafe"] * 3,
            "tracking": ["time"] * 3,
            "path": ["a", "b", "c"],
            "speed": [1.0, 2.0, 1.0],
            "speed_error_share": [0.0, 0.0, 0.0],
            "turn_rate_error_deg": [0.0, 0.0, 0.0],
            "offset_mean": [0.6, 0.4, 0.1],
            "slowest_speed": [1.0, 2.0, 1.0],
            "drift_deg": [90.0, 90.0, 180.0],
            "facing_error_deg": [30.0, 10.0, 2.0],
        }
    )
    said = list(path_sentences(part, Table({"speed": [1.0], "weight": [1.0]}), Limits()))
    assert said[1] == (
        "By direction it is off from path and facing by: backwards 0.1 m and 2 degrees and to the left 0.5 m "
        "and 20 degrees."
    )


def test_a_drift_beyond_half_a_turn_is_refused() -> None:
    class Odd:
        name = "odd"

        def trials(self) -> tuple[Trial, ...]:
            return (Trial.along("odd", "x", (Segment(4.0, 1.0, 0.0, 200.0),)),)

    with pytest.raises(ValueError, match="drift is 200; give -180 to 180 degrees"):
        asked_trials((Odd(),))
