"""Holes of a dataset are filled from other clips, and each choice is what the trials say it is."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.completion import Completion, complete_from, completion_section, synthesised, write_completion
from gmr.completion.candidates import Candidate, on_skeleton, variants
from gmr.completion.choice_words import from_folder
from gmr.completion.choosing import bound, on_plan
from gmr.completion.queries import queries_of
from gmr.completion.shortfall import shortfalls
from gmr.completion.tempo import rows_of
from gmr.completion.words import change_sentence, headline, sentences
from gmr.evaluation.scenario import constant_trials
from gmr.evaluation.simulation import simulated
from gmr.matching import LOCOMOTION, Database, Profile, Status, run_trials
from gmr.matching.trial import Tracking
from gmr.pruning.outcomes import outcomes_of
from restless import without_rest
from walkers import CMU, placed, walker

DEMO = Path(gmr.__file__).parent / "data" / "demo"
SPEEDS, TURNS = (1.2, 1.6), (-45.0, 0.0, 45.0)
LEFT = float(np.radians(45.0))
OTHER_HEAD = {part: f"other {name}" if part == "head" else name for part, name in CMU.items()}


@pytest.fixture(scope="module")
def straight() -> dict[str, gmr.Motion]:
    return {"straight.bvh": walker(6, 1.2), "faster.bvh": walker(6, 1.6)}


@pytest.fixture(scope="module")
def others() -> dict[str, gmr.Motion]:
    return {
        "turns/left.bvh": walker(8, 1.2, LEFT),
        "stands.bvh": walker(4, 0.1),
        "short.bvh": walker(0.5, 1.2, LEFT),
        "odd.bvh": walker(8, 1.2, LEFT, names=OTHER_HEAD),
    }


@pytest.fixture(scope="module")
def completed(straight: dict[str, gmr.Motion], others: dict[str, gmr.Motion]) -> Completion:
    return complete_from(
        straight, others, source="archive", dataset="two", speeds=SPEEDS, turn_rates_deg=TURNS
    )


def folders(top: Path, archive: Mapping[str, gmr.Motion]) -> tuple[Path, Path]:
    """The folder of a dataset that only goes straight, and one of other clips."""
    clips = {"takes": {"straight.bvh": walker(5, 1.2)}, "archive": archive}
    for folder, motions in clips.items():
        (top / folder).mkdir()
        for name, motion in motions.items():
            gmr.write(motion, top / folder / name)
    return top / "takes", top / "archive"


def test_turns_are_filled_from_the_one_clip_that_turns_to_both_sides(completed: Completion) -> None:
    before, after = completed.trials["held_before"], completed.trials["held_after"]
    assert before.sum() == 2
    assert after.sum() > before.sum() + 1
    assert {choice.candidate.source for choice in completed.choices} == {"turns/left.bvh"}
    assert {choice.candidate.mirrored for choice in completed.choices} == {False, True}


def test_what_the_completed_dataset_still_lacks_is_told(completed: Completion) -> None:
    lacking = [sentence for sentence in sentences(completed) if sentence.startswith("Even so, ")]
    of_its_own = [sentence.lower() for sentence in completed.after.verdict.sentences]
    assert len(lacking) == (not completed.trials["held_after"].all())
    assert all(sentence.removeprefix("Even so, ").lower() in of_its_own for sentence in lacking)


def test_each_choice_takes_away_cost_and_loses_no_trial(completed: Completion) -> None:
    assert completed.before.simulation is not None
    log = completed.before.simulation.logs["time"]
    held, cost = completed.held_before, float(shortfalls(log).sum())
    for choice in completed.choices:
        assert choice.cost_before == pytest.approx(cost)
        assert choice.cost_after <= 0.99 * cost
        assert choice.held >= held
        assert choice.gain == pytest.approx(
            (choice.cost_before - choice.cost_after) / (choice.seconds * choice.candidate.factor)
        )
        held, cost = choice.held, choice.cost_after


def test_what_the_last_choice_says_is_what_the_chosen_files_do(
    straight: dict[str, gmr.Motion], completed: Completion
) -> None:
    assert completed.before.simulation is not None
    whole = completed.before.simulation
    built = Database.build({**straight, **completed.added}, normalization=whole.database.normalization)
    log = run_trials(built, whole.profiles)
    assert outcomes_of(log, whole.trials).held.sum() == completed.choices[-1].held
    assert shortfalls(log).sum() == pytest.approx(completed.choices[-1].cost_after)


def test_what_cannot_be_used_is_refused_in_a_sentence(completed: Completion) -> None:
    assert set(completed.refused) == {"odd.bvh"}
    assert "without 'Head'" in completed.refused["odd.bvh"]
    assert any("1 clip of archive was not considered (odd.bvh)" in each for each in sentences(completed))


def test_kinds_of_chosen_clips_are_counted_behind_their_words(completed: Completion) -> None:
    first = completed.choices[0]
    slow = replace(first, candidate=Candidate("a.bvh", factor=0.8))
    whole = replace(first, candidate=Candidate("b.bvh"))
    said = next(from_folder(replace(completed, choices=(whole, slow, whole))))
    assert said.endswith("that were there: as it is (2); 0.8 times as fast (1).")


def test_no_more_seconds_are_chosen_than_asked_for(
    straight: dict[str, gmr.Motion], others: dict[str, gmr.Motion]
) -> None:
    found = complete_from(straight, others, at_most=8.5, speeds=(1.2,), turn_rates_deg=TURNS)
    assert 0 < sum(choice.seconds for choice in found.choices) <= 8.5
    none = complete_from(
        straight, others, source="archive", dataset="two", at_most=0.3, speeds=(1.2,), turn_rates_deg=TURNS
    )
    assert not none.added
    assert headline(none).startswith("Nothing in archive helps: two does 1 of 3 trials.")


def test_a_dataset_with_mirrored_copies_is_offered_none(
    straight: dict[str, gmr.Motion], others: dict[str, gmr.Motion]
) -> None:
    found = complete_from(straight, others, mirror=True, speeds=(1.2,), turn_rates_deg=TURNS)
    assert found.added
    assert not any(choice.candidate.mirrored for choice in found.choices)
    assert found.trials["held_after"].sum() == 3


def test_a_clip_that_the_dataset_holds_already_changes_nothing(
    straight: dict[str, gmr.Motion], others: dict[str, gmr.Motion], completed: Completion
) -> None:
    # Of two files of one motion the shorter name would stand; here it is the dataset's own.
    again = {"a.bvh": straight["straight.bvh"], "b.bvh": placed(straight["faster.bvh"], 1.0, (2.0, 0.0))}
    found = complete_from(
        straight, {**again, **others}, source="archive", dataset="two", speeds=SPEEDS, turn_rates_deg=TURNS
    )
    assert [choice.name for choice in found.choices] == [choice.name for choice in completed.choices]
    np.testing.assert_array_equal(found.trials["held_after"], completed.trials["held_after"])
    assert found.held_before == completed.held_before


@pytest.mark.parametrize("mirror", [False, True])
def test_of_a_motion_that_the_dataset_holds_already_its_own_file_stays(mirror: bool) -> None:
    walks = {f"day 1/walk {speed}.bvh": walker(6, speed, 0.3 * speed) for speed in SPEEDS}
    far = {name.split()[-1]: placed(walk, 1.0, (2.0, 0.0)) for name, walk in walks.items()}
    others = {"left.bvh": walker(8, 1.2, LEFT)}
    asked: dict[str, Any] = {"speeds": SPEEDS, "turn_rates_deg": TURNS, "mirror": mirror}
    once, again = (complete_from(walks, archive, **asked) for archive in (others, {**far, **others}))
    assert once.held_before == again.held_before
    assert not {choice.name for choice in again.choices} & set(far)


def test_a_dataset_without_holes_is_left_alone(straight: dict[str, gmr.Motion]) -> None:
    found = complete_from(straight, {"more.bvh": walker(4, 1.2)}, speeds=(1.2,), turn_rates_deg=(0.0,))
    assert found.after is found.before
    assert headline(found).startswith("Nothing is missing")
    assert not any("takes away" in sentence for sentence in sentences(found))


def test_the_map_of_changes_says_what_changed_and_nothing_where_nothing_did(
    completed: Completion, straight: dict[str, gmr.Motion]
) -> None:
    assert "; the greatest gain is at " in change_sentence(completed)
    none = complete_from(straight, {"more.bvh": walker(4, 1.2)}, speeds=(1.2,), turn_rates_deg=(0.0,))
    assert change_sentence(none) == "Nothing was added, so no trial has changed."
    unmoved = replace(completed, after=completed.before)
    assert change_sentence(unmoved) == (
        "No trial comes closer to the plan by 10 cm or more, none strays farther from it by as much."
    )
    backwards = replace(completed, before=completed.after, after=completed.before)
    assert change_sentence(backwards).startswith(
        "No trial comes closer to the plan by 10 cm or more, 4 stray"
    )


def test_a_walk_is_chosen_where_a_walk_is_wanted() -> None:
    runs = {name: gmr.read(DEMO / name) for name in ("09_01.bvh", "09_02.bvh")}
    pool = {name: gmr.read(DEMO / name) for name in ("02_03.bvh", "07_02.bvh", "09_03.bvh", "09_11.bvh")}
    found = complete_from(runs, pool, speeds=(1.2, 1.4), turn_rates_deg=(0.0,))
    assert {choice.candidate.source for choice in found.choices} == {"07_02.bvh"}
    assert found.choices[-1].held == 2


@pytest.mark.parametrize("tracking", ["time", "velocity"])
def test_queries_made_again_cost_what_was_logged(straight: dict[str, gmr.Motion], tracking: Tracking) -> None:
    database = Database.build(straight)
    log = run_trials(database, [Profile.constant(1.3, 0.4, record=6.0)], tracking=tracking)
    asked = queries_of(database, log, np.array([0]))
    step = np.arange(log.recorded_from[0] + 1, log.lengths[0] - 60)
    step = step[np.isin(log.status[0, step], (Status.KEPT, Status.JUMPED))]
    shown = database.features[log.row[0, step]].astype(np.float64)
    cost = ((asked.features - shown) ** 2).sum(axis=1)
    assert len(cost) > 20
    np.testing.assert_allclose(cost, asked.cost, rtol=1e-3, atol=1e-4)


def test_frames_that_are_there_already_can_save_nothing_and_those_that_are_lacking_can(
    straight: dict[str, gmr.Motion],
) -> None:
    database = Database.build(straight)
    log = run_trials(database, [Profile.constant(1.2, 0.4, record=6.0)])
    asked = on_plan(database, log, np.array([0]), 1)
    assert bound(rows_of(database, 0), asked) == pytest.approx(0.0, abs=1e-4)
    better = Database.build({"turn": walker(6, 1.2, 0.4)}, normalization=database.normalization)
    assert bound(rows_of(better, 0), asked) > 0.1


def test_the_second_evaluation_has_the_features_and_the_switches_of_the_first(
    straight: dict[str, gmr.Motion], others: dict[str, gmr.Motion]
) -> None:
    before = gmr.evaluate(
        straight,
        schema=LOCOMOTION.weighed({"hips velocity": 3.0}),
        switched_speed=1.6,
        switch_every=2.0,
        speeds=(1.2,),
        turn_rates_deg=TURNS,
    )
    found = complete_from(straight, others, before=before)
    assert found.added
    assert found.after.summary.settings == before.summary.settings


def test_standing_still_is_no_cure(straight: dict[str, gmr.Motion]) -> None:
    found = complete_from(straight, {"stands.bvh": walker(4, 0.0)}, speeds=(1.2,), turn_rates_deg=TURNS)
    assert found.choices == () or found.choices[-1].held > found.held_before


def test_what_a_trial_lacks_is_nothing_just_where_it_holds(straight: dict[str, gmr.Motion]) -> None:
    database = Database.build(straight)
    asked = constant_trials((1.2, 1.4, 3.0), (0.0, 6.0, 60.0))
    log = simulated(database, asked, ("time",), threads=1, progress=lambda done, of: None).logs["time"]
    lacks = shortfalls(log)
    assert np.all((lacks >= 0) & (lacks < 1))
    np.testing.assert_array_equal(lacks == 0, outcomes_of(log, asked).held)
    assert 0 < (lacks == 0).sum() < len(asked)


@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_another_pace_is_that_of_a_clip_built_anew(factor: float) -> None:
    clip = walker(6, 1.2, 0.5)
    own = Database.build({"clip": clip})
    quick = Candidate("clip", factor=factor).of(clip)
    anew = Database.build({"clip": quick}, normalization=own.normalization, unit="m")
    guessed, built = rows_of(own, 0, factor), rows_of(anew, 0)
    assert guessed.seconds == pytest.approx(built.seconds, rel=0.01)
    inner = slice(30, -30)
    np.testing.assert_allclose(
        guessed.features[inner].mean(axis=0), built.features[inner].mean(axis=0), atol=0.12
    )
    np.testing.assert_array_equal(rows_of(own, 0).features, own.features[own.candidates])


def test_a_candidate_says_what_was_done_to_its_clip() -> None:
    found = list(variants("a/b.bvh", mirror=True, laid=False))
    assert len(found) == 10
    assert len({candidate.name for candidate in found}) == 10
    assert [candidate.name for candidate in found if candidate.whole] == ["b.bvh"]
    assert {"as it is", "mirrored", "0.8 times as fast", "mirrored, 1.25 times as fast"} <= {
        candidate.how for candidate in found
    }
    clip = walker(2, 1.2, 0.5)
    turned = Candidate("b", mirrored=True, factor=0.8).of(clip)
    assert turned.duration == pytest.approx(clip.duration / 0.8)
    seen = clip.positions()[:, 0] * (-1, 1, 1)
    np.testing.assert_allclose(turned.positions()[:, 0], seen, atol=1e-5)


def test_another_skeleton_is_laid_on_the_datasets_where_that_is_asked_for(
    straight: dict[str, gmr.Motion],
) -> None:
    like = straight["straight.bvh"]
    strange = {"m.bvh": walker(1, 1.2, names={part: f"x{name}" for part, name in CMU.items()})}
    usable, laid, refused = on_skeleton(strange, like.skeleton, lambda motion: like)
    assert (set(usable), laid, refused) == ({"m.bvh"}, {"m.bvh"}, {})
    usable, laid, refused = on_skeleton(strange, like.skeleton, None)
    assert (usable, laid, set(refused)) == ({}, set(), {"m.bvh"})


def test_made_clips_compete_where_that_is_asked_for(straight: dict[str, gmr.Motion]) -> None:
    clips = {"09_01.bvh": gmr.read(DEMO / "09_01.bvh")}
    pool = {"09_02.bvh": gmr.read(DEMO / "09_02.bvh")}
    found = complete_from(clips, pool, fill=synthesised(seconds=2), speeds=(1.3,), turn_rates_deg=(0.0,))
    assert [choice.candidate.how for choice in found.choices] == ["synthesised"]
    assert found.trials["held_after"].all()


def test_chosen_files_are_copied_whole_and_changed_ones_written(
    completed: Completion, tmp_path: Path
) -> None:
    archive = tmp_path / "archive"
    (archive / "turns").mkdir(parents=True)
    gmr.write(walker(2, 1.2, LEFT), archive / "turns" / "left.bvh")
    last = completed.choices[-1]
    as_it_is = replace(last, name="left.bvh", candidate=Candidate("turns/left.bvh"))
    found = replace(
        completed,
        added={**completed.added, "left.bvh": walker(2, 1.2, LEFT)},
        choices=(*completed.choices, as_it_is),
    )
    page = write_completion(found, tmp_path / "out", source=archive)
    clips = tmp_path / "out" / "clips"
    assert (clips / "left.bvh").read_bytes() == (archive / "turns" / "left.bvh").read_bytes()
    for choice in completed.choices:
        written, made = (
            motion.positions(joints=["LeftToeBase"])
            for motion in (gmr.read(clips / choice.name), completed.added[choice.name])
        )
        np.testing.assert_allclose(written, made, atol=1e-4)
    told = json.loads((tmp_path / "out" / "manifest.json").read_text(encoding="utf-8"))
    assert [clip["clip"] for clip in told["clips"]] == list(found.added)
    assert told["refused"] == dict(completed.refused)
    assert headline(found) in page.read_text(encoding="utf-8")
    assert len((tmp_path / "out" / "chosen.csv").read_text().splitlines()) == len(found.choices) + 1


def test_both_commands_choose_the_same(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    takes, archive = folders(tmp_path, {"left.bvh": walker(6, 1.2, LEFT)})
    asked = ["--speeds", "1.2", "--turn-rates", "0,45", "-q"]
    one, two = tmp_path / "one", tmp_path / "two"
    assert finished(command, ["complete", str(takes), "--from", str(archive), "-o", str(one), *asked]) == 0
    evaluate = ["evaluate", str(takes), "--complete-from", str(archive), "--complete-out", str(two)]
    assert finished(command, [*evaluate, "--no-report", "--scenario", "constant", *asked]) == 0
    said = capsys.readouterr().out
    assert said.count("chosen from archive") == 2
    assert f"Chosen clips: {two / 'clips'}" in said
    assert not list(two.glob("*.html"))
    assert (one / "chosen.csv").read_bytes() == (two / "chosen.csv").read_bytes()
    files = [sorted(path.name for path in (out / "clips").iterdir()) for out in (one, two)]
    assert files[0] == files[1]
    assert finished(command, ["complete", str(takes), "--made"]) == 2


def test_the_report_has_before_and_after_and_the_object_their_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    takes, archive = folders(tmp_path, {"left.bvh": walker(6, 1.2, LEFT)})
    out, report = tmp_path / "out", tmp_path / "report.html"
    asked = ["--speeds", "1.2", "--turn-rates", "0,45", "--scenario", "constant", "-q"]
    completing = ["--complete-from", str(archive), "--complete-out", str(out)]
    assert finished(command, ["evaluate", str(takes), *completing, *asked, "-o", str(report), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    told = found["completed"]
    page = report.read_text(encoding="utf-8")
    assert told["headline"] in page
    for part in ('id="completion"', 'href="#completion"', "Save completion_clips.csv"):
        assert part in page
    for figure in ("holds_before", "holds_after", "offset_before", "offset_after", "change"):
        assert page.count(f'data-figure="{figure}"') == 1
    before = {row["turn_rate_deg"]: row["offset_mean"] for row in found["trials"]}
    assert {row["turn_rate_deg"]: row["offset_before"] for row in told["trials"]} == before
    assert sum(row["held_after"] for row in told["trials"]) > sum(
        row["held_before"] for row in told["trials"]
    )
    assert [row["clip"] for row in told["chosen"]] == sorted(path.name for path in (out / "clips").iterdir())
    assert "takes, completed" in (out / "after.html").read_text(encoding="utf-8")


def test_a_completion_that_adds_nothing_is_words_alone_in_the_report(straight: dict[str, gmr.Motion]) -> None:
    found = complete_from(straight, {"more.bvh": walker(4, 1.2)}, speeds=(1.2,), turn_rates_deg=(0.0,))
    section = completion_section(found)
    assert "Nothing is missing" in section.html
    assert section.figures == ()
    assert "data-figure" not in section.html
    assert "data-save" not in section.html


def test_maps_before_and_after_are_on_one_scale(completed: Completion) -> None:
    drawn = {figure.name: figure for figure in completion_section(completed).figures}
    for measure in ("holds", "offset"):
        before, after = drawn[f"{measure}_before"], drawn[f"{measure}_after"]
        assert before.chart == after.chart
        assert [before.data["trials"][name].tolist() for name in ("speed", "turn_rate_deg")] == [
            after.data["trials"][name].tolist() for name in ("speed", "turn_rate_deg")
        ]


def test_a_folder_to_be_completed_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gmr.cli.commands import gmr as command
    from gmr.cli.common import finished
    from gmr.formats.folder import read_folder

    takes, archive = folders(tmp_path, {"left.bvh": walker(6, 1.2, LEFT)})
    (takes / "broken.bvh").write_text("HIERARCHY\n")
    looked_at = []

    def counted(folder: Path, **options: Any) -> Any:
        looked_at.append(Path(folder).name)
        return read_folder(folder, **options)

    monkeypatch.setattr("gmr.evaluation.reading.read_folder", counted)
    completing = ["--complete-from", str(archive), "--complete-out", str(tmp_path / "out")]
    asked = ["--speeds", "1.2", "--turn-rates", "0,45", "--scenario", "constant", "--no-report", "-q"]
    assert finished(command, ["evaluate", str(takes), *completing, *asked]) == 1
    assert sorted(looked_at) == ["archive", "takes"]


def test_weights_of_a_completion_are_those_asked_for(tmp_path: Path) -> None:
    takes = tmp_path / "takes"
    takes.mkdir()
    gmr.write(walker(5, 1.2), takes / "straight.bvh")
    asked = ["--speeds", "1.2", "--turn-rates", "0", "-q", "-o", str(tmp_path / "out")]
    assert finished(command, ["complete", str(takes), *asked, "--weight", "hips velocity=7"]) == 0
    assert "hips velocity: 7" in (tmp_path / "out" / "before.html").read_text(encoding="utf-8")
    assert finished(command, ["complete", str(takes), *asked, "--weight", "nose=7"]) == 2


def test_a_place_for_the_clips_that_cannot_be_is_found_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    place = tmp_path / "file" / "completed"
    takes = tmp_path / "takes"
    takes.mkdir()
    completing = ["--complete-from", str(tmp_path), "--complete-out", str(place)]
    assert finished(command, ["evaluate", str(takes), *completing, "-q", "--no-report"]) == 1
    assert "Not a directory (while looking where to write)" in capsys.readouterr().err


def test_clips_that_are_refused_are_told_like_files_that_are_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    odd = walker(5, 1.2, LEFT, names=OTHER_HEAD)
    takes, archive = folders(tmp_path, {"a.bvh": odd, "b.bvh": odd})
    (archive / "broken.bvh").write_text("HIERARCHY\n")
    asked = ["--speeds", "1.2", "--turn-rates", "0,45", "-q", "--json"]
    evaluate = [
        "evaluate",
        str(takes),
        "--complete-from",
        str(archive),
        "--complete-out",
        str(tmp_path / "a"),
    ]
    assert finished(command, [*evaluate, "--no-report", "--scenario", "constant", *asked]) == 1
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert told["not_done"]["--complete-from"].startswith("no clip of archive can be used: another skeleton")
    assert set(told["completed"]["refused"]) == {"a.bvh", "b.bvh"}
    assert set(told["completed"]["failed"]) == {str(archive / "broken.bvh")}
    lines = said.err.splitlines()
    assert len(lines) == 3
    assert "broken.bvh" in lines[0]
    assert lines[1].startswith("gmr: left out a.bvh, b.bvh of archive: another skeleton than the dataset's")
    assert lines[2].startswith(
        "gmr: --complete-from came to nothing, all else is done: no clip of archive can"
    )
    complete = ["complete", str(takes), "--from", str(archive), "-o", str(tmp_path / "b")]
    (takes / "cut.bvh").write_text("HIERARCHY\n")
    assert finished(command, [*complete, *asked]) == 1
    again = capsys.readouterr()
    assert [line for line in again.err.splitlines() if "cut.bvh" not in line] == lines[:2]
    failed = json.loads(again.out)["failed"]
    assert set(failed) == {"cut.bvh", str(archive / "broken.bvh")}
    assert failed[str(archive / "broken.bvh")] == told["completed"]["failed"][str(archive / "broken.bvh")]


def test_nothing_is_said_to_be_undone_where_some_clips_can_be_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    odd = walker(5, 1.2, LEFT, names=OTHER_HEAD)
    takes, archive = folders(tmp_path, {"left.bvh": walker(6, 1.2, LEFT), "odd.bvh": odd})
    asked = [
        "--speeds",
        "1.2",
        "--turn-rates",
        "0,45",
        "--scenario",
        "constant",
        "--no-report",
        "-q",
        "--json",
    ]
    completing = ["--complete-from", str(archive), "--complete-out", str(tmp_path / "out")]
    assert finished(command, ["evaluate", str(takes), *completing, *asked]) == 1
    said = capsys.readouterr()
    assert json.loads(said.out)["not_done"] == {}
    assert said.err.startswith("gmr: left out odd.bvh of archive: another skeleton")


def test_the_other_folder_is_named_where_none_of_its_clips_can_be_used(
    straight: dict[str, gmr.Motion],
) -> None:
    short = {"short.bvh": walker(0.5, 1.2, LEFT)}
    asked: dict[str, Any] = {"source": "archive", "speeds": (1.2,), "turn_rates_deg": TURNS}
    with pytest.raises(gmr.DatasetError, match=r"^no clip of archive can be used: no clip lasts the 1.00 s"):
        complete_from(straight, short, **asked)
    found = complete_from(straight, short, fill=synthesised(seconds=2), **asked)
    assert found.refused["short.bvh"].startswith("no clip lasts the 1.00 s")
    assert found.considered == 0


def test_clips_without_a_rest_pose_are_laid_by_the_frame_in_which_they_stand(
    straight: dict[str, gmr.Motion],
) -> None:
    names = {part: f"mixamorig:{name}" for part, name in CMU.items()}
    restless = {"left.bvh": without_rest(walker(8, 1.2, LEFT, names=names), 3)}
    asked: dict[str, Any] = {"source": "archive", "speeds": (1.2,), "turn_rates_deg": TURNS}
    found = complete_from(straight, restless, lay=True, **asked)
    assert {choice.candidate.how.split(",")[0] for choice in found.choices} == {"laid on this skeleton"}
    assert found.choices[-1].held == 3
    assert any("1 clip of another skeleton has no rest pose" in note for note in found.noticed)


def test_clips_that_cannot_be_laid_for_one_reason_are_told_in_one_sentence(
    straight: dict[str, gmr.Motion],
) -> None:
    strange = walker(2, 1.2, names={part: f"mixamorig:{name}" for part, name in CMU.items()})
    rotations = strange.rotations.copy()
    rotations[:, strange.skeleton.index("mixamorig:LeftUpLeg")] = (1.0, 0.0, 0.0, 0.0)
    kicking = gmr.Motion.from_pose(
        strange.skeleton, rotations, strange.translations, strange.frame_time, unit=1.0
    )
    names = ("one/a.bvh", "two/b.bvh")
    others = {name: replace(without_rest(kicking, 1), name=f"/archive/{name}") for name in names}
    asked: dict[str, Any] = {"source": "archive", "speeds": (1.2,), "turn_rates_deg": TURNS}
    found = complete_from(straight, others, lay=True, **asked)
    assert set(found.refused) == set(names)
    assert len(set(found.refused.values())) == 1
    assert "stands in no frame" in found.refused[names[0]]
    assert sum("of archive were not considered" in sentence for sentence in sentences(found)) == 1
