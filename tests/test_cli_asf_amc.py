"""The commands on ASF and AMC files."""

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


def run(*args: str | Path) -> int:
    return finished(command, [str(arg) for arg in args])


@pytest.fixture
def takes(tmp_path: Path, data: Path) -> Path:
    """07_01.amc and 07.asf in a folder."""
    return Path(shutil.copytree(data / "amc", tmp_path / "takes"))


def test_info_tells_of_degrees_of_freedom_and_of_a_rate_that_nobody_said(
    takes: Path, capsys: Captured
) -> None:
    assert run("info", takes) == 0
    page = capsys.readouterr().out
    for told in ("20 at 120 fps", "62 a frame", "XYZ rotation (10)", "1.", "no frame rate", "07_01.amc"):
        assert told in page
    assert "a skeleton alone" not in page
    assert run("info", takes / "07_01.amc", "--amc-fps", "60", "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["fps"], told["joint_count"], told["channels"]) == (60, 31, 62)
    assert not any("rate" in oddity for oddity in told["oddities"])


def test_info_tells_which_skeleton_an_amc_hangs_on(takes: Path, tmp_path: Path, capsys: Captured) -> None:
    found, other = takes / "07.asf", tmp_path / "actor.asf"
    shutil.copy(found, other)
    assert run("info", takes / "07_01.amc") == 0
    assert f"  skeleton  {found}\n" in capsys.readouterr().out
    assert run("info", takes / "07_01.amc", "--asf", other, "--json") == 0
    assert json.loads(capsys.readouterr().out)["asf"] == str(other)
    for take in ("07_02", "07_03", "07_04"):
        shutil.copy(takes / "07_01.amc", takes / f"{take}.amc")
    assert run("info", takes) == 0
    assert f"  skeleton  {found}\n" in capsys.readouterr().out
    assert run("info", found) == 0
    assert "  skeleton " not in capsys.readouterr().out


@pytest.mark.parametrize("line", ["info -", "convert - out.bvh"])
def test_a_skeleton_that_is_found_for_standard_input_is_named(line: str, takes: Path) -> None:
    told = []
    for options in ([], ["--asf", "07.asf"], ["--strict"]):
        gmr_line = [sys.executable, "-m", "gmr", *line.split(), *options]
        with (takes / "07_01.amc").open("rb") as file:
            done = subprocess.run(
                gmr_line, stdin=file, capture_output=True, check=False, cwd=takes, text=True
            )
        said = "its skeleton is taken from 07.asf, for none is named" in done.stdout + done.stderr
        told.append((done.returncode, said))
    assert told == [(0, True), (0, False), (1, True)]


def test_info_takes_a_skeleton_from_elsewhere(takes: Path, tmp_path: Path, capsys: Captured) -> None:
    shutil.move(takes / "07.asf", tmp_path / "actor.asf")
    assert run("info", takes / "07_01.amc") == 1
    assert "07_01.asf and 07.asf" in capsys.readouterr().err
    assert run("info", takes / "07_01.amc", "--asf", tmp_path / "actor.asf") == 0
    assert run("info", tmp_path / "actor.asf") == 0
    assert "a skeleton alone" in capsys.readouterr().out


def test_convert_writes_the_skeleton_beside_and_says_so(
    walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    assert run("convert", walk_path, tmp_path / "walk.amc") == 0
    assert f"the skeleton is in {tmp_path / 'walk.asf'}" in capsys.readouterr().err
    motion, found = gmr.read(walk_path), gmr.read(tmp_path / "walk.amc")
    np.testing.assert_allclose(
        found.positions(dtype=np.float64), motion.positions(dtype=np.float64), rtol=0, atol=1e-9 * 40
    )
    assert found.frame_time == pytest.approx(motion.frame_time, rel=1e-15)
    assert run("convert", walk_path, tmp_path / "alone.asf") == 0
    assert "holds the skeleton alone" in capsys.readouterr().err
    assert gmr.read(tmp_path / "alone.asf").skeleton == found.skeleton


def test_convert_changes_a_folder_of_amc_files(takes: Path, tmp_path: Path, capsys: Captured) -> None:
    assert run("convert", takes, tmp_path / "out", "--fps", "40", "--mirror", "--unit", "m") == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["07_01.amc", "07_01.asf"]
    found = gmr.read(tmp_path / "out" / "07_01.amc")
    wanted = gmr.read(takes / "07_01.amc").mirror().resample(40).to_unit("m")
    np.testing.assert_allclose(found.positions(), wanted.positions(), rtol=0, atol=1e-6)
    assert found.fps == pytest.approx(40)
    assert found.unit == pytest.approx(1)
    assert found.acclaim is not None
    assert found.acclaim.limits["ltibia"] == {"rx": (-10, 170)}
    capsys.readouterr()


def test_an_amc_whose_bones_hang_in_a_chain_is_written_as_bvh(tmp_path: Path) -> None:
    (tmp_path / "arm.asf").write_text(
        ":root\norder TX TY TZ\n:bonedata\n"
        "begin\nname a\ndirection 0 1 0\nlength 2\naxis 5 6 7 XYZ\ndof rx rz\nend\n"
        "begin\nname b\ndirection 1 0 0\nlength 3\naxis 0 0 20 XYZ\ndof ry\nend\n"
        ":hierarchy\nbegin\nroot a\na b\nend\n"
    )
    (tmp_path / "arm.amc").write_text("1\nroot 1 2 3\na 10 20\nb 30\n2\nroot 1 2 4\na 11 22\nb 40\n")
    assert run("convert", tmp_path / "arm.amc", tmp_path / "arm.bvh") == 0
    motion, found = (gmr.read(tmp_path / f"arm.{kind}") for kind in ("amc", "bvh"))
    np.testing.assert_allclose(
        found.positions(dtype=np.float64)[:, :3], motion.positions(dtype=np.float64), rtol=0, atol=1e-9
    )


def test_a_take_of_cmu_is_written_as_bvh_with_every_joint_in_place(takes: Path) -> None:
    assert run("convert", takes / "07_01.amc", takes / "walk.bvh") == 0
    motion, found = gmr.read(takes / "07_01.amc"), gmr.read(takes / "walk.bvh")
    places = found.positions(dtype=np.float64, joints=motion.skeleton.names)
    np.testing.assert_allclose(places, motion.positions(dtype=np.float64), rtol=0, atol=1e-9 * 40)
