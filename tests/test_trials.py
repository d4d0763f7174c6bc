"""Trials through Python: what is asked, what is logged, threads, instruction sets, interruption, poses.

The laws of the controller itself are tested in the core, on databases with known answers.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gmr import _core
from gmr.matching.database import Database
from gmr.matching.trial import Profile, Segment, Status, Tracking, TrialLog, run_trials, trial_positions
from locomotion import Arc
from walker import walker_bvh

GAITS = (Arc(6.0, 0.9), Arc(6.0, 1.6, 20.0), Arc(5.0, 1.3, 60.0), Arc(4.0, 2.8, 10.0))

PROFILES = (
    Profile.constant(1.2, 0.0, run_up=1.0, settle=1.0, record=4.0),
    Profile.constant(1.2, 0.5, run_up=1.0, settle=1.0, record=4.0),
    Profile.switching(1.0, 2.5, -0.4, every=2.0, run_up=0.0, settle=0.5, record=4.5),
)


def walking_database() -> Database:
    clips = {f"walk {k}": gmr.read(walker_bvh(arc).encode(), format="bvh") for k, arc in enumerate(GAITS)}
    return Database.build(clips, mirror=True)


@pytest.fixture(scope="module")
def database() -> Database:
    return walking_database()


@pytest.fixture(scope="module")
def log(database: Database) -> TrialLog:
    return run_trials(database, PROFILES, threads=1)


def columns(log: TrialLog) -> dict[str, bytes]:
    values = {field.name: getattr(log, field.name) for field in fields(log)}
    return {name: value.tobytes() for name, value in values.items() if isinstance(value, np.ndarray)}


def test_one_and_two_threads_give_the_same_bits(database: Database, log: TrialLog) -> None:
    assert columns(run_trials(database, PROFILES, threads=2)) == columns(log)


TRACKINGS: tuple[Tracking, ...] = ("time", "velocity")

DIGEST = """
import hashlib, sys
sys.path.insert(0, {tests!r})
from test_trials import PROFILES, columns, walking_database
from gmr.matching.trial import run_trials
every = columns(run_trials(walking_database(), PROFILES))
print(hashlib.sha256(b"".join(every[name] for name in sorted(every))).hexdigest())
"""


def test_every_instruction_set_gives_the_same_bits() -> None:
    code = DIGEST.format(tests=str(Path(__file__).parent))
    digests = {
        isa: subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, "GMR_ISA": isa},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
        for isa in _core.instruction_sets()
    }
    assert len(digests) >= 2
    assert len(set(digests.values())) == 1, digests


def test_trials_of_different_lengths_are_padded(log: TrialLog) -> None:
    assert len(log) == 3
    assert log.lengths.tolist() == [361, 361, 301]
    assert log.recorded_from.tolist() == [120, 120, 30]
    assert log.x.shape == log.row.shape == (3, 361)
    assert np.isnan(log.x[2, 301:]).all()
    assert np.isnan(log.cost_pose[2, 301:]).all()
    assert (log.row[2, 301:] == -1).all()
    assert (log.status[2, 301:] == Status.NONE).all()
    assert np.isfinite(log.x[:2]).all()
    assert (log.row[:2] >= 0).all()


def test_the_reference_is_the_path_that_was_asked_for(log: TrialLog) -> None:
    assert log.ref_speed[2, [0, 149, 150, 151, 269, 270, 300]].tolist() == [1.0, 1.0, 2.5, 2.5, 2.5, 1.0, 1.0]
    assert log.ref_turn_rate[1, [0, 59, 60, 360]].tolist() == [0.0, 0.0, 0.5, 0.5]
    np.testing.assert_allclose(log.ref_z[0], 1.2 * np.arange(361) / 60, atol=1e-12)
    radius, turned = 1.2 / 0.5, 0.5 * 5.0
    expected = [radius * (1 - np.cos(turned)), 1.2 + radius * np.sin(turned), turned]
    np.testing.assert_allclose(
        [log.ref_x[1, -1], log.ref_z[1, -1], log.ref_heading[1, -1]], expected, atol=1e-12
    )


def test_the_root_moves_as_the_rows_shown_say(database: Database, log: TrialLog) -> None:
    for trial in range(len(log)):
        steps = log.lengths[trial] - 1
        row, heading = log.row[trial, :steps], log.heading[trial, :steps]
        left, forward = database.displacements[row].astype(np.float64).T
        x = left * np.cos(heading) + forward * np.sin(heading)
        z = forward * np.cos(heading) - left * np.sin(heading)
        np.testing.assert_allclose(np.diff(log.x[trial, : steps + 1]), x, atol=1e-12)
        np.testing.assert_allclose(np.diff(log.z[trial, : steps + 1]), z, atol=1e-12)
        np.testing.assert_allclose(np.diff(log.heading[trial, : steps + 1]), database.turns[row], atol=1e-12)


def test_what_is_not_a_jump_is_the_next_frame_of_its_clip(database: Database, log: TrialLog) -> None:
    for trial in range(len(log)):
        row = log.row[trial, : log.lengths[trial]]
        status = log.status[trial, 1 : log.lengths[trial]]
        follows = (row[1:] == row[:-1] + 1) & (database.clips[row[1:]] == database.clips[row[:-1]])
        np.testing.assert_array_equal(follows, (status == Status.PLAYED_ON) | (status == Status.KEPT))
        assert (status == Status.JUMPED).any()


def test_the_cost_of_a_jump_is_the_distance_to_the_continuing_frame(
    database: Database, log: TrialLog
) -> None:
    pose = ~database.is_trajectory
    for trial, step in zip(*np.nonzero(log.status == Status.JUMPED), strict=True):
        if step == 0:
            continue
        before, entered = log.row[trial, step - 1] + 1, log.row[trial, step]
        apart = database.features[before, pose] - database.features[entered, pose]
        np.testing.assert_allclose(log.cost_pose[trial, step], np.sum(apart**2), rtol=1e-5)
        joints = np.linalg.norm(database.positions[before] - database.positions[entered], axis=1)
        np.testing.assert_allclose(log.discontinuity[trial, step], joints.mean(), rtol=1e-5)


def test_a_log_cannot_be_written_to(log: TrialLog) -> None:
    with pytest.raises(ValueError, match="read-only"):
        log.x[0, 0] = 1.0


def test_closed_loop_mends_what_open_loop_forgets(database: Database) -> None:
    between_gaits = [Profile.constant(2.0, 0.0, run_up=0.0, settle=0.0, record=30.0)]
    logs = {tracking: run_trials(database, between_gaits, tracking=tracking) for tracking in TRACKINGS}
    late = {name: abs(float(log.z[0, -1] - log.ref_z[0, -1])) for name, log in logs.items()}
    assert late["time"] < 0.5 * late["velocity"], late


def test_progress_tells_how_many_of_all_are_done(database: Database) -> None:
    told: list[tuple[int, int]] = []
    run_trials(database, PROFILES, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (3, 3)
    assert told == sorted(told)


ENDLESS = [Profile.constant(1.0, 0.0, record=99_000.0)] * 50


def test_ctrl_c_ends_a_run(database: Database) -> None:
    bell = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    bell.start()
    with pytest.raises(KeyboardInterrupt):
        run_trials(database, ENDLESS)
    bell.join()


def test_what_progress_raises_ends_a_run(database: Database) -> None:
    def stop(done: int, total: int) -> None:
        raise RuntimeError(f"stopped after {done}")

    with pytest.raises(RuntimeError, match="stopped after 1"):
        run_trials(database, [Profile.constant(1.0, 0.0), *ENDLESS], threads=1, progress=stop)


@pytest.mark.parametrize(
    ("profile", "settings", "words"),
    [
        (Profile(()), {}, "trial 0: a path needs at least one segment"),
        (Profile((Segment(1.0, np.nan, 0.0),)), {}, "segment 0 of the path has speed NaN"),
        (Profile((Segment(1.0, 1.0, 0.0),), 2.0), {}, "recording from 2 s is not within the trial"),
        (PROFILES[0], {"search_every": -1.0}, "search every -1 s"),
        (PROFILES[0], {"transition_penalty": -1.0}, "transition penalty of -1"),
        (PROFILES[0], {"tracking": "speed"}, "use 'time' or 'velocity'"),
        (PROFILES[0], {"tags": 8}, "tag bits 0b1000"),
    ],
)
def test_what_cannot_be_run_is_refused(
    database: Database, profile: Profile, settings: dict[str, object], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        run_trials(database, [profile], **settings)  # type: ignore[arg-type]


def test_no_profile_gives_an_empty_log(database: Database) -> None:
    log = run_trials(database, [])
    assert len(log) == 0
    assert log.x.shape == (0, 0)


@given(
    every=st.sampled_from([0.5, 1.0, 5.0, 7.5, 30.0, 50.0, 0.1]),
    record=st.sampled_from([0.5, 10.0, 12.0, 30.0]),
    run_up=st.sampled_from([0.0, 3.0]),
)
def test_speeds_alternate_and_end_in_time(every: float, record: float, run_up: float) -> None:
    profile = Profile.switching(1.0, 4.0, 0.5, every=every, run_up=run_up, settle=2.0, record=record)
    assert profile.duration == pytest.approx(run_up + 2.0 + record)
    assert profile.record_from == run_up + 2.0
    assert all(segment.duration > 0 for segment in profile.segments)
    turning = [segment for segment in profile.segments if segment.turn_rate]
    assert [segment.speed for segment in turning] == [(1.0, 4.0)[i % 2] for i in range(len(turning))]
    ends = np.cumsum([segment.duration for segment in turning]) - 2.0
    np.testing.assert_allclose(ends[:-1], every * np.arange(1, len(turning)))


def test_a_switch_that_takes_no_time_is_refused() -> None:
    with pytest.raises(ValueError, match="every 0 s"):
        Profile.switching(1.0, 2.0, 0.0, every=0)


def test_poses_stand_where_the_root_stands(database: Database, log: TrialLog) -> None:
    for trial in range(len(log)):
        steps = slice(0, log.lengths[trial])
        positions = trial_positions(database, log, trial)
        assert positions.shape == (log.lengths[trial], len(database.skeleton.names), 3)
        raw = database.positions[log.row[trial, steps]].astype(np.float64)
        sine, cosine = (f(log.heading[trial, steps, None]) for f in (np.sin, np.cos))
        x = log.x[trial, steps, None] + raw[:, :, 0] * cosine + raw[:, :, 2] * sine
        z = log.z[trial, steps, None] + raw[:, :, 2] * cosine - raw[:, :, 0] * sine
        away = np.linalg.norm(positions - np.stack([x, raw[:, :, 1], z], axis=2), axis=2).max(axis=1)
        jumps = np.nonzero(np.isfinite(log.discontinuity[trial, steps]))[0]
        before_all = slice(0, jumps[jumps > 0][0])
        assert away[before_all].max() < 2e-5
        ways = np.linalg.norm(np.diff(positions, axis=0), axis=2).max(axis=1)
        assert ways.max() < 0.25, "no joint is faster than 15 m/s, at jumps neither"


def test_some_joints_are_those_of_all(database: Database, log: TrialLog) -> None:
    every = trial_positions(database, log, 0)
    np.testing.assert_array_equal(trial_positions(database, log, 0, joints=[5, 0, 5]), every[:, [5, 0, 5]])


def test_what_cannot_be_shown_is_refused(database: Database, log: TrialLog) -> None:
    with pytest.raises(ValueError, match="joints holds 9999 at place 0"):
        trial_positions(database, log, 0, joints=[9999])
    with pytest.raises(ValueError, match="half-life of 0 s"):
        trial_positions(database, log, 0, half_life=0.0)
    with pytest.raises(IndexError):
        trial_positions(database, log, 3)
