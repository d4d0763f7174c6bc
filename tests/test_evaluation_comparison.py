"""Several datasets beside each other: names, tables, words, the same axes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
from fake_evaluation import fake_evaluation
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.evaluation import Comparison, Evaluation, Table, comparison_of
from gmr.evaluation.compare import dataset_names
from gmr.evaluation.comparison_words import grids_of
from gmr.evaluation.figures import figures
from gmr.evaluation.figures.compared_trials import compared_trials
from gmr.evaluation.figures.comparison import comparison_figures
from gmr.evaluation.figures.same_axes import on_same_axes
from gmr.pages.figure import Figure
from locomotion import Arc
from walker import write_walkers

GRID = ("--speeds", "1,2", "--turn-rates", "-50:50:50", "--quiet")


def called(evaluation: Evaluation, name: str) -> Evaluation:
    trials = evaluation.measured.trials
    renamed = Table({**dict(trials), "dataset": np.full(len(trials), name, object)})
    return replace(evaluation, dataset=name, measured=replace(evaluation.measured, trials=renamed))


def doing(evaluation: Evaluation, name: str, done: NDArray[np.bool_]) -> Evaluation:
    """An evaluation in which exactly the trials ``done`` go as asked."""
    trials = evaluation.measured.trials
    wrong = np.where(done, 0.0, 3.0)
    changed = {
        "offset_mean": np.where(done, 0.1, 3.0),
        "speed_error": -wrong,
        "turn_rate_error_deg": np.zeros(len(trials)),
        **({"speed_error_share": -wrong} if "speed_error_share" in trials else {}),
    }
    measured = replace(evaluation.measured, trials=Table({**dict(trials), **changed}))
    return called(replace(evaluation, measured=measured), name)


@pytest.fixture(scope="module")
def made() -> Evaluation:
    return fake_evaluation(12, 40, replay_seconds=1)


@pytest.fixture(scope="module")
def compared(made: Evaluation) -> Comparison:
    other = fake_evaluation(9, 50, seed=3, replay_seconds=1)
    return comparison_of([called(made, "one"), called(other, "two")])


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    write_walkers(tmp_path / "a" / "takes", {"walk.bvh": Arc(4.0, 1.0), "left.bvh": Arc(4.0, 1.0, 50.0)})
    write_walkers(tmp_path / "b" / "takes", {"run.bvh": Arc(4.0, 2.0)})
    return tmp_path / "a" / "takes", tmp_path / "b" / "takes"


@given(st.lists(st.sampled_from(["/a/x", "/b/x", "/c/y", "/a/x"]), max_size=6))
def test_no_two_datasets_have_the_same_name(places: list[str]) -> None:
    names = dataset_names(places)
    assert len(set(names)) == len(places)
    assert dataset_names(["/a/x", "/b/y"]) == ["x", "y"]
    assert dataset_names(["/a/x", "/b/x"]) == ["a/x", "b/x"]


def test_one_dataset_or_other_trials_or_equal_names_cannot_be_compared(made: Evaluation) -> None:
    with pytest.raises(gmr.DatasetError, match="give two or more"):
        comparison_of([made])
    with pytest.raises(gmr.DatasetError, match="two datasets are called fake"):
        comparison_of([made, made])
    fewer = made.measured.trials.take(np.arange(10))
    other = replace(called(made, "other"), measured=replace(made.measured, trials=fewer))
    with pytest.raises(gmr.DatasetError, match="other was sent through other trials than fake"):
        comparison_of([made, other])


def test_the_words_name_what_all_and_what_only_one_can_do(made: Evaluation) -> None:
    trials = made.measured.trials
    straight, slow = trials["turn_rate_deg"] == 0, trials["speed"] == 1
    found = comparison_of([doing(made, "A", straight), doing(made, "B", straight | slow)]).verdict
    assert found.headline == "B does 17 of 81 trials as asked and A 9; 17 are done by at least one of them."
    said = " ".join(found.sentences)
    assert "What both can do: 9 trials, going straight at 1 to 3 m/s." in said
    assert "Only B does 8 trials: 4 of them turning right by 25 to 100 degrees/s at 1 m/s" in said
    assert "All that the other can, B can too." in said
    assert "A does nothing that the other cannot." in said
    assert "Neither does 64 trials" in said
    assert (
        "In the trials that both do, A and B keep equally close to their path: 10 cm off on average." in said
    )


@settings(max_examples=15)
@given(st.integers(2, 4), st.integers(0, 2**32 - 1))
def test_shared_alone_and_missing_trials_are_counted(made: Evaluation, datasets: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    done = random.random((datasets, 81)) < random.random()
    found = comparison_of([doing(made, f"D{k}", which) for k, which in enumerate(done)])
    held = np.stack([grid.held.ravel() for grid in grids_of(found.evaluations)])
    np.testing.assert_array_equal(held, done)
    said = " ".join(found.verdict.sentences)
    if n := int(done.all(axis=0).sum()):
        assert f"can do: {n} trial" in said
    for k in range(datasets):
        only = int((done[k] & (done.sum(axis=0) == 1)).sum())
        assert (f"Only D{k} does {only} trial" in said) == (only > 0)
    drawn = compared_trials(found.evaluations).data["trials"]
    np.testing.assert_array_equal(drawn["number"], done.sum(axis=0))


def test_tables_of_all_datasets_stand_under_each_other(compared: Comparison) -> None:
    tables = compared.tables()
    for name, table in tables.items():
        parts = [evaluation.tables()[name] for evaluation in compared.evaluations]
        assert len(table) == sum(map(len, parts))
        assert table.column_names == parts[0].column_names
    assert list(dict.fromkeys(tables["trials"]["dataset"].tolist())) == ["one", "two"]


def bars(values: list[float]) -> Figure:
    return Figure(
        name="bars",
        title="",
        sentence="",
        chart={
            "height": 10,
            "data": {"name": "bars"},
            "mark": {"type": "bar"},
            "encoding": {
                "x": {"field": "value", "type": "quantitative"},
                "y": {"field": "name", "type": "nominal"},
                "color": {"field": "kind", "type": "nominal"},
            },
        },
        data={
            "bars": Table({"value": values, "name": ["a"] * len(values), "kind": list(range(len(values)))})
        },
    )


@given(st.lists(st.lists(st.floats(0, 100), min_size=1, max_size=4), min_size=1, max_size=4))
def test_stacked_bars_of_all_datasets_reach_as_far_as_the_longest(stacks: list[list[float]]) -> None:
    drawn = on_same_axes([bars(values) for values in stacks])
    domains = [figure.chart["encoding"]["x"].get("scale", {}).get("domain") for figure in drawn]
    longest = max(map(sum, stacks))
    for domain in domains:
        assert domain == (pytest.approx([0.0, longest]) if longest > 0 else None)


def test_every_figure_of_each_dataset_has_its_fellow(compared: Comparison) -> None:
    drawn = comparison_figures(compared.evaluations)
    names = [figure.name for figure in drawn.every()]
    assert len(set(names)) == len(names)
    for row in drawn.rows.values():
        assert [place for place, _ in row] == [0, 1]
    for figure in drawn.every():
        assert figure.sentence.endswith(".")
        json.dumps(figure.description())
    density = [figure.chart["layer"][0]["encoding"] for _, figure in drawn.rows["coverage_density"]]
    for axis in ("x", "y"):
        assert density[0][axis]["scale"]["domain"] == density[1][axis]["scale"]["domain"]


def test_several_folders_make_one_report_and_tables(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = [*map(str, folders), *GRID, "-o", out / "both.html", "--tables", out / "tables"]
    assert finished(command, ["evaluate", *map(str, arguments)]) == 0
    said = capsys.readouterr().out
    assert "b/takes" in said.splitlines()[0]
    assert "a/takes: This dataset does what it is asked in" in " ".join(said.split())
    page = (out / "both.html").read_text(encoding="utf-8")
    assert "a/takes and b/takes" in page
    trials = (out / "tables" / "trials.csv").read_text(encoding="utf-8").splitlines()
    assert {line.partition(",")[0] for line in trials[1:]} == {"a/takes", "b/takes"}


def test_json_of_several_folders_lists_the_datasets_and_a_broken_file_makes_the_exit_code_1(
    folders: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    (folders[1] / "broken.bvh").write_text("nonsense")
    assert finished(command, ["evaluate", *map(str, folders), *GRID, "--no-report", "--json"]) == 1
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert [one["dataset"] for one in found["datasets"]] == ["a/takes", "b/takes"]
    assert list(found["failed"]) == ["b/takes: broken.bvh"]
    assert found["verdict"]["headline"]
    assert said.err.count("\n") == 1
    assert "broken.bvh" in said.err


def test_a_folder_without_motions_is_named_among_several(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty").mkdir()
    both = [str(folders[0]), str(tmp_path / "empty")]
    assert finished(command, ["evaluate", *both, *GRID, "-o", str(tmp_path / "r.html")]) == 1
    said = capsys.readouterr().err
    assert "gmr: empty: " in said
    assert "holds no motion files" in said
    assert not (tmp_path / "r.html").exists()


def test_figures_are_written_for_each_dataset_and_for_all(
    compared: Comparison, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("vl_convert")
    few = {"trial_map_holds", "clip_usage"}
    monkeypatch.setattr(
        "gmr.evaluation.figures.comparison.figures",
        lambda evaluation: [figure for figure in figures(evaluation) if figure.name in few],
    )
    written = compared.write_figures(tmp_path / "figures")
    names = {path.relative_to(tmp_path / "figures").as_posix() for path in written}
    assert names == {"compared_trials.svg", "compared_coverage.svg"} | {
        f"{each}/{name}.svg" for each in ("one", "two") for name in few
    }
    assert all(path.read_text(encoding="utf-8").startswith("<svg") for path in written)
