"""Gaps found, filled where that is safe, and left open and named where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gmr.markers import Markers
from gmr.markers.gaps import runs
from marker_scene import hidden, noisy, worn

FPS = 120


@given(st.lists(st.booleans(), max_size=40))
def test_runs_are_the_stretches_of_true(mask: list[bool]) -> None:
    rebuilt = [False] * len(mask)
    last = -1
    for first, length in runs(np.array(mask, bool)):
        assert first > last
        assert length > 0
        rebuilt[first : first + length] = [True] * length
        last = first + length
    assert rebuilt == mask


def test_every_gap_is_listed_with_its_place() -> None:
    markers = hidden(hidden(worn(), "L_FLE", 10, 5), "CV7", 0, 3)
    found = {(gap.marker, gap.first, gap.length, gap.at_edge) for gap in markers.gaps()}
    assert found == {("L_FLE", 10, 5, False), ("CV7", 0, 3, True)}
    assert markers.gaps()[-1].seconds == pytest.approx(5 / FPS, abs=0.05)


@given(
    label=st.sampled_from(["L_TTC", "R_FLE", "SNJ", "L_HDB", "R_IAS", "L_FM1"]),
    first=st.integers(0, 250),
    length=st.integers(1, 60),
)
def test_within_a_rigid_part_a_gap_is_filled_exactly(label: str, first: int, length: int) -> None:
    markers = hidden(worn(), label, first, length)
    filled, report = markers.fill_gaps("ior")
    np.testing.assert_allclose(filled.positions, worn().positions, atol=1e-9)
    assert [each.how for each in report.gaps] == ["cluster"]


def test_a_part_carries_a_marker_from_where_it_was_to_where_it_comes_back() -> None:
    """A marker that slides on its part is met at both ends of its gap."""
    slid = worn().positions.copy()
    knee = worn().index("L_FLE")
    slid[:, knee] += np.linspace(0, 0.02, len(slid))[:, None]
    truth = replace(worn(), positions=slid)
    filled, _ = hidden(truth, "L_FLE", 100, 30).fill_gaps("ior")
    off = np.linalg.norm(filled.positions[95:135, knee] - slid[95:135, knee], axis=1)
    assert off.max() < 0.002


def polynomial(frames: int, seed: int) -> Markers:
    rng = np.random.default_rng(seed)
    t = np.linspace(-1, 1, frames)
    places = sum(rng.normal(size=3) * (t**power)[:, None] for power in range(4))
    return Markers(("A",), np.asarray(places)[:, None], 1 / FPS, unit=1.0)


@given(seed=st.integers(0, 10**6), first=st.integers(8, 40), length=st.integers(1, 12))
def test_a_short_gap_of_a_cubic_path_is_filled_exactly(seed: int, first: int, length: int) -> None:
    truth = polynomial(60, seed)
    filled, report = hidden(truth, "A", first, length).fill_gaps()
    np.testing.assert_allclose(filled.positions, truth.positions, atol=1e-9)
    assert report.gaps[0].how == "cubic"


def test_a_cubic_does_not_swing_with_noise() -> None:
    truth = polynomial(60, 3)
    filled, _ = hidden(noisy(truth, 0.5), "A", 20, 12).fill_gaps()
    assert np.abs(filled.positions[20:32] - truth.positions[20:32]).max() < 0.003


def test_one_place_on_a_side_makes_a_line_and_says_so() -> None:
    markers = hidden(hidden(polynomial(60, 1), "A", 20, 3), "A", 24, 3)
    _, report = markers.fill_gaps()
    assert [each.how for each in report.gaps] == ["linear", "linear"]


def test_long_gaps_and_those_at_an_edge_stay_open_and_are_named() -> None:
    markers = hidden(hidden(polynomial(60, 1), "A", 20, 13), "A", 0, 2)
    filled, report = markers.fill_gaps(max_gap=0.1)
    assert filled is markers
    assert len(report.open) == 2
    assert "nothing is seen on its other side" in report.open[0].why
    assert "longer than the 0.1 s" in report.open[1].why
    assert "A: frames 20 to 32: left open" in str(report)


def test_a_gap_is_as_long_as_the_limit_says_in_seconds() -> None:
    for length, how in ((12, "cubic"), (13, "open")):
        _, report = hidden(polynomial(60, 1), "A", 20, length).fill_gaps(max_gap=0.1)
        assert report.gaps[0].how == how


def test_a_part_of_which_too_little_is_seen_carries_nothing() -> None:
    markers = worn()
    for label in ("L_FLE", "L_FME"):
        markers = hidden(markers, label, 100, 40)
    filled, report = markers.fill_gaps("ior")
    assert len(report.open) == 2
    assert "fewer than 3 other markers of its part are seen all through" in report.open[0].why
    assert not filled.visible[100:140, markers.index("L_FLE")].any()


def test_a_gap_longer_than_a_part_may_carry_stays_open() -> None:
    _, report = hidden(worn(), "L_TTC", 50, 200).fill_gaps("ior", max_cluster_gap=1.0)
    assert report.gaps[0].how == "open"
    assert "longer than 1 s" in report.gaps[0].why


def test_filling_says_what_it_did_and_changes_nothing_else() -> None:
    markers = hidden(worn(), "L_TTC", 50, 20)
    filled, report = markers.fill_gaps("ior")
    np.testing.assert_array_equal(filled.positions[markers.visible], markers.positions[markers.visible])
    assert filled.history == ("1 of 1 gaps filled",)
    assert str(report) == "1 of 1 gaps filled\nL_TTC: frames 50 to 69: filled, cluster"
    assert str(worn().fill_gaps("ior")[1]) == "no gaps"


def test_parts_need_a_unit() -> None:
    with pytest.raises(gmr.GmrError, match="does not say in what unit it is"):
        worn().with_unit(None).fill_gaps("ior")


@pytest.mark.parametrize(("first", "length"), [(0, 10), (306, 10)])
def test_a_part_carries_a_marker_that_is_not_seen_at_an_edge(first: int, length: int) -> None:
    filled, report = hidden(worn(), "L_TTC", first, length).fill_gaps("ior")
    assert report.gaps[0].how == "cluster"
    np.testing.assert_allclose(filled.positions, worn().positions, atol=1e-9)


def test_a_part_that_is_hardly_seen_around_a_gap_carries_through_it_all_the_same() -> None:
    markers = hidden(worn(), "L_TTC", 100, 10)
    for label in ("L_FAX", "L_FAL", "L_TAM"):
        for frame in (99, 110):
            markers = hidden(markers, label, frame, 1)
    filled, _ = markers.fill_gaps("ior")
    shin = worn().index("L_TTC")
    np.testing.assert_allclose(filled.positions[:, shin], worn().positions[:, shin], atol=1e-9)
