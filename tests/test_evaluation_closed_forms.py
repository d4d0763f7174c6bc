"""From files to tables, where everything is known in closed form: clips that go exactly as is asked.

The dataset is a straight line and a circle of one speed. On both the character keeps speed and turn rate. Its
place it keeps on the straight line only: tracking its path in time, it looks a second ahead, and enters the
circle some searches before the corner, when the way ahead is more of a circle than of a line. From then on
it faces some degrees ahead of the plan, its circle lies beside the planned one, and no clip leads back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import gmr
import plain_matching
from gmr.evaluation import Evaluation
from gmr.evaluation.coverage import Bins, density
from locomotion import RATE, Arc
from walker import walker_bvh

TURNING = slice(5 * 60, 35 * 60 + 1)
"""The steps of a constant trial that are recorded."""


class Case(NamedTuple):
    """A speed (m/s) and a turn rate (degrees/s), the frames a second of the files."""

    speed: float
    turn_rate_deg: float
    fps: float

    @property
    def turn(self) -> float:
        return float(np.radians(self.turn_rate_deg))

    @property
    def clips(self) -> dict[str, Arc]:
        return {
            "circle.bvh": Arc(9.5, self.speed, self.turn_rate_deg),
            "straight.bvh": Arc(8.0, self.speed),
        }

    def evaluated(self, tracking: str) -> Evaluation:
        files = {name: walker_bvh(arc, self.fps).encode() for name, arc in self.clips.items()}
        motions = {name: gmr.read(text, format="bvh") for name, text in files.items()}
        asked = {"speeds": [self.speed], "turn_rates_deg": [0.0, self.turn_rate_deg]}
        return gmr.evaluate(motions, scenarios="constant", tracking=tracking, **asked)  # type: ignore[arg-type]


CASES = (
    Case(1.5, 50.0, 30.0),
    Case(1.5, 50.0, 60.0),
    Case(1.1, -30.0, 60.0),
    Case(2.25, 80.0, 120.0),
    Case(0.85, -100.0, 24.0),
    Case(2.9, 25.0, 60.0),
)


class Evaluated(NamedTuple):
    case: Case
    found: Evaluation

    def of(self, column: str, turn_rate_deg: float) -> float:
        trials = self.found.measured.trials
        return float(trials[column][trials["turn_rate_deg"] == turn_rate_deg][0])


@pytest.fixture(scope="module", params=CASES, ids=lambda case: "{:g} m/s {:g} deg/s {:g} fps".format(*case))
def timed(request: pytest.FixtureRequest) -> Evaluated:
    return Evaluated(request.param, request.param.evaluated("time"))


def root_speeds(case: Case) -> NDArray[np.float64]:
    """The speed of the simulation root from frame to frame within the circle.

    The file's places lie on the circle, those between its frames on the chords; a cubic through half a second
    about each frame then shortens the radius a little.
    """
    t = np.arange(0, 4, 1 / case.fps)
    on_circle = plain_matching.arc_ahead(t, case.speed, case.turn)
    frames = np.arange(0, 3.9, 1 / RATE)
    place = np.stack([np.interp(frames, t, on_circle[:, axis]) for axis in (0, 1)], axis=1)
    fit = np.vander(np.arange(-15, 16), 4)
    middle = np.linalg.pinv(fit)[3]
    smoothed = np.stack([np.convolve(axis, middle, "valid") for axis in place.T], axis=1)
    return np.asarray(np.hypot(*np.diff(smoothed, axis=0).T) * RATE)


def radius_left(case: Case) -> float:
    """The share of the circle's radius that smoothing leaves."""
    chord = case.speed * np.sinc(case.turn / (2 * RATE) / np.pi)
    return float(root_speeds(case).mean() / chord)


def test_the_root_of_a_circle_has_the_radius_that_smoothing_leaves() -> None:
    """Of places on the circle: a symmetric filter scales a rotation by the cosine sum of its weights."""
    case = Case(1.5, 50.0, 60.0)
    m, k = 15, np.arange(-15, 16)
    savitzky_golay = 3 * (3 * m * m + 3 * m - 1 - 5 * k * k) / ((2 * m + 3) * (2 * m + 1) * (2 * m - 1))
    shrunk = (savitzky_golay * np.cos(case.turn * k / RATE)).sum()
    chord = np.sinc(case.turn / (2 * RATE) / np.pi)
    np.testing.assert_allclose(root_speeds(case), case.speed * shrunk * chord, rtol=1e-12)


def test_on_the_straight_line_nothing_is_amiss(timed: Evaluated) -> None:
    assert abs(timed.of("speed_error", 0.0)) < 1e-6
    assert timed.of("speed_deviation", 0.0) < 1e-5
    assert abs(timed.of("turn_rate_error_deg", 0.0)) < 1e-5
    assert timed.of("turn_rate_deviation_deg", 0.0) < 1e-4
    assert timed.of("offset_max", 0.0) < 1e-5


def test_on_the_circle_speed_and_turn_rate_are_those_of_its_root(timed: Evaluated) -> None:
    case, speeds = timed.case, root_speeds(timed.case)
    error = speeds.mean() - case.speed
    assert -1e-3 < error < 0
    assert timed.of("speed_error", case.turn_rate_deg) == pytest.approx(error, abs=3e-6)
    assert timed.of("speed_deviation", case.turn_rate_deg) == pytest.approx(speeds.std(), abs=1e-5)
    assert abs(timed.of("turn_rate_error_deg", case.turn_rate_deg)) < 1e-5
    assert timed.of("turn_rate_deviation_deg", case.turn_rate_deg) < 3e-4


def test_the_whole_way_is_that_of_a_second_implementation(timed: Evaluated) -> None:
    case, simulation = timed.case, timed.found.simulation
    assert simulation is not None
    for trial, log, place in (simulation[row] for row in range(2)):
        plain = plain_matching.walked(list(case.clips.values()), trial.speed, trial.turn_rate_deg, 35.0)
        walked = np.stack([log.x[place], log.z[place], log.heading[place]], axis=1)
        np.testing.assert_allclose(walked, plain.place, atol=1e-3)


def test_the_offset_is_that_of_two_circles_one_beside_the_other(timed: Evaluated) -> None:
    """It enters the circle before the corner, goes straight once or twice more, and stays on the circle."""
    case = timed.case
    plain = plain_matching.walked(list(case.clips.values()), case.speed, case.turn_rate_deg, 35.0)
    turning = plain.row < round(case.clips["circle.bvh"].seconds * RATE) + 1
    first, last = np.flatnonzero(np.diff(turning.astype(int)) == 1)[[0, -1]] + 1
    assert first == plain_matching.RUN_UP - 3 * plain_matching.EVERY
    assert last < TURNING.start
    x, z, heading = plain.place[last]

    t = np.arange(TURNING.start, TURNING.stop) / RATE
    beyond = plain_matching.arc_ahead(t - last / RATE, case.speed * radius_left(case), case.turn)
    sin, cos = np.sin(heading), np.cos(heading)
    left, forward = beyond[:, 0], beyond[:, 1]
    shown = np.stack([x + left * cos + forward * sin, z - left * sin + forward * cos], axis=1)
    offset = np.hypot(*(shown - plain_matching.planned(t, case.speed, case.turn)[:, :2]).T)
    figures = {
        "offset_mean": offset.mean(),
        "offset_rms": np.sqrt((offset**2).mean()),
        "offset_p95": np.percentile(offset, 95),
        "offset_max": offset.max(),
        "offset_final": offset[-1],
    }
    for name, value in figures.items():
        assert timed.of(name, case.turn_rate_deg) == pytest.approx(value, abs=2e-4), name

    # The middles of the circles are this far apart, and the headings this much: of the two vectors between
    # the places one rests and one goes round.
    radius = case.speed / case.turn
    apart = np.hypot(x + radius * cos - radius, z - radius * sin - 3 * case.speed)
    ahead = heading - case.turn * (last / RATE - 3)
    round_about = 2 * abs(radius) * np.sin(abs(ahead) / 2)
    phase = np.linspace(0, 2 * np.pi, 3600, endpoint=False)
    mean = np.sqrt(apart**2 + round_about**2 - 2 * apart * round_about * np.cos(phase)).mean()
    turns = int(abs(case.turn) * 30 / (2 * np.pi))
    whole = offset[: round(turns * 2 * np.pi / abs(case.turn) * RATE)]
    assert whole.mean() == pytest.approx(mean, abs=1e-3)
    assert offset.max() <= apart + round_about + 1e-3
    assert 0.1 <= ahead / case.turn + 1e-9 <= 0.3


@pytest.mark.parametrize("case", CASES[:4], ids=lambda case: "{:g} m/s {:g} deg/s {:g} fps".format(*case))
def test_asked_for_speed_and_turn_rate_only_it_enters_the_circle_at_the_corner(case: Case) -> None:
    found = Evaluated(case, case.evaluated("velocity"))
    shorter = case.speed / abs(case.turn) * (1 - radius_left(case))
    assert found.of("offset_max", case.turn_rate_deg) == pytest.approx(2 * shorter, abs=3e-5)
    assert found.of("offset_mean", case.turn_rate_deg) == pytest.approx(4 / np.pi * shorter, abs=3e-5)


def test_clips_that_turn_a_little_otherwise_lead_back_to_the_path() -> None:
    case = CASES[0]
    offsets = []
    for beside in ((), (Arc(8.0, 1.5, 40.0), Arc(8.0, 1.5, 60.0))):
        clips = dict(enumerate((*case.clips.values(), *beside)))
        motions = {f"{n}": gmr.read(walker_bvh(arc).encode(), format="bvh") for n, arc in clips.items()}
        found = gmr.evaluate(motions, scenarios="constant", speeds=[1.5], turn_rates_deg=[50.0])
        offsets.append(Evaluated(case, found).of("offset_mean", 50.0))
    assert offsets[0] == pytest.approx(0.391, abs=5e-4)
    assert offsets[1] < offsets[0] / 2


def test_coverage_is_the_time_of_the_clips_in_the_cell_of_each(timed: Evaluated) -> None:
    case, coverage = timed.case, timed.found.measured.coverage
    speeds = {"circle.bvh": root_speeds(case).mean(), "straight.bvh": case.speed}
    for name, arc in case.clips.items():
        windows = coverage.take(coverage["clip"] == name)
        frames = round(arc.seconds * RATE) + 1
        assert len(windows) == frames - 60
        np.testing.assert_array_equal(windows["frame"], np.arange(30, frames - 30))
        np.testing.assert_allclose(windows["weight"], arc.seconds / len(windows))
        # Within a quarter of a second of a clip's ends its root is that of the end's own cubic.
        np.testing.assert_allclose(windows["speed"][15:-15], speeds[name], atol=2e-5)
        np.testing.assert_allclose(windows["speed"], speeds[name], atol=2e-4)
        np.testing.assert_allclose(windows["forward_speed"], speeds[name], atol=2e-4)
        np.testing.assert_allclose(windows["turn_rate_deg"], arc.turn_rate_deg, atol=2e-4)
    # No speed of the cases lies on the edge of a cell of 0.2 m/s.
    cells = density(coverage, Bins(speed=0.2, blur=0.0))
    row = np.searchsorted(cells.speed_edges, case.speed) - 1
    wanted = np.zeros_like(cells.seconds)
    for arc in case.clips.values():
        wanted[row, np.searchsorted(cells.turn_rate_edges_deg, arc.turn_rate_deg) - 1] = arc.seconds
    np.testing.assert_allclose(cells.seconds, wanted)
    np.testing.assert_array_equal(cells.clips, wanted > 0)
