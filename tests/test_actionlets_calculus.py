"""The laws of the actionlet, of the measured curve, of tracks and of scores."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy.integrate import quad

import gmr
from gmr.actionlets import Actionlet, Measured, Piece, Score, Track
from scores import actionlets, angles, assert_smooth, durations, measured, scores, shares, skews, tracks


def v(t: float, skew: float) -> float:
    """Eq. 1 of the paper, letter by letter."""
    if t <= skew:
        return 0.5 * (1 + math.sin(math.pi / skew * (t - skew / 2)))
    return 0.5 * (1 + math.sin(math.pi / (1 - skew) * (t - (skew - (1 - skew) / 2))))


@given(actionlets, shares)
def test_the_velocity_is_that_of_the_paper(one: Actionlet, u: float) -> None:
    expected = 2 * one.travel / one.duration * v(u, one.skew)
    scale = 1 + abs(one.travel / one.duration) / min(one.skew, 1 - one.skew)
    assert float(one.velocity(u * one.duration)) == pytest.approx(expected, abs=1e-12 * scale)


@given(actionlets, shares)
def test_the_angle_is_the_integral_of_the_paper_s_velocity(one: Actionlet, u: float) -> None:
    area, _ = quad(v, 0, u, args=(one.skew,), points=[one.skew] if one.skew < u else None)
    expected = one.start + 2 * one.travel * area
    assert float(one.angle(u * one.duration)) == pytest.approx(expected, abs=1e-7)


@given(actionlets)
def test_an_actionlet_is_at_rest_at_both_ends_and_fastest_after_its_skew(one: Actionlet) -> None:
    assert one.angle([0.0, one.duration]).tolist() == [one.start, one.end]
    np.testing.assert_allclose(one.velocity([0.0, one.duration]), 0, atol=1e-12)
    times = np.linspace(0, one.duration, 101)
    speeds = np.abs(one.velocity(times))
    top = abs(float(one.velocity(one.skew * one.duration)))
    assert top == pytest.approx(2 * abs(one.travel) / one.duration)
    assert (speeds <= top * (1 + 1e-12)).all()
    if not one.is_silence:
        assert (speeds[1:-1] > 0).all()


@given(actionlets)
def test_the_acceleration_is_the_slope_of_the_velocity(one: Actionlet) -> None:
    u = np.linspace(0.01, 0.99, 37)
    u = u[np.abs(u - one.skew) > 1e-3]
    t, step = u * one.duration, 1e-6 * one.duration
    slope = (one.velocity(t + step) - one.velocity(t - step)) / (2 * step)
    scale = 1 + float(np.abs(one.acceleration(t)).max())
    np.testing.assert_allclose(one.acceleration(t), slope, atol=1e-5 * scale)


@given(actionlets, shares)
def test_backwards_is_the_way_back(one: Actionlet, u: float) -> None:
    t = u * one.duration
    assert float(one.backwards().angle(t)) == pytest.approx(float(one.angle(one.duration - t)), abs=1e-9)


@given(angles, durations, shares)
def test_a_silence_is_exactly_still(angle: float, duration: float, u: float) -> None:
    still = Actionlet.silence(angle, duration)
    assert float(still.angle(u * duration)) == angle
    assert float(still.velocity(u * duration)) == 0


@given(st.floats(min_value=0, max_value=1, exclude_min=True, exclude_max=True), shares)
@example(0.75, 1.904148339345565e-135)
def test_no_skew_however_extreme_leaves_the_way(skew: float, u: float) -> None:
    one = Actionlet(0.0, 1.0, 1.0, skew)
    assert 0 <= float(one.angle(u)) <= 1
    assert np.isfinite([float(one.velocity(u)), float(one.angle(0)), float(one.angle(1))]).all()


@given(measured)
@example(Measured(np.array([0.0175, 2e-311, 0.0]), 0.1))
def test_a_measured_curve_passes_its_samples_at_rest_at_both_ends(one: Measured) -> None:
    np.testing.assert_allclose(one.angle(one.knots), one.angles, atol=1e-12)
    np.testing.assert_allclose(one.velocity([0.0, one.duration]), 0, atol=1e-12)


@given(measured)
def test_a_measured_curve_stays_between_neighbouring_samples(one: Measured) -> None:
    t = np.linspace(0, one.duration, 301)
    i = np.clip(np.searchsorted(one.knots, t, side="right") - 1, 0, len(one.angles) - 2)
    low, high = np.minimum(one.angles[i], one.angles[i + 1]), np.maximum(one.angles[i], one.angles[i + 1])
    found = one.angle(t)
    assert (found >= low - 1e-9).all()
    assert (found <= high + 1e-9).all()


@given(measured)
def test_a_measured_curve_has_the_velocity_that_its_angles_have(one: Measured) -> None:
    t = np.linspace(0.01, 0.99, 41) * one.duration
    step = 1e-6 * one.duration
    near = np.abs(t[:, None] - one.knots).min(axis=1) < 2 * step
    slope = (one.angle(t + step) - one.angle(t - step)) / (2 * step)
    scale = 1 + float(np.abs(one.velocity(t)).max())
    np.testing.assert_allclose(one.velocity(t)[~near], slope[~near], atol=1e-4 * scale)


@given(tracks(), shares)
def test_a_track_does_what_its_pieces_do(track: Track, u: float) -> None:
    t = u * track.duration
    i = min(int(np.searchsorted(track.bounds, t, side="right")) - 1, len(track.pieces) - 1)
    piece: Piece = track.pieces[i]
    local = t - float(track.bounds[i])
    assert float(track.angle(t)) == pytest.approx(float(piece.angle(local)), abs=1e-9)
    assert float(track.velocity(t)) == pytest.approx(float(piece.velocity(local)), abs=1e-6)
    assert track.duration == pytest.approx(sum(p.duration for p in track.pieces))


@given(tracks())
def test_a_track_is_smooth_and_rests_at_its_ends(track: Track) -> None:
    assert_smooth(track)
    np.testing.assert_allclose(track.velocity([0.0, track.duration]), 0, atol=1e-9)
    assert (track.start, track.end) == (track.pieces[0].start, track.pieces[-1].end)


@given(tracks(whole=False), shares, shares)
def test_an_excerpt_is_the_track_between_two_times(track: Track, one: float, other: float) -> None:
    begin, end = sorted((one * track.duration, other * track.duration))
    assume(end - begin > 1e-3)
    part = track.excerpt(begin, end)
    assert part.duration == pytest.approx(end - begin)
    t = np.linspace(0, end - begin, 60)
    np.testing.assert_allclose(part.angle(t), track.angle(t + begin), atol=1e-6)
    assert len(part.pieces) <= len(track.pieces)


@given(st.lists(st.tuples(durations, angles, skews), min_size=2, max_size=6))
def test_a_track_goes_through_its_extremes(steps: list[tuple[float, float, float]]) -> None:
    times = np.cumsum([step[0] for step in steps])
    extremes = [(time, angle, skew) for time, (_, angle, skew) in zip(times, steps, strict=True)]
    track = Track.through(extremes)
    np.testing.assert_allclose(track.angle(times - times[0]), [step[1] for step in steps], atol=1e-9)
    np.testing.assert_allclose(track.velocity(times - times[0]), 0, atol=1e-6)
    assert [piece.skew for piece in track.pieces if isinstance(piece, Actionlet)] == [s[2] for s in steps[1:]]


@given(st.floats(-2, 2), st.floats(0.1, 4))
def test_a_window_waits_for_the_first_extreme_and_holds_the_last(begin: float, seconds: float) -> None:
    track = Track.through([(0.0, 0.1), (1.0, 0.9, 0.3)], window=(begin, begin + seconds))
    t = np.linspace(begin, begin + seconds, 50)
    np.testing.assert_allclose(track.angle(t - begin), Actionlet(0.1, 0.9, 1.0, 0.3).angle(t), atol=1e-6)
    assert track.duration == pytest.approx(seconds)


steps_of_tracks = st.lists(
    st.lists(st.tuples(durations, angles, skews), min_size=2, max_size=6), min_size=1, max_size=4
)


@given(steps_of_tracks, st.floats(-3, 1), st.floats(0.1, 4))
def test_a_score_through_extremes_is_that_of_the_tracks_through_them(
    steps: list[list[tuple[float, float, float]]], begin: float, seconds: float
) -> None:
    rows = {f"dof {k}": np.array(one) for k, one in enumerate(steps)}
    for one in rows.values():
        one[:, 0] = begin + np.cumsum(one[:, 0])
    score = Score.through(rows, seconds)
    tracks = Score({dof: Track.through(one, (0.0, seconds)) for dof, one in rows.items()})
    times = np.linspace(-0.1, seconds + 0.1, 57)
    np.testing.assert_allclose(score.angles(times), tracks.angles(times), atol=1e-9)
    speed = 1 + np.abs(tracks.velocities(times)).max()
    np.testing.assert_allclose(score.velocities(times), tracks.velocities(times), atol=1e-6 * speed)
    assert score == tracks
    assert score.dofs == tracks.dofs
    assert score.duration == seconds


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ([[0.0, 0.0, 0.5]], "1 given"),
        ([[0.0, 0.0, 0.5], [0.0, 1.0, 0.5]], "extreme 1 of a track is at 0 s"),
        ([[0.0, 0.0, 0.5], [1.0, math.nan, 0.5]], "angle of extreme 1"),
        ([[0.0, 0.0, 0.5], [1.0, 1.0, 1.5]], "skew T is 1.5"),
    ],
)
def test_extremes_that_make_no_track_make_no_score(rows: list[list[float]], told: str) -> None:
    good = np.array([[0.0, 0.0, 0.5], [1.0, 1.0, 0.5]])
    with pytest.raises(gmr.ActionletError, match=told):
        Score.through({"good": good, "wrong": np.array(rows)}, 1.0)


@given(scores(whole=False))
def test_a_score_samples_its_tracks_and_rests_elsewhere(score: Score) -> None:
    names = ["unmoved", *reversed(score.dofs)]
    times = score.times(30)
    found, speeds = score.angles(times, names), score.velocities(times, names)
    assert found.shape == (len(times), len(names)) == score.sample(30, names).shape
    assert not found[:, 0].any()
    assert not speeds[:, 0].any()
    for column, name in enumerate(names[1:], 1):
        np.testing.assert_array_equal(found[:, column], score[name].angle(times))
        np.testing.assert_array_equal(speeds[:, column], score[name].velocity(times))
    assert times[-1] <= score.duration + 1e-6 < times[-1] + 1 / 30 + 1e-5


def test_the_same_pieces_are_the_same_track() -> None:
    pieces = (Actionlet(0, 1, 1), Measured(np.array([1.0, 2.0]), 1.0))
    again = (Actionlet(0, 1, 1), Measured(np.array([1.0, 2.0]), 1.0))
    assert Track(pieces) == Track(again)
    assert hash(Track(pieces)) == hash(Track(again))
    assert Score({"a": Track(pieces)}) == Score({"a": Track(again)})
    assert Measured(np.array([1.0, 2.0]), 1.0) != Measured(np.array([1.0, 2.5]), 1.0)


NAN = float("nan")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Actionlet(0, 1, 1, 0), "skew T is 0"),
        (lambda: Actionlet(0, 1, 1, 1), "skew T is 1"),
        (lambda: Actionlet(0, 1, 1, NAN), "skew is nan"),
        (lambda: Actionlet(0, 1, 0), "duration of an actionlet is 0 s"),
        (lambda: Actionlet(0, 1, -2), "duration of an actionlet is -2 s"),
        (lambda: Actionlet(0, 1, math.inf), "duration of an actionlet is inf"),
        (lambda: Actionlet(NAN, 1, 1), "start is nan"),
        (lambda: Actionlet(0, "far", 1), "end is 'far', which is no number"),  # type: ignore[arg-type]
        (lambda: Measured(np.array([1.0]), 1), "two or more"),
        (lambda: Measured(np.array([1.0, NAN]), 1), "angle 1 of a measured actionlet is nan"),
        (lambda: Track(()), "without pieces"),
        (
            lambda: Track((Actionlet(0, 1, 1), Actionlet(0.5, 1, 1))),
            r"piece 0 of a track ends at 57.2958 degrees, piece 1 starts at 28.6479 \(1 s",
        ),
        (lambda: Track((Actionlet(0, 1, 1),), lead=1.0), "lead is 1 s"),
        (lambda: Track((Actionlet(0, 1, 1),), lead=0.6, trail=0.5), "shows nothing"),
        (lambda: Track.through([(0, 0)]), "two extremes or more; 1 given"),
        (lambda: Track.through([(0, 0), (0, 1)]), "extreme 1 of a track is at 0 s"),
        (lambda: Track.through([(0, 0), (1, NAN)]), "angle of extreme 1 of a track is nan"),
        (lambda: Track.through([(0, 0), (1, 1, 0.5, 2)]), "has 4 numbers"),
        (lambda: Track((Actionlet(0, 1, 1),)).excerpt(0.5, 1.5), "excerpt from 0.5 to 1.5 s"),
        (lambda: Score({}), "without tracks"),
        (
            lambda: Score({"a": Track((Actionlet(0, 1, 1),)), "b": Track((Actionlet(0, 1, 2),))}),
            "track of 'b' lasts 2 s, that of 'a' 1 s",
        ),
        (lambda: Score({"a": Track((Actionlet(0, 1, 1),))})["b"], "no track 'b'; it has a"),
        (lambda: Score({"a": Track((Actionlet(0, 1, 1),))}).sample(0), "0 frames a second"),
    ],
)
def test_what_cannot_be_is_refused_in_words(make: Callable[[], object], words: str) -> None:
    with pytest.raises(gmr.ActionletError, match=words):
        make()


@pytest.mark.parametrize("travel", [5e-324, 2.2e-309, -1e-310])
def test_a_course_of_hardly_any_travel_is_led_over(travel: float) -> None:
    led = Measured(np.array([0.0, travel]), 0.1).between(0.0, 0.4)
    assert np.isfinite(led.angles).all()
    assert (led.start, led.end) == (0.0, 0.4)
