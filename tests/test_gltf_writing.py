"""A character that is written comes back, and the Khronos glTF-Validator has nothing against the file."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import warnings
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
import random_characters
from gltf_files import arm
from gmr import Character, FormatError, FormatWarning, GmrError
from gmr.formats.gltf_writer import glb_pieces
from gmr.skinning import Animation, Nodes, Part, Texture
from gmr.skinning.transforms import local_matrices

ROOT = Path(__file__).parent.parent
NODE_MODULES = ROOT / ".node" / "node_modules"
GMR_DATA = Path(os.environ.get("GMR_DATA", "/nowhere")) / "gltf"
RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"
FILES = [RIGGED, *(GMR_DATA / name for name in ("cesium_man.gltf", "fox.glb"))]
seeds = st.integers(0, 2**32)


def quietly(path: Path) -> Character:
    if not path.exists():
        pytest.skip("needs GMR_DATA")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        return gmr.read_character(path)


def written(character: Character, **options: Any) -> Character:
    return gmr.read_character(b"".join(glb_pieces(character, **options)))


def assert_same(one: Any, other: Any) -> None:
    """Equal, whatever it is made of; arrays bit by bit."""
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype
        assert np.array_equal(one, other)
    elif isinstance(one, tuple):
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    elif isinstance(one, Character | Part | Nodes | Animation):
        for field in fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name))
    elif isinstance(one, dict):
        assert_same(tuple(one.items()), tuple(other.items()))
    elif isinstance(one, gmr.skinning.Channel):
        for field in fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name))
    else:
        assert one == other


@given(seeds)
def test_a_character_comes_back_as_it_was(seed: int) -> None:
    character = random_characters.character(seed)
    if not any(part.is_skinned for part in character.parts):
        return  # without a skin, what moves are the joints
    assert_same(written(character), character)


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_a_real_file_comes_back_as_it_was(file: Path, tmp_path: Path) -> None:
    character = quietly(file)
    gmr.write_character(character, tmp_path / "again.glb")
    again = gmr.read_character(tmp_path / "again.glb")
    assert_same(again, character)


def rigid_poses(character: Character, rng: np.random.Generator, count: int) -> Any:
    """(F, J, 4, 4) turned and moved at will, with the scale that the joints have at rest."""
    turns = random_characters.turns(rng, count * len(character.joints)).astype(np.float64)
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    made = local_matrices(rng.normal(size=(len(turns), 3)), turns, np.ones((len(turns), 3)))
    return made.reshape(count, -1, 4, 4)


@given(seeds)
def test_poses_play_as_they_were_given(seed: int) -> None:
    rng = np.random.default_rng(seed)
    character = gmr.read_character(arm().glb())
    poses = rigid_poses(character, rng, 5)
    again = written(character, poses=poses, frame_time=0.125)
    assert [clip.name for clip in again.animations] == ["poses"]
    assert again.animations[0].fps == 30  # eight keys a second are far apart
    assert np.allclose(again.animation(fps=8), poses, atol=2e-6)


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_the_animation_of_a_real_file_plays_the_same_as_poses(file: Path) -> None:
    character = quietly(file)
    poses = character.animation()
    again = written(character, poses=poses, frame_time=1 / 24)
    size = np.abs(poses).max()
    assert np.allclose(again.animation(), poses, rtol=0, atol=4e-6 * size)


def test_written_quaternions_take_the_short_way() -> None:
    character = gmr.read_character(arm().glb())
    again = written(character, poses=character.animation(fps=7), frame_time=1 / 7)
    for channel in again.animations[0].channels:
        if channel.path == "rotation":
            assert ((channel.values[1:] * channel.values[:-1]).sum(axis=1) >= 0).all()


def test_poses_with_scale_get_channels_of_scale() -> None:
    character = gmr.read_character(arm().glb())
    poses = np.tile(character.rest_pose(), (3, 1, 1, 1))
    poses[1, :, :3, :3] *= 1.5
    again = written(character, poses=poses, frame_time=0.05)
    assert {channel.path for channel in again.animations[0].channels} >= {"scale"}
    assert np.allclose(again.animation(fps=20), poses, atol=1e-6)


def test_poses_that_need_shear_are_refused() -> None:
    character = gmr.read_character(arm().glb())
    poses = np.tile(character.rest_pose(), (2, 1, 1, 1))
    poses[1, 0, :3, :3] = poses[1, 0, :3, :3] @ np.diag([1, 3, 1])  # what hangs on it stays as it was
    with pytest.raises(GmrError, match="'lower' would be sheared in frame 1"):
        glb_pieces(character, poses, 0.1)


@pytest.mark.parametrize(
    ("poses", "frame_time", "said"),
    [
        (np.zeros((2, 4, 4, 4)), 0.1, "must be"),
        (np.full((2, 3, 4, 4), np.nan), 0.1, "not finite"),
        (np.zeros((2, 3, 4, 4)), None, "frame_time="),
        (np.zeros((2, 3, 4, 4)), 0.0, "frame_time="),
    ],
)
def test_poses_that_do_not_fit_are_refused(poses: Any, frame_time: Any, said: str) -> None:
    with pytest.raises(GmrError, match=said):
        glb_pieces(gmr.read_character(arm().glb()), poses, frame_time)


def test_a_character_is_written_as_glb_only(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"\.glb"):
        gmr.write_character(gmr.read_character(arm().glb()), tmp_path / "arm.gltf")
    assert not list(tmp_path.iterdir())


def test_a_picture_that_glb_cannot_hold_is_left_out_with_a_warning() -> None:
    character = replace(gmr.read_character(arm().glb()), textures=(Texture(b"BM...", "image/bmp", "hair"),))
    with pytest.warns(FormatWarning, match="'hair' is image/bmp"):
        glb_pieces(character)


def test_factors_outside_of_0_to_1_are_cut_with_a_warning() -> None:
    character = gmr.read_character(arm().glb())
    bright = replace(character.materials[0], emissive=(3.0, 0.5, 0.0))
    with pytest.warns(FormatWarning, match=r"emissive \(3.0, 0.5, 0.0\); it is cut"):
        again = written(replace(character, materials=(bright,)))
    assert again.materials[0].emissive == (1, 0.5, 0)


def odd_character() -> Character:
    """What a .glb cannot hold as it is: normals without length, weights at one joint twice, two roots."""
    arm_character = gmr.read_character(arm().glb())
    (part,) = arm_character.parts
    nodes = arm_character.nodes
    loose = Nodes(
        (*nodes.names, "loose"),
        np.append(nodes.parents, np.int32(-1)),
        np.vstack([nodes.translations, [1, 2, 3]]),
        np.vstack([nodes.rotations, [0, 0, 0, 1]]),
        np.vstack([nodes.scales, [1, 1, 1]]),
    )
    assert part.inverse_bind is not None
    bent = replace(
        part,
        normals=np.array([[0, 0, 0], [0, 0, 3], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 0]], np.float32),
        joints=np.zeros_like(part.joints) + 3,
        inverse_bind=np.concatenate([part.inverse_bind, np.eye(4)[None]]),
        node=-1,
    )
    return Character("odd", loose, np.array([2, 3, 4, 5], np.int32), (bent,), arm_character.materials)


def verdicts(files: list[Path]) -> list[dict[str, Any]]:
    """What the validator says of each file."""
    if shutil.which("node") is None or not (NODE_MODULES / "gltf-validator").is_dir():
        reason = "needs Node and the package gltf-validator in .node/ (make develop)"
        if os.environ.get("CI"):
            pytest.fail(f"{reason}; on CI written files must be validated")
        pytest.skip(reason)
    script = ROOT / "tests" / "oracles" / "validate_gltf.cjs"
    done = subprocess.run(
        ["node", str(script), *map(str, files)],
        env={**os.environ, "NODE_PATH": str(NODE_MODULES)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_the_khronos_validator_accepts_what_is_written(tmp_path: Path) -> None:
    characters = [random_characters.character(seed) for seed in range(80)]
    characters += [gmr.read_character(arm().glb()), gmr.read_character(RIGGED)]
    files = [tmp_path / f"{k}.glb" for k in range(len(characters))]
    for character, file in zip(characters, files, strict=True):
        gmr.write_character(character, file)
    with pytest.warns(FormatWarning, match="1 normals of length 0"):
        gmr.write_character(odd_character(), tmp_path / "odd.glb")
    moving = gmr.read_character(RIGGED)
    gmr.write_character(moving, tmp_path / "poses.glb", moving.animation(fps=60), 1 / 60)
    walk = gmr.read(ROOT / "tests" / "data" / "cmu_07_01.bvh").with_unit("cm")
    gmr.write(walk, tmp_path / "motion.glb")
    files += [tmp_path / name for name in ("odd.glb", "poses.glb", "motion.glb")]
    found = verdicts(files)
    assert len(found) == len(files)
    assert [one for one in found if one["errors"]] == []


def test_the_validator_finds_errors_where_there_are_some(tmp_path: Path) -> None:
    file = arm()
    file.content["accessors"][0]["max"] = [9, 9, 9]
    (tmp_path / "wrong.glb").write_bytes(file.glb())
    (verdict,) = verdicts([tmp_path / "wrong.glb"])
    assert verdict["errors"] > 0


def test_what_had_to_be_mended_is_the_same_character() -> None:
    character = odd_character()
    with pytest.warns(FormatWarning, match="normals of length 0"):
        again = written(character)
    (part,) = again.parts
    assert ((part.joints == 3) & (part.weights == 1)).sum(axis=1).tolist() == [1] * 6
    assert np.allclose(again.rest_pose(), character.rest_pose())
    assert again.parts[0].normals is not None
    assert np.allclose(np.linalg.norm(again.parts[0].normals, axis=1), 1)
