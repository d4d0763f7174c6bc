"""``gmr skin``: a motion drives a character from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import figures
import gmr
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.demo import demo_folder
from test_gltf_writing import verdicts

WALK = demo_folder() / "07_01.bvh"
AMC = Path(__file__).parent / "data" / "amc" / "07_01.amc"
Captured = pytest.CaptureFixture[str]


def run(*args: str | Path) -> int:
    """The exit code of ``gmr skin ARGS``, in this process."""
    return finished(command, ["skin", *(str(arg) for arg in args)])


@pytest.fixture
def man(tmp_path: Path) -> Path:
    gmr.write_character(figures.body(), tmp_path / "man.glb")
    return tmp_path / "man.glb"


@pytest.mark.parametrize("motion", [WALK, AMC], ids=["bvh", "amc"])
def test_the_moving_character_is_written_and_said(man: Path, motion: Path, capsys: Captured) -> None:
    out = man.with_name("walking.glb")
    assert run(man, motion, out, "--fps", "30") == 0
    said = capsys.readouterr().out
    for part in ("frames,", "21 joints follow", "'Tail'", "scale: 1.0", "by the legs", "left foot: "):
        assert part in said
    moving = gmr.read_character(out)
    driven = gmr.skinning.drive(gmr.read(motion), gmr.read_character(man), fps=30)
    assert np.allclose(moving.animation(fps=30), driven.poses, atol=1e-5)


def test_the_khronos_validator_accepts_a_moving_character(man: Path) -> None:
    out = man.with_name("walking.glb")
    assert run(man, WALK, out) == 0
    assert [one["errors"] for one in verdicts([out])] == [0]


def test_the_report_as_json(man: Path, capsys: Captured) -> None:
    assert run(man, WALK, man.with_name("walking.glb"), "--json", "--no-ground", "--scale", "2") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["follows"]["LeftUpperArm"] == "LeftArm"
    assert found["unmatched_character"] == ["Tail"]
    assert (found["frames"], found["left_out"]) == (316, 1)
    assert found["scale"] == pytest.approx(2)
    assert [foot["side"] for foot in found["feet"]] == ["left", "right"]


def test_a_map_says_who_follows_whom(man: Path, capsys: Captured) -> None:
    names = man.with_name("names.toml")
    names.write_text('[follows]\nTail = "LThumb"\nHead = ""\n')
    assert run(man, WALK, man.with_name("walking.glb"), "--map", names, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["follows"]["Tail"] == "LThumb"
    assert found["unmatched_character"] == ["Head"]


def test_what_cannot_be_is_one_sentence(man: Path, capsys: Captured) -> None:
    out = man.with_name("walking.gltf")
    assert run(man, WALK, out) == 2
    assert "written as .glb" in capsys.readouterr().err
    rod = figures.character(["rod", "tip"], [-1, 0], np.array([[0.0, 0, 0], [0, 1, 0]]))
    gmr.write_character(rod, man.with_name("rod.glb"))
    assert run(man.with_name("rod.glb"), WALK, man.with_name("walking.glb")) == 1
    said = capsys.readouterr().err
    assert "07_01.bvh" in said
    assert "--map FILE" in said
    assert not man.with_name("walking.glb").exists()


def test_the_comparison_is_written_without_a_moving_character(man: Path, capsys: Captured) -> None:
    pytest.importorskip("pyvista")
    folder = man.with_name("compared")
    assert run(man, WALK, "--fps", "10", "--compare", folder, "--no-film", "--json") == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["page"] == str(folder / "index.html")
    assert "Linear blending loses up to" in captured.err
    assert "07_01" in (folder / "index.html").read_text(encoding="utf-8")
    assert not (folder / "side_by_side.mp4").exists()


@pytest.mark.parametrize(
    ("args", "said"),
    [([], "name OUT.glb, or --compare FOLDER"), (["out.glb", "--no-film"], "the film of --compare")],
)
def test_what_is_asked_for_must_be_said(man: Path, args: list[str], said: str, capsys: Captured) -> None:
    assert run(man, WALK, *args) == 2
    assert said in capsys.readouterr().err


def test_a_mesh_without_a_skin_is_bound_to_the_motion(tmp_path: Path, capsys: Captured) -> None:
    motion = gmr.read(WALK).with_unit("cmu").to_unit("m")
    skeleton = motion.skeleton
    places = np.zeros((skeleton.joint_count, 3))
    for joint in skeleton.parents_first[1:]:
        places[joint] = places[skeleton.parents[joint]] + skeleton.offsets[joint]
    mesh = figures.character(skeleton.names, skeleton.parents.tolist(), places).merged
    faces = figures.character(skeleton.names, skeleton.parents.tolist(), places).faces + 1
    lines = [f"v {x} {y} {z}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in faces.tolist()]
    (tmp_path / "body.obj").write_text("\n".join(lines) + "\n")
    out = tmp_path / "walking.glb"
    assert run(tmp_path / "body.obj", WALK, out, "--bind", "--no-ground", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert "names, which are the same" in found["matched_by"]
    assert found["scale"] == pytest.approx(1)
    moving = gmr.read_character(out)
    joints = ["Hips", "Head", "LeftHand", "RightToeBase"]
    there = moving.animation(fps=120)[:, [moving.joint_names.index(name) for name in joints]][..., :3, 3]
    assert np.allclose(there, motion[1:].positions(joints=joints, dtype=np.float64), atol=1e-4)
