"""Datasets as people have them: what is odd is taken and told, or refused with what helps."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from locomotion import Arc
from walker import walker_bvh

SMALL = ("--speeds", "1", "--turn-rates", "0", "--quiet")
WALK = walker_bvh(Arc(4.0, 1.0))
TURN = walker_bvh(Arc(4.0, 1.2, 40.0))

Captured = pytest.CaptureFixture[str]


def changed(text: str, change: Callable[[np.ndarray[tuple[int, int], np.dtype[np.float64]]], object]) -> str:
    """The file with other numbers in its frames."""
    head, times, rows = re.split(r"(MOTION\n.*\n.*\n)", text)
    numbers = np.array([line.split() for line in rows.splitlines()], np.float64)
    change(numbers)
    return head + times + "\n".join(" ".join(f"{value:.6f}" for value in row) for row in numbers) + "\n"


def turned(text: str, axis: str, degrees: float) -> str:
    """The world turned about x or z."""
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    one, other = {"X": (1, 2), "Z": (0, 1)}[axis]

    def turn(rows: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
        here, there = rows[:, one].copy(), rows[:, other].copy()
        rows[:, one], rows[:, other] = cos * here - sin * there, sin * here + cos * there
        rows[:, [3, 4]] = np.stack([np.full(len(rows), degrees), rows[:, 3]], axis=1)

    channels = {"X": "Xrotation Yrotation Zrotation", "Z": "Zrotation Yrotation Xrotation"}[axis]
    return changed(text.replace("Yrotation Xrotation Zrotation", channels, 1), turn)


def z_up(text: str) -> str:
    return turned(text, "X", 90.0)


def in_metres(text: str) -> str:
    """The file in metres, which does not say so."""

    def offsets(match: re.Match[str]) -> str:
        return "OFFSET " + " ".join(f"{float(value) / 100:g}" for value in match[1].split())

    def places(rows: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
        rows[:, :3] /= 100

    return changed(re.sub(r"OFFSET (.*)", offsets, text), places)


def in_place(text: str) -> str:
    """The root stays where it is."""

    def stay(rows: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
        rows[:, [0, 2]] = 0

    return changed(text, stay)


def anonymous(text: str) -> str:
    """Joints that no map knows."""
    numbers: dict[str, int] = {}
    return re.sub(
        r"(ROOT|JOINT) (\S+)", lambda found: f"{found[1]} b{numbers.setdefault(found[2], len(numbers))}", text
    )


def far_away(text: str) -> str:
    """A root so far out that its bones vanish in rounding."""

    def move(rows: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
        rows[:, 0] = 1e30

    return changed(text, move)


TAKEN = {
    "one clip": ({"walk": WALK}, "All of the time is played from the one clip, walk.bvh."),
    "the same clip again": (
        {"walk": WALK, "copy": WALK, "again": WALK},
        "2 clips hold the same motion as others ('again.bvh' as 'copy.bvh' and 1 more) and were left out: ",
    ),
    "rates that differ": (
        {"a": walker_bvh(Arc(4.0, 1.0), 24.0), "b": walker_bvh(Arc(4.0, 1.0), 120.0), "c": WALK},
        "The clips were recorded at 24, 30 and 120 frames per second; all were brought to one rate.",
    ),
    "standing": (
        {"idle": walker_bvh(Arc(4.0, 0.0))},
        "The clips stand: 0 seconds of their 4 seconds go 0.1 m/s",
    ),
    "exported in place": (
        {"walk": in_place(WALK)},
        "they were exported in place: export them with the root's",
    ),
    "z up": ({"walk": z_up(WALK), "turn": z_up(TURN)}, "The files have +Z up; they were turned to +Y."),
    "one file with z up": (
        {"walk": WALK, "turn": TURN, "odd": z_up(WALK)},
        "In 1 of 3 clips ('odd.bvh') the hips do not lie above the feet along +Y as in the others",
    ),
    "one file with y down": (
        {"walk": WALK, "turn": TURN, "again": walker_bvh(Arc(4.0, 1.1)), "odd": turned(WALK, "X", 180.0)},
        "In 1 of 4 clips ('odd.bvh') the hips do not lie above the feet along +Y as in the others",
    ),
    "all with x up": (
        {"walk": turned(WALK, "Z", -90.0), "turn": turned(TURN, "Z", -90.0)},
        "The files have +X up; they were turned to +Y.",
    ),
    "metres and centimetres": (
        {"walk": WALK, "turn": in_metres(TURN)},
        "(for 'turn.bvh'); if it is another, say --unit (unit=... in Python).",
    ),
    "unknown names": (
        {"walk": anonymous(WALK)},
        "The joints' names are not known; the body's shape gave hips 'b0'",
    ),
    "a clip shorter than the path ahead": (
        {"walk": WALK, "step": walker_bvh(Arc(0.5, 1.0))},
        "but never matched: 1 of 2 clips ('step.bvh').",
    ),
    "a file cut off": (
        {"walk": WALK, "cut": TURN[: TURN.rindex(" ", 0, -200)]},
        "the frame is left out. Export the file again for the rest.",
    ),
}

LEFT_OUT = {
    "a number that is none": (
        re.sub(r"\b9[34]\.\d+", "nan", WALK, count=1),
        "'nan' stands for no number",
    ),
    "another skeleton": (WALK.replace("JOINT Head", "JOINT Kopf"), "another skeleton than that of the clips"),
    "a body on its side": (
        turned(WALK, "Z", 90.0),
        "along -X and not, as in the others, along +Y: the file has another axis up, or the body lies and "
        "shows no facing; give it a folder of its own",
    ),
    "no unit fits": (in_metres(in_metres(in_metres(WALK))), "say how many metres a file unit is: --unit"),
    "farther than a body can be": (
        far_away(WALK),
        "it holds a number as large as 1e+30, where no body can be",
    ),
    "no frames": (
        re.sub(r"Frames: .*\n(.*\n)[^$]*", r"Frames: 0\n\1", WALK),
        "it holds no frames; export it",
    ),
    "one frame": (walker_bvh(Arc(0.0, 1.0)), "it is a pose, not a movement: a clip has at least 2 frames"),
}

REFUSED = {
    "an empty folder": ({}, "holds no motion files (.bvh"),
    "only a broken file": ({"odd": "HIERARCHY\n"}, "the only motion file of"),
    "files of two axes": (
        {"one": z_up(WALK), "other": turned(TURN, "X", -90.0)},
        "the clips do not have one axis up: +Z is up in 'one.bvh'; -Z in 'other.bvh'. Give the files of each "
        "axis a folder of their own",
    ),
    "only short clips": ({"step": walker_bvh(Arc(0.5, 1.0))}, "Give longer takes"),
}


def folder_of(folder: Path, files: dict[str, str]) -> Path:
    folder.mkdir()
    for name, text in files.items():
        (folder / f"{name}.bvh").write_text(text)
    return folder


def told(text: str) -> str:
    return " ".join(text.split())


@pytest.mark.parametrize("case", TAKEN)
def test_what_is_odd_is_taken_and_told_on_the_terminal_and_in_the_report(
    tmp_path: Path, capsys: Captured, case: str
) -> None:
    files, says = TAKEN[case]
    folder, report = folder_of(tmp_path / "takes", files), tmp_path / "report.html"
    assert (
        finished(command, ["evaluate", str(folder), *SMALL, "--scenario", "constant", "-o", str(report)]) == 0
    )
    said = capsys.readouterr()
    assert says in told(said.out)
    assert said.err == ""
    assert says in told(report.read_text().replace("&#x27;", "'"))


def test_recordings_of_markers_are_said_to_be_left_out(tmp_path: Path, capsys: Captured) -> None:
    folder = folder_of(tmp_path / "takes", {"walk": WALK})
    (folder / "hop.c3d").write_bytes(b"\x02P")
    evaluate = ["evaluate", str(folder), *SMALL, "--scenario", "constant", "--no-report"]
    why = "hop.c3d is left out: it holds markers, not a motion; make one of it first"
    assert finished(command, evaluate) == 0
    assert why in told(capsys.readouterr().out)
    (folder / "walk.bvh").unlink()
    assert finished(command, evaluate) == 1
    said = told(capsys.readouterr().err)
    assert why in said
    assert "holds no motion files (.bvh, .amc, .asf, .gmr, .gmrb, .glb and .gltf)" in said


@pytest.mark.parametrize("case", LEFT_OUT)
@pytest.mark.parametrize("subcommand", ["evaluate", "complete"])
def test_one_bad_file_among_good_ones_is_left_out_and_named(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch, case: str, subcommand: str
) -> None:
    monkeypatch.chdir(tmp_path)
    odd, why = LEFT_OUT[case]
    folder = folder_of(tmp_path / "takes", {"walk": WALK, "turn": TURN, "odd": odd})
    assert finished(command, [subcommand, str(folder), *SMALL]) == 1
    said = capsys.readouterr()
    assert "1 file could not be used and was left out: odd.bvh." in told(said.out)
    assert why in said.err
    assert said.err.count("\n") == 1


@pytest.mark.parametrize("case", REFUSED)
@pytest.mark.parametrize(
    "arguments", [("evaluate",), ("evaluate", "--prune", "30%"), ("evaluate", "--tune"), ("complete",)]
)
def test_what_cannot_be_evaluated_is_one_sentence_whatever_is_asked(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch, case: str, arguments: tuple[str, ...]
) -> None:
    monkeypatch.chdir(tmp_path)
    files, says = REFUSED[case]
    folder = folder_of(tmp_path / "takes", files)
    first, *others = arguments
    assert finished(command, [first, str(folder), *SMALL, *others]) == 1
    said = capsys.readouterr()
    assert says in said.err
    assert said.err.count("\n") == 1
    assert said.out == ""


def test_a_body_on_its_side_is_left_out_with_mirrored_copies_too(tmp_path: Path, capsys: Captured) -> None:
    files = {"walk": WALK, "turn": TURN, "odd": turned(WALK, "Z", 90.0)}
    folder = folder_of(tmp_path / "takes", files)
    assert finished(command, ["evaluate", str(folder), *SMALL, "--no-report", "--mirror"]) == 1
    said = capsys.readouterr()
    assert "1 file could not be used and was left out: odd.bvh." in told(said.out)
    assert "left out odd.bvh: its hips lie above its feet along -X" in said.err


def test_a_unit_that_makes_dwarfs_of_some_clips_is_told(tmp_path: Path, capsys: Captured) -> None:
    folder = folder_of(tmp_path / "takes", {"walk": WALK, "turn": in_metres(TURN)})
    assert finished(command, ["evaluate", str(folder), *SMALL, "--no-report", "--unit", "cm"]) == 0
    said = told(capsys.readouterr().out)
    assert (
        "the body of 1 of 2 clips ('turn.bvh') about 0.017 m tall: give another, or none, and it is" in said
    )


def test_the_remedy_for_too_much_pruning_helps(tmp_path: Path, capsys: Captured) -> None:
    folder, out = folder_of(tmp_path / "takes", {"walk": WALK}), tmp_path / "smaller"
    run = ["evaluate", str(folder), *SMALL, "--no-report", "--prune-out", str(out), "--prune"]
    assert finished(command, [*run, "99%"]) == 1
    said = capsys.readouterr().err
    most = re.search(r"ask for (\d+%|lossless)", said)
    assert most is not None, said
    assert finished(command, [*run, most[1]]) == 0


def test_notes_of_files_are_told_of_a_completion_too(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files, says = TAKEN["a file cut off"]
    assert finished(command, ["complete", str(folder_of(tmp_path / "takes", files)), *SMALL]) == 0
    said = capsys.readouterr()
    assert says in told(said.out)
    assert said.err == ""
    assert says in told((tmp_path / "completed" / "index.html").read_text())


def test_what_is_odd_is_told_of_the_dataset_and_of_the_folder_that_completes_it(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    takes = folder_of(tmp_path / "takes", {"turn": TURN, "slow": walker_bvh(Arc(4.0, 1.2, 40.0), 50.0)})
    archive = folder_of(tmp_path / "archive", {"walk": z_up(walker_bvh(Arc(6.0, 1.0)))})
    assert finished(command, ["complete", str(takes), "--from", str(archive), *SMALL]) == 0
    rates = "The clips were recorded at 30 and 50 frames per second; all were brought to one rate."
    turned = "archive: Its files have +Z up, those of the dataset +Y: what is chosen is turned to +Y up."
    for said in (told(capsys.readouterr().out), told((tmp_path / "completed" / "index.html").read_text())):
        assert f"takes: {rates}" in said
        assert turned in said
    asked = ["--scenario", "constant", "--no-report", *SMALL]
    assert finished(command, ["evaluate", str(takes), "--complete-from", str(archive), *asked]) == 0
    said = told(capsys.readouterr().out)
    assert said.count(rates) == 1
    assert turned in said
    assert finished(command, ["complete", str(takes), *SMALL]) == 0
    assert f"- {rates}" in told(capsys.readouterr().out)


def test_what_is_odd_in_one_of_several_datasets_is_told_under_its_name(
    tmp_path: Path, capsys: Captured
) -> None:
    upright = folder_of(tmp_path / "upright", {"walk": WALK})
    lying = folder_of(tmp_path / "lying", {"walk": z_up(WALK)})
    assert finished(command, ["evaluate", str(upright), str(lying), "--no-report", *SMALL]) == 0
    said = told(capsys.readouterr().out)
    assert said.count("The files have +Z up; they were turned to +Y.") == 1
    assert said.index("upright: This dataset") < said.index("lying: This dataset") < said.index("have +Z up")


def test_clips_of_which_none_could_be_tried_are_not_said_to_be_of_no_help(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = folder_of(tmp_path / "takes", {"turn": TURN})
    other = folder_of(tmp_path / "archive", {"walk": WALK.replace("JOINT Head", "JOINT Kopf")})
    assert finished(command, ["complete", str(folder), "--from", str(other), *SMALL]) == 1
    said = told(capsys.readouterr().out)
    assert said.startswith("No clip of archive could be tried: takes does 0 of 1 trials.")
    assert "it can be laid on the dataset's by --retarget" in said


def test_clips_of_an_earlier_completion_are_told_from_those_of_this_one(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = folder_of(tmp_path / "takes", {"turn": TURN})
    for speed in ("1", "1.5"):
        arguments = ("--speeds", speed, "--turn-rates", "0", "--quiet")
        assert finished(command, ["complete", str(folder), *arguments]) == 0
    said = told(capsys.readouterr().err)
    assert said.startswith(
        "gmr: 1 file in completed/clips is no part of this, but there from before: made_1mps"
    )


def test_clips_whose_names_are_no_utf_8_can_be_chosen(
    tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = folder_of(tmp_path / "takes", {"turn": TURN})
    archive = folder_of(tmp_path / "archive", {"walk": walker_bvh(Arc(6.0, 1.0))})
    (archive / "walk.bvh").rename(archive / "w\udcffalk.bvh")
    assert finished(command, ["complete", str(folder), "--from", str(archive), *SMALL]) == 0
    assert "1 clip was chosen from archive" in told(capsys.readouterr().out)
    assert [path.suffix for path in (tmp_path / "completed" / "clips").iterdir()] == [".bvh"]
