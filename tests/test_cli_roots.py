"""``gmr roots`` and ``gmr convert --roots``: the forest shown, and motions written with other roots."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.forest_outline import described, drawn

Captured = pytest.CaptureFixture[str]


def run(*args: str | Path) -> int:
    """The exit code of ``gmr ARGS``, in this process."""
    return finished(command, [str(arg) for arg in args])


def assert_same_places(one: gmr.Motion, other: gmr.Motion) -> None:
    """The joints that the first has are where they are in the second."""
    joints = other.skeleton.indices(one.skeleton.names)
    places = other.positions(dtype=np.float64, joints=joints)
    np.testing.assert_allclose(one.positions(dtype=np.float64), places, rtol=0, atol=1e-9)


def test_a_file_is_shown_as_a_tree_with_its_dummies_marked(walk_path: Path, capsys: Captured) -> None:
    assert run("roots", walk_path) == 0
    page = capsys.readouterr().out.splitlines()
    assert page[0] == "38 joints in 1 tree, 0 soft links, 10 dummies"
    assert page[2] == "Hips  (root)"
    assert page[3] == "├─ LHipJoint* - LeftUpLeg - LeftLeg - LeftFoot - LeftToeBase - LeftToeBase_end"
    assert page[-1] == "*  dummy: of zero length in every frame"


def test_every_joint_stands_once_in_the_outline_of_any_configuration(walk_path: Path) -> None:
    motion = gmr.read(walk_path)
    everywhere = range(motion.skeleton.joint_count)
    for moved in (motion, motion.with_roots(["LeftHand", "Neck"]), motion.with_roots(everywhere)):
        page = drawn(moved).split("\n\n")[1 : 1 + len(moved.roots)]
        words = "\n".join(line.split("  (")[0].strip("│├└─ ") for tree in page for line in tree.splitlines())
        names = [word.rstrip("*^") for line in words.splitlines() for word in line.split(" - ")]
        assert sorted(names) == sorted(motion.skeleton.names)
        told = described(moved)
        assert sorted(name for tree in told["trees"] for name in tree["joints"]) == sorted(names)
        assert told["roots"] == list(moved.roots)


def test_the_outline_tells_soft_links_and_bones_that_were_turned_over(walk_path: Path) -> None:
    motion = gmr.read(walk_path).with_roots(["Neck"]).split("RightForeArm").shift_root("RightHand")
    page = drawn(motion)
    assert "Neck  (root; at home Hips)" in page
    assert "RightHand  (root; soft link RightForeArm ~ RightArm)\n├─ RightForeArm^" in page
    assert "Spine^ - LowerBack^* - Hips^" in page


def test_json_names_roots_links_trees_and_parents(walk_path: Path, tmp_path: Path, capsys: Captured) -> None:
    out = tmp_path / "out.bvh"
    assert run("roots", walk_path, "--set", "Hips, LeftHand", "--out", out, "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert told["roots"] == ["Hips", "LeftHand"]
    assert told["links"] == [{"joint": "LeftHand", "parent": "LeftForeArm"}]
    hand = told["trees"][1]
    assert (hand["root"], hand["joints"][0], len(hand["joints"])) == ("LeftHand", "LeftHand", 6)
    assert {"joint": "LeftHand", "parent": None} in told["parents"]


def test_a_shifted_walk_written_as_bvh_hangs_on_its_neck(walk_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "neck.bvh"
    assert run("roots", walk_path, "--shift", "Neck", "--out", out) == 0
    assert gmr.read(out).roots == ("Neck",)
    assert_same_places(gmr.read(walk_path), gmr.read(out))


def test_convert_chooses_roots_too(walk_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "neck.bvh"
    assert run("convert", walk_path, out, "--roots", "Neck") == 0
    assert gmr.read(out).roots == ("Neck",)
    assert_same_places(gmr.read(walk_path), gmr.read(out))


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (
            ("convert", "{walk}", "{out}.bvh", "--roots", "Hips,Neck"),
            "{out}.bvh: BVH cannot keep 'Neck' as a",
        ),
        (
            ("convert", "{walk}", "{out}.amc", "--roots", "Neck,LeftHand"),
            "AMC cannot keep 'LeftHand' as a root",
        ),
        (("convert", "{walk}", "-", "--roots", "Hips,Neck"), "standard output: BVH cannot keep 'Neck' as a"),
        (
            ("roots", "{walk}", "--split", "Neck,Head", "--out", "{out}.bvh"),
            "keep 'Neck', 'Head' as roots, so",
        ),
        (
            ("convert", "{walk}", "{out}.x3d", "--roots", "Neck", "--unit", "cmu", "--from-unit", "cmu"),
            "X3D cannot keep 'Neck' as a root, so it hangs on its old parent again; .gmr and .gmrb keep it",
        ),
    ],
)
def test_roots_that_a_format_cannot_keep_are_named(
    args: tuple[str, ...], said: str, walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    out = tmp_path / "out"
    assert run(*(arg.format(walk=walk_path, out=out) for arg in args)) == 0
    assert said.format(out=out) in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    "args",
    [("out.bvh", "Hips"), ("out.bvh", "Neck"), ("out.gmr", "Hips,Neck"), ("out.gmrb", "Neck,LeftHand")],
)
def test_nothing_is_said_of_roots_that_are_kept(
    args: tuple[str, str], walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    assert run("convert", walk_path, tmp_path / args[0], "--roots", args[1]) == 0
    assert capsys.readouterr().err == ""
    assert gmr.read(tmp_path / args[0]).roots == tuple(args[1].split(","))


def test_choices_are_followed_in_the_order_that_help_tells(
    walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    out = tmp_path / "out.bvh"
    choices = (
        "--shift",
        "RightHand",
        "--join",
        "LeftHand",
        "--split",
        "RightForeArm",
        "--set",
        "Neck,LeftHand",
    )
    assert run("roots", walk_path, *choices, "--out", out, "--json") == 0
    assert json.loads(capsys.readouterr().out)["roots"] == ["Neck", "RightHand"]


def test_without_a_place_the_motion_goes_beside_its_file_as_gmr(
    walk_path: Path, tmp_path: Path, capsys: Captured
) -> None:
    file = tmp_path / "walk.bvh"
    file.write_bytes(walk_path.read_bytes())
    assert run("roots", file, "--set", "LeftHand,Neck") == 0
    assert "walk.gmr" in capsys.readouterr().err
    found, motion = gmr.read(tmp_path / "walk.gmr"), gmr.read(file)
    assert found.roots == ("Neck", "LeftHand")
    assert_same_places(motion, found)
    assert run("roots", tmp_path / "walk.gmr", "--join", "LeftHand") == 2
    assert "say where to write with --out" in capsys.readouterr().err


def test_roots_are_moved_and_moved_back_in_a_pipeline(walk_path: Path) -> None:
    def piped(data: bytes, *args: str) -> bytes:
        command = [sys.executable, "-m", "gmr", "roots", "-", *args]
        done = subprocess.run(command, input=data, capture_output=True, timeout=60, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    apart = piped(walk_path.read_bytes(), "--split", "LeftHand")
    assert gmr.read(apart).roots == ("Hips", "LeftHand")
    together = gmr.read(piped(apart, "--join", "LeftHand", "--out", "-"))
    assert together.roots == ("Hips",)
    assert_same_places(gmr.read(walk_path), together)


def test_what_is_read_from_standard_input_can_be_shown(walk_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "gmr", "roots", "-", "--json"],
        input=walk_path.read_bytes(), capture_output=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["roots"] == ["Hips"]


@pytest.mark.parametrize(
    ("args", "code", "said"),
    [
        (["--out", "x.bvh"], 2, "nothing to write: choose roots with --set, --split, --join or --shift"),
        (["--set", "Hips,,Neck"], 2, "'Hips,,Neck' has an empty name in it"),
        (["--set", "Neck", "--out", "x.xyz"], 2, "'.xyz' is none that gmr writes"),
        (["--set", "Neck", "--out", "-", "--json"], 2, "the motion goes to standard output"),
        (["--set", "Nekc", "--out", "x.bvh"], 1, "did you mean 'Neck'"),
        (["--join", "Hips", "--out", "x.bvh"], 1, "'Hips' is the last root"),
        (["--split", "Hips", "--out", "x.bvh"], 1, "cmu_07_01.bvh: 'Hips' is a root already"),
    ],
)
def test_what_cannot_be_done_is_said_and_nothing_is_written(
    args: list[str],
    code: int,
    said: str,
    walk_path: Path,
    tmp_path: Path,
    capsys: Captured,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("roots", walk_path.absolute(), *args) == code
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_help_teaches_with_examples(capsys: Captured) -> None:
    assert run("roots", "--help") == 0
    page = capsys.readouterr().out
    assert "gmr roots walk.bvh --set Hips,LeftHand,RightHand" in page
    assert "in this order: set, split, join, shift" in page
