"""``gmr info`` and ``gmr convert`` on files of characters."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import gmr
from gltf_files import arm
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished

RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"
Captured = pytest.CaptureFixture[str]


def run(*args: str | Path) -> int:
    """The exit code of ``gmr ARGS``, in this process."""
    return finished(command, [str(arg) for arg in args])


def test_info_tells_what_a_character_is_made_of(capsys: Captured) -> None:
    assert run("info", RIGGED) == 0
    page = capsys.readouterr().out
    assert "2 of 5 nodes; roots: Bone" in page
    assert "1: 'Cylinder'; 160 vertices, 188 triangles in 1 parts" in page
    assert "1 skin, up to 2 joints a vertex" in page
    assert "'animation_0', 2.04 s, keys at 24 fps; channels: linear (3)" in page


def test_info_as_json_and_what_is_odd(tmp_path: Path, capsys: Captured) -> None:
    file = arm()
    file.content["meshes"][0]["primitives"][0]["targets"] = [{}]
    (tmp_path / "arm.glb").write_bytes(file.glb())
    assert run("info", "--json", tmp_path / "arm.glb") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["joints"] == ["upper", "lower", "hand"]
    assert found["animations"][0]["interpolation"] == {"LINEAR": 2}
    assert any("morph targets" in oddity for oddity in found["oddities"])
    assert run("info", "--strict", tmp_path / "arm.glb") == 1


def test_the_motion_of_a_character_is_converted(tmp_path: Path) -> None:
    file = arm()
    clip = file.content["animations"][0]
    file.content["animations"].append({**clip, "name": "other", "channels": clip["channels"][:1]})
    (tmp_path / "arm.glb").write_bytes(file.glb())
    assert run("convert", tmp_path / "arm.glb", tmp_path / "arm.bvh", "--animation", "other") == 0
    motion = gmr.read(tmp_path / "arm.bvh")
    expected = gmr.read(tmp_path / "arm.glb", animation="other")
    assert motion.skeleton.names[:3] == ("upper", "lower", "hand")
    joints = ["upper", "lower", "hand"]
    difference = motion.positions(joints=joints, dtype=float) - expected.positions(joints=joints, dtype=float)
    assert abs(difference).max() < 1e-9


def test_an_animation_that_is_not_there_is_one_sentence(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "arm.glb").write_bytes(arm().glb())
    assert run("convert", tmp_path / "arm.glb", tmp_path / "arm.bvh", "--animation", "run") == 1
    assert "there is no animation 'run'; there are 'wave'" in capsys.readouterr().err
