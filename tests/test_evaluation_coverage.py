"""Speeds and turn rates in the clips themselves."""

from __future__ import annotations

import numpy as np
import pytest

from gmr.evaluation.coverage import Bins, coverage_table, density, symmetry
from locomotion import RATE, Arc, frames_of


def test_a_window_has_the_speed_and_turn_rate_of_its_arc() -> None:
    table = coverage_table("set", frames_of({"a": Arc(3.0, 1.5, 40.0), "b": Arc(2.0, 3.0, -20.0)}))
    in_a = table["clip"] == "a"
    np.testing.assert_allclose(table["speed"], np.where(in_a, 1.5, 3.0))
    np.testing.assert_allclose(table["turn_rate_deg"], np.where(in_a, 40.0, -20.0))


def test_windows_move_by_one_frame_and_never_leave_their_clip() -> None:
    table = coverage_table("set", frames_of({"a": Arc(3.0, 1.0), "b": Arc(1.5, 2.0)}))
    for name, last in (("a", 180), ("b", 90)):
        frames = table["frame"][table["clip"] == name]
        np.testing.assert_array_equal(frames, np.arange(30, last - 30 + 1))
    np.testing.assert_allclose(table["seconds"], table["frame"] / RATE)


def test_a_window_that_sees_two_speeds_has_their_mean() -> None:
    frames = frames_of({"a": Arc(2.0, 1.0)})
    frames.displacement[60:, 1] = 3.0 / RATE
    table = coverage_table("set", frames)
    np.testing.assert_allclose(table["speed"], np.clip(1 + 2 * (table["frame"] - 30) / 60, 1, 3))


def test_a_short_clip_gives_one_window_and_a_lone_frame_none() -> None:
    table = coverage_table("set", frames_of({"short": Arc(0.5, 2.0, 90.0), "still": Arc(0.0, 0.0)}))
    assert table["clip"].tolist() == ["short"]
    assert table["frame"].tolist() == [15]
    np.testing.assert_allclose(table["speed"], 2.0)
    np.testing.assert_allclose(table["turn_rate_deg"], 90.0)


def test_the_weights_of_a_clip_add_up_to_its_duration() -> None:
    arcs = {"a": Arc(3.0, 1.0), "b": Arc(1.05, 2.0), "c": Arc(0.25, 2.0)}
    table = coverage_table("set", frames_of(arcs))
    for name, arc in arcs.items():
        assert table["weight"][table["clip"] == name].sum() == pytest.approx(arc.seconds)


def test_walking_backwards_has_speed_but_goes_not_forward() -> None:
    table = coverage_table("set", frames_of({"a": Arc(2.0, 1.2, backwards=True)}))
    np.testing.assert_allclose(table["speed"], 1.2)
    np.testing.assert_allclose(table["forward_speed"], -1.2)
    np.testing.assert_allclose(table["left_speed"], 0)


def test_a_cell_counts_its_seconds_and_its_clips() -> None:
    arcs = {"a": Arc(3.0, 1.02, 12.0), "b": Arc(2.0, 1.07, 11.0), "c": Arc(4.0, 2.55, -31.0)}
    map_ = density(coverage_table("set", frames_of(arcs)), Bins(speed=0.1, turn_rate_deg=5.0, blur=0.0))
    assert map_.seconds.sum() == pytest.approx(9.0)

    def cell(speed: float, turn: float) -> tuple[int, int]:
        return (
            int(np.searchsorted(map_.speed_edges, speed) - 1),
            int(np.searchsorted(map_.turn_rate_edges_deg, turn) - 1),
        )

    assert map_.seconds[cell(1.05, 10.0)] == pytest.approx(5.0)
    assert map_.clips[cell(1.05, 10.0)] == 2
    assert map_.seconds[cell(2.55, -31.0)] == pytest.approx(4.0)
    assert map_.clips.sum() == 3
    np.testing.assert_allclose(map_.turn_rate_edges_deg, -map_.turn_rate_edges_deg[::-1])
    np.testing.assert_array_equal(map_.blurred, map_.seconds)


def test_the_blur_spreads_the_seconds_about_their_cell() -> None:
    arcs = {"a": Arc(3.0, 1.05, 0.0), "edge": Arc(1.0, 2.0, 60.0), "other": Arc(1.0, 2.0, -60.0)}
    sharp = density(coverage_table("set", frames_of(arcs)), Bins(blur=0.0)).seconds
    blurred = density(coverage_table("set", frames_of(arcs)), Bins(blur=1.0)).blurred
    peak = np.unravel_index(sharp.argmax(), sharp.shape)
    assert blurred[peak] == pytest.approx(3.0 / (2 * np.pi), rel=0.02)
    assert blurred[peak[0] + 1, peak[1]] == pytest.approx(blurred[peak] * np.exp(-0.5))
    assert blurred[peak[0], peak[1] - 1] == pytest.approx(blurred[peak] * np.exp(-0.5))


def test_symmetry_is_one_for_mirrored_sets_and_zero_for_one_sided_ones() -> None:
    left, right = Arc(5.0, 1.05, 60.0), Arc(5.0, 1.05, -60.0)

    def of(arcs: dict[str, Arc]) -> float:
        return symmetry(density(coverage_table("set", frames_of(arcs))))

    assert of({"l": left, "r": right}) == pytest.approx(1.0)
    assert of({"l": left, "s": Arc(9.0, 1.0)}) == 0.0
    assert of({"l": Arc(10.0, 1.05, 60.0), "r": right}) == pytest.approx(0.5)
    assert np.isnan(of({"s": Arc(9.0, 1.0)}))


def test_a_dataset_that_never_moves_has_a_map_all_the_same() -> None:
    map_ = density(coverage_table("set", frames_of({"still": Arc(2.0, 0.0)})))
    assert map_.seconds.sum() == pytest.approx(2.0)
    empty = density(coverage_table("set", frames_of({"pose": Arc(0.0, 0.0)})))
    assert empty.seconds.sum() == 0
