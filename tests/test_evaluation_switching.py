"""Speeds that switch: how they are taken up, how the errors are spread, what they cost over time."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from gmr.evaluation.distributions import error_bins_table, error_fits_table
from gmr.evaluation.gaussians import fitted
from gmr.evaluation.graph import graph_table
from gmr.evaluation.log import Log
from gmr.evaluation.scenario import Switching, constant_trials, planned_trials
from gmr.evaluation.scenario_sentences import taken_up
from gmr.evaluation.segments import answer, segments_table
from gmr.evaluation.step_response import step_response
from gmr.evaluation.timeline import timeline_table
from gmr.evaluation.transitions import transitions_of, transitions_table
from gmr.table import Table
from locomotion import RATE, Arc, Gait, frames_of, walked

CLIPS = frames_of({"a.bvh": Arc(4.0, 1.0), "b.bvh": Arc(3.0, 2.0)})
TRIALS = planned_trials(("switching",), (1.0, 2.0), (0.0, 50.0))
FINE = 1000.0
TIME = (np.arange(20_000) + 0.5) / FINE


@given(st.floats(0.1, 1.0), st.floats(0.5, 3.0), st.floats(-3.0, 5.0).filter(lambda x: abs(x - 1) > 0.1))
def test_a_lag_of_first_order_rises_and_settles_in_closed_form(
    tau: float, start: float, target: float
) -> None:
    if abs(target - start) < 0.1:
        return
    within = 0.05 * abs(target - start)
    found = step_response(target + (start - target) * np.exp(-TIME / tau), start, target, FINE, within)
    assert found.rise_time == pytest.approx(tau * np.log(9), abs=1e-3)
    assert found.settling_time == pytest.approx(tau * np.log(20), abs=1e-3)
    assert found.overshoot == pytest.approx(0, abs=1e-12)


@given(st.floats(0.2, 0.9), st.floats(3.0, 10.0))
def test_an_oscillation_of_second_order_overshoots_in_closed_form(damping: float, natural: float) -> None:
    damped = natural * np.sqrt(1 - damping**2)
    phase = np.arccos(damping)
    swing = np.exp(-damping * natural * TIME) * np.sin(damped * TIME + phase) / np.sqrt(1 - damping**2)
    found = step_response(1 + 3 * (1 - swing), 1.0, 4.0, FINE, 0.1)
    assert found.overshoot == pytest.approx(3 * np.exp(-np.pi * damping / np.sqrt(1 - damping**2)), abs=1e-3)
    after = np.abs(3 * swing)[np.ceil(found.settling_time * FINE).astype(int) + 1 :]
    assert (after <= 0.1).all()


def test_what_never_arrives_has_no_time() -> None:
    short = step_response(1 + 2 * (1 - np.exp(-TIME)), 1.0, 4.0, FINE, 0.2)
    assert np.isnan(short.rise_time)
    assert np.isnan(short.settling_time)
    assert short.overshoot == 0
    at_once = step_response(np.full(100, 4.0), 1.0, 4.0, FINE, 0.2)
    assert (at_once.rise_time, at_once.overshoot, at_once.settling_time) == (0, 0, 0)


def test_the_answer_keeps_ramps_forgets_sway_and_foresees_nothing() -> None:
    ramp = np.arange(300.0)
    np.testing.assert_allclose(answer(ramp, RATE), ramp[:-15])
    sway = 1 + 0.2 * np.sin(2 * np.pi * np.arange(300) * 2 / RATE)
    assert np.abs(answer(sway, RATE)[15:] - 1).max() < 0.01
    assert answer(np.concatenate([[5.0], np.zeros(99)]), RATE)[0] == 5.0
    assert len(answer(np.ones(10), RATE)) == 0


def lagging(seconds: float) -> Log:
    """The log of a character whose speed ramps to what is asked for over some seconds after each switch."""
    log = walked(TRIALS, CLIPS)
    late = np.apply_along_axis(
        lambda asked: np.convolve(asked, np.full(round(seconds * RATE), 1 / round(seconds * RATE)))[
            : len(asked)
        ],
        1,
        log.ref_speed,
    )
    z = np.concatenate([np.zeros((len(late), 1)), np.cumsum(late[:, :-1], axis=1) / RATE], axis=1)
    return dataclasses.replace(log, x=np.zeros_like(z), z=z, heading=log.ref_heading)


def test_every_stretch_has_the_errors_and_times_of_a_ramp_in_closed_form() -> None:
    ramp = 2.0
    table = segments_table("set", TRIALS, "time", lagging(ramp))
    assert len(table) == 4 * 6
    assert table["segment"].tolist() == [0, 1, 2, 3, 4, 5] * 4
    np.testing.assert_allclose(table["start"], 5.0 * table["segment"])
    np.testing.assert_allclose(table["seconds"], 5)
    first = table["segment"] == 0
    assert np.isnan(table["rise_time"][first]).all()
    rest = table.take(~first)
    step = rest["to_speed"] - rest["from_speed"]
    assert set(np.abs(step)) == {2.0, 3.0}
    # A box of n samples makes a ramp of which the first sample has one n-th already.
    np.testing.assert_allclose(rest["rise_time"], 0.8 * ramp, atol=0.02)
    near = 0.15 * rest["to_speed"] / np.abs(step)
    np.testing.assert_allclose(rest["settling_time"], ramp * (1 - near), atol=0.03)
    np.testing.assert_allclose(rest["overshoot"], 0, atol=1e-9)
    samples = -np.arange(119, 0, -1) / 120
    np.testing.assert_allclose(rest["speed_error"], step * samples.sum() / 300, rtol=1e-9)
    full = np.concatenate([samples, np.zeros(181)])
    np.testing.assert_allclose(rest["speed_deviation"], np.abs(step) * full.std(), rtol=1e-9)
    np.testing.assert_allclose(rest["turn_rate_error_deg"], 0, atol=1e-9)


def test_a_character_that_never_changes_its_speed_takes_up_none_but_its_own() -> None:
    log = walked(TRIALS, CLIPS, lambda speed, turn: Gait(1.0, turn))
    table = segments_table("set", TRIALS, "time", log)
    own = (table["speed"] == 1.0) & (table["segment"] > 0) & (table["to_speed"] == 1.0)
    assert (table["settling_time"][own] == 0).all()
    assert np.isnan(table["settling_time"][(table["segment"] > 0) & ~own]).all()
    assert taken_up(table).endswith(
        "in 0 of 12 switches when speeding up and in 4 of 8 switches when slowing down "
        "(at all of these it was at that speed already)."
    )


def test_what_is_at_a_new_speed_already_does_not_count_for_how_soon_it_is_taken_up() -> None:
    table = segments_table("set", TRIALS, "time", lagging(2.0))
    up = np.flatnonzero(table["to_speed"] > table["from_speed"])
    settled = np.full(len(table), np.nan)
    settled[up] = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.5, 2.0, *[np.nan] * (len(up) - 8)]
    said = taken_up(Table({**dict(table), "settling_time": settled}))
    assert (
        f"in 8 of {len(up)} switches when speeding up (at 5 of these it was at that speed already; at the "
        "others it takes 1.5 seconds in the median)"
    ) in said
    settled[up[1:]] = np.nan
    said = taken_up(Table({**dict(table), "settling_time": settled}))
    assert "when speeding up (it was at that speed already)" in said


def test_trials_of_one_speed_have_no_switch_to_measure() -> None:
    constant = constant_trials((1.0,), (0.0,))
    assert len(segments_table("set", constant, "time", walked(constant, CLIPS))) == 0
    same = planned_trials(("switching",), (4.0,), (0.0,))
    table = segments_table("set", same, "time", walked(same, CLIPS))
    assert table["seconds"].tolist() == [30.0]
    assert taken_up(table) == "No speed is asked for that differs from the one before."


def test_the_timeline_adds_up_to_the_trial() -> None:
    trials = planned_trials(("switching",), (1.0, 2.0), (0.0,), switching=Switching(3.0, 4.9))
    log = walked(trials, CLIPS, lambda speed, turn: Gait(0.9 * speed, turn))
    transitions = transitions_of(log, CLIPS)
    table = timeline_table("set", trials, "time", log, transitions)
    assert len(table) == 2 * 120
    assert table["seconds"][:3].tolist() == [0, 0.25, 0.5]
    np.testing.assert_allclose(table["played_speed"], 0.9 * table["asked_speed"])
    assert set(table["asked_speed"][table["seconds"] < 4.75]) == {1.0, 2.0}
    assert table["jumps"].sum() == len(transitions.trial)
    assert np.isfinite(table["search_cost"]).sum() == (table["jumps"] > 0).sum()
    np.testing.assert_allclose(np.nanmean(table["search_cost"]), 0.75)


def drawn(parts: list[tuple[float, float, int]], seed: int) -> NDArray[np.float64]:
    random = np.random.default_rng(seed)
    return np.concatenate([random.normal(mean, deviation, n) for mean, deviation, n in parts])[None, :]


def of(
    values: NDArray[np.float64], independent: float = 60.0
) -> tuple[int, list[float], list[float], list[float]]:
    fit = fitted(values, np.isfinite(values), np.array([independent]))
    return int(fit.components[0]), *(part[0].tolist() for part in (fit.shares, fit.means, fit.deviations))


@pytest.mark.parametrize("seed", range(3))
def test_two_centres_are_found_where_there_are_two_and_one_where_there_is_one(seed: int) -> None:
    number, shares, means, deviations = of(drawn([(0.1, 0.2, 1200), (-2.5, 0.4, 600)], seed))
    assert number == 2
    np.testing.assert_allclose(shares, [1 / 3, 2 / 3], atol=0.01)
    np.testing.assert_allclose(means, [-2.5, 0.1], atol=0.06)
    np.testing.assert_allclose(deviations, [0.4, 0.2], atol=0.04)
    number, shares, means, deviations = of(drawn([(0.5, 0.3, 1800)], seed))
    assert number == 1
    assert shares[0] == 1
    assert np.isnan([shares[1], means[1], deviations[1]]).all()
    np.testing.assert_allclose([means[0], deviations[0]], [0.5, 0.3], atol=0.03)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(-5, 5), min_size=2, max_size=60),
    st.floats(1.0, 1e4),
)
def test_a_fit_has_the_mean_and_the_variance_of_its_samples(samples: list[float], independent: float) -> None:
    values = np.array([samples])
    fit = fitted(values, np.ones(values.shape, bool), np.array([independent]))
    share, mean, deviation = (np.nan_to_num(part[0]) for part in (fit.shares, fit.means, fit.deviations))
    assert share.sum() == pytest.approx(1)
    centre = float((share * mean).sum())
    assert centre == pytest.approx(values.mean(), abs=1e-6)
    # A component is never narrower than a hundredth of the whole deviation.
    spread = float((share * (deviation**2 + (mean - centre) ** 2)).sum())
    assert spread == pytest.approx(values.var(), rel=2e-4, abs=1e-6)


def test_errors_without_spread_have_one_centre_and_no_deviation() -> None:
    assert of(np.full((1, 50), 0.3))[0] == 1
    assert of(np.full((1, 50), 0.3))[3][0] == pytest.approx(0, abs=1e-12)
    assert of(np.full((1, 50), np.nan))[0] == 0


def test_a_character_that_keeps_one_of_two_speeds_has_errors_about_two_centres() -> None:
    log = walked(TRIALS, CLIPS, lambda speed, turn: Gait(min(speed, 2.5), 0.9 * turn))
    bins = error_bins_table("set", TRIALS, "time", log)
    fits = error_fits_table("set", TRIALS, "time", log)
    speed = fits.take(fits["error_of"] == "speed")
    assert speed["components"].tolist() == [2] * 4
    np.testing.assert_allclose(speed["mean_1"], -1.5, atol=1e-6)
    np.testing.assert_allclose(speed["mean_2"], 0, atol=1e-6)
    np.testing.assert_allclose(speed["share_1"], 0.5)
    turn = fits.take(fits["error_of"] == "turn_rate_deg")
    assert turn["components"].tolist() == [1] * 4
    np.testing.assert_allclose(turn["mean_1"], -0.1 * turn["turn_rate_deg"], atol=1e-6)
    held = bins.take(bins["error_of"] == "speed")
    np.testing.assert_allclose(held["share"], 0.5)
    centres = (held["from"] + held["to"]) / 2
    np.testing.assert_allclose(centres, np.tile([-1.5, 0.0], 4), atol=1e-9)


def test_the_graph_has_every_jump_on_the_edge_between_its_clips() -> None:
    log = walked(TRIALS, CLIPS)
    jumps = transitions_of(log, CLIPS)
    graph = graph_table("set", "switching", "time", jumps, CLIPS)
    table = transitions_table("set", "switching", "time", jumps, CLIPS)
    assert graph["count"].sum() == table["count"].sum() == len(jumps.trial)
    for edge in graph.rows():
        of_edge = (table["from_clip"] == edge["from_clip"]) & (table["to_clip"] == edge["to_clip"])
        assert table["count"][of_edge].sum() == edge["count"]
        leaving = graph["count"][graph["from_clip"] == edge["from_clip"]].sum()
        assert edge["share"] == pytest.approx(edge["count"] / leaving)
        assert edge["inter_clip"] + edge["intra_clip"] + edge["forced_end"] == edge["count"]
