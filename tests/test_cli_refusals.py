"""What goes wrong around the command line, and the one sentence that it gets."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import gmr
from gmr.cli.commands import COMMANDS
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished

Captured = pytest.CaptureFixture[str]


def run(*args: str | Path) -> int:
    """The exit code of ``gmr ARGS``, in this process."""
    return finished(command, [str(arg) for arg in args])


def process(*args: str | Path, **options: Any) -> subprocess.CompletedProcess[str]:
    """``gmr ARGS`` as a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "gmr", *map(str, args)],
        stderr=subprocess.PIPE, text=True, timeout=60, check=False, **options,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("typed", "says"),
    [
        ("evalute", "Did you mean evaluate?"),
        (
            "nonsense",
            "There are evaluate, complete, info, convert, roots, view, skin, synthesize, decompose, bench, "
            "demo.",
        ),
    ],
)
def test_an_unknown_command_gets_the_names_near_it(typed: str, says: str, capsys: Captured) -> None:
    assert run(typed, "takes") == 2
    assert f"No such command '{typed}'. {says}" in capsys.readouterr().err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_a_line_of_its_own_in_the_help(name: str, capsys: Captured) -> None:
    assert run("--help") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line for line in lines if line.startswith(f"  {name} ") and line.endswith(".")]
    assert not [line for line in lines if line.startswith("  ") and line.endswith("...")]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (
            ("evaluate", ".", "--prune-out", "less"),
            "--prune-out is where --prune writes; say how much shall go",
        ),
        (
            ("evaluate", ".", "--complete-out", "more"),
            "--complete-out is where --complete-from FOLDER writes",
        ),
        (
            ("info", "walk.bvh", "--relation", "ior"),
            "--relation is for recordings of markers (C3D) only, but",
        ),
    ],
)
def test_an_option_that_would_do_nothing_is_refused(
    options: tuple[str, ...], says: str, walk_path: Path, tmp_path: Path, capsys: Captured,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    (tmp_path / "walk.bvh").write_bytes(walk_path.read_bytes())
    monkeypatch.chdir(tmp_path)
    assert run(*options) == 2
    said = capsys.readouterr()
    assert says in " ".join(said.err.split())
    assert not said.out
    assert [path.name for path in tmp_path.iterdir()] == ["walk.bvh"]


def test_a_unit_to_convert_from_needs_one_to_convert_to(
    walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    assert run("convert", walk_path, tmp_path / "out.bvh", "--from-unit", "cm") == 2
    assert "give --unit too" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_an_error_about_joints_names_the_file(walk_path: Path, tmp_path: Path, capsys: Captured) -> None:
    lame = tmp_path / "lame.bvh"
    lame.write_text(re.sub(r"JOINT RightUpLeg\b", "JOINT Tail", walk_path.read_text()))
    assert run("convert", lame, tmp_path / "out.bvh", "--mirror") == 1
    said = capsys.readouterr().err
    assert said.startswith(f"gmr: {lame}: joint ")
    assert said.count("\n") == 1


def test_a_rate_that_cannot_be_meant_is_refused(walk_path: Path, tmp_path: Path, capsys: Captured) -> None:
    assert run("convert", walk_path, tmp_path / "out.bvh", "--fps", "1e300") == 1
    said = capsys.readouterr().err
    assert "give a lower rate" in said
    assert str(walk_path) in said
    assert list(tmp_path.iterdir()) == []


def test_what_does_not_fit_into_memory_is_one_sentence(walk_path: Path, tmp_path: Path) -> None:
    import resource

    done = process(
        "convert", walk_path, tmp_path / "out.bvh", "--fps", "5e6",
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (2**31, 2**31)),
    )  # fmt: skip
    assert done.returncode == 1
    assert "does not fit into the memory" in done.stderr
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_link_that_leads_nowhere_is_called_one(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "walk.bvh").symlink_to("gone.bvh")
    assert run("info", tmp_path) == 1
    assert "walk.bvh: this is a link to 'gone.bvh', which is not there" in capsys.readouterr().err


def test_a_place_that_cannot_be_written_to_is_the_only_one_named(walk_path: Path, capsys: Captured) -> None:
    out = Path(os.devnull) / "out.bvh"
    assert run("convert", walk_path, out) == 1
    assert capsys.readouterr().err.startswith(f"gmr: {out}: ")


@pytest.mark.parametrize("closed", [0, 1, 2])
def test_a_closed_standard_stream_does_no_harm(walk_path: Path, closed: int) -> None:
    reads = "-" if closed == 0 else walk_path
    done = process("convert", reads, "-", stdout=subprocess.DEVNULL, preexec_fn=lambda: os.close(closed))
    assert done.returncode == (1 if closed == 0 else 0)
    assert done.stderr.count("\n") == (1 if closed == 0 else 0)
    assert "Traceback" not in done.stderr


def test_an_instruction_set_that_there_is_not_is_one_sentence(walk_path: Path) -> None:
    banana = os.environ | {"GMR_ISA": "banana"}
    done = process("info", walk_path, env=banana, stdout=subprocess.PIPE)
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(r"gmr: GMR_ISA=banana cannot be used here; this machine runs .+\n", done.stderr)
    assert process("--help", env=banana, stdout=subprocess.PIPE).returncode == 0


def test_an_interrupt_while_the_program_starts_is_one_sentence() -> None:
    code = """
import signal, sys
class Interrupting:
    def find_spec(self, name, path, target=None):
        if name == "click":
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Interrupting())
signal.signal(signal.SIGINT, signal.default_int_handler)
from gmr.cli import main
main(["--help"])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 128 + signal.SIGINT
    assert done.stderr == "gmr: interrupted; no file was left half-written\n"
    assert done.stdout == ""


def test_nothing_else_is_loaded_before_an_interrupt_can_be_answered() -> None:
    code = "import sys; held = {*sys.modules}; import gmr.cli; print(*sorted({*sys.modules} - held))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "gmr gmr.cli\n"


def test_an_interrupt_outside_of_the_command_is_one_sentence() -> None:
    code = "from gmr.cli import main; import signal; signal.signal(2, signal.default_int_handler); {}"
    launcher = [sys.executable, "-c", code.format("signal.raise_signal(signal.SIGINT)")]
    done = subprocess.run(launcher, capture_output=True, text=True, check=False)
    assert done.returncode in (-signal.SIGINT, 128 + signal.SIGINT)
    assert done.stderr == "gmr: interrupted; no file was left half-written\n"
    launcher[-1] = code.format("raise RuntimeError('a fault')")
    done = subprocess.run(launcher, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("Traceback")


def test_a_folder_is_not_converted_into_what_is_called_like_a_file(
    walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    (tmp_path / "takes").mkdir()
    (tmp_path / "takes" / "walk.bvh").write_bytes(walk_path.read_bytes())
    assert run("convert", tmp_path / "takes", tmp_path / "out.bvh") == 2
    assert "is called like a file; give a name without the suffix" in " ".join(
        capsys.readouterr().err.split()
    )
    assert not (tmp_path / "out.bvh").exists()


def test_a_format_that_is_not_known_gets_remedies_for_both_faces(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "walk.txt").write_text("HIERARCHY")
    assert run("info", tmp_path / "walk.txt") == 1
    said = capsys.readouterr().err
    assert "in Python (format='bvh'), or put - in its place on the command line" in said


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_disk_that_fills_up_under_standard_output_is_one_sentence(
    walk_path: Path, tmp_path: Path, unbuffered: str
) -> None:
    import resource

    # The limit lets a first part of the file through, as a disk does that is nearly full.
    with (tmp_path / "out.bvh").open("wb") as out:
        done = process(
            "convert", walk_path, "-", stdout=out, env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192)),
        )  # fmt: skip
    assert done.returncode == 1
    assert done.stderr == "gmr: standard output: File too large\n"


@pytest.mark.parametrize("source", [None, 3, ["walk.bvh"]])
def test_what_is_no_source_is_said_to_be_none(source: Any) -> None:
    with pytest.raises(TypeError, match="read from a path, bytes or an open file"):
        gmr.read(source)


@pytest.mark.parametrize("motions", [["walk.bvh"], {"walk": "walk.bvh"}, [None]])
def test_what_is_no_motion_is_said_to_be_none(motions: Any) -> None:
    with pytest.raises(TypeError, match=r"a motion is needed here, not .*; read files with gmr\.read"):
        gmr.evaluate(motions)
