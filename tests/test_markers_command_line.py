"""``gmr info`` and ``gmr convert`` on recordings of markers."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

import gmr
from c3d_files import recorded
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.markers import load_relation
from marker_scene import exchanged, hidden, noisy, worn

pytest.importorskip("ezc3d")

DATA = os.environ.get("GMR_DATA")


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return recorded(tmp_path_factory.mktemp("c3d") / "walk.c3d", noisy(worn(), 0.5))


def run(*arguments: object) -> Result:
    return CliRunner().invoke(command, [str(argument) for argument in arguments])


def test_info_tells_what_is_recorded_and_which_set_fits(walk: Path) -> None:
    done = run("info", walk)
    assert done.exit_code == 0, done.output
    for line in (
        "frames    316 at 120 fps: 2.63 s",
        "markers   56: SNJ, SXS, CV7, TV8, L_IAS, L_IPS and 50 more",
        "unit      0.001 m",
        "up        unknown; the body tells it when it is fitted",
        "gaps      none",
        "set       IOR full body: 56 of 56 markers",
    ):
        assert line in done.output
    assert "odd" not in done.output


def test_standard_input_may_be_a_recording(walk: Path) -> None:
    done = CliRunner().invoke(command, ["info", "-"], input=walk.read_bytes())
    assert done.exit_code == 0, done.output
    assert "markers   56" in done.output


def test_info_names_gaps_flickers_and_exchanges(tmp_path: Path) -> None:
    markers = hidden(hidden(exchanged(worn(), "L_FLE", "L_FME", 40, 60), "CV7", 40, 10), "CV7", 52, 10)
    done = run("info", recorded(tmp_path / "faults.c3d", markers))
    assert "gaps      2, 0.1% of all places; the longest is 'CV7' from frame 40, 10 frames" in done.output
    assert "'CV7' is seen for frames 50 to 51 only" in done.output
    assert "'L_FLE' and 'L_FME' have each other's labels in frames 40 to 99" in done.output


def test_info_as_json_has_all_of_it(tmp_path: Path, walk: Path, walk_path: Path) -> None:
    markers = hidden(worn(), "CV7", 40, 10)
    done = run("info", "--json", recorded(tmp_path / "gap.c3d", markers), walk_path)
    motion, recording = json.loads(done.output)
    assert recording["marker_count"] == 56
    assert recording["up"] is None
    assert recording["gaps"][0]["marker"] == "CV7"
    assert recording["relation"]["name"] == "IOR full body"
    assert motion["joint_count"] == 38


def test_info_takes_a_relation_and_says_what_is_missing(walk: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text(
        '[parts.head]\njoint = "Head"\nmarkers = ["L_HDF", "R_HDF", "L_HDBB"]\n'
        'left = { from = ["R_HDF"], to = ["L_HDF"] }\nforward = { from = ["L_HDBB"], to = ["L_HDF"] }\n'
    )
    done = run("info", walk, "--relation", mine)
    assert "set       mine: 2 of 3 markers, without L_HDBB ('L_HDB', 'R_HDB'?)" in done.output


def test_convert_makes_a_motion_of_markers_and_says_how_well(walk: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "walk.bvh", tmp_path / "walk.svg"
    done = run("convert", walk, out, "--relation", "ior", "--picture", picture)
    assert done.exit_code == 0, done.output
    assert "IOR full body: 15 parts; markers are 0.5 mm off rigid parts in the mean" in done.output
    motion = gmr.read(out)
    assert motion.skeleton.joint_count == 20
    expected = noisy(worn(), 0.5).to_unit("mm").fit("ior").motion
    np.testing.assert_allclose(motion.positions(), expected.positions(), atol=0.05)
    assert picture.read_text().startswith("<svg")


def test_convert_names_markers_of_the_relation_that_are_not_recorded(walk: Path, tmp_path: Path) -> None:
    shipped = Path(gmr.__file__).parent / "data" / "relations" / load_relation("ior").file
    mine = tmp_path / "mine.toml"
    mine.write_text(shipped.read_text().replace("CV7", "XQZ").replace("R_HDF", "R_HDFX"))
    said = run("convert", walk, tmp_path / "walk.bvh", "--relation", mine).stderr
    assert "'R_HDFX' (did you mean 'R_HDF'?), 'XQZ' are not in the recording" in said
    assert "not in the recording" not in run("convert", walk, tmp_path / "walk.bvh").stderr


def test_convert_changes_the_motion_as_any_other(walk: Path, tmp_path: Path) -> None:
    done = run("convert", walk, tmp_path / "walk.bvh", "--fps", "30", "--unit", "m")
    assert done.exit_code == 0, done.output
    motion = gmr.read(tmp_path / "walk.bvh")
    assert motion.fps == pytest.approx(30)
    assert 0.3 < np.linalg.norm(motion.skeleton.offsets[motion.skeleton.index("LeftLeg")]) < 0.5


def test_convert_prints_the_report_as_json(walk: Path, tmp_path: Path) -> None:
    done = run("convert", walk, tmp_path / "walk.bvh", "--json")
    report = json.loads(done.stdout)
    assert report["relation"] == "IOR full body"
    assert {joint["joint"] for joint in report["joints"]} > {"LeftUpLeg", "RightFoot"}


def test_convert_undoes_exchanges_when_asked(tmp_path: Path) -> None:
    path = recorded(tmp_path / "swap.c3d", exchanged(worn(), "L_FLE", "L_FME", 40, 60))
    said = run("convert", path, tmp_path / "wrong.bvh").output
    assert "look for exchanged markers" in said
    said = run("convert", path, tmp_path / "right.bvh", "--undo-swaps").output
    assert "exchange undone: 'L_FLE' and 'L_FME'" in said
    expected = worn().to_unit("mm").fit("ior").motion
    apart = gmr.read(tmp_path / "right.bvh").positions() - expected.positions()
    assert np.abs(apart).max() < 0.05


def test_convert_never_writes_what_was_not_seen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    markers = worn()
    for label in ("L_FLE", "L_FME"):
        markers = hidden(markers, label, 100, 60)
    path, out = recorded(tmp_path / "gap.c3d", markers), tmp_path / "gap.bvh"
    assert finished(command, ["convert", str(path), str(out)]) == 1
    said = capsys.readouterr().err
    assert "'left_thigh' is not seen in frames 100 to 159, nor left_shank in others" in said
    assert "--known-only" in said
    assert not out.exists()
    done = run("convert", path, out, "--known-only")
    assert "frames 160 to 315 are written" in done.output
    assert gmr.read(out).frame_count == 156
    assert run("convert", path, out, "--max-gap", "0.6").exit_code == 0
    assert gmr.read(out).frame_count == 316


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--relation", "rizzoli"], "there is no relation 'rizzoli'"),
        (["--relation", "plug_in_gait"], "no part of 'Plug-in Gait full body' can be fitted"),
        (["--subject", "Anna"], "walk.c3d: no marker is of the subject 'Anna'"),
    ],
)
def test_what_does_not_fit_is_refused_in_a_sentence(
    walk: Path, tmp_path: Path, arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.bvh"
    assert finished(command, ["convert", str(walk), str(out), *arguments]) == 1
    assert said in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--relation", "ior"], "--relation is for recordings of markers (C3D) only, but '{walk}' holds"),
        (["--subject", "Anna"], "a motion; leave it out"),
        (["--max-gap", "0.2"], "--max-gap is for"),
        (["--undo-swaps", "--known-only"], "--undo-swaps, --known-only are for"),
        (["--picture", "{folder}/walk.svg"], "--picture is for"),
    ],
)
@pytest.mark.parametrize("out", ["{folder}/walk.gmr", "-"])
def test_options_for_markers_are_refused_where_there_are_none(
    options: list[str],
    said: str,
    out: str,
    walk_path: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    line = [arg.format(folder=tmp_path) for arg in ("convert", str(walk_path), out, *options)]
    assert finished(command, line) == 2
    assert said.format(walk=walk_path) in " ".join(capsys.readouterr().err.split())
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["walk.png", "walk", "-"])
def test_a_picture_is_an_svg_and_is_called_so(
    name: str, walk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["convert", str(walk), str(tmp_path / "walk.bvh"), "--picture", name]
    assert finished(command, line) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert f"the picture is an SVG; give a name that ends with .svg, not '{name}'" in said
    assert not list(tmp_path.iterdir())


def test_a_relation_that_ships_is_offered_in_the_help() -> None:
    shown = run("convert", "--help").output
    assert load_relation("ior").file.removesuffix(".toml") in shown


@pytest.mark.skipif(DATA is None, reason="GMR_DATA is not set")
@pytest.mark.parametrize("name", ["C3DRotationExample", "Optotrak", "Qualisys", "Vicon"])
def test_info_reads_every_real_file(name: str) -> None:
    done = run("info", Path(DATA or "") / "c3d" / f"{name}.c3d")
    assert done.exit_code == 0, done.output
    assert "frames" in done.output
