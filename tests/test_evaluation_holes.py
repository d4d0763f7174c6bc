"""A dataset that lacks one speed, from files to words, tables and report: that hole is named and no other."""

from __future__ import annotations

import html
import re
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.evaluation import Evaluation, Table
from locomotion import Arc
from walker import write_walkers

SPEEDS = (1.0, 1.5, 2.0, 2.5, 3.0)
TURNS = (-50.0, 0.0, 50.0)
BESIDE = (-60.0, -40.0, -10.0, 10.0, 40.0, 60.0)
"""Turn rates that lead back to the path where a bend was entered too early."""


def lacking(folder: Path, hole: float, turns: tuple[float, ...], tracking: str) -> Evaluation:
    clips = {
        f"{speed:g}_{turn:g}.bvh": Arc(5.0, speed, turn)
        for speed in SPEEDS
        for turn in turns
        if speed != hole
    }
    write_walkers(folder, clips)
    asked = {"speeds": SPEEDS, "turn_rates_deg": TURNS, "tracking": tracking}
    return gmr.evaluate(folder, scenarios="constant", **asked)  # type: ignore[arg-type]


def fails(trials: Table, limits: dict[str, float]) -> list[tuple[float, float]]:
    """Speed and turn rate of the trials that do not hold, from the table alone."""
    held = np.abs(trials["speed_error"]) <= limits["speed"] * trials["speed"]
    held &= np.abs(trials["turn_rate_error_deg"]) <= limits["turn_rate_deg"]
    held &= (trials["offset_mean"] <= limits["offset"]) | (trials["tracking"] == "velocity")
    cells = np.stack([trials["speed"], trials["turn_rate_deg"]], axis=1)
    return [(float(speed), float(turn)) for speed, turn in cells[~held]]


def speeds_in(sentences: list[str]) -> set[float]:
    """What sentences say of trials and clips in m/s, without by how much a character goes too slowly."""
    said = " ".join(re.sub(r"the character goes .*? too (slowly|fast)", "", each) for each in sentences)
    return {float(value) for value in re.findall(r"([\d.]+) m/s", said)}


def in_report(found: Evaluation, folder: Path) -> str:
    path = folder / "report.html"
    found.report(path)
    return html.unescape(path.read_text())


@pytest.mark.parametrize("hole", [1.5, 2.0, 2.5])
def test_asked_for_speed_and_turn_rate_only_the_missing_speed_fails_and_nothing_else(
    tmp_path: Path, hole: float
) -> None:
    found = lacking(tmp_path / "takes", hole, TURNS, "velocity")
    trials, words = found.measured.trials, found.verdict.sentences
    assert fails(trials, found.summary.settings["limits"]) == [(hole, turn) for turn in TURNS]
    # It goes at the next speed below or above instead, and does all else to less than a hundredth.
    of_hole = trials["speed"] == hole
    np.testing.assert_allclose(np.abs(trials["speed_error"][of_hole]), 0.5, atol=1e-2)
    assert np.abs(trials["speed_error"][~of_hole]).max() < 1e-2
    assert np.abs(trials["turn_rate_error_deg"]).max() < 0.1

    assert found.verdict.headline.startswith("This dataset does what it is asked in 12 of 15 trials (80%)")
    *others, last = [f"{speed:g}" for speed in SPEEDS if speed != hole]
    assert f"Straight ahead it keeps {', '.join(others)} and {last} m/s, but not {hole:g} m/s." in words
    failing = [sentence for sentence in words if sentence.startswith("It fails")]
    assert len(failing) == 2
    assert all("no clip moves like that" in sentence for sentence in failing)
    (capture,) = [sentence for sentence in words if sentence.startswith("Capture next")]
    assert speeds_in([*failing, capture]) == {hole}
    page = in_report(found, tmp_path)
    assert all(sentence in page for sentence in (found.verdict.headline, *failing, capture))


@pytest.mark.parametrize("hole", [2.0, 2.5])
def test_on_a_timed_path_turns_at_the_missing_speed_fail_and_straight_ahead_it_is_pieced_together(
    tmp_path: Path, hole: float
) -> None:
    found = lacking(tmp_path / "takes", hole, (*TURNS, *BESIDE), "time")
    trials, words = found.measured.trials, found.verdict.sentences
    assert fails(trials, found.summary.settings["limits"]) == [(hole, -50.0), (hole, 50.0)]
    straight = trials.take((trials["speed"] == hole) & (trials["turn_rate_deg"] == 0.0))
    assert straight["clip_count"][0] > 1
    assert straight["inter_clip_per_second"][0] > 0.1

    pieced = (
        f"It keeps {hole:g} m/s straight ahead only by switching between slower and faster clips: they hold "
        "less than 1 second of such movement."
    )
    assert pieced in words
    (failing,) = [sentence for sentence in words if sentence.startswith("It fails")]
    (capture,) = [sentence for sentence in words if sentence.startswith("Capture next")]
    assert failing.startswith(f"It fails when turning either way by 50 degrees/s at {hole:g} m/s (2 trials)")
    assert speeds_in([failing, capture]) == {hole}
    page = in_report(found, tmp_path)
    assert all(sentence in page for sentence in (found.verdict.headline, pieced, failing, capture))


def test_the_coverage_has_a_gap_about_the_missing_speed_and_nowhere_else(tmp_path: Path) -> None:
    found = lacking(tmp_path / "takes", 2.0, TURNS, "velocity")
    speeds = np.sort(found.measured.coverage["speed"])
    edges = np.flatnonzero(np.diff(speeds) > 0.1)
    gaps = [(round(float(speeds[at]), 1), round(float(speeds[at + 1]), 1)) for at in edges]
    assert gaps == [(1.0, 1.5), (1.5, 2.5), (2.5, 3.0)]
    cells = found.tables()["pose_coverage"]
    about = np.abs(cells["speed"] - 2.0) < 0.4
    assert not about.any()
    assert cells["seconds"].sum() == pytest.approx(4 * 3 * 5.0)
