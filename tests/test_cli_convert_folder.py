"""``gmr convert`` of whole folders into another format."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished

Captured = pytest.CaptureFixture[str]

FORMATS = ("bvh", "amc", "gmr", "gmrb")


def run(*args: str | Path) -> int:
    return finished(command, [str(arg) for arg in args])


@pytest.fixture
def takes(tmp_path: Path, data: Path, walk_path: Path) -> Path:
    """A motion of each format, two of them in folders below, and a file of another kind."""
    folder = tmp_path / "takes"
    (folder / "below" / "deep").mkdir(parents=True)
    shutil.copy(walk_path, folder / "walk.BVH")
    shutil.copytree(data / "amc", folder / "below", dirs_exist_ok=True)
    gmr.write(gmr.read(walk_path)[:9], folder / "text.gmr")
    gmr.write(gmr.read(walk_path).with_roots(["Hips", "Neck"])[:7], folder / "below" / "deep" / "binary.gmrb")
    (folder / "notes.txt").write_text("not a motion")
    return folder


def everything(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.*"))


@pytest.mark.parametrize("to", FORMATS)
def test_a_folder_of_all_formats_becomes_one_of_one_format(takes: Path, tmp_path: Path, to: str) -> None:
    before = everything(takes)
    out = tmp_path / "out"
    assert run("convert", takes, out, "--to", to) == 0
    written = [
        f"below/07_01.{to}",
        f"below/deep/binary.{to}",
        f"text.{to}",
        f"walk.{to if to != 'bvh' else 'BVH'}",
    ]
    beside = [name.replace(".amc", ".asf") for name in written] if to == "amc" else []
    assert everything(out) == sorted(written + beside)
    assert everything(takes) == before
    for name in written:
        source = next(path for path in takes.rglob(f"{Path(name).stem}.*") if path.suffix != ".asf")
        motion, found = gmr.read(source), gmr.read(out / name)
        # The root of an ASF is called root.
        joints = [name if name in found.skeleton.names else "root" for name in motion.skeleton.names]
        places = found.positions(dtype=np.float64, joints=joints)
        np.testing.assert_allclose(places, motion.positions(dtype=np.float64), rtol=0, atol=1e-7)


def test_the_format_is_named_with_or_without_its_dot(takes: Path, tmp_path: Path) -> None:
    assert run("convert", takes / "walk.BVH", tmp_path, "--to", ".GMR") == 0
    assert gmr.read(tmp_path / "walk.gmr") == gmr.read(takes / "walk.BVH")


def test_json_tells_what_was_written_and_what_failed(takes: Path, tmp_path: Path, capsys: Captured) -> None:
    (takes / "broken.bvh").write_text("HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 zero 0\n}\n")
    (takes / "below" / "cut.amc").write_text("1\nroot one")
    out = tmp_path / "out"
    assert run("convert", takes, out, "--to", "amc", "--json") == 1
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert [Path(entry["file"]).name for entry in told["written"]] == [
        "07_01.amc", "binary.gmrb", "text.gmr", "walk.BVH",
    ]  # fmt: skip
    assert told["written"][0] == {
        "file": str(takes / "below" / "07_01.amc"),
        "out": str(out / "below" / "07_01.amc"),
        "beside": [str(out / "below" / "07_01.asf")],
        "frames": 20,
        "fps": 120.0,
    }
    failed = [str(takes / "below" / "cut.amc"), str(takes / "broken.bvh")]
    assert [entry["file"] for entry in told["failed"]] == failed
    assert "zero" in told["failed"][1]["error"]
    assert f"gmr: 2 of 6 files failed: {', '.join(failed)}" == said.err.splitlines()[-1]


def test_json_of_one_file_is_of_the_same_form(takes: Path, tmp_path: Path, capsys: Captured) -> None:
    assert run("convert", takes / "walk.BVH", tmp_path / "walk.gmr", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert [entry["out"] for entry in told["written"]] == [str(tmp_path / "walk.gmr")]
    assert told["failed"] == []


def test_two_inputs_of_one_output_are_refused_before_any_work(
    takes: Path, walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    shutil.copy(walk_path, takes / "below" / "07_01.bvh")
    assert run("convert", takes, tmp_path / "out", "--to", "gmr") == 2
    said = " ".join(capsys.readouterr().err.split())
    below, out = takes / "below", tmp_path / "out" / "below"
    both = f"'{below / '07_01.amc'}', '{below / '07_01.bvh'}'"
    assert f"{both} would both be written to '{out / '07_01.gmr'}'" in said
    assert not (tmp_path / "out").exists()


def test_a_skeleton_that_other_takes_need_is_not_written_over(
    takes: Path, walk_path: Path, capsys: Captured
) -> None:
    shutil.copy(walk_path, takes / "below" / "07.bvh")
    skeleton = (takes / "below" / "07.asf").read_bytes()
    assert run("convert", takes, takes, "--to", "amc") == 2
    assert "07.asf', which lies among the inputs" in " ".join(capsys.readouterr().err.split())
    assert (takes / "below" / "07.asf").read_bytes() == skeleton
    assert not (takes / "walk.amc").exists()


def test_a_folder_is_converted_in_place_where_nothing_is_in_the_way(takes: Path) -> None:
    assert run("convert", takes, takes, "--to", "gmrb") == 0
    assert (takes / "below" / "07_01.gmrb").exists()
    assert (takes / "below" / "07_01.amc").exists()


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["{takes}", "{out}", "--to", "c3d"], "gmr reads C3D but does not write it; write one of: bvh, amc"),
        (
            ["{takes}", "{out}", "--to", "fbx"],
            "there is no format 'fbx'; write one of: bvh, amc, asf, gmr, gmrb, glb, x3d",
        ),
        (["{takes}/walk.BVH", "{out}.gmr", "--to", "bvh"], "--to asks for BVH, but"),
        (["{takes}/walk.BVH", "-", "--json"], "--json is printed on standard output, where the motion goes"),
    ],
)
def test_what_cannot_be_meant_is_refused(
    args: list[str], said: str, takes: Path, tmp_path: Path, capsys: Captured
) -> None:
    out = tmp_path / "out"
    assert run("convert", *(arg.format(takes=takes, out=out) for arg in args)) == 2
    assert said in " ".join(capsys.readouterr().err.split())
    assert everything(tmp_path) == sorted(f"takes/{name}" for name in everything(takes))


@pytest.mark.parametrize("to", ["bvh", "gmr", "gmrb", "amc", "glb"])
@pytest.mark.parametrize("name", ["walk", "walk.mocap"])
def test_the_format_asked_for_decides_where_the_suffix_does_not(
    to: str, name: str, takes: Path, tmp_path: Path, capsys: Captured
) -> None:
    out, like = tmp_path / name, tmp_path / f"like.{to}"
    asked = ["--unit", "m", "--from-unit", "cmu", "--to", to]
    assert run("convert", takes / "walk.BVH", out, *asked) == 0
    assert (tmp_path / "walk.asf").exists() == (to == "amc")
    assert f"skeleton is in {tmp_path / 'walk.asf'}" in capsys.readouterr().err or to != "amc"
    assert run("convert", takes / "walk.BVH", like, *asked) == 0
    one, other = (path.read_bytes().replace(b"walk", b"like") for path in (out, like))
    assert one == other


def test_the_format_asked_for_decides_what_goes_to_a_device(takes: Path, capsys: Captured) -> None:
    assert run("convert", takes / "walk.BVH", "/dev/full", "--to", "gmr") == 1
    assert "/dev/full: cannot be written: No space left on device" in capsys.readouterr().err


def test_standard_output_gets_the_format_that_is_asked_for(takes: Path) -> None:
    line = [sys.executable, "-m", "gmr", "convert", str(takes / "walk.BVH"), "-", "--to", "gmrb"]
    done = subprocess.run(line, capture_output=True, check=True)
    assert gmr.read(done.stdout) == gmr.read(takes / "walk.BVH")
