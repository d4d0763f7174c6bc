"""A dataset made smaller: what can go unnoticed, what clips are worth, and files that do as was promised."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gmr
from gmr.evaluation import Evaluation
from gmr.evaluation.simulation import Simulation
from gmr.matching import LOCOMOTION, Database
from gmr.matching.trial import TrialLog, run_trials
from gmr.pruning import Part, Pruning, Score, lossless, prune, write_pruned
from gmr.pruning.curve import Curve, Point
from gmr.pruning.figures import figures
from gmr.pruning.outcomes import joined, outcomes_of
from gmr.pruning.part import gaps, ranges_of, recordings_of, whole
from gmr.pruning.prune import goal_of
from gmr.pruning.section import pruning_section
from gmr.pruning.words import curve_sentence, headline, importance_sentence, sentences
from gmr.table import Table
from locomotion import Arc
from walker import write_walkers

WALKS = {
    "fast.bvh": Arc(8.0, 2.0),
    "left/fast.bvh": Arc(8.0, 2.0, 50.0),
    "left/slow.bvh": Arc(8.0, 1.0, 50.0),
    "odd.bvh": Arc(6.0, 3.0, -90.0),
    "slow.bvh": Arc(8.0, 1.0),
}
GRID: dict[str, Any] = {"speeds": (1.0, 1.5, 2.0), "turn_rates_deg": (0.0, 50.0), "scenarios": "constant"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("takes")
    write_walkers(top, WALKS)
    return top


@pytest.fixture(scope="module", params=[False, True], ids=["plain", "mirrored"])
def found(request: pytest.FixtureRequest, folder: Path) -> Evaluation:
    return gmr.evaluate(folder, mirror=request.param, **GRID)


@pytest.fixture(scope="module")
def pruned(found: Evaluation) -> Pruning:
    return prune(found, "40%")


def simulation_of(found: Evaluation) -> Simulation:
    assert found.simulation is not None
    return found.simulation


def again(simulation: Simulation, database: Database) -> Iterator[TrialLog]:
    for tracking in simulation.logs:
        yield run_trials(database, simulation.profiles, tracking=tracking)


def score_on(simulation: Simulation, part: Part) -> Score:
    database = simulation.database.subset(part.rows(simulation.database))
    return joined([outcomes_of(log, simulation.trials) for log in again(simulation, database)]).score


def bits(log: TrialLog, trial: int) -> dict[str, bytes]:
    values = {field.name: getattr(log, field.name) for field in fields(log)}
    return {name: each[trial].tobytes() for name, each in values.items() if isinstance(each, np.ndarray)}


def alike(one: Evaluation, other: Evaluation) -> bool:
    """Whether all trials show the same frames at the same places, bit by bit."""
    pairs = zip(simulation_of(one).logs.values(), simulation_of(other).logs.values(), strict=True)
    return all(bits(a, trial) == bits(b, trial) for a, b in pairs for trial in range(len(a)))


@pytest.mark.parametrize("mirror", [False, True], ids=["plain", "mirrored"])
def test_a_clip_that_is_there_twice_changes_nothing_and_goes(mirror: bool, tmp_path: Path) -> None:
    # Within a curve of a second and a half no jump goes anywhere new, but one to its copy did.
    once = {**WALKS, "left/short.bvh": Arc(1.6, 1.5, 50.0)}
    copies = {"left/short copy.bvh": "left/short.bvh", "slow (2).bvh": "slow.bvh"}
    write_walkers(tmp_path / "once", once)
    write_walkers(tmp_path / "twice", once | {name: once[first] for name, first in copies.items()})
    alone, among = (gmr.evaluate(tmp_path / name, mirror=mirror, **GRID) for name in ("once", "twice"))
    assert dict(simulation_of(among).database.duplicates) == copies
    assert simulation_of(alone).database.clip_names == simulation_of(among).database.clip_names
    assert alike(alone, among)
    assert alone.summary.seconds == among.summary.seconds
    assert any("'left/short copy.bvh' as 'left/short.bvh' and 1 more" in note for note in among.notes)

    of = prune(among, "lossless")
    assert dict(of.lossless.ranges) == {**lossless(alone).ranges, **dict.fromkeys(copies, ())}
    assert of.curve.points[0].part.seconds == pytest.approx(8.0 * 6 - 2 + 1.6 * 2, abs=0.1)
    assert of.curve.points[-1].part.seconds <= 0.5 * of.curve.points[0].part.seconds
    assert sentences(of)[1] == (
        "2 clips hold the same motion as others ('left/short copy.bvh' as 'left/short.bvh' and 1 more) and "
        "went first."
    )
    written = write_pruned(of, tmp_path / "twice", tmp_path / "smaller")
    assert written.identical
    assert written.part.ranges == of.lossless.ranges
    told = json.loads((tmp_path / "smaller" / "manifest.json").read_text())
    assert [gone for gone in told["gone"] if gone["clip"] == "left/short copy.bvh"] == [
        {
            "clip": "left/short copy.bvh",
            "seconds": [0.0, pytest.approx(1.6, abs=0.04)],
            "whole": True,
            "played_seconds": 0.0,
            "why": "the same motion as 'left/short.bvh'",
        }
    ]
    in_words = (tmp_path / "smaller" / "manifest.md").read_text()
    assert "`slow (2).bvh`, all of it: the same motion as 'slow.bvh'." in in_words


def test_where_copies_alone_are_as_much_as_shall_go_nothing_else_does(tmp_path: Path) -> None:
    write_walkers(
        tmp_path / "takes",
        {name.replace(".", f"{copy}."): arc for name, arc in WALKS.items() for copy in ("", "_2", "_3")},
    )
    of = prune(gmr.evaluate(tmp_path / "takes", **GRID), "50%")
    assert of.chosen.lossless
    assert of.chosen.part.seconds == pytest.approx(8.0 * 4 + 6, abs=0.2)
    assert headline(of) == "67% of the seconds can go, and every trial stays the same, bit by bit."
    assert sorted(of.importance["clip"]) == sorted(WALKS)


def test_a_file_whose_name_is_no_text_is_pruned_as_others_are(tmp_path: Path) -> None:
    write_walkers(tmp_path / "takes", WALKS)
    name = os.fsdecode(b"gr\xfcn.bvh")
    (tmp_path / "takes" / "fast.bvh").rename(tmp_path / "takes" / name)
    (tmp_path / "takes" / "broken.bvh").write_text("HIERARCHY")
    of = prune(gmr.evaluate(tmp_path / "takes", **GRID), "lossless")
    write_pruned(of, tmp_path / "takes", tmp_path / "smaller")
    left = [path.name for path in (tmp_path / "smaller").iterdir() if path.suffix == ".bvh"]
    assert [each for each in left if each.startswith(name[:3])]
    told = json.loads((tmp_path / "smaller" / "manifest.json").read_text())
    assert list(told["not_evaluated"]) == ["broken.bvh"]
    assert any(file["of"] == "gr\\xfcn.bvh" for file in told["files"])
    assert "- `broken.bvh`: " in (tmp_path / "smaller" / "manifest.md").read_text()


def test_what_no_trial_shows_can_go(found: Evaluation) -> None:
    left = lossless(found)
    assert left.ranges["odd.bvh"] == ()
    assert left.ranges["slow.bvh"]
    assert left.ranges["left/fast.bvh"]
    assert left.seconds < 32.0


def test_without_what_can_go_every_trial_is_the_same_in_every_bit(found: Evaluation) -> None:
    simulation = simulation_of(found)
    left = lossless(found).rows(simulation.database)
    logs = again(simulation, simulation.database.subset(left))
    for before, after in zip(simulation.logs.values(), logs, strict=True):
        assert not (~left)[after.row[after.row >= 0]].any()
        for trial in range(len(before)):
            assert bits(before, trial) == bits(after, trial)


def test_a_trial_that_never_shows_a_clip_is_the_same_without_it(found: Evaluation) -> None:
    simulation = simulation_of(found)
    database, untouched = simulation.database, 0
    for recording in recordings_of(database):
        gone = ~whole(database).without(recording.name, (0, recording.frames)).rows(database)
        logs = again(simulation, database.subset(~gone))
        for before, after in zip(simulation.logs.values(), logs, strict=True):
            for trial in range(len(before)):
                if not gone[before.row[trial][before.row[trial] >= 0]].any():
                    untouched += 1
                    assert bits(before, trial) == bits(after, trial)
    assert untouched > 10


def test_importance_is_what_running_all_trials_without_the_clip_shows(pruned: Pruning) -> None:
    simulation = pruned.simulation
    before = score_on(simulation, whole(simulation.database))
    assert before == pruned.outcomes.score
    for row in pruned.importance.rows():
        frames = next(r.frames for r in recordings_of(simulation.database) if r.name == row["clip"])
        after = score_on(simulation, whole(simulation.database).without(row["clip"], (0, frames)))
        assert row["offset_change"] == pytest.approx(after.offset - before.offset, abs=1e-12)
        assert row["held_change"] == after.held - before.held
    assert np.all(np.diff(pruned.importance["loss"]) <= 0)
    assert pruned.importance["runs"][list(pruned.importance["clip"]).index("odd.bvh")] == 0


def test_every_point_of_the_curve_is_what_running_all_trials_on_it_shows(pruned: Pruning) -> None:
    points = pruned.curve.points
    assert [point.part.seconds for point in points] == sorted(
        (point.part.seconds for point in points), reverse=True
    )
    for point in points:
        again = score_on(pruned.simulation, point.part)
        assert again.held == point.score.held
        assert again.offset == pytest.approx(point.score.offset, abs=1e-12)
        assert point.lossless <= (point.score == pruned.outcomes.score)
    assert points[0].part == whole(pruned.simulation.database)
    assert points[-1].part.seconds <= 0.5 * points[0].part.seconds
    assert {point.lossless for point in points} == {False, True}


def test_the_goal_is_reached_and_not_passed_by_more_than_a_move(pruned: Pruning) -> None:
    seconds = pruned.chosen.part.seconds / pruned.curve.points[0].part.seconds
    assert 0.5 < seconds <= 0.6
    assert not pruned.chosen.lossless


def scored(of: Pruning, *scores: Score) -> Pruning:
    """A pruning whose curve goes on from the whole to points with other scores, the first of them chosen."""
    whole_of_it, last = of.curve.points[0], of.curve.points[-1]
    held = np.arange(162) < 31
    outcomes = replace(of.outcomes, offset=np.full(162, 0.956), held=held, steady=np.ones(162, bool))
    points = [Point(last.part, score, lossless=False) for score in scores]
    return replace(of, outcomes=outcomes, curve=Curve((whole_of_it, *points)), chosen=points[0])


def test_words_say_that_it_costs_only_where_it_does(pruned: Pruning) -> None:
    better, same, worse = Score(0.955, 32, 162), Score(0.956, 31, 162), Score(0.956, 30, 162)
    told = curve_sentence(scored(pruned, better))
    assert told.startswith("Beyond what no trial needs, trials change, yet on the whole not for the worse: ")
    assert "the mean offset is 0.955 m where it was 0.956 m, and 32 of 162 trials hold where 31 did" in told
    told = curve_sentence(scored(pruned, same))
    assert "the mean offset stays 0.956 m, and 31 of 162 trials hold, as before" in told
    assert curve_sentence(scored(pruned, worse)).startswith("Beyond what no trial needs, it costs: ")
    assert curve_sentence(scored(pruned, better, worse)).startswith(
        "Beyond what no trial needs, trials change: "
    )


def test_the_headline_tells_what_an_evaluation_of_the_new_folder_shows(
    pruned: Pruning, folder: Path, tmp_path: Path
) -> None:
    written = write_pruned(pruned, folder, tmp_path / "smaller")
    shown = replace(written, whole=Score(0.956, 31, 162), own_scale=Score(0.971, 29, 162))
    assert headline(pruned, shown).endswith(
        " of the seconds can go; the new folder does 29 of 162 trials where the whole dataset does 31, and "
        "its mean offset is 0.971 m where that of the whole is 0.956 m."
    )
    same = replace(pruned, chosen=pruned.curve.lossless)
    assert headline(same, replace(shown, identical=True)).endswith(
        " of the seconds can go, and every trial stays the same, bit by bit. With the features scaled by "
        "what is left, as an evaluation of the new folder has them, it does 29 of 162 trials where the whole "
        "dataset does 31, and its mean offset is 0.971 m where that of the whole is 0.956 m."
    )


def test_clips_that_go_as_a_whole_leave_no_part_of_another(pruned: Pruning) -> None:
    whole = pruned.curve.points[0].part
    first, *others = whole.ranges
    left = replace(whole, ranges={first: whole.ranges[first], **dict.fromkeys(others, ())})
    told = sentences(replace(pruned, lossless=left))
    assert any(f"of {len(whole.ranges)} as a whole, and no part of another. Without" in one for one in told)


def test_one_trial_is_one(pruned: Pruning) -> None:
    rows = len(pruned.importance)
    lost = np.array([-1.0, -2.0, *[0.0] * (rows - 2)])
    changed = {"loss": -lost, "held_change": lost, "offset_change": np.full(rows, 0.01)}
    said = importance_sentence(replace(pruned, importance=Table({**dict(pruned.importance), **changed})))
    assert "(+0.01 m, -1 trial)" in said
    assert "(+0.01 m, -2 trials)" in said


def test_bars_are_sorted_by_what_they_show(pruned: Pruning) -> None:
    changes = np.linspace(-0.01, 0.05, len(pruned.importance))
    mixed = np.roll(changes, 2)
    importance = Table({**dict(pruned.importance), "offset_change": mixed})
    figure = next(
        f for f in figures(replace(pruned, importance=importance)) if f.name == "pruning_importance"
    )
    shown = figure.data["clips"]["offset_change"]
    assert (np.diff(shown) <= 0).all()
    assert "Bars are sorted by the mean offset alone" in figure.sentence


def test_a_step_that_takes_much_more_than_was_asked_for_is_told(
    pruned: Pruning, folder: Path, tmp_path: Path
) -> None:
    more = replace(pruned, goal=0.1)
    share = f"{100 * (1 - more.chosen.part.seconds / more.curve.points[0].part.seconds):.0f}%"
    said = f"10% was asked for; the smallest step that reaches it takes {share}."
    assert sentences(more)[0] == said
    assert said in pruning_section(more).html
    assert "was asked for" not in " ".join(sentences(replace(pruned, goal=0.999 * float(share[:-1]) / 100)))
    write_pruned(more, folder, tmp_path / "smaller")
    assert said in (tmp_path / "smaller" / "manifest.md").read_text()


@pytest.mark.parametrize("goal", [0.4, 0.55])
def test_a_goal_is_passed_by_no_more_than_a_second_where_smaller_moves_do(
    tmp_path: Path, goal: float
) -> None:
    arcs = [Arc(20.0, speed, turn) for speed in (1.0, 2.0) for turn in (0.0, 50.0)]
    write_walkers(tmp_path, {f"{place}.bvh": arc for place, arc in enumerate(arcs)})
    of = prune(gmr.evaluate(tmp_path, **GRID), goal, until=0.2)
    every = of.curve.points[0].part.seconds
    assert goal * every <= every - of.chosen.part.seconds <= goal * every + 1.0


@given(st.data())
@settings(max_examples=8)
def test_clips_that_are_left_do_as_a_database_built_of_their_files(folder: Path, data: st.DataObject) -> None:
    takes = gmr.read_folder(folder)
    mirror = data.draw(st.booleans())
    names = data.draw(st.sets(st.sampled_from(sorted(takes)), min_size=1))
    every = Database.build(dict(takes), mirror=mirror)
    clips = [name.removesuffix(" (mirrored)") in names for name in every.clip_names]
    part = every.subset(np.array(clips)[every.clips])
    built = Database.build(
        {name: take for name, take in takes.items() if name in names},
        mirror=mirror,
        normalization=every.normalization,
    )
    profiles = [gmr.matching.Profile.constant(speed, 0.4, record=3.0) for speed in (1.2, 2.4)]
    found, expected = (run_trials(database, profiles) for database in (part, built))
    renumbered = np.flatnonzero(np.array(clips)[every.clips])[expected.row]
    np.testing.assert_array_equal(found.row, renumbered)
    for name in ("x", "z", "heading", "status", "cost_pose", "cost_trajectory", "discontinuity"):
        assert getattr(found, name).tobytes() == getattr(expected, name).tobytes()


def test_a_subset_of_the_wrong_length_or_of_nothing_is_refused(found: Evaluation) -> None:
    database = simulation_of(found).database
    with pytest.raises(ValueError, match="one entry for each of the"):
        database.subset([True])
    with pytest.raises(gmr.DatasetError, match="no clip has the 61 frames"):
        database.subset(np.zeros(len(database), bool))


@pytest.mark.parametrize("goal", ["lossless", "40%"])
def test_the_files_do_what_the_manifest_promises(
    found: Evaluation, folder: Path, tmp_path: Path, goal: str
) -> None:
    of, mirror = prune(found, goal), found.summary.settings["mirror"]
    written = write_pruned(of, folder, tmp_path / "smaller")
    told = json.loads((tmp_path / "smaller" / "manifest.json").read_text())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["smaller"]

    alone = gmr.evaluate(tmp_path / "smaller", mirror=mirror, **GRID)
    trials = alone.measured.trials
    promised = told["runs"]["files_by_themselves"]
    assert promised["offset_mean"] == pytest.approx(trials["offset_mean"].mean(), abs=1e-12)
    assert f"in {promised['held']} of 6 trials" in alone.verdict.headline

    takes = gmr.read_folder(tmp_path / "smaller")
    scale = gmr.matching.Normalization(
        *(np.array(told["scale"][key], np.float32) for key in ("offset", "scale"))
    )
    database = Database.build(dict(takes), mirror=mirror, normalization=scale)
    logs = list(again(of.simulation, database))
    scaled = joined([outcomes_of(log, of.simulation.trials) for log in logs]).score
    assert told["runs"]["files_with_the_scale_of_the_whole"]["offset_mean"] == scaled.offset
    assert told["identical"] == written.identical == (goal == "lossless")
    if goal == "lossless":
        for before, after in zip(of.simulation.logs.values(), logs, strict=True):
            for name in ("x", "z", "heading", "cost_pose", "cost_trajectory", "discontinuity"):
                assert getattr(before, name).tobytes() == getattr(after, name).tobytes()

    assert told["seconds_after"] == pytest.approx(written.part.seconds)
    assert sum(file["seconds"] for file in told["files"]) == pytest.approx(told["seconds_after"], abs=0.3)
    for file in told["files"]:
        source = gmr.read(folder / file["of"])
        if file["frames"] == "all":
            assert (tmp_path / "smaller" / file["file"]).read_bytes() == (folder / file["of"]).read_bytes()
        else:
            first, last = file["frames"]
            np.testing.assert_array_equal(takes[file["file"]].rows, source.rows[first : last + 1])
    assert {gone["clip"] for gone in told["gone"] if gone["whole"]} == {"odd.bvh"}
    in_words = (tmp_path / "smaller" / "manifest.md").read_text()
    for name in ("`odd.bvh`, all of it: no trial needs it.", "byte for byte", "mean offset, m"):
        assert name in in_words


def test_nothing_is_left_where_writing_fails(
    found: Evaluation, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    of = prune(found, "lossless")
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "mine.txt").write_text("")
    with pytest.raises(gmr.DatasetError, match=r"there is there and not empty"):
        write_pruned(of, folder, tmp_path / "there")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("gmr.pruning.writing.write", full)
    with pytest.raises(OSError, match="No space left"):
        write_pruned(of, folder, tmp_path / "smaller")
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["mine.txt", "there"]


def test_a_source_that_has_changed_is_refused(found: Evaluation, tmp_path: Path) -> None:
    write_walkers(tmp_path / "other", {"fast.bvh": WALKS["fast.bvh"]})
    with pytest.raises(gmr.DatasetError, match=r"no longer holds left/fast\.bvh; evaluate it again"):
        write_pruned(prune(found), tmp_path / "other", tmp_path / "smaller")


@pytest.mark.parametrize("goal", ["0%", "100%", "30", "-5%", "nan", "half", 1.5])
def test_a_goal_that_is_no_share_is_refused(goal: float | str) -> None:
    with pytest.raises(ValueError, match="no share of a dataset"):
        goal_of(goal)


def test_goals_are_shares_or_lossless() -> None:
    assert [goal_of(goal) for goal in ("30%", "0.3", 0.3, "lossless")] == [0.3, 0.3, 0.3, "lossless"]


def test_trials_of_every_scenario_can_be_pruned_and_hold_as_the_verdict_has_it(folder: Path) -> None:
    asked = ("constant", "start-stop", "slalom", "splines")
    found = gmr.evaluate(
        folder, speeds=(1.0,), turn_rates_deg=(0.0, 50.0), scenarios=asked, tracking=("time", "velocity")
    )
    of = prune(found, "20%", until=0.2)
    trials = found.measured.trials
    limits = found.summary.settings["limits"]
    held = np.abs(trials["speed_error_share"]) <= limits["speed"]
    held &= np.abs(trials["turn_rate_error_deg"]) <= limits["turn_rate_deg"]
    held &= (trials["tracking"] == "velocity") | (trials["offset_mean"] <= limits["offset"])
    assert of.outcomes.held.tolist() == held.tolist()
    judged = (trials["scenario"] == "constant") & (trials["tracking"] == "time")
    assert of.outcomes.score.offset == pytest.approx(trials["offset_mean"][judged].mean(), abs=1e-12)


def test_so_much_cannot_go_that_nothing_is_left(found: Evaluation) -> None:
    with pytest.raises(gmr.GmrError, match=r"99\.9% of the seconds cannot go"):
        prune(found, "99.9%")


def test_an_evaluation_without_trials_is_refused(found: Evaluation) -> None:
    import pickle

    with pytest.raises(gmr.GmrError, match="without its trials; evaluate the clips again"):
        lossless(pickle.loads(pickle.dumps(found)))


@given(st.lists(st.booleans(), max_size=30), st.integers(1, 5))
def test_ranges_and_gaps_make_up_the_whole(left: list[bool], least: int) -> None:
    mask = np.array(left, bool)
    ranges = ranges_of(mask, least)
    covered = np.zeros(len(mask), bool)
    for first, end in ranges:
        covered[first:end] = True
    assert not (mask & ~covered).any()
    between = list(gaps(len(mask), ranges))
    assert sum(end - first for first, end in (*ranges, *between)) == len(mask)
    assert all(end - first >= least for first, end in between if first > 0 and end < len(mask))
    for first, end in between:
        covered[first:end] = True
    assert covered.all()


def test_a_score_tells_offset_and_lost_trials_together() -> None:
    best, worse = Score(0.2, 10, 20), Score(0.3, 8, 20)
    assert worse.worse_than(best) == pytest.approx(0.1 + 0.5 * 2 / 20)
    assert Score(math.nan, 8, 20).worse_than(Score(math.nan, 10, 20)) == pytest.approx(0.05)


def test_files_are_measured_by_the_features_of_the_evaluation(folder: Path, tmp_path: Path) -> None:
    schema = LOCOMOTION.weighed({"foot position": 0.0, "trajectory facing": 4.0})
    found = gmr.evaluate(folder, schema=schema, **{**GRID, "speeds": (1.0, 2.0)})
    assert write_pruned(prune(found, "lossless"), folder, tmp_path / "less").identical
