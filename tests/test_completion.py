"""A dataset's holes are filled, and it is told what that did."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.completion import Ask, Completion, complete, holes, synthesised, write_completion
from gmr.completion.words import headline, sentences
from gmr.table import Table

SPEEDS, TURNS = (1.5, 3.0), (-50.0, 0.0, 50.0)
DEMO = Path(gmr.__file__).parent / "data" / "demo"


@pytest.fixture(scope="module")
def clips() -> dict[str, gmr.Motion]:
    names = ("07_01.bvh", "07_02.bvh", "08_01.bvh", "09_01.bvh")
    return {name: gmr.read(DEMO / name) for name in names}


@pytest.fixture(scope="module")
def completed(clips: dict[str, gmr.Motion]) -> Completion:
    return complete(clips, synthesised(seconds=6), dataset="four", speeds=SPEEDS, turn_rates_deg=TURNS)


def test_both_evaluations_are_called_by_the_dataset(completed: Completion) -> None:
    assert completed.before.dataset == completed.dataset
    assert completed.after.dataset == f"{completed.dataset}, completed"
    assert set(completed.after.measured.trials["dataset"]) == {completed.after.dataset}


def test_holes_are_the_trials_that_do_not_hold(completed: Completion) -> None:
    trials = completed.trials
    missing = {(row["speed"], row["turn_rate_deg"]) for row in trials.rows() if not row["held_before"]}
    assert missing == {(hole.speed, hole.turn_rate_deg) for hole in holes(completed.before)}
    assert len(trials) == 6


def test_turns_that_four_straight_clips_lack_are_filled(completed: Completion) -> None:
    before, after = completed.trials["held_before"], completed.trials["held_after"]
    assert before.sum() <= 2
    assert after.sum() >= 5


def test_made_clips_have_the_speed_and_the_turn_rate_that_they_were_made_for(completed: Completion) -> None:
    from gmr.matching import Database

    for name, ask in completed.asked.items():
        made = Database.build({name: completed.added[name]}, unit=completed.added[name].unit)
        turning = slice(int(3 * made.rate), int(-0.75 * made.rate))
        speed = np.hypot(*(made.displacements[turning] * made.rate).T).mean()
        turn = np.degrees(made.turns[turning] * made.rate).mean()
        assert speed == pytest.approx(ask.speed, rel=0.04), name
        assert turn == pytest.approx(ask.turn_rate_deg, abs=3), name


def test_made_clips_stand_on_the_skeleton_of_the_dataset(
    clips: dict[str, gmr.Motion], completed: Completion
) -> None:
    first = next(iter(clips.values())).skeleton
    assert all(made.skeleton is first for made in completed.added.values())
    assert all(made.unit is not None for made in completed.added.values())


def test_the_same_seed_makes_the_same_clip_and_another_seed_another(clips: dict[str, gmr.Motion]) -> None:
    like = clips["07_01.bvh"]
    ask = Ask(1.5, 50.0)
    one, same, other = (synthesised(seconds=3, seed=seed)(ask, like) for seed in (0, 0, 1))
    assert one is not None
    assert same is not None
    assert other is not None
    assert np.array_equal(one.rotations, same.rotations)
    assert not np.array_equal(one.rotations, other.rotations)


def test_what_no_action_reaches_is_told(clips: dict[str, gmr.Motion]) -> None:
    found = complete(clips, synthesised(seconds=3), speeds=(12.0,), turn_rates_deg=(0.0,))
    assert found.not_made == (Ask(12.0, 0.0),)
    assert found.after is found.before
    assert any("no action reaches so far" in sentence for sentence in sentences(found))


def test_clips_whose_names_would_be_alike_are_all_kept(clips: dict[str, gmr.Motion]) -> None:
    walk = synthesised(seconds=3)
    found = complete(clips, walk, speeds=(1.0,), turn_rates_deg=(80.1, 80.2))
    made = [ask for ask in found.asked.values() if ask.turn_rate_deg]
    assert sorted(made) == [Ask(1.0, 80.1), Ask(1.0, 80.2)]


def test_a_dataset_without_holes_is_left_alone(completed: Completion) -> None:
    def never(ask: Ask, like: gmr.Motion) -> gmr.Motion:
        raise AssertionError("nothing is missing")

    walks = {"walk": completed.added["made_1.5mps_straight.bvh"]}
    found = complete(walks, never, dataset="walks", speeds=(1.5,), turn_rates_deg=(0.0,))
    assert not found.added
    assert headline(found) == "Nothing is missing: walks does the one trial that it is asked for."


def test_what_got_worse_is_told(completed: Completion) -> None:
    trials = dict(completed.trials)
    trials["held_before"], trials["held_after"] = np.ones(6, bool), np.arange(6) != 2
    worse = replace(completed)
    worse.__dict__["trials"] = Table(trials)
    told = " ".join(sentences(worse))
    assert "It got worse, too: 1.5 m/s turning left by 50 degrees/s held before and does not now" in told
    assert "1 trial is lost" in headline(worse) or "Nothing is missing" in headline(worse)


def test_a_completion_is_a_folder_with_a_page_tables_and_clips(completed: Completion, tmp_path: Path) -> None:
    page = write_completion(completed, tmp_path / "out")
    text = page.read_text(encoding="utf-8")
    assert headline(completed) in text
    assert "made_3mps_left050.bvh" in text
    again = gmr.read(tmp_path / "out" / "clips" / "made_3mps_left050.bvh")
    made = completed.added["made_3mps_left050.bvh"]
    assert np.allclose(again.positions(), made.positions(), atol=1e-3)
    for name in ("before.html", "after.html", "trials.csv", "clips.csv"):
        assert (tmp_path / "out" / name).stat().st_size > 100


def test_the_command_does_it_all(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from gmr.cli.commands import gmr as command
    from gmr.cli.common import finished

    takes = tmp_path / "takes"
    takes.mkdir()
    for name in ("07_01.bvh", "09_01.bvh"):
        (takes / name).write_bytes((DEMO / name).read_bytes())
    (takes / "broken.bvh").write_text("HIERARCHY\nnonsense")
    out = tmp_path / "completed"
    code = finished(
        command,
        ["complete", str(takes), "-o", str(out), "--speeds", "1.5", "--turn-rates", "0,60", "--json", "-q",
         "--seconds", "4"],
    )  # fmt: skip
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert set(found["failed"]) == {"broken.bvh"}
    assert code == 1, "a file was left out"
    assert "broken.bvh" in said.err
    assert found["page"] == str(out / "index.html")
    assert {clip["clip"] for clip in found["clips"]} >= {"made_1.5mps_left060.bvh"}
