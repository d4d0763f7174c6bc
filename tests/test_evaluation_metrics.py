"""The figures of trials whose answers are known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from gmr.evaluation import metrics
from gmr.evaluation.scenario import constant_trials
from gmr.evaluation.transitions import transitions_of
from gmr.evaluation.trials import trials_table
from locomotion import RATE, Arc, Gait, frames_of, walked

WALK = frames_of({"walk.bvh": Arc(60.0, 1.0)})
CIRCLES = constant_trials((1.0, 2.0), (-50.0, 0.0, 50.0))


def test_a_character_that_does_what_it_is_asked_has_no_error() -> None:
    log = walked(CIRCLES, WALK)
    table = trials_table("set", CIRCLES, "time", log, transitions_of(log, WALK), WALK)
    for name in (
        "speed_error",
        "turn_rate_error_deg",
        "speed_deviation",
        "turn_rate_deviation_deg",
        "offset_max",
    ):
        np.testing.assert_allclose(table[name], 0, atol=1e-9, err_msg=name)
    np.testing.assert_allclose(table["speed_mean"], table["speed"])
    np.testing.assert_allclose(table["turn_rate_mean_deg"], table["turn_rate_deg"], atol=1e-9)
    np.testing.assert_allclose(table["seconds"], 30)


def test_static_error_is_positive_for_too_fast_and_has_no_spread() -> None:
    log = walked(CIRCLES, WALK, lambda speed, turn: Gait(speed + 0.2, turn * 0.9))
    table = trials_table("set", CIRCLES, "time", log, transitions_of(log, WALK), WALK)
    np.testing.assert_allclose(table["speed_error"], 0.2)
    np.testing.assert_allclose(table["turn_rate_error_deg"], -0.1 * table["turn_rate_deg"], atol=1e-9)
    np.testing.assert_allclose(table["speed_deviation"], 0, atol=1e-9)


def test_dynamic_error_is_the_standard_deviation_of_the_samples() -> None:
    log = walked(CIRCLES, WALK)
    sway = 0.3 * np.sin(2 * np.pi * np.arange(log.x.shape[1]) / RATE)
    z = np.tile((np.cumsum(2 + sway) - sway) / RATE, (6, 1))
    swaying = dataclasses.replace(log, x=np.zeros_like(log.x), z=z)
    table = trials_table("set", CIRCLES, "time", swaying, transitions_of(log, WALK), WALK)
    samples = sway[log.moving[0]]
    np.testing.assert_allclose(table["speed_deviation"], np.std(samples), rtol=1e-9)
    np.testing.assert_allclose(table["speed_error"], 2 + np.mean(samples) - table["speed"], atol=1e-9)
    np.testing.assert_allclose(table["speed_deviation_1s"], 0, atol=1e-9)


def test_turn_rate_does_not_jump_where_the_heading_wraps() -> None:
    log = walked(CIRCLES, WALK)
    assert np.abs(np.diff(log.heading)).max() > 6
    rates = np.degrees(metrics.turn_rate(log)[:, :-1])
    assert np.abs(rates).max() <= 50 + 1e-6


def test_the_offset_of_a_character_that_lags_is_its_lag_along_the_track() -> None:
    straight = constant_trials((1.5,), (0.0,))
    log = walked(straight, WALK)
    late = dataclasses.replace(log, z=log.z - 0.4, x=log.x + 0.3)
    table = trials_table("set", straight, "time", late, transitions_of(log, WALK), WALK)
    for name in ("offset_mean", "offset_rms", "offset_p95", "offset_max", "offset_final"):
        np.testing.assert_allclose(table[name], 0.5, err_msg=name)
    np.testing.assert_allclose(table["offset_sum"], 0.5 * (30 * RATE + 1))
    np.testing.assert_allclose(table["along_track_mean"], -0.4)
    np.testing.assert_allclose(table["cross_track_mean"], 0.3)


def test_the_offset_grows_with_a_wrong_speed() -> None:
    straight = constant_trials((2.0,), (0.0,))
    log = walked(straight, WALK, lambda speed, turn: Gait(speed - 0.1, turn))
    table = trials_table("set", straight, "time", log, transitions_of(log, WALK), WALK)
    samples = 0.1 * (5 + np.arange(1801) / RATE)
    np.testing.assert_allclose(table["offset_final"], samples[-1])
    np.testing.assert_allclose(table["offset_max"], samples[-1])
    np.testing.assert_allclose(table["offset_mean"], np.mean(samples))
    np.testing.assert_allclose(table["offset_p95"], np.percentile(samples, 95))
    np.testing.assert_allclose(table["offset_rms"], np.sqrt(np.mean(samples**2)))


def test_only_recorded_steps_count() -> None:
    log = walked(CIRCLES, WALK)
    spoilt = np.where(log.recorded, log.x, 1e6 * np.sin(np.arange(log.x.shape[1])))
    table = trials_table(
        "set", CIRCLES, "time", dataclasses.replace(log, x=spoilt), transitions_of(log, WALK), WALK
    )
    np.testing.assert_allclose(table["speed_error"], 0, atol=1e-9)
    np.testing.assert_allclose(table["speed_deviation_1s"], 0, atol=1e-6)
    np.testing.assert_allclose(table["offset_max"], 0, atol=1e-9)


def test_trials_of_different_lengths_each_count_their_own_steps() -> None:
    trials = constant_trials((1.0, 2.0), (0.0, 25.0), preset="mig2022")
    log = walked(trials, WALK)
    table = trials_table("set", trials, "time", log, transitions_of(log, WALK), WALK)
    np.testing.assert_allclose(table["seconds"], [5, 25, 5, 25])
    np.testing.assert_allclose(table["speed_error"], 0, atol=1e-9)


def test_a_trial_without_a_search_or_a_jump_has_no_cost() -> None:
    log = walked(CIRCLES, WALK)
    table = trials_table("set", CIRCLES, "time", log, transitions_of(log, WALK), WALK)
    assert np.isnan(table["search_cost_mean"]).all()
    assert np.isnan(table["pose_discontinuity_mean"]).all()
    assert (table["transitions_per_second"] == 0).all()


@pytest.mark.parametrize("rate", [60.0, 30.0])
def test_a_centred_mean_takes_a_whole_second_and_keeps_a_ramp(rate: float) -> None:
    ramp = np.arange(300.0)[None, :]
    everywhere = np.ones((1, 300), bool)
    means, whole = metrics.centred_mean(ramp, everywhere, rate)
    half = round(rate / 2)
    assert np.flatnonzero(whole[0]).tolist() == list(range(half, 300 - half + 1))
    np.testing.assert_allclose(means[whole], ramp[whole] - 0.5)
