"""Scenarios off the grid: starts and stops, slaloms, random splines, the points of a file, one's own."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
from gmr.evaluation import PathPoints, Scenario, Segment, Slalom, Splines, StartStop, Trial
from gmr.evaluation.figures.planned_paths import planned_paths
from gmr.evaluation.intervals import mean_interval
from gmr.evaluation.path_sentences import path_sentences
from gmr.evaluation.paths import held_paths, paths_table
from gmr.evaluation.regions import Limits
from gmr.evaluation.scenarios import OnGrid, asked_trials, scenarios_of
from gmr.evaluation.transitions import transitions_of
from gmr.evaluation.trials import trials_table
from gmr.table import Table
from locomotion import Arc, Gait, frames_of, walked
from walker import write_walkers

WALK = frames_of({"a.bvh": Arc(9.0, 1.0)})
GRID = OnGrid(speeds=(1.0, 2.0), turn_rates_deg=(-50.0, 0.0, 50.0))
OTHERS: tuple[Scenario, ...] = (StartStop(), Slalom(), Splines(3))


def gone(segments: Sequence[Segment], seconds: NDArray[np.float64], steps: int = 40) -> NDArray[np.float64]:
    """(T, 2) where a character is at some times, by the midpoint rule: nothing here is in closed form."""
    edges, places, heading = [0.0], [np.zeros(2)], 0.0
    for segment in segments:
        dt = segment.seconds / steps
        for _ in range(steps):
            middle = heading + math.radians(segment.turn_rate_deg) * dt / 2
            places.append(places[-1] + segment.speed * dt * np.array([math.sin(middle), math.cos(middle)]))
            heading += math.radians(segment.turn_rate_deg) * dt
            edges.append(edges[-1] + dt)
    return np.stack([np.interp(seconds, edges, np.array(places)[:, axis]) for axis in (0, 1)], axis=1)


def shape(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The distances between all points: what a path is wherever it lies and however it is turned."""
    return np.asarray(np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)))


@pytest.mark.parametrize("scenario", OTHERS, ids=lambda scenario: scenario.name)
def test_a_planned_path_never_jumps_and_its_trials_are_named_apart(scenario: Scenario) -> None:
    trials = asked_trials((scenario,))
    assert len({trial.path for trial in trials}) == len(trials)
    log = walked(trials[:2], WALK)
    fastest = max(segment.speed for trial in trials for segment in trial.segments)
    way = np.hypot(np.diff(log.ref_x), np.diff(log.ref_z))
    assert way.max() <= fastest / 60 + 1e-9
    assert np.abs(np.diff(log.ref_heading)).max() <= math.radians(100) / 60 + 1e-9


@pytest.mark.parametrize("scenario", OTHERS, ids=lambda scenario: scenario.name)
def test_off_the_grid_speed_and_turn_rate_are_the_means_of_what_is_asked(scenario: Scenario) -> None:
    trials = asked_trials((scenario,))[:3]
    log = walked(trials, WALK)
    for number, trial in enumerate(trials):
        moving = log.moving[number]
        assert trial.speed == pytest.approx(log.ref_speed[number][moving].mean(), abs=1e-9)
        asked = np.degrees(log.ref_turn_rate[number][moving])
        assert trial.turn_rate_deg == pytest.approx(asked.mean(), abs=1e-9)
        assert trial.slowest == log.ref_speed[number][moving].min()


def test_start_stop_stands_and_walks_in_turn() -> None:
    (trial,) = StartStop(speeds=(1.5,), walk=4.0, stand=2.0, times=3).trials()
    speeds = [segment.speed for segment in trial.segments]
    assert speeds == [0.0, 1.5, 0.0, 1.5, 0.0, 1.5, 0.0]
    assert trial.seconds - trial.recorded_from == pytest.approx(18.0)
    assert trial.speed == pytest.approx(1.0)
    assert trial.slowest == 0.0


@given(st.sampled_from([0.5, 1.0, 2.0, 3.0]), st.floats(5.0, 180.0), st.integers(1, 4))
def test_a_slalom_swings_as_far_to_either_side_and_goes_straight_on_the_whole(
    every: float, rate: float, weaves: int
) -> None:
    (trial,) = Slalom((1.5,), (rate,), every, record=2 * every * weaves).trials()
    turns = [segment.turn_rate_deg * segment.seconds for segment in trial.segments[1:]]
    heading = np.cumsum(turns)
    np.testing.assert_allclose(heading[0::2][:weaves], rate * every / 2)
    np.testing.assert_allclose(heading[1:-1:2], -rate * every / 2)
    assert heading[-1] == pytest.approx(0, abs=1e-6)
    assert trial.seconds - trial.recorded_from == pytest.approx(2 * every * weaves)


@settings(max_examples=20)
@given(st.integers(0, 2**32), st.floats(0.3, 4.0), st.floats(0.0, 2.0), st.floats(0.0, 3.0))
def test_splines_keep_their_bounds_and_change_smoothly(
    seed: int, every: float, low: float, width: float
) -> None:
    (trial,) = Splines(1, seed, (low, low + width), (-90.0, 30.0), every, record=12.0).trials()
    speed = np.array([segment.speed for segment in trial.segments[1:]])
    rate = np.array([segment.turn_rate_deg for segment in trial.segments[1:]])
    assert low - 1e-9 <= speed.min() <= speed.max() <= low + width + 1e-9
    assert -90 - 1e-9 <= rate.min() <= rate.max() <= 30 + 1e-9
    # A uniform cubic B-spline of values within a width changes by no more than the width from knot to knot.
    assert np.abs(np.diff(speed)).max() <= width * 0.1 / every + 1e-9
    assert np.abs(np.diff(rate)).max() <= 120 * 0.1 / every + 1e-9


def test_a_seed_gives_the_same_bits_and_another_other_paths() -> None:
    assert Splines(4, seed=5).trials() == Splines(4, seed=5).trials()
    assert Splines(4, seed=5).trials() == Splines(9, seed=5).trials()[:4]
    assert not {trial.segments for trial in Splines(4, seed=5).trials()} & {
        trial.segments for trial in Splines(4, seed=6).trials()
    }
    bits = [trial.segments[100].speed.hex() for trial in Splines(2, seed=5).trials()]
    assert bits == [trial.segments[100].speed.hex() for trial in Splines(2, seed=5).trials()]


ARCS = st.lists(
    st.builds(Segment, st.floats(1.0, 4.0), st.floats(0.5, 3.0), st.floats(-60.0, 60.0)),
    min_size=1,
    max_size=4,
)


@settings(max_examples=20)
@given(ARCS, st.floats(0.0, 6.28), st.sampled_from([0.1, 0.3]))
def test_points_of_a_path_become_arcs_that_are_near_each_point_at_its_time(
    arcs: list[Segment], turned: float, apart: float
) -> None:
    seconds = np.arange(0.0, sum(arc.seconds for arc in arcs), apart)
    points = gone(arcs, seconds) @ np.array(
        [[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]]
    )
    scenario = PathPoints.of("mine", points + 7.0, seconds=seconds)
    (trial,) = asked_trials((scenario,))
    planned = gone(trial.segments[1:], seconds)
    np.testing.assert_allclose(shape(planned), shape(points), atol=2 * scenario.tolerance + 5e-3)
    assert scenario.planned["as timed"].deviation <= scenario.tolerance
    assert trial.seconds - trial.recorded_from == pytest.approx(seconds[-1])
    assert len(trial.segments) < max(len(points), 4)


def test_the_points_of_a_circle_become_that_circle() -> None:
    angle = np.linspace(0, 1.5 * np.pi, 40)
    points = 4 * np.stack([1 - np.cos(angle), np.sin(angle)], axis=1)
    (trial,) = PathPoints.of("circle", points, speeds=(2.0,)).trials()
    for segment in trial.segments[1:]:
        assert segment.speed == pytest.approx(2.0, rel=1e-6)
        assert segment.turn_rate_deg == pytest.approx(math.degrees(2.0 / 4.0), rel=1e-6)
    assert trial.path == "2 m/s"


def test_a_point_given_twice_at_two_times_is_stood_at_and_turned_round_in() -> None:
    out = PathPoints.of("out", [(0, 0), (0, 6), (0, 6), (0, 0)], seconds=[0, 4, 6, 10])
    (trial,) = out.trials()
    walk, stand, back = trial.segments[1:3], *trial.segments[3:4], trial.segments[4:]
    assert [each.speed for each in walk] == pytest.approx([1.5] * len(walk))
    assert (stand.seconds, stand.speed, abs(stand.turn_rate_deg)) == pytest.approx((2.0, 0.0, 90.0))
    assert [each.speed for each in back] == pytest.approx([1.5] * len(back))
    assert trial.slowest == 0.0


def test_speeds_in_the_points_are_gone_at_there(tmp_path: Path) -> None:
    rows = "\n".join(f"0,{z},{1 + z / 10}" for z in range(21))
    (tmp_path / "faster.csv").write_text(f"# a remark\n\nX, Z, Speed\n{rows}\n")
    scenario = PathPoints.read(tmp_path / "faster.csv", tolerance=0.01)
    (trial,) = scenario.trials()
    assert scenario.name == "faster"
    # From 1 to 3 m/s in proportion to the way: dt = dz / (1 + z / 10).
    assert trial.seconds - trial.recorded_from == pytest.approx(10 * math.log(3), rel=1e-3)
    assert trial.segments[-1].speed == pytest.approx(2.9, abs=0.11)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x,z,t\n0,0,0\n0,1,one\n", r"bad\.csv:3: t is 'one'; give a number from 0 to 100000"),
        ("x,z\n0,0\n\n0,nan\n", r"bad\.csv:4: z is 'nan'"),
        ("x,z\n0,0\n1\n", r"bad\.csv:3: 1 values where 2 were expected \(x,z\)"),
        ("0,0,0\n1,1,1\n", r"bad\.csv:1: the first line is '0,0,0'; begin with a header"),
        ("x,z,t\n0,0,0\n0,1,1\n0,2,1\n", r"bad\.csv:4: t is 1 after 1; time must rise"),
        ("x,z,speed\n0,0,1\n0,1,-1\n", r"bad\.csv:3: speed is '-1'; give a number from 0 to 100"),
        ("a,b\n0,0\n1,1\n", r"bad\.csv:1: the first line is 'a,b'; begin with a header: 'x,z', "),
        ("x,z\n0,0\n", r"bad\.csv: 1 point; a path has 2"),
        ("", r"bad\.csv: 0 points"),
        (
            "x,z\n0,0\n0,1\n0,0\n",
            r"bad\.csv: from line 2 to line 3 the path turns in no time; at most 720 degrees/s",
        ),
        ("x,z,t\n0,0,0\n0,9,0.01\n", r"bad\.csv: from line 2 to line 3 the path takes 900 m/s"),
        ("x,z,t\n0,0,0\n0,2,1\n0,0,2\n0,0,3\n", r"bad\.csv: from line 2 to line 3.*stand there"),
        ("x,z,speed\n0,0,0\n0,1,0\n", r"bad\.csv: from line 2 to line 3 the speed is 0; standing is"),
        ("x,z\n0,0\n0,0\n0,1\n", r"bad\.csv: line 3 has the same point as line 2; standing is told by time"),
        ("x,z\n0,0\n0,0.001\n", r"bad\.csv: the path is 0\.001 m long; give 0\.1 m at least"),
        ("x,z,speed\n0,0,1\n0.03,0,1\n0,0,1\n", r"bad\.csv: the path is 0\.06 m long.*, or, to stand, "),
    ],
)
def test_a_file_that_is_no_path_is_refused_by_line_and_value(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(ValueError, match=says):
        asked_trials(scenarios_of(str(tmp_path / "bad.csv"), GRID))


def test_files_that_cannot_be_read_say_so(tmp_path: Path) -> None:
    with pytest.raises(gmr.FormatError, match=r"none\.csv: the file cannot be read"):
        PathPoints.read(tmp_path / "none.csv")
    (tmp_path / "bytes.csv").write_bytes(b"x,z\n\xff\xfe,0\n")
    with pytest.raises(
        gmr.FormatError, match=r"bytes\.csv: the file holds no text in UTF-8; save the points "
    ):
        PathPoints.read(tmp_path / "bytes.csv")


def test_points_in_memory_are_refused_by_the_name_of_the_path_and_their_number() -> None:
    back = PathPoints.of("back", [(0, 0), (0, 5), (0, -5)], speeds=[1.0])
    with pytest.raises(ValueError, match=r"^back: from point 1 to point 2 the path turns in no time"):
        back.trials()
    with pytest.raises(ValueError, match=r"^short: the path is 0\.002 m long; give 0\.1 m at least"):
        PathPoints.of("short", [(0, 0), (0, 0.002)]).trials()


def test_who_gives_times_may_stand_however_small_the_way() -> None:
    for points in ([(0, 0), (0, 0)], [(0, 0), (0, 0.001)]):
        (trial,) = PathPoints.of("stand", points, seconds=[0, 10]).trials()
        assert (trial.speed, trial.seconds - trial.recorded_from) == pytest.approx((0.0, 10.0))


def test_the_note_counts_points_and_segments_in_the_right_number() -> None:
    (one,) = PathPoints.of("stand", [(0, 0), (0, 0)], seconds=[0, 9]).notes
    (many,) = PathPoints.of("way", [(0, 0), (0, 4), (4, 4)], speeds=[1.0]).notes
    assert one.startswith("Scenario 'stand': 2 points became 1 segment of constant speed and turn rate, ")
    assert re.match(r"Scenario 'way': 3 points became \d segments of constant speed", many)


@dataclass(frozen=True)
class Hurry:
    """A scenario of somebody else's."""

    name: str = "hurry"
    segments: tuple[Segment, ...] = (Segment(3, 1.0, 0.0), Segment(5, 1.5, 20.0))
    recorded_from: float = 3.0

    def trials(self) -> list[Trial]:
        """One."""
        return [Trial.along(self.name, "", self.segments, self.recorded_from)]


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"segments": ()}, "recorded from 3 s on, but lasts 0 s"),
        ({"recorded_from": 8.0}, "recorded from 8 s on, but lasts 8 s"),
        (
            {"segments": (Segment(9, -1.0, 0.0),)},
            "'hurry', path 1, segment 1: speed is -1; give 0 to 100 m/s",
        ),
        ({"segments": (Segment(9, 1.0, 721.0),)}, "turn rate is 721; give -720 to 720 degrees/s"),
        ({"segments": (Segment(math.nan, 1.0, 0.0),)}, "seconds is nan"),
        ({"segments": (Segment(3600, 1.0, 0.0),) * 30}, "are too many"),
        ({"name": "constant"}, "cannot be called 'constant'"),
    ],
)
def test_trials_that_cannot_be_run_are_refused(changed: dict[str, object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        asked_trials((replace(Hurry(), **changed),))  # type: ignore[arg-type]


def test_what_is_no_scenario_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown scenario 'stroll'; known are constant, switching, start"):
        scenarios_of("stroll", GRID)
    with pytest.raises(ValueError, match="once, and at least one"):
        scenarios_of(("slalom", "slalom"), GRID)
    with pytest.raises(TypeError, match="a name and trials"):
        scenarios_of((3,), GRID)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="other than 0"):
        scenarios_of("slalom", replace(GRID, turn_rates_deg=(0.0,)))
    with pytest.raises(ValueError, match="too many"):
        asked_trials((StartStop((1.0,), times=1000), Slalom((1.0,), tuple(range(1, 21)))))


def test_named_scenarios_ask_for_the_speeds_and_turns_of_the_grid_and_come_after_it() -> None:
    found = scenarios_of(("splines", "slalom", "start-stop", "switching"), GRID, seed=4)
    assert [scenario.name for scenario in found] == ["switching", "splines", "slalom", "start-stop"]
    assert found[1:] == (
        Splines(seed=4, speeds=(1.0, 2.0), turn_rates_deg=(-50.0, 50.0)),
        Slalom((1.0, 2.0), (50.0,)),
        StartStop((1.0, 2.0)),
    )
    assert [scenario.name for scenario in scenarios_of("slalom", GRID)] == ["constant", "slalom"]


@settings(max_examples=20)
@given(st.lists(st.floats(0, 10), min_size=2, max_size=30))
def test_an_interval_holds_the_mean_and_lies_within_the_values(values: list[float]) -> None:
    found = mean_interval(values)
    assert min(values) - 1e-9 <= found.low <= found.mean + 1e-9
    assert found.mean - 1e-9 <= found.high <= max(values) + 1e-9
    assert found == mean_interval(values)


def test_the_interval_is_that_of_the_normal_approximation_where_that_holds() -> None:
    values = np.random.default_rng(3).normal(2.0, 0.5, 400)
    found = mean_interval(values)
    half = 1.96 * values.std() / math.sqrt(len(values))
    assert (found.low, found.high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.006)
    assert math.isnan(mean_interval([1.0]).low)


def tables(scenario: Scenario, answer: Gait | None = None) -> tuple[Table, Table]:
    trials = asked_trials((scenario,))
    log = walked(trials, WALK, lambda speed, turn: answer or Gait(speed, turn))
    measured = trials_table("set", trials, "time", log, transitions_of(log, WALK), WALK)
    return measured, paths_table("set", trials, "time", log)


def test_who_does_what_is_asked_holds_and_who_stands_still_does_not() -> None:
    kept, paths = tables(StartStop((1.0, 2.0)))
    assert held_paths(kept, Limits()).all()
    assert np.isfinite(kept["speed_error_share"]).all()
    np.testing.assert_allclose(paths["planned_z"], paths["walked_z"], atol=1e-9)
    assert paths["seconds"].max() == pytest.approx(32.0)
    stood, _ = tables(StartStop((1.0, 2.0)), Gait(0.0, 0.0))
    assert not held_paths(stood, Limits()).any()
    np.testing.assert_allclose(stood["speed_error_share"], -1.0)


def test_the_sentences_count_and_give_intervals_and_miss_standing() -> None:
    coverage = Table({"speed": [1.0, 0.05], "weight": [9.0, 0.5]})
    kept, _ = tables(StartStop((1.0, 2.0)))
    said = list(path_sentences(kept, coverage, Limits()))
    assert said[0].startswith("In scenario 'start-stop' it does what is asked in 2 of 2 trials, 0 m (95%")
    assert "the clips stand (below 0.1 m/s) for only 0.5 seconds" in said[1]
    stands = Table({"speed": [0.05], "weight": [2.0]})
    assert len(list(path_sentences(kept, stands, Limits()))) == 1
    slalom, _ = tables(Slalom((1.0, 2.0), (50.0,)))
    assert len(list(path_sentences(slalom, coverage, Limits()))) == 1


@pytest.mark.parametrize(
    ("held", "every", "said"),
    [
        (0, 20, "None of 20 trials goes as asked; the"),
        (1, 5, "1 of 5 trials goes as asked; the"),
        (2, 5, "2 of 5 trials go as asked; the"),
        (1, 1, "The trial goes as asked; the"),
        (0, 1, "The trial does not go as asked; the"),
    ],
)
def test_the_pictures_of_paths_count_what_goes_as_asked(
    found: gmr.evaluation.Evaluation, held: int, every: int, said: str
) -> None:
    chosen = found.measured.trials
    one = chosen.take(np.repeat(np.flatnonzero(chosen["scenario"] == "hurry"), every))
    right = np.arange(every) < held
    trials = Table(
        {
            **dict(one),
            "path": np.array([f"path {place}" for place in range(every)], object),
            "offset_mean": np.where(right, 0.1, 3.0),
            "speed_error_share": np.zeros(every),
            "turn_rate_error_deg": np.zeros(every),
        }
    )
    path = found.measured.paths
    path = path.take(path["scenario"] == "hurry")
    paths = Table.joined(
        [Table({**dict(path), "path": np.full(len(path), name, object)}) for name in trials["path"]]
    )
    measured = replace(found.measured, trials=trials, paths=paths)
    assert planned_paths(replace(found, measured=measured), "hurry", "time").sentence.startswith(said)


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> gmr.evaluation.Evaluation:
    top = tmp_path_factory.mktemp("takes")
    write_walkers(top, {"straight.bvh": Arc(6.0, 1.0), "left.bvh": Arc(6.0, 1.0, 50.0)})
    (top / "l.csv").write_text("x,z\n0,0\n0,5\n1,7\n5,8\n")
    asked: list[Any] = [Hurry(), Splines(2, speeds=(0.8, 1.2), record=5.0), top / "l.csv"]
    return gmr.evaluate(top, scenarios=asked, speeds=(1.0,), turn_rates_deg=(0.0, 50.0))


def test_scenarios_run_beside_the_grid_and_the_verdict_judges_the_grid(
    found: gmr.evaluation.Evaluation,
) -> None:
    trials = found.measured.trials
    assert trials["scenario"].tolist() == ["constant"] * 2 + ["hurry"] + ["splines"] * 2 + ["l"]
    assert trials["path"].tolist() == ["", "", "path 1", "path 1", "path 2", "1 m/s"]
    assert found.summary.settings["scenarios"] == ["constant", "hurry", "splines", "l"]
    assert found.summary.settings["seed"] == 0
    assert found.verdict.headline.endswith("1 m/s.")
    assert "of 2" in found.verdict.headline or "2 trials" in found.verdict.headline
    for name in ("hurry", "splines", "l"):
        assert sum(f"In scenario '{name}'" in sentence for sentence in found.verdict.sentences) == 1
    assert any("'l': 4 points became" in note for note in found.notes)
    offsets = trials["offset_mean"][trials["scenario"] == "splines"]
    paths = found.measured.paths
    apart = np.hypot(paths["planned_x"] - paths["walked_x"], paths["planned_z"] - paths["walked_z"])
    quarter = [
        apart[(paths["scenario"] == "splines") & (paths["path"] == f"path {n}")].mean() for n in (1, 2)
    ]
    np.testing.assert_allclose(quarter, offsets, rtol=0.1)


def test_every_scenario_off_the_grid_has_a_picture_of_its_paths(found: gmr.evaluation.Evaluation) -> None:
    from gmr.evaluation.figures import figures

    names = [figure.name for figure in figures(found)]
    assert [name for name in names if name.startswith("planned_paths")] == [
        f"planned_paths_{scenario}" for scenario in ("hurry", "splines", "l")
    ]
    assert sum(name.startswith("trial_map_holds") for name in names) == 1
    figure = planned_paths(found, "splines", "time")
    lines = figure.data["lines"]
    assert set(lines["way"]) == {"planned", "walked"}
    assert np.abs(lines["x"]).max() <= 1.4
    assert np.abs(lines["y"]).max() <= 1
    assert "2 trials" in figure.sentence or "of 2" in figure.sentence


def test_the_report_has_the_paths(found: gmr.evaluation.Evaluation, tmp_path: Path) -> None:
    found.report(tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    for scenario in ("hurry", "splines", "l"):
        assert f'id="planned_paths_{scenario}"' in page or f"id='planned_paths_{scenario}'" in page
