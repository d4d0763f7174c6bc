"""The command line as people and scripts meet it: what it prints, what it leaves, how it exits."""

from __future__ import annotations

import contextlib
import io
import json
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from gmr.cli.commands import COMMANDS
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.sides import pair_joints

Captured = pytest.CaptureFixture[str]


def run(*args: str | Path) -> int:
    """The exit code of ``gmr ARGS``, in this process."""
    return finished(command, [str(arg) for arg in args])


def process(*args: str | Path, **options: Any) -> subprocess.CompletedProcess[bytes]:
    """``gmr ARGS`` as a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "gmr", *map(str, args)], capture_output=True, timeout=60, **options
    )


@pytest.fixture
def takes(tmp_path: Path, data: Path) -> Path:
    """A folder of three motions, one of them broken and one in a folder below, and files of other kinds."""
    folder = tmp_path / "takes"
    (folder / "below").mkdir(parents=True)
    shutil.copy(data / "cmu_07_01.bvh", folder / "walk.bvh")
    shutil.copy(data / "cmu_12_01.bvh", folder / "below" / "stroll.BVH")
    (folder / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 zero 0\n}\n")
    (folder / "notes.txt").write_text("not a motion")
    (folder / ".hidden.bvh").write_text("not seen")
    return folder


def test_info_tells_what_is_in_a_file_and_what_is_odd(walk_path: Path, capsys: Captured) -> None:
    assert run("info", walk_path) == 0
    page = capsys.readouterr().out
    for told in (
        "60 at 120 fps: 0.50 s",
        "38, 7 of them end sites",
        "LHipJoint",
        "96 a frame",
        "cmu",
        "a guess",
        "+Y",
    ):
        assert told in page
    assert "frame 0 is a T-pose that a converter added" in page


def test_info_as_json_is_an_object_for_a_file_and_a_list_for_more(
    walk_path: Path, takes: Path, capsys: Captured
) -> None:
    assert run("info", "--json", walk_path) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["frames"], told["fps"], told["joint_count"], told["ends"]) == (60, 120.0, 38, 7)
    assert (told["unit"], told["unit_guess"]["name"], told["up_guess"]["axis"]) == (None, "cmu", "+Y")
    assert told["leading_rest_frames"] == 1
    assert run("info", "--json", takes) == 1
    listed = json.loads(capsys.readouterr().out)
    assert [Path(entry["file"]).name for entry in listed] == ["stroll.BVH", "walk.bvh", "broken.bvh"]
    assert "OFFSET" in listed[2]["error"]


def test_info_names_every_oddity_of_a_file(tmp_path: Path, capsys: Captured) -> None:
    odd = tmp_path / "odd.bvh"
    odd.write_text(
        "HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\n"
        "CHANNELS 6 Zrotation Xrotation Yrotation Xposition Yposition Zposition\n"
        "JOINT B\n{\nOFFSET 0 1 0\nCHANNELS 2 Xrotation Yrotation\n}\n"
        "JOINT B\n{\nOFFSET 1 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
        "End Site\n{\nOFFSET 0 1 0\n}\n}\n}\n"
        "ROOT C\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n}\n"
        "MOTION\nFrames: 5\nFrame Time: 0.1\n" + "1 2 3 4 5 6 7 8 9 10 11 12 13 14\n" * 3
    )
    assert run("info", odd) == 0
    page = capsys.readouterr().out
    for oddity in (
        "5 frames are declared, but 3 are there",
        "several joints share a name: B",
        "1 turning leaf has no End Site",
        "2 roots: A, C",
        "rotation orders differ between joints: ZXY (1), XYZ (1)",
        "1 joint has fewer than three rotation channels",
        "rotation channels come before position channels",
    ):
        assert oddity in page
    assert run("info", "--strict", odd) == 1


def test_many_files_get_a_line_each_and_what_is_odd_about_which(takes: Path, capsys: Captured) -> None:
    for copy in ("a.bvh", "b.bvh", "c.bvh"):
        shutil.copy(takes / "walk.bvh", takes / copy)
    assert run("info", takes) == 1
    said = capsys.readouterr()
    assert [line.split()[0] for line in said.out.splitlines()[:6]] == [
        "file", "a.bvh", "b.bvh", "below/stroll.BVH", "c.bvh", "walk.bvh",
    ]  # fmt: skip
    assert f"5 motions in {takes}: 280 frames, 2.3 s" in said.out
    assert said.out.count("T-pose") == 1
    assert "broken.bvh" in said.err


def test_one_broken_file_is_named_and_the_others_are_converted(
    takes: Path, tmp_path: Path, capsys: Captured
) -> None:
    out = tmp_path / "out"
    assert run("convert", takes, out, "--fps", "60") == 1
    assert "broken.bvh:4" in capsys.readouterr().err
    assert sorted(path.relative_to(out).as_posix() for path in out.rglob("*.*")) == [
        "below/stroll.BVH",
        "walk.bvh",
    ]
    assert gmr.read(out / "walk.bvh").fps == pytest.approx(60)
    assert gmr.read(out / "walk.bvh").frame_count == 30


def test_without_options_every_value_comes_back(walk_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.bvh"
    assert run("convert", walk_path, out) == 0
    assert gmr.read(out) == gmr.read(walk_path)


def test_a_mirrored_file_is_the_mirror_image(walk_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.bvh"
    assert run("convert", walk_path, out, "--mirror") == 0
    motion, mirrored = gmr.read(walk_path), gmr.read(out)
    pair = pair_joints(motion.skeleton)
    wanted = motion.positions(dtype=np.float64) * (-1, 1, 1)
    np.testing.assert_allclose(mirrored.positions(dtype=np.float64)[:, pair], wanted, atol=1e-12)


def test_dummies_are_left_out_but_for_those_that_bvh_needs(walk_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.bvh"
    assert run("convert", walk_path, out, "--drop-dummies") == 0
    motion, lean = gmr.read(walk_path), gmr.read(out)
    gone = set(motion.skeleton.names) - set(lean.skeleton.names)
    assert gone == {"LHipJoint", "RHipJoint", "LeftShoulder", "RightShoulder"}
    kept = motion.skeleton.indices(lean.skeleton.names)
    np.testing.assert_allclose(
        lean.positions(dtype=np.float64), motion.positions(dtype=np.float64)[:, kept], atol=1e-9
    )


def test_a_guessed_unit_is_said_and_a_stated_one_is_not_doubted(
    walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    guessed, stated = tmp_path / "guessed.bvh", tmp_path / "stated.bvh"
    assert run("convert", walk_path, guessed, "--unit", "m") == 0
    assert "taken to be in cmu" in capsys.readouterr().err
    assert run("convert", walk_path, stated, "--unit", "cm", "--from-unit", "cmu") == 0
    assert capsys.readouterr().err == ""
    metres, centimetres = (gmr.read(path).positions(dtype=np.float64) for path in (guessed, stated))
    np.testing.assert_allclose(metres * 100, centimetres, atol=1e-9)


def test_standard_input_goes_to_standard_output(walk_path: Path) -> None:
    done = process("convert", "-", "-", "--fps", "60", input=walk_path.read_bytes())
    assert done.returncode == 0, done.stderr
    assert gmr.read(done.stdout) == gmr.read(walk_path).resample(60)


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["convert", "{walk}", "out.xyz"], "'.xyz' is none that gmr writes"),
        (
            ["convert", "{walk}", "out.c3d"],
            "out.c3d: gmr reads C3D but does not write it; write one of: .bvh, .amc",
        ),
        (["convert", "{walk}", "out.bvh", "--fps", "0"], "above 0"),
        (["convert", "{walk}", "out.bvh", "--unit", "parsec"], "there is no unit 'parsec'"),
        (["convert", "{folder}", "-"], "OUT must be a folder"),
        (["info"], "FILE..."),
        (["infos"], "No such command"),
    ],
)
def test_wrong_usage_is_said_and_exits_with_2(
    args: list[str], said: str, walk_path: Path, capsys: Captured
) -> None:
    assert run(*(arg.format(walk=walk_path, folder=walk_path.parent) for arg in args)) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("missing", ["nowhere.bvh", "nowhere/walk.bvh"])
def test_a_missing_file_is_named(missing: str, tmp_path: Path, capsys: Captured) -> None:
    assert run("info", tmp_path / missing) == 1
    assert missing in capsys.readouterr().err


def test_a_folder_without_motions_is_named(tmp_path: Path, capsys: Captured) -> None:
    assert run("info", tmp_path) == 1
    assert "no motion in this folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    "args", [("info", "{folder}"), ("convert", "{folder}", "{folder}/out", "--to", "gmr")]
)
def test_recordings_of_markers_in_a_folder_are_said_to_be_left_out(
    args: tuple[str, ...], walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    recording = tmp_path / "hop.c3d"
    recording.write_bytes(b"\x02P")
    line = [arg.format(folder=tmp_path) for arg in args]
    why = (
        f"hop.c3d is left out: it holds markers, not a motion; make one of it first: gmr convert {recording} "
    )
    assert run(*line) == 1
    assert f"(.bvh, .amc, .asf, .gmr, .gmrb, .glb, .gltf); {why}" in capsys.readouterr().err
    shutil.copy(walk_path, tmp_path)
    assert run(*line) == 0
    assert f"gmr: {tmp_path}: {why}{tmp_path / 'hop.gmr'}\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    "args", [("info", "{folder}"), ("convert", "{folder}", "{folder}/out", "--to", "gmr")]
)
def test_a_sentence_stands_on_a_line_of_its_own_while_a_bar_is_shown(
    args: tuple[str, ...], walk_path: Path, tmp_path: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a", "c"):
        shutil.copy(walk_path, tmp_path / f"{name}.bvh")
    (tmp_path / "b.bvh").write_text("no motion")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert run(*(arg.format(folder=tmp_path) for arg in args)) == 1
    bar, said = capsys.readouterr().err.split(f"gmr: {tmp_path}/b.bvh:1", 1)
    assert "%" in bar
    assert bar.endswith("\r\x1b[K")
    assert "100%" in said
    assert "\x1b[K" not in said


def test_a_disk_that_fills_up_leaves_the_old_file(walk_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.bvh"
    out.write_bytes(b"what was there")
    done = process(
        "convert", walk_path, out,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, 10_000)),
    )  # fmt: skip
    assert done.returncode == 1
    assert b"out.bvh: cannot be written" in done.stderr
    assert b"untouched" in done.stderr
    assert out.read_bytes() == b"what was there"
    assert [path.name for path in tmp_path.iterdir()] == ["out.bvh"]


def test_a_reader_that_goes_away_ends_it_quietly(walk_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "gmr", "convert", str(walk_path), "-"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as running:
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.close()
        assert running.stderr.read() == b""
        assert running.wait(60) == 1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_standard_output_is_one_sentence(walk_path: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "gmr", "convert", str(walk_path), "-"],
            stdout=full, stderr=subprocess.PIPE, timeout=60, check=False,
        )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == b"gmr: standard output: No space left on device\n"


def test_an_interrupt_is_one_sentence(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "gmr", "convert", "-", str(tmp_path / "out.bvh")],
        stdin=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as running:  # fmt: skip
        assert running.stdin is not None
        assert running.stderr is not None
        # Half a file on an open pipe: when the second write is through, the first is being read.
        running.stdin.write(b"HIERARCHY\n" * 200_000)
        running.stdin.flush()
        while running.poll() is None:
            # One that arrives just before the process waits for input again is only seen with the next.
            running.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                running.wait(2)
        said = running.stderr.read()
        assert running.returncode == 130
    assert b"interrupted" in said
    assert b"Traceback" not in said
    assert list(tmp_path.iterdir()) == []


def test_help_teaches_with_examples(capsys: Captured) -> None:
    for name in ("info", "convert"):
        assert run(name, "--help") == 0
        page = capsys.readouterr().out
        assert "Examples:" in page
        assert f"gmr {name} walk.bvh" in page
    assert run("--help") == 0
    assert "Exit codes" in capsys.readouterr().out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_help_says_what_its_exit_codes_mean(name: str, capsys: Captured) -> None:
    assert run(name, "--help") == 0
    page = " ".join(capsys.readouterr().out.split())
    codes = page[page.index("Exit codes: 0 ") :]
    for code in (" 1 ", " 2 wrong usage", " 130 "):
        assert code in codes


def test_help_does_not_wait_for_numpy() -> None:
    code = """
import sys
from gmr.cli.commands import gmr
from gmr.cli.common import finished
finished(gmr, ["--help"])
sys.exit("numpy" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    assert done.returncode == 0


def test_info_reads_standard_input(
    walk_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured
) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(walk_path.read_bytes())))
    assert run("info", "-") == 0
    assert "60 at 120 fps" in capsys.readouterr().out


def test_a_motion_goes_through_gmr_files_unchanged(walk_path: Path, tmp_path: Path) -> None:
    text, binary, out = (tmp_path / f"walk.{suffix}" for suffix in ("gmr", "gmrb", "bvh"))
    for source, target in ((walk_path, text), (text, binary), (binary, out)):
        assert run("convert", source, target) == 0
    for file in (text, binary, out):
        assert gmr.read(file) == gmr.read(walk_path)
    assert run("convert", walk_path, tmp_path / "plain.bvh") == 0
    assert out.read_bytes() == (tmp_path / "plain.bvh").read_bytes()


def test_info_names_what_was_done_to_the_forest(walk_path: Path, tmp_path: Path, capsys: Captured) -> None:
    moved = gmr.read(walk_path).split("LeftFoot").shift_root("Head")
    gmr.write(moved, tmp_path / "moved.gmrb")
    assert run("info", tmp_path / "moved.gmrb") == 0
    page = capsys.readouterr().out
    assert "LeftFoot cut from LeftLeg" in page
    assert "the tree of Hips turned over onto Head" in page
    assert run("info", "--json", tmp_path / "moved.gmrb") == 0
    assert json.loads(capsys.readouterr().out)["configuration"] == [
        "LeftFoot cut from LeftLeg",
        "the tree of Hips turned over onto Head",
    ]


def test_x3d_is_in_metres_and_a_guessed_unit_is_said(
    walk_path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    guessed, stated = tmp_path / "guessed.x3d", tmp_path / "stated.x3d"
    assert run("convert", walk_path, guessed) == 0
    assert "taken to be in cmu" in capsys.readouterr().err
    assert run("convert", walk_path, stated, "--from-unit", "cmu") == 0
    assert capsys.readouterr().err == ""
    assert stated.read_bytes() == guessed.read_bytes()
    assert run("convert", tmp_path / "guessed.x3d", tmp_path / "back.bvh") == 1
    assert "gmr writes X3D but does not read it" in capsys.readouterr().err
    assert run("info", guessed) == 1
    assert "gmr writes X3D but does not read it" in capsys.readouterr().err


def test_a_folder_becomes_one_of_x3d(takes: Path, tmp_path: Path) -> None:
    assert run("convert", takes, tmp_path / "out", "--to", "x3d", "--fps", "30") == 1  # one is broken
    written = sorted(path.suffix for path in (tmp_path / "out").rglob("*.*"))
    assert written == [".x3d", ".x3d"]
