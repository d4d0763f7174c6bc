"""Weights of the features are tuned on one half of the grid and proved on the other."""

from __future__ import annotations

import math
import pickle
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gmr
from gmr.evaluation import Evaluation, tune
from gmr.evaluation.intervals import Interval
from gmr.evaluation.tuning import Tuning
from gmr.evaluation.tuning.descent import FARTHEST, descend
from gmr.evaluation.tuning.section import tuning_section
from gmr.evaluation.tuning.weights import _checkerboard, _tied
from gmr.evaluation.tuning.words import headline, sentences
from gmr.matching import Database
from gmr.matching.schema import LOCOMOTION, Schema
from gmr.table import Table
from locomotion import Arc
from walker import write_walkers

GRID = {"speeds": (1.0, 1.5, 2.0), "turn_rates_deg": (-50.0, 0.0, 50.0)}

WALKS = {
    "slow.bvh": Arc(4.0, 1.0),
    "fast.bvh": Arc(4.0, 2.0),
    "left.bvh": Arc(4.0, 1.0, 50.0),
    "right.bvh": Arc(4.0, 2.0, -50.0),
}


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory: pytest.TempPathFactory) -> Evaluation:
    top = tmp_path_factory.mktemp("takes")
    write_walkers(top, WALKS)
    return gmr.evaluate(top, scenarios="constant", **GRID)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def tuned(evaluated: Evaluation) -> Tuning:
    return tune(evaluated, most=12)


@settings(max_examples=25)
@given(st.lists(st.floats(-2.5, 2.5), min_size=2, max_size=4))
def test_descent_finds_the_bottom_of_a_bowl(bottom: list[float]) -> None:
    def bowl(factors: tuple[float, ...]) -> float:
        assert all(1 / FARTHEST - 1e-6 <= factor <= FARTHEST + 1e-6 for factor in factors)
        return sum((math.log2(factor) - at) ** 2 for factor, at in zip(factors, bottom, strict=True))

    found = descend(bowl, len(bottom), range(len(bottom)), most=500)
    np.testing.assert_allclose(np.log2(found.factors), bottom, atol=0.2)
    assert found.value == min(step.value for step in found.steps) == bowl(found.factors)
    assert found == descend(bowl, len(bottom), range(len(bottom)), most=500)


@given(st.integers(2, 40))
def test_descent_keeps_to_its_runs_and_to_what_may_move(most: int) -> None:
    found = descend(lambda factors: -factors[0] - factors[2], 3, [0, 1], most)
    assert len(found.steps) <= most
    assert {step.factors[2] for step in found.steps} == {1.0}
    assert len({step.factors for step in found.steps}) == len(found.steps)


def test_left_and_right_share_a_weight_which_leaves_five() -> None:
    assert _tied(LOCOMOTION) == {
        "foot position": [0, 1],
        "foot velocity": [2, 3],
        "hips velocity": [4],
        "trajectory position": [5],
        "trajectory facing": [6],
    }


def test_the_halves_are_a_checkerboard_and_mirror_images_are_in_one_half() -> None:
    speed, turn = (grid.ravel() for grid in np.meshgrid([1.0, 2.0, 3.0], np.arange(-100, 101, 25.0)))
    training = _checkerboard(speed, turn)
    assert abs(int(training.sum()) - int((~training).sum())) <= 3
    half = dict(zip(zip(speed.tolist(), turn.tolist(), strict=True), training.tolist(), strict=True))
    for (v, w), is_training in half.items():
        assert half[v, -w] == is_training
        for neighbour in ((v + 1, w), (v, abs(w) + 25)):
            assert half.get(neighbour, not is_training) != is_training


def test_the_search_never_sees_what_is_held_out(
    evaluated: Evaluation, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = sys.modules["gmr.evaluation.tuning.weights"]
    seen: list[set[tuple[float, float]]] = []
    run = module.run_trials

    def watched(database: Database, profiles: object, **settings: object) -> object:
        chosen = list(profiles)  # type: ignore[call-overload]
        seen.append(
            {(p.segments[-1].speed, round(math.degrees(p.segments[-1].turn_rate), 6)) for p in chosen}
        )
        return run(database, chosen, **settings)

    monkeypatch.setattr(module, "run_trials", watched)
    found = tune(evaluated, most=5)
    rows = list(found.trials.rows())
    held_out = {(row["speed"], row["turn_rate_deg"]) for row in rows if row["set"] == "held out"}
    assert len(held_out) == 5
    searched, proofs = seen[: len(found.search)], seen[len(found.search) :]
    assert all(not cells & held_out for cells in searched)
    assert sum(cells == held_out for cells in proofs) == 2
    assert len(proofs) == 4


def test_as_it_was_is_what_was_evaluated_and_the_best_step_is_what_was_found(
    evaluated: Evaluation, tuned: Tuning
) -> None:
    trials = {(row["speed"], row["turn_rate_deg"]): row for row in evaluated.measured.trials.rows()}
    for row in tuned.trials.rows():
        own = trials[row["speed"], row["turn_rate_deg"]]
        assert row["offset_mean"] == own["offset_mean"]
        jumped = own["transitions_per_second"] * np.nan_to_num(own["pose_discontinuity_mean"])
        assert row["discontinuity_per_second"] == pytest.approx(jumped, rel=1e-6, abs=1e-9)
        assert row["objective"] == row["offset_mean"] + row["discontinuity_per_second"]
    assert tuned.search["objective"][0] == pytest.approx(tuned.mean("training", "objective"))
    assert tuned.search["objective"].min() == pytest.approx(tuned.mean("training", "objective_tuned"))
    held_out = tuned.mean("held out", "objective") - tuned.mean("held out", "objective_tuned")
    assert tuned.gain.mean == pytest.approx(held_out)
    assert len(tuned.search) <= 12


def test_weights_are_worth_what_a_database_built_with_them_is(evaluated: Evaluation, tuned: Tuning) -> None:
    found = replace(tuned, gain=Interval(1.0, 0.5, 1.5)).chosen
    assert evaluated.simulation is not None
    database = evaluated.simulation.database
    assert {group.name: group.weight for group in found.groups} == dict(tuned.weights)
    multiplied = np.concatenate(
        [
            np.full(new.width, new.weight / old.weight)
            for new, old in zip(found.groups, LOCOMOTION.groups, strict=True)
        ]
    )
    queries, rows = database.features[[5, 50, 300]] + np.float32(0.1), slice(None)
    scaled = ((queries[:, None] - database.features[None, rows]) * multiplied) ** 2
    cost = np.where(database.candidates, scaled.sum(axis=2), np.inf)
    costs, _ = database.search(queries, weights=(multiplied**2).astype(np.float32))
    np.testing.assert_allclose(costs[:, 0], cost.min(axis=1), rtol=1e-4)


def test_weights_that_hardly_look_at_the_path_are_put_right_also_on_what_was_held_out(tmp_path: Path) -> None:
    write_walkers(
        tmp_path, {f"{v:g}_{w:g}.bvh": Arc(4.0, v, w) for v in (1.0, 1.5, 2.0) for w in (0.0, 25.0, 50.0)}
    )
    grid = {"speeds": np.arange(1.0, 2.01, 0.25), "turn_rates_deg": np.arange(-50.0, 51.0, 25.0)}
    evaluated = gmr.evaluate(tmp_path, scenarios="constant", mirror=True, **grid)  # type: ignore[arg-type]
    assert evaluated.simulation is not None
    poor = Schema(
        tuple(
            replace(group, weight=group.weight * (0.15 if "trajectory" in group.name else 1))
            for group in LOCOMOTION.groups
        )
    )
    database = Database.build(gmr.read_folder(tmp_path), mirror=True, schema=poor)
    found = tune(replace(evaluated, simulation=replace(evaluated.simulation, database=database)), most=30)
    assert found.improves
    assert found.mean("held out", "objective_tuned") < found.mean("held out", "objective")
    assert found.chosen != poor


def test_threads_do_not_change_a_bit(evaluated: Evaluation, tuned: Tuning) -> None:
    for threads in (1, 2):
        again = tune(evaluated, most=12, threads=threads)
        assert again.trials == tuned.trials
        assert again.search == tuned.search
        assert again.weights == tuned.weights


def test_what_is_no_better_on_the_held_out_half_is_not_chosen(tuned: Tuning) -> None:
    worse = replace(tuned, gain=Interval(0.1, -0.01, 0.2))
    assert not worse.improves
    assert worse.chosen is worse.schema
    assert headline(worse).startswith("The weights of the features stay as they are")
    assert "not to be trusted" in list(sentences(worse))[-1]
    better = replace(tuned, gain=Interval(0.1, 0.01, 0.2))
    assert better.improves
    assert headline(better).startswith("Weigh the features anew")
    assert "falls by 0.1 m (95% confidence interval 0.01 to 0.2)" in list(sentences(better))[2]
    least = 0.02 * tuned.mean("held out", "objective")
    assert tuned.worthwhile == pytest.approx(least)
    tiny = replace(tuned, gain=Interval(0.9 * least, 0.1 * least, 1.5 * least))
    assert tiny.beyond_chance
    assert not tiny.improves
    assert tiny.chosen is tiny.schema
    assert "no worthwhile gain" in headline(tiny)
    assert "not worth it" in list(sentences(tiny))[-1]
    assert replace(tuned, gain=Interval(1.1 * least, 0.1 * least, 1.5 * least)).improves
    same = replace(tuned, gain=Interval(-1e-17, -1e-16, 0.0))
    assert list(sentences(same))[2].endswith(": nothing changes.")


def test_weights_with_which_fewer_of_the_held_out_trials_hold_are_not_recommended(tuned: Tuning) -> None:
    held_out = tuned.trials["set"] == "held out"
    first, second = np.flatnonzero(held_out)[:2]

    def holding(before: list[int], after: list[int]) -> Tuning:
        held = {"held": np.isin(np.arange(9), before), "held_tuned": np.isin(np.arange(9), after)}
        return replace(tuned, gain=Interval(10.0, 9.0, 11.0), trials=Table({**dict(tuned.trials), **held}))

    lost = holding([first], [])
    assert lost.beyond_chance
    assert lost.loses_trials
    assert not lost.improves
    assert lost.chosen is lost.schema
    assert headline(lost) == (
        "The weights of the features stay as they are: others lower offset and jumping by 10 m on trials "
        f"that were not tuned on, but of the {held_out.sum()} none does what it is asked, where 1 did."
    )
    assert "What the search found, and what loses trials" in list(sentences(lost))[-1]
    fewer = holding([first, second], [second])
    assert not fewer.improves
    assert headline(fewer).endswith(f"of the {held_out.sum()} only 1 does what it is asked, where 2 did.")
    # As many hold as before, others among them; and what the search saw does not count.
    assert holding([first], [second]).improves
    assert holding([int(np.flatnonzero(~held_out)[0])], []).improves


def test_words_tell_the_trials_that_hold_the_options_and_what_lies_at_the_bound(
    evaluated: Evaluation, tuned: Tuning
) -> None:
    own = {(row["speed"], row["turn_rate_deg"]): row for row in evaluated.measured.trials.rows()}
    for row in tuned.trials.rows():
        was = own[row["speed"], row["turn_rate_deg"]]
        near = abs(was["speed_error_share"]) <= 0.15 and abs(was["turn_rate_error_deg"]) <= 10
        assert row["held"] == (near and was["offset_mean"] <= 0.5)
    training = tuned.trials["set"] == "training"
    trials = {**dict(tuned.trials), "held": np.arange(9) == 0, "held_tuned": training}
    last = {"best": np.arange(2) == 1, "objective": np.array([1.0, 0.5])}
    factors = {"foot position": 1 / 16, "foot velocity": 2**-0.5, "trajectory facing": 16.0}
    names = [name for name in tuned.search.column_names if name not in last]
    weights = {
        group.name: group.weight * factors.get(group.name.replace("left ", "").replace("right ", ""), 1.0)
        for group in LOCOMOTION.groups
    }
    usual = {name: LOCOMOTION.groups[places[0]].weight for name, places in _tied(LOCOMOTION).items()}
    search = {**last, **{name: usual[name] * np.array([1.0, factors.get(name, 1.0)]) for name in names}}
    found = replace(
        tuned,
        gain=Interval(100.0, 99.0, 101.0),
        trials=Table(trials),
        search=Table(search),
        weights=weights,
    )
    told = list(sentences(found))
    assert told[3] == (
        f"Of the {training.sum()} trials tuned on {training.sum()} hold where 1 did; of the "
        f"{9 - training.sum()} trials held out none holds, as before."
    )
    assert told[4:6] == [
        "The weight of foot position lies at the bound of the search, a 16th of what it was: a smaller one "
        "may do better.",
        "The weight of trajectory facing lies at the bound of the search, 16 times what it was: a larger one "
        "may do better.",
    ]
    assert told[6:] == [
        'To evaluate with these weights: --weight "foot position=0.046875" --weight "foot velocity=0.707107" '
        '--weight "trajectory facing=24"'
    ]
    *groups, facing = found.schema.groups
    other = replace(found, schema=Schema((*groups, replace(facing, times=(0.5,)))))
    assert not any("--weight" in sentence for sentence in sentences(other))


def test_the_section_names_its_figure_and_tables(tuned: Tuning) -> None:
    section = tuning_section(tuned)
    assert headline(tuned) in section.html
    (figure,) = section.figures
    assert f'data-figure="{figure.name}"' in section.html or f"data-figure='{figure.name}'" in section.html
    assert len(figure.data["cells"]) == 9
    assert set(section.tables) == {"tuning", "tuning_search"}


def test_what_cannot_be_tuned_is_refused(evaluated: Evaluation, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="lost its simulation"):
        tune(pickle.loads(pickle.dumps(evaluated)))
    with pytest.raises(ValueError, match="0 or more"):
        tune(evaluated, smoothness=-1.0)
    write_walkers(tmp_path, {"a.bvh": Arc(3.0, 1.0)})
    with pytest.raises(ValueError, match="1 constant trial cannot be split"):
        tune(tmp_path, speeds=(1.0,), turn_rates_deg=(0.0,))
