"""``gmr evaluate --prune`` as people and scripts use it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import gmr
from gmr.cli import evaluate
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.pruning.manifest import cost_of_files
from gmr.pruning.outcomes import Score
from gmr.pruning.part import Part
from gmr.pruning.writing import Written
from locomotion import Arc
from walker import write_walkers

SMALL = ("--speeds", "1,2", "--turn-rates", "0,50", "--scenario", "constant")
TAKES = {
    "a.bvh": Arc(6.0, 1.0),
    "b.bvh": Arc(6.0, 2.0, 50.0),
    "twin.bvh": Arc(6.0, 1.0),
}

Captured = pytest.CaptureFixture[str]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_walkers(tmp_path / "takes", TAKES)
    return tmp_path / "takes"


def run(*arguments: object) -> int:
    """The exit code of ``gmr evaluate ARGUMENTS``, in this process."""
    return finished(command, ["evaluate", *map(str, arguments)])


def test_the_smaller_dataset_is_written_and_the_report_shows_why(
    folder: Path, tmp_path: Path, capsys: Captured
) -> None:
    pytest.importorskip("vl_convert")
    out, report, figures = tmp_path / "new" / "smaller", tmp_path / "report.html", tmp_path / "figures"
    written = ("--prune-out", out, "-o", report, "--figures", figures)
    assert run(folder, *SMALL, "--prune", "30%", *written) == 0
    assert {"coverage_scatter", "pruning_offset"} <= {path.stem for path in figures.iterdir()}
    said = capsys.readouterr()
    told = "of the seconds can go, and every trial stays the same, bit by bit."
    assert told in " ".join(said.out.split())
    assert f"Smaller dataset: {out}" in said.out
    assert all(len(line) <= 100 for line in said.out.splitlines() if str(tmp_path) not in line)
    for phase in ("leaving out each clip: 2,", "removing frames: ", "checking what was written,"):
        assert phase in said.err
    left = json.loads((out / "manifest.json").read_text())
    assert left["seconds_after"] <= 0.7 * left["seconds_before"]
    assert sorted(gmr.read_folder(out)) == [file["file"] for file in left["files"]]
    page = report.read_text()
    own = left["runs"]["files_by_themselves"]
    table = page[page.index('aria-label="What the smaller dataset does"') :]
    table = table[: table.index("</table>")]
    assert re.findall(r"<td[^>]*>([^<]*)</td>", table)[-4:] == [
        "The new folder's files by themselves".replace("'", "&#x27;"),
        f"{own['offset_mean']:.3f}",
        str(own["held"]),
        str(own["runs"]),
    ]
    assert "An evaluation of the new folder scales the features by what is left" in page
    for name in ('id="pruning"', 'href="#pruning"', 'data-figure="pruning_offset"', "importance"):
        assert name in page


def test_a_pruning_that_cannot_be_costs_neither_report_nor_tables(
    folder: Path, tmp_path: Path, capsys: Captured
) -> None:
    report, tables, out = tmp_path / "report.html", tmp_path / "tables", tmp_path / "smaller"
    written = ("-o", report, "--tables", tables, "--prune-out", out)
    assert run(folder, *SMALL, *written, "--prune", "99%", "--quiet") == 1
    said = capsys.readouterr()
    assert f"Report: {report}" in said.out
    assert 'id="pruning"' not in report.read_text()
    assert (tables / "trials.csv").exists()
    assert not out.exists()
    assert said.err.startswith("gmr: --prune came to nothing, all else is done: 99% of the seconds cannot go")
    assert said.err.count("\n") == 1


def test_what_could_not_be_done_is_told_to_machines_too(
    folder: Path, tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    grid = ("--speeds", "1", "--turn-rates", "0", "--scenario", "constant", "--no-report", "--json", "-q")
    assert run(folder, *grid, "--prune", "lossless", "--tune") == 1
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert list(told["not_done"]) == ["--tune"]
    assert told["not_done"]["--tune"].startswith("1 constant trial cannot be split")
    assert "tuned" not in told
    assert told["pruned"]["identical"] is True
    assert "--tune came to nothing" in said.err


@pytest.mark.parametrize(
    "options",
    [
        ("evaluate", "--prune", "30%"),
        ("evaluate", "--prune", "30%", "--prune-out", "a/smaller"),
        ("evaluate", "--complete-from", "../archive"),
        ("complete",),
        ("complete", "-o", "."),
        ("complete", "--from", "../archive", "-o", "../takes"),
    ],
)
def test_clips_are_not_written_into_the_dataset_that_they_come_from(
    folder: Path, options: tuple[str, ...], capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_walkers(folder.parent / "archive", TAKES)
    before = sorted(folder.rglob("*"))
    monkeypatch.chdir(folder)
    assert finished(command, [options[0], ".", *options[1:], "--quiet"]) == 2
    assert "lies in ., and would be read as a part of it the next time; give --" in capsys.readouterr().err
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize(
    ("places", "named"),
    [
        (("--prune-out", "one", "--complete-out", "one"), "--complete-out and --prune-out are both one"),
        (("--prune-out", "one", "--complete-out", "two/../one"), "--complete-out and --prune-out are both"),
        (
            ("--prune-out", "one/two", "--complete-out", "one"),
            "--complete-out and --prune-out are one and one/two",
        ),
        (
            ("--complete-out", "pruned/more"),
            "--complete-out and --prune-out are pruned/more and pruned, one in",
        ),
        (("--tables", "completed"), "--complete-out and --tables are both completed"),
        (
            ("--tables", "completed/clips"),
            "--tables is completed/clips, where --complete-out writes the clips",
        ),
        (("--figures", "completed"), "--complete-out and --figures are both completed"),
        (("--figures", "completed/clips/x"), "--figures is completed/clips/x, where --complete-out writes"),
        (("-o", "completed/clips/r.html"), "--out is completed/clips/r.html, where --complete-out writes"),
        (("--tables", "pruned"), "--tables is pruned, where --prune-out writes a dataset"),
        (("--tables", "two/../pruned/tables"), "--tables is two/../pruned/tables, where --prune-out writes"),
        (("--figures", "pruned"), "--figures is pruned, where --prune-out writes a dataset"),
        (("-o", "pruned/report.html"), "--out is pruned/report.html, where --prune-out writes a dataset"),
        (("-o", "completed/after.html"), "--out is completed/after.html, where --complete-out writes"),
    ],
)
def test_no_result_is_written_over_another(
    places: tuple[str, ...], named: str, folder: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = folder.parent / "elsewhere"
    elsewhere.mkdir()
    write_walkers(folder.parent / "archive", TAKES)
    monkeypatch.chdir(elsewhere)
    asked = ("--prune", "lossless", "--complete-from", "../archive", *places)
    assert run(folder, *SMALL, *asked) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert named in said
    assert "give" in said
    assert not list(elsewhere.iterdir())


def test_nothing_else_is_written_into_the_folder_of_the_smaller_dataset(
    folder: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = folder.parent / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    places = ("--tables", "less", "--figures", "less", "-o", "less/report.html")
    assert run(folder, *SMALL, "--prune", "30%", "--prune-out", "less", *places) == 2
    assert "--prune-out writes a dataset" in " ".join(capsys.readouterr().err.split())
    assert not list(elsewhere.iterdir())


def test_an_interrupt_after_the_trials_costs_neither_report_nor_what_was_done(
    folder: Path, tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(evaluate, "tune_evaluation", interrupted)
    report, archive = tmp_path / "report.html", tmp_path / "archive"
    write_walkers(archive, TAKES)
    asked = ("--prune", "lossless", "--prune-out", tmp_path / "smaller", "--tune", "--complete-from", archive)
    assert run(folder, *SMALL, *asked, "-o", report, "--quiet") == 130
    said = capsys.readouterr()
    assert f"Report: {report}" in said.out
    assert 'id="pruning"' in report.read_text()
    assert (tmp_path / "smaller" / "manifest.json").exists()
    assert said.err.splitlines() == [
        "gmr: --tune came to nothing, all else is done: it was interrupted",
        "gmr: --complete-from came to nothing, all else is done: what came before it was interrupted",
    ]


def test_json_has_the_curve_and_the_importance(
    folder: Path, tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(folder, *SMALL, "--prune", "lossless", "--no-report", "--json", "--quiet") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["duplicates"] == {"twin.bvh": "a.bvh"}
    found = told["pruned"]
    assert found["identical"] is True
    assert found["runs"] == {
        name: score
        for name, score in json.loads((tmp_path / "pruned" / "manifest.json").read_text())["runs"].items()
        if name != "simulated"
    }
    assert found["folder"] == "pruned"
    assert found["curve"][0]["share_kept"] == 1.0
    assert found["sentences"][1].startswith("'twin.bvh' holds the same motion as 'a.bvh' and went first.")
    assert {row["clip"] for row in found["importance"]} == {"a.bvh", "b.bvh"}
    assert (tmp_path / "pruned" / "a.bvh").exists()
    assert not (tmp_path / "pruned" / "twin.bvh").exists()


def test_a_share_that_is_none_is_wrong_usage(folder: Path, capsys: Captured) -> None:
    assert run(folder, *SMALL, "--prune", "30") == 2
    assert "'30' is no share of a dataset that can go" in capsys.readouterr().err


def test_a_folder_that_is_not_empty_is_found_before_the_work(folder: Path, capsys: Captured) -> None:
    assert run(folder, *SMALL, "--prune", "30%", "--prune-out", folder) == 1
    said = capsys.readouterr()
    assert said.err == f"gmr: {folder} is there and not empty; give a new folder for the smaller dataset\n"
    assert sorted(path.name for path in folder.iterdir()) == sorted(TAKES)


@pytest.mark.parametrize(
    ("held", "says"),
    [(3, "It costs 1 of 8 trials;"), (4, "It costs no trial;"), (6, "no trial, and 2 of 8 more hold;")],
)
def test_what_the_files_cost_is_told_by_both_scales(held: int, says: str) -> None:
    whole, kept, own = (Score(0.2, number, 8) for number in (4, held, 2))
    told = cost_of_files(Written(Path(), (), Part(60.0, {}), whole, kept, own, identical=False))
    assert says in told
    assert told.endswith("by what is left: there 2 of 8 trials hold, where 4 did.")
