"""Feet that slide and bodies that jerk, where the answers are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gmr.editing import contacts
from gmr.evaluation.footing import Ground, Shown, ground_of, jerk_about, shown, slid_while
from gmr.evaluation.log import Log
from gmr.evaluation.scenario import constant_trials
from gmr.evaluation.seen import seen_at_transitions, seen_in_clips, seen_in_trials
from gmr.evaluation.simulation import frames_of as frames_in
from gmr.evaluation.simulation import log_of
from gmr.evaluation.transitions import transitions_of, transitions_table
from gmr.matching import Database, Profile, run_trials
from gmr.matching.trial import TrialLog
from locomotion import RATE, Arc, frames_of, walked
from walker import walker_bvh, write_walkers

CLIPS = frames_of({"a.bvh": Arc(4.0, 1.0), "b.bvh": Arc(3.0, 2.0)})
TRIALS = constant_trials((1.0,), (0.0,))


@given(st.floats(-50, 50), st.floats(-5, 5), st.floats(-5, 5), st.sampled_from([30.0, 60.0, 120.0]))
def test_a_cubic_motion_has_its_third_derivative_as_jerk(
    third: float, second: float, first: float, rate: float
) -> None:
    time = np.arange(40) / rate
    places = np.zeros((40, 2, 3))
    places[:, 0, 0] = third * time**3 / 6 + second * time**2 + first * time
    places[:, 1, 2] = -third * time**3 / 6
    found = jerk_about(places, rate)
    np.testing.assert_allclose(found[3:-2], abs(third), atol=1e-6)
    assert np.isnan(found[:3]).all()
    assert np.isnan(found[-2:]).all()


def test_a_jump_of_acceleration_is_seen_at_its_step() -> None:
    time = np.arange(60) / RATE
    places = np.zeros((60, 1, 3))
    places[:, 0, 1] = np.where(time > 0.5, 2.0 * (time - 0.5) ** 2, 0.0)
    found = jerk_about(places, RATE)
    assert np.flatnonzero(found > 1).tolist() == [29, 30, 31, 32]
    assert np.isnan(jerk_about(places[:5], RATE)).all()


@given(st.floats(0.005, 0.3), st.floats(0.5, 3.0), st.sampled_from([60.0, 120.0]))
def test_a_circle_has_the_jerk_of_its_radius_and_frequency(radius: float, hertz: float, rate: float) -> None:
    turned = 2 * np.pi * hertz * np.arange(120) / rate
    places = radius * np.stack([np.cos(turned), 0 * turned, np.sin(turned)], axis=1)[:, None]
    found = jerk_about(places, rate)[3:-2]
    # A difference over one step is 2 sin(w dt / 2) / dt times as large, where a derivative is w times.
    differences = radius * (2 * rate * np.sin(np.pi * hertz / rate)) ** 3
    np.testing.assert_allclose(found, differences, rtol=1e-6)
    np.testing.assert_allclose(found, radius * (2 * np.pi * hertz) ** 3, rtol=0.015)


def test_a_body_that_sways_has_the_jerk_of_a_sinusoid_whatever_the_rate_of_its_file(tmp_path: Path) -> None:
    (tmp_path / "walk.bvh").write_text(walker_bvh(Arc(3.0, 1.0), rate=120.0))
    walk = gmr.read(tmp_path / "walk.bvh")
    radius, hertz = 4.0, 2.0
    for rate in (60.0, 120.0):
        time = np.arange(round(3 * rate)) / rate
        moves = np.repeat(walk.translations[:1], len(time), axis=0)
        moves[:, 0, 0] += radius * np.cos(2 * np.pi * hertz * time)
        moves[:, 0, 1] += radius * np.sin(2 * np.pi * hertz * time)
        moves[:, 0, 2] += 100 * time
        still = np.repeat(walk.rotations[:1], len(time), axis=0)
        swaying = gmr.Motion.from_pose(walk.skeleton, still, moves, 1 / rate, unit=0.01, name="sway")
        jerk = ground_of(Database.build([swaying])).jerk[3:-2]
        np.testing.assert_allclose(jerk, radius / 100 * (2 * np.pi * hertz) ** 3, rtol=0.02)


STEPS = st.lists(st.booleans(), min_size=1, max_size=60)


@given(STEPS, st.floats(0, 1), st.floats(0, 6.28))
def test_an_even_slide_is_as_long_as_its_path_and_nothing_slides_in_the_air(
    flags: list[bool], speed: float, way: float
) -> None:
    down = np.array(flags)[:, None]
    time = np.arange(len(flags) + 1) / RATE
    places = (speed * time[:, None] * np.array([np.cos(way), 0, np.sin(way)]))[:, None]
    np.testing.assert_allclose(slid_while(down, places, RATE), down * speed / RATE, atol=1e-12)


@given(st.integers(10, 120), st.floats(0.001, 0.02), st.sampled_from([60.0, 120.0]))
def test_a_toe_that_trembles_on_the_spot_slides_a_fifth_of_its_path_at_most(
    steps: int, tremble: float, rate: float
) -> None:
    places = np.zeros((steps + 1, 1, 3))
    places[::2, 0, 0] = tremble
    slid = slid_while(np.ones((steps, 1), bool), places, rate)
    path = steps * tremble
    assert slid.sum() <= path / 5 + tremble


@pytest.fixture(scope="module")
def walking(tmp_path_factory: pytest.TempPathFactory) -> tuple[Database, Ground, Path]:
    folder = tmp_path_factory.mktemp("takes")
    write_walkers(folder, {"left.bvh": Arc(6.0, 1.2, 30.0), "straight.bvh": Arc(6.0, 1.2)})
    database = Database.build(gmr.read_folder(folder), unit="cm")
    return database, ground_of(database), folder


def test_feet_are_down_where_the_detector_of_motions_says_so(walking: tuple[Database, Ground, Path]) -> None:
    database, ground, folder = walking
    names = [database.skeleton.names[foot] for foot in ground.feet.tolist()]
    for clip in database.clip_names:
        motion = gmr.read(folder / clip).with_unit("cm").resample(60)
        rows = database.clip_rows(clip)
        expected = contacts(motion, names).mask
        assert expected.any()
        assert np.mean(expected == ground.down[rows]) > 0.99
        places = motion.positions(joints=names, dtype=np.float64) / 100
        stands = ground.down[rows][:-1] & ground.down[rows][1:]
        np.testing.assert_allclose(ground.slid[rows][:-1], slid_while(stands, places, 60.0), atol=1e-5)
        assert (ground.slid[rows][-1] == 0).all()


def without_jumps(database: Database) -> TrialLog:
    profiles = [Profile.constant(1.2, turn, run_up=1.0, settle=0.5, record=1.5) for turn in (0.0, 0.5)]
    return run_trials(database, profiles, transition_penalty=1e9)


@pytest.mark.parametrize("threads", [1, 2])
def test_what_is_played_without_a_jump_slides_and_jerks_as_its_clip(
    walking: tuple[Database, Ground, Path], threads: int
) -> None:
    database, ground, _ = walking
    trial_log = without_jumps(database)
    found = shown(database, ground, trial_log, threads)
    log, frames = log_of(trial_log), frames_in(database)
    jumps = transitions_of(log, frames)
    assert len(jumps.trial) == 0
    assert found.slide.sum() > 0.01
    np.testing.assert_allclose(found.slide, found.own, atol=1e-5)
    steps = slice(10, 150)
    np.testing.assert_allclose(found.jerk[:, steps], ground.jerk[trial_log.row[:, steps]], rtol=0.02, atol=5)
    columns = seen_in_trials(log, jumps, found)
    np.testing.assert_allclose(columns["foot_slide_mm"], columns["foot_slide_own_mm"], atol=0.5)
    assert np.isnan(columns["jerk_at_jumps"]).all()
    assert np.isfinite(columns["jerk_between_jumps"]).all()


def made_up(log: Log, down: slice, slide: float, own: float, jerk: float) -> Shown:
    """One foot down for half of every second, and figures that do not vary."""
    shape = log.row.shape
    second = np.arange(shape[1]) % 60
    standing = (second >= down.start) & (second < down.stop)
    flags = np.zeros((*shape, 2), bool)
    flags[..., 0] = standing
    return Shown(
        flags, standing * slide * np.ones(shape), standing * own * np.ones(shape), np.full(shape, jerk)
    )


def test_the_slide_of_a_stance_is_the_sum_over_its_steps() -> None:
    log = walked(TRIALS, CLIPS)
    jumps = transitions_of(log, CLIPS)
    columns = seen_in_trials(log, jumps, made_up(log, slice(10, 40), 0.002, 0.0005, 700.0))
    np.testing.assert_allclose(columns["stances_per_second"], 1.0)
    np.testing.assert_allclose(columns["foot_slide_mm"], 60.0)
    np.testing.assert_allclose(columns["foot_slide_own_mm"], 15.0)
    np.testing.assert_allclose(columns["jerk_at_jumps"], 700.0)
    np.testing.assert_allclose(columns["jerk_between_jumps"], 700.0)
    nothing = seen_in_trials(log, jumps, made_up(log, slice(0, 0), 0.0, 0.0, 700.0))
    assert np.isnan(nothing["foot_slide_mm"]).all()
    np.testing.assert_allclose(nothing["stances_per_second"], 0)


def test_a_jump_answers_for_half_a_second_or_until_the_next() -> None:
    rows = np.tile(np.concatenate([np.arange(100), np.arange(20), np.arange(240)] * 6)[:2101], (1, 1))
    log = walked(TRIALS, CLIPS, rows=rows)
    jumps = transitions_of(log, CLIPS)
    always = made_up(log, slice(0, 60), 0.003, 0.001, 500.0)
    columns = seen_at_transitions(log, jumps, always)
    gap = np.append(np.diff(jumps.step), 10_000)
    # What is left of the recording after the last jump may be less than that.
    gap[-1] = log.moving[0].nonzero()[0][-1] + 2 - jumps.step[-1]
    np.testing.assert_allclose(columns["foot_slide_added_mm"], 2.0 * np.minimum(gap, 30))
    assert {20, 100} <= set(gap.tolist())
    np.testing.assert_allclose(columns["jerk_mean"], 500.0)
    table = transitions_table("set", "constant", "time", jumps, CLIPS, columns)
    total = (table["foot_slide_added_mm"] * table["count"]).sum()
    assert total == pytest.approx(columns["foot_slide_added_mm"].sum())


def test_a_clip_tells_its_own_slide_a_stance_and_never_across_clips() -> None:
    down = np.zeros((len(CLIPS), 2), bool)
    down[230:260, 0] = True
    down[10:21, 1] = True
    ground = Ground(
        np.zeros(2, int), np.zeros(1, int), down, np.full(down.shape, 0.001), np.full(len(CLIPS), 9.0)
    )
    columns = seen_in_clips(ground, CLIPS)
    assert columns["stances"].tolist() == [2, 1]
    # Clip a has 241 rows: its last stance is over after ten ways, and 18 are left to clip b.
    np.testing.assert_allclose(columns["foot_slide_mm"], [(10 + 10) / 2, 18])
    np.testing.assert_allclose(columns["stance_seconds"], [(10 + 10) / 2 / 60, 18 / 60])
    np.testing.assert_allclose(columns["jerk_mean"], 9)
