"""``gmr evaluate`` as people and scripts use it."""

from __future__ import annotations

import inspect
import json
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import gmr
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.cli.evaluate import evaluate
from gmr.matching.schema import LOCOMOTION
from locomotion import Arc
from walker import walker_bvh, write_walkers

SMALL = ("--speeds", "1,2", "--turn-rates", "-50:50:50", "--no-report")
PROGRAM = (sys.executable, "-m", "gmr", "evaluate")

Captured = pytest.CaptureFixture[str]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_walkers(tmp_path / "takes", {"walk.bvh": Arc(6.0, 1.0), "run.bvh": Arc(6.0, 2.0, 50.0)})
    return tmp_path / "takes"


def run(*arguments: object) -> int:
    """The exit code of ``gmr evaluate ARGUMENTS``, in this process."""
    return finished(command, ["evaluate", *map(str, arguments)])


def test_the_verdict_goes_to_stdout_and_progress_to_stderr(folder: Path, capsys: Captured) -> None:
    assert run(folder, *SMALL) == 0
    said = capsys.readouterr()
    assert said.out.startswith("This dataset does what it is asked in ")
    for phase in ("reading: 2,", "preparing,", "simulating: 12,", "measuring,"):
        assert phase in said.err
    assert "reading" not in said.out
    assert all(len(line) <= 100 for line in said.out.splitlines())


def test_the_demo_evaluates_with_mirrored_copies_and_says_what_comes_next(
    folder: Path, tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gmr.demo.demo_folder", lambda: folder)
    report = tmp_path / "demo" / "report.html"
    assert finished(command, ["demo", "--out", str(report)]) == 0
    said = capsys.readouterr().out
    assert said.startswith("Evaluating the 2 clips ")
    assert "This dataset does what it is asked in " in said
    assert "Next: gmr evaluate FOLDER" in said
    assert "Mirrored copies" in report.read_text()


def test_quiet_says_nothing_of_progress(folder: Path, capsys: Captured) -> None:
    assert run(folder, *SMALL, "--quiet") == 0
    assert capsys.readouterr().err == ""


def test_json_is_one_object_with_the_figures(folder: Path, capsys: Captured) -> None:
    assert run(folder, *SMALL, "--json", "--mirror", "--preset", "mig2022") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["dataset"] == "takes"
    assert (found["clips"], found["mirrored_clips"]) == (2, 2)
    assert found["settings"]["preset"] == "mig2022"
    assert found["settings"]["speeds"] == [1.0, 2.0]
    assert [row["turn_rate_deg"] for row in found["trials"]] == [-50.0, 0.0, 50.0] * 4
    assert [row["scenario"] for row in found["trials"]] == ["constant"] * 6 + ["switching"] * 6
    assert found["verdict"]["headline"].startswith("This dataset does what it is asked in ")
    assert found["failed"] == {}


def test_the_report_and_the_tables_are_written_where_asked(
    folder: Path, tmp_path: Path, capsys: Captured
) -> None:
    report, tables = tmp_path / "new" / "report.html", tmp_path / "new" / "tables"
    assert run(folder, "--speeds", 1, "--turn-rates", 0, "-o", report, "--tables", tables) == 0
    said = capsys.readouterr().out
    assert f"Report: {report}" in said
    assert f"Tables: {tables}" in said
    assert "</html>" in report.read_text()
    names = {path.name for path in tables.iterdir()}
    assert {"trials.csv", "coverage.csv", "usage.csv", "transitions.csv", "clips.csv"} < names
    assert sorted(path.name for path in report.parent.iterdir()) == ["report.html", "tables"]


def test_tables_are_json_where_pyarrow_is_missing(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert run(folder, *SMALL, "--tables", tmp_path / "tables") == 0
    suffixes = {path.suffix for path in (tmp_path / "tables").iterdir()}
    assert suffixes == {".csv", ".json"}
    trials = json.loads((tmp_path / "tables" / "trials.json").read_text())
    assert [row["speed"] for row in trials] == [1.0, 1.0, 1.0, 2.0, 2.0, 2.0] * 2


def test_file_names_that_are_no_utf_8_do_no_harm(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    (folder / "walk.bvh").rename(folder / "w\udcffalk.bvh")
    (folder / "b\udcfeoken.bvh").write_text("nonsense")
    report, tables = tmp_path / "report.html", tmp_path / "tables"
    assert run(folder, "--speeds", 1, "--turn-rates", 0, "-o", report, "--tables", tables) == 1
    assert "w\\xffalk.bvh" in (tables / "usage.csv").read_text(encoding="utf-8")
    assert "oken.bvh" in capsys.readouterr().err
    assert report.exists()


def test_a_broken_file_is_named_and_the_exit_code_is_1(folder: Path, capsys: Captured) -> None:
    (folder / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n")
    assert run(folder, *SMALL, "--quiet") == 1
    said = capsys.readouterr()
    assert said.err.count("\n") == 1
    assert "broken.bvh:4" in said.err
    assert "1 file could not be used and was left out: broken.bvh." in " ".join(said.out.split())


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("missing",), "missing"),
        (("takes", "--speeds", "fast"), "neither START:STOP:STEP nor numbers"),
        (("takes", "--speeds", "1:3:0"), "no list of numbers"),
        (("takes", "--speeds", "3:1:1"), "no list of numbers"),
        (("takes", "--speeds", "0,1"), "from 0.01 to 100 m/s"),
        (("takes", "--speeds", "1e30"), "1e+30 is not"),
        (("takes", "--unit", "banana"), "no unit 'banana'"),
        (("takes", "--name", "paw=LeftFoot"), "no role is called 'paw'"),
        (("takes", "--turn-rates", "nan"), "turn rate must be"),
        (("takes", "--name", "left_foot"), "ROLE=JOINT"),
        (("takes", "--name", "left_foot=L", "--name", "left_foot=R"), "named twice, L and R"),
        (("takes", "--unit", "1e30"), "a unit cannot be 1e+30 metres"),
        (("takes", "--preset", "mig2023"), "mig2022"),
        (("takes", "--threads", "0"), "threads"),
    ],
)
def test_wrong_usage_is_explained_with_exit_code_2(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Captured,
    arguments: tuple[str, ...],
    says: str,
) -> None:
    (tmp_path / "takes").mkdir()
    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == 2
    assert says in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [tmp_path / "takes"]


@pytest.mark.parametrize(
    ("clips", "says"),
    [({}, "holds no motion files"), ({"short.bvh": Arc(0.5, 1.0)}, "no clip lasts the 1.0")],
)
def test_a_dataset_that_cannot_be_evaluated_is_one_sentence(
    tmp_path: Path, capsys: Captured, clips: dict[str, Arc], says: str
) -> None:
    (tmp_path / "takes").mkdir()
    write_walkers(tmp_path / "takes", clips)
    assert run(tmp_path / "takes", "--quiet", "-o", tmp_path / "report.html") == 1
    said = capsys.readouterr()
    assert says in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""
    assert not (tmp_path / "report.html").exists()


def test_joints_can_be_named(folder: Path, capsys: Captured) -> None:
    assert run(folder, *SMALL, "--name", "left_foot=Paw") == 1
    assert capsys.readouterr().err.splitlines()[-1].startswith("gmr: left_foot=Paw: there is no joint 'Paw'")
    assert run(folder, *SMALL, "--name", "left_foot=LeftFoot", "--json") == 0
    assert json.loads(capsys.readouterr().out)["joints"]["left_foot"] == "LeftFoot"


def test_the_only_file_of_a_folder_is_not_counted(folder: Path, capsys: Captured) -> None:
    (folder / "walk.bvh").unlink()
    (folder / "run.bvh").write_text("nonsense")
    assert run(folder, "--quiet", "--no-report") == 1
    assert "the only motion file of" in capsys.readouterr().err


def test_clips_of_another_skeleton_are_left_out_in_one_sentence(folder: Path, capsys: Captured) -> None:
    for name, speed in (("odd.bvh", 1.0), ("queer.bvh", 1.2)):
        (folder / name).write_text(walker_bvh(Arc(2.0, speed)).replace("JOINT Head", "JOINT Kopf"))
    assert run(folder, *SMALL, "--quiet") == 1
    said = capsys.readouterr()
    assert said.err == (
        "gmr: left out odd.bvh, queer.bvh: another skeleton than that of the clips evaluated, "
        "without 'Head', 'Head_end' and with 'Kopf', 'Kopf_end' besides\n"
    )
    assert "2 of 4 clips have the one of most of the time" in " ".join(said.out.split())
    assert "give them a folder of their own" in " ".join(said.out.split())


def test_ranges_have_both_ends(folder: Path, capsys: Captured) -> None:
    assert run(folder, "--speeds", "0.5:1.1:0.2", "--turn-rates=-30,30", "--no-report", "--json") == 0
    settings = json.loads(capsys.readouterr().out)["settings"]
    assert settings["speeds"] == [0.5, 0.7, 0.9, 1.1]
    assert settings["turn_rates_deg"] == [-30.0, 30.0]


def test_ctrl_c_is_one_sentence_and_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    long = ("--speeds", "0.5:4:0.1", "--turn-rates", "-100:100:5", "--scenario", "constant")
    with subprocess.Popen(
        [*PROGRAM, folder, *long, "-o", out / "report.html", "--tables", out / "tables"],
        stderr=subprocess.PIPE,
        text=True,
    ) as running:
        assert running.stderr is not None
        for line in running.stderr:
            if line.startswith("preparing,"):
                break
        running.send_signal(signal.SIGINT)
        rest = running.stderr.read()
    assert running.returncode == 130
    assert rest.strip().endswith("no file was left half-written")
    assert "Traceback" not in rest
    assert not out.exists()


@pytest.mark.parametrize("option", ["--out", "--tables"])
def test_a_place_that_cannot_be_written_to_is_found_before_the_work(
    folder: Path, tmp_path: Path, capsys: Captured, option: str
) -> None:
    file = tmp_path / "file"
    file.write_text("")
    place = file / "new" / "place"
    assert run(folder, *SMALL[:-1], "-o", tmp_path / "report.html", option, place) == 1
    said = capsys.readouterr()
    assert said.err == (
        f"gmr: {place}: Not a directory (while looking where to write); no file was left half-written\n"
    )
    assert sorted(tmp_path.iterdir()) == [file, folder]


def test_a_place_without_permission_is_found_before_the_work(
    folder: Path, tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Permissions do not bind whoever runs the tests as root, so the system's answer is played.
    def forbidden(path: object, *_: object, **__: object) -> int:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("gmr.replacing.os.open", forbidden)
    assert run(folder, "-o", tmp_path / "report.html") == 1
    said = capsys.readouterr().err
    assert said.startswith(f"gmr: {tmp_path / 'report.html'}: Permission denied (while looking")
    assert said.count("\n") == 1


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
    assert f"gmr: {tmp_path / 'tables'}: " in done.stderr
    assert "(while writing tables); no file was left half-written" in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "tables").exists()


def test_scenarios_are_named_again_and_again_also_by_file(
    folder: Path, tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "bend.csv").write_text("x,z,t\n0,0,0\n0,3,3\n1,5,5\n")
    chosen = ("--scenario", "start-stop", "--scenario", tmp_path / "bend.csv")
    assert run(folder, "--speeds", "1", "--turn-rates", "0", "--no-report", "--json", *chosen) == 0
    found = json.loads(capsys.readouterr().out)
    assert [row["scenario"] for row in found["trials"]] == ["constant", "start-stop", "bend"]
    assert found["trials"][2]["path"] == "as timed"


@pytest.mark.parametrize(
    ("scenario", "says"),
    [
        ("stroll", "unknown scenario 'stroll'"),
        ("bad.csv", "bad.csv:2: z is 'far'"),
        ("no.csv", "cannot be read"),
    ],
)
def test_a_scenario_that_cannot_be_is_wrong_usage(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured, scenario: str, says: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("x,z\n0,far\n1,1\n")
    assert run(folder, "--no-report", "--scenario", scenario) == 2
    assert says in capsys.readouterr().err


def test_weights_are_tuned_where_asked(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    grid = ("--speeds", "1,2", "--turn-rates", "-50:50:50", "--scenario", "constant", "--tune")
    assert run(folder, *grid, "-o", tmp_path / "report.html") == 0
    said = capsys.readouterr()
    assert "weights of the features" in said.out or "Weigh the features anew" in said.out
    assert "tuning" in said.err
    assert "tuning_cells" in (tmp_path / "report.html").read_text()
    assert run(folder, *grid, "--no-report", "--json") == 0
    found = json.loads(capsys.readouterr().out)["tuned"]
    assert set(found["weights"]) >= {"hips velocity", "trajectory facing"}
    assert len(found["trials"]) == 6
    assert run(folder, folder, "--tune") == 2


def test_weights_and_switches_of_the_command_are_those_of_python(folder: Path, capsys: Captured) -> None:
    chosen = ("--weight", "foot position=2", "--weight", "trajectory facing=0.5")
    switches = ("--switched-speed", "1.5", "--switch-every", "2")
    assert run(folder, *SMALL, *chosen, *switches, "--json", "-q") == 0
    told = json.loads(capsys.readouterr().out)
    schema = LOCOMOTION.weighed({"foot position": 2.0, "trajectory facing": 0.5})
    found = gmr.evaluate(
        folder,
        schema=schema,
        switched_speed=1.5,
        switch_every=2.0,
        speeds=(1.0, 2.0),
        turn_rates_deg=(-50.0, 0.0, 50.0),
    )
    assert told["settings"] == found.summary.settings
    assert told["settings"]["weights"]["left foot position"] == 2.0
    assert [row["offset_mean"] for row in told["trials"]] == found.measured.trials["offset_mean"].tolist()


def test_every_option_has_its_counterpart_in_the_documentation() -> None:
    page = (Path(__file__).parent.parent / "docs" / "evaluation.md").read_text(encoding="utf-8")
    rows = [row.split("|")[1:3] for row in page.partition("## From the command line")[2].splitlines()[5:]]
    typed, called = (" ".join(cells) for cells in zip(*rows, strict=True))
    options = [each.opts[-1] for each in evaluate.params if each.opts[0].startswith("-")]
    assert [option for option in options if f"`{option}`" not in typed] == []
    names = inspect.signature(gmr.evaluate).parameters
    assert [name for name in names if f"`{name}`" not in called] == []


@pytest.mark.parametrize(
    ("option", "value", "says"),
    [
        ("--weight", "hips=2", "no feature group is called 'hips'"),
        ("--weight", "hips velocity=-1", "give a number, 0 or more"),
        ("--weight", "hips velocity", "is not GROUP=WEIGHT"),
        ("--switched-speed", "nan", "from 0.01 to 100 m/s"),
        ("--switch-every", "0", "from 0.5 to 60 s"),
    ],
)
def test_weights_and_switches_that_cannot_be_are_wrong_usage(
    folder: Path, capsys: Captured, option: str, value: str, says: str
) -> None:
    assert run(folder, "--no-report", option, value) == 2
    assert says in capsys.readouterr().err
