"""``gmr evaluate`` as people and scripts use it."""

from __future__ import annotations

import json
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from gmr.cli.evaluate import evaluate
from locomotion import Arc
from walker import write_walkers

SMALL = ("--speeds", "1,2", "--turn-rates", "-50:50:50", "--no-report")
PROGRAM = (sys.executable, "-c", "from gmr.cli.evaluate import evaluate; evaluate()")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_walkers(tmp_path / "takes", {"walk.bvh": Arc(6.0, 1.0), "run.bvh": Arc(6.0, 2.0, 50.0)})
    return tmp_path / "takes"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(evaluate, [str(argument) for argument in arguments])


def test_the_verdict_goes_to_stdout_and_progress_to_stderr(folder: Path) -> None:
    result = run(folder, *SMALL)
    assert result.exit_code == 0
    assert result.stdout.startswith("This dataset holds ")
    for phase in ("reading: 2,", "preparing,", "simulating: 6,", "measuring,"):
        assert phase in result.stderr
    assert "reading" not in result.stdout
    assert all(len(line) <= 100 for line in result.stdout.splitlines())


def test_quiet_says_nothing_of_progress(folder: Path) -> None:
    result = run(folder, *SMALL, "--quiet")
    assert result.stderr == ""
    assert result.exit_code == 0


def test_json_is_one_object_with_the_figures(folder: Path) -> None:
    result = run(folder, *SMALL, "--json", "--mirror", "--preset", "mig2022")
    found = json.loads(result.stdout)
    assert found["dataset"] == "takes"
    assert (found["clips"], found["mirrored_clips"]) == (2, 2)
    assert found["settings"]["preset"] == "mig2022"
    assert found["settings"]["speeds"] == [1.0, 2.0]
    assert [row["turn_rate_deg"] for row in found["trials"]] == [-50.0, 0.0, 50.0] * 2
    assert found["verdict"]["headline"].startswith("This dataset holds ")
    assert found["failed"] == {}


def test_tables_are_written_where_asked(folder: Path, tmp_path: Path) -> None:
    result = run(folder, *SMALL, "--tables", tmp_path / "new" / "tables")
    assert result.exit_code == 0
    names = {path.name for path in (tmp_path / "new" / "tables").iterdir()}
    assert {"trials.csv", "coverage.csv", "usage.csv", "transitions.csv", "clips.csv"} <= names
    assert f"Tables: {tmp_path / 'new' / 'tables'}" in result.stdout


def test_a_broken_file_is_named_and_the_exit_code_is_1(folder: Path) -> None:
    (folder / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n")
    result = run(folder, *SMALL)
    assert result.exit_code == 1
    assert "left out: " in result.stderr
    assert "broken.bvh:4" in result.stderr
    assert "1 file could not be used and was left out: broken.bvh." in " ".join(result.stdout.split())


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("missing",), "missing"),
        (("takes", "--speeds", "fast"), "neither START:STOP:STEP nor numbers"),
        (("takes", "--speeds", "1:3:0"), "no list of numbers"),
        (("takes", "--speeds", "3:1:1"), "no list of numbers"),
        (("takes", "--speeds", "0,1"), "above 0 m/s"),
        (("takes", "--turn-rates", "nan"), "turn rate must be"),
        (("takes", "--name", "left_foot"), "ROLE=JOINT"),
        (("takes", "--preset", "mig2023"), "mig2022"),
        (("takes", "--threads", "0"), "threads"),
    ],
)
def test_wrong_usage_is_explained_with_exit_code_2(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], says: str
) -> None:
    (tmp_path / "takes").mkdir()
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert result.exit_code == 2
    assert says in result.stderr
    assert list(tmp_path.iterdir()) == [tmp_path / "takes"]


@pytest.mark.parametrize(
    ("clips", "says"),
    [({}, "holds no motion files"), ({"short.bvh": Arc(0.5, 1.0)}, "no clip lasts the 1.02 s")],
)
def test_a_dataset_that_cannot_be_evaluated_is_one_sentence(
    tmp_path: Path, clips: dict[str, Arc], says: str
) -> None:
    (tmp_path / "takes").mkdir()
    write_walkers(tmp_path / "takes", clips)
    result = run(tmp_path / "takes", "--quiet", "-o", tmp_path / "report.html")
    assert result.exit_code == 1
    assert result.stderr.startswith("Error: ")
    assert says in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not (tmp_path / "report.html").exists()


def test_joints_can_be_named(folder: Path) -> None:
    wrong = run(folder, *SMALL, "--name", "left_foot=Paw")
    assert wrong.exit_code == 1
    assert "Paw" in wrong.stderr
    right = run(folder, *SMALL, "--name", "left_foot=LeftFoot", "--json")
    assert json.loads(right.stdout)["joints"]["left_foot"] == "LeftFoot"


def test_ranges_have_both_ends(folder: Path) -> None:
    result = run(folder, "--speeds", "0.5:1.1:0.2", "--turn-rates=-30,30", "--no-report", "--json")
    settings = json.loads(result.stdout)["settings"]
    assert settings["speeds"] == [0.5, 0.7, 0.9, 1.1]
    assert settings["turn_rates_deg"] == [-30.0, 30.0]


def test_ctrl_c_is_one_sentence_and_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    long = ("--speeds", "0.5:4:0.05", "--turn-rates", "-100:100:5", "-o", out / "report.html")
    with subprocess.Popen(
        [*PROGRAM, folder, *long, "--tables", out / "tables"], stderr=subprocess.PIPE, text=True
    ) as running:
        assert running.stderr is not None
        for line in running.stderr:
            if line.startswith("preparing,"):
                break
        running.send_signal(signal.SIGINT)
        rest = running.stderr.read()
    assert running.returncode == 130
    assert rest.strip().splitlines()[-1].startswith("Interrupted while ")
    assert "Traceback" not in rest
    assert not out.exists()


def test_a_disk_that_fills_up_is_one_sentence_and_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    # A limit on the size of files stands for the full disk: both end a write half-way with an OSError.
    def small_files_only() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    done = subprocess.run(
        [*PROGRAM, folder, *SMALL, "--quiet", "--tables", tmp_path / "tables"],
        preexec_fn=small_files_only,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert done.stderr.startswith("Error while writing tables: ")
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "tables").exists()
