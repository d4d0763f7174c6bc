"""A motion that is written as .glb comes back, and others play it as it is."""

from __future__ import annotations

import json
import shutil
import subprocess
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from numpy.typing import NDArray

import gmr
from gmr import FormatError, FormatWarning, quaternions
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.demo import demo_folder
from gmr.formats.gltf_motion_writer import glb_of_motion
from gmr.skeleton import End
from strategies import motions
from test_gltf_writing import verdicts

WALK = demo_folder() / "07_01.bvh"
AMC = sorted((Path(__file__).parent / "data" / "amc").glob("*.amc"))[0]
SCRIPT = Path(__file__).parent / "oracles" / "nodes_blender.py"
METRES = 0.0254 / 0.45

Floats = NDArray[np.float64]


def written(motion: gmr.Motion, folder: Path) -> gmr.Motion:
    gmr.write(motion, folder / "motion.glb")
    return gmr.read(folder / "motion.glb")


def places(motion: gmr.Motion, names: list[str]) -> Floats:
    return np.asarray(motion.positions(joints=names, dtype=np.float64)) * (motion.unit or 1.0)


def proper(motion: gmr.Motion) -> list[str]:
    """Names of the motion's joints that a .glb has: all but tips, and but dummies that come in."""
    own = motion.skeleton
    return [name for name, end in zip(own.names, own.ends, strict=True) if end != End.TIP]


def assert_same_places(again: gmr.Motion, motion: gmr.Motion) -> None:
    names = proper(motion)
    wanted = places(motion, names)
    extent = max(float(np.ptp(wanted, axis=(0, 1)).max()), float(np.abs(wanted).max()), 1e-3)
    assert again.unit == 1
    np.testing.assert_allclose(places(again, names), wanted, rtol=0, atol=1e-5 * extent)


@given(motions(min_frames=2))
def test_a_motion_comes_back_where_it_was(motion: gmr.Motion) -> None:
    known = motion.with_unit(motion.unit or 0.01)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)  # which way is up may be guessed of a random tree
        again = gmr.read(b"".join(glb_of_motion(known)))
    assert again.frame_count == known.frame_count
    assert again.frame_time == pytest.approx(known.frame_time, rel=1e-3)
    assert_same_places(again, known)


@pytest.mark.parametrize("file", [WALK, AMC], ids=["bvh", "amc"])
def test_a_real_motion_comes_back_where_it_was(file: Path, tmp_path: Path) -> None:
    motion = gmr.read(file).with_unit("cmu")
    again = written(motion, tmp_path)
    assert again.frame_count == motion.frame_count
    assert again.fps == pytest.approx(motion.fps)
    assert_same_places(again, motion)


def test_several_roots_and_dropped_dummies_come_back_where_they_were(tmp_path: Path) -> None:
    motion = gmr.read(WALK).with_unit("cmu")
    for changed in (motion.with_roots(["Hips", "LeftFoot"]), motion.drop_dummies()):
        assert_same_places(written(changed, tmp_path), changed)


def test_what_does_not_move_has_a_key_at_each_end(tmp_path: Path) -> None:
    motion = gmr.read(WALK).with_unit("cmu")
    gmr.write(motion, tmp_path / "walk.glb")
    (clip,) = gmr.read_character(tmp_path / "walk.glb").animations
    keys = {len(channel.times) for channel in clip.channels}
    assert keys == {2, motion.frame_count}
    assert clip.name == "07_01"


def test_an_unknown_unit_is_guessed_and_said(tmp_path: Path) -> None:
    motion = gmr.read(WALK)
    with pytest.warns(FormatWarning, match="taken for cmu"):
        again = written(motion, tmp_path)
    assert_same_places(again, motion.with_unit(METRES))


def test_z_up_is_turned_and_said(tmp_path: Path) -> None:
    walk = gmr.read(WALK).with_unit("cmu")
    turn = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    rotations = walk.rotations.copy()
    slot = walk.skeleton.slots[walk.skeleton.children[walk.skeleton.roots[0]][0]]
    rotations[:, slot] = quaternions.multiply(turn, rotations[:, slot])
    lying = gmr.Motion.from_pose(
        walk.skeleton,
        rotations,
        quaternions.rotated(turn, walk.translations),
        walk.frame_time,
        unit=walk.unit,
    )
    with pytest.warns(FormatWarning, match=r"\+Z is up"):
        again = written(lying, tmp_path)
    assert_same_places(again, walk)


def broken(kind: str) -> gmr.Motion:
    walk = gmr.read(WALK).with_unit("cmu")
    rotations = walk.rotations.copy()
    if kind == "nan":
        rotations[7] = np.nan
        return gmr.Motion.from_pose(walk.skeleton, rotations, walk.translations, walk.frame_time)
    return walk[:0] if kind == "empty" else replace(walk, frame_time=0.0)


@pytest.mark.parametrize(
    ("kind", "said"), [("nan", "frame 7 holds NaN"), ("empty", "no frames"), ("timeless", "take no time")]
)
def test_what_a_glb_cannot_say_is_refused(kind: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=said):
        gmr.write(broken(kind), tmp_path / "out.glb")
    assert not list(tmp_path.iterdir())


def test_a_body_that_tells_no_unit_is_refused(tmp_path: Path) -> None:
    dot = gmr.Skeleton.post_rotation(["dot"], [-1], [(0, 0, 0)])
    still = gmr.Motion.from_pose(dot, np.zeros((2, 0, 4)), np.zeros((2, 1, 3)), 0.1)
    with pytest.raises(FormatError, match="declare it"):
        gmr.write(still, tmp_path / "out.glb")


def test_the_khronos_validator_accepts_motions(tmp_path: Path) -> None:
    motion = gmr.read(WALK).with_unit("cmu")
    made = {
        "bvh": motion,
        "amc": gmr.read(AMC),
        "one": motion[5:6],
        "roots": motion.with_roots(["Hips", "Head"]),
    }
    files = [tmp_path / f"{name}.glb" for name in made]
    for one, file in zip(made.values(), files, strict=True):
        gmr.write(one, file)
    found = verdicts(files)
    assert len(found) == len(files)
    assert [one for one in found if one["errors"]] == []


@pytest.mark.skipif(shutil.which("blender") is None, reason="needs blender on the path")
@pytest.mark.parametrize("file", [WALK, AMC], ids=["bvh", "amc"])
def test_blender_puts_the_nodes_where_the_joints_are(file: Path, tmp_path: Path) -> None:
    motion = gmr.read(file).with_unit("cmu")
    gmr.write(motion, tmp_path / "walk.glb")
    frames = [0, motion.frame_count // 2, motion.frame_count - 1]
    found = in_blender(tmp_path / "walk.glb", round(motion.fps), frames, tmp_path)
    names = proper(motion)
    assert set(names) <= set(found[0])
    wanted = places(motion, names)[frames]
    theirs = np.array([[one[name] for name in names] for one in found])
    np.testing.assert_allclose(theirs, wanted, rtol=0, atol=1e-5 * np.ptp(wanted, axis=(0, 1)).max())


def in_blender(file: Path, fps: int, frames: list[int], folder: Path) -> list[dict[str, Any]]:
    """By frame the places of the nodes by name."""
    out = folder / "places.json"
    # Blender's glTF importer needs NumPy, which Debian's Blender lacks.
    packages = Path(np.__file__).parent.parent
    options = ["--background", "--factory-startup", "--python-exit-code", "1"]
    command_line = ["blender", *options, "--python", SCRIPT, "--", file, out, fps, packages, *frames]
    done = subprocess.run(
        list(map(str, command_line)), capture_output=True, text=True, timeout=300, check=False
    )
    if "numpy" in done.stdout + done.stderr and not out.exists():
        pytest.skip("Blender's Python is another than the one that has NumPy here")
    assert done.returncode == 0, done.stderr
    found: dict[str, dict[str, Any]] = json.loads(out.read_text())
    return [found[str(frame)] for frame in frames]


def test_the_command_line_writes_glb_and_says_the_guess(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert finished(command, ["convert", str(WALK), str(tmp_path / "walk.glb")]) == 0
    assert "taken to be in cmu" in capsys.readouterr().err
    assert gmr.read(tmp_path / "walk.glb").unit == 1
