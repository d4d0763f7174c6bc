"""Characters read from glTF stand where the standard says."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gmr
from gltf_files import FACES, POINTS, WEIGHTS, arm, inverse_binds
from gmr import Character, FormatWarning, GmrError
from gmr.quaternions import matrices
from gmr.skinning import Part
from lbs_oracle import blended, json_of, world_matrix

GMR_DATA = Path(os.environ.get("GMR_DATA", "/nowhere")) / "gltf"
RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"
FILES = [RIGGED, *(GMR_DATA / name for name in ("cesium_man.gltf", "fox.glb"))]


def quietly(path: Path) -> Character:
    if not path.exists():
        pytest.skip("needs GMR_DATA")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        return gmr.read_character(path)


def test_a_handmade_arm_is_read_as_it_was_made() -> None:
    character = gmr.read_character(arm().glb())
    (part,) = character.parts
    assert character.joint_names == ("upper", "lower", "hand")
    assert character.joint_parents.tolist() == [-1, 0, 1]
    assert np.array_equal(part.vertices, POINTS)
    assert np.array_equal(part.faces, FACES)
    assert np.array_equal(part.weights, WEIGHTS)
    assert np.array_equal(part.joints[:, :3], np.tile([0, 1, 2], (6, 1)))
    assert part.inverse_bind is not None
    assert np.array_equal(part.inverse_bind, inverse_binds())
    assert part.texture_coordinates is not None
    assert character.materials[0].base_color == (0.5, 0.25, 1, 1)
    assert np.array_equal(character.faces, FACES)


def test_text_and_binary_hold_the_same() -> None:
    one, other = (gmr.read_character(data) for data in (arm().glb(), arm().gltf()))
    assert np.array_equal(one.parts[0].vertices, other.parts[0].vertices)
    assert np.array_equal(one.animation(), other.animation())


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_joints_at_rest_are_where_the_standard_puts_them(file: Path) -> None:
    character = quietly(file)
    nodes = json_of(file.read_bytes())["nodes"]
    expected = [world_matrix(nodes, node) for node in character.joints.tolist()]
    assert np.allclose(character.rest_pose(), expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_skinning_ignores_the_node_of_the_mesh_and_heeds_what_the_joints_hang_on() -> None:
    file = arm()
    nodes = file.content["nodes"]
    world = np.array([world_matrix(nodes, k) for k in (2, 3, 4)])
    expected = np.zeros((6, 3))
    for vertex in range(6):
        for k in range(3):
            matrix = world[k] @ inverse_binds()[k]
            expected[vertex] += WEIGHTS[vertex, k] * (matrix @ [*POINTS[vertex], 1])[:3]
    character = gmr.read_character(file.glb())
    assert np.allclose(character.skin(character.rest_pose())[0], expected, rtol=0, atol=1e-6)
    assert character.skin(np.tile(character.rest_pose(), (4, 1, 1, 1))).shape == (4, 6, 3)


def part_blended(part: Part, poses: Any) -> Any:
    """The vertices of a part by the definition."""
    assert part.inverse_bind is not None
    return blended(part.vertices, part.joints, part.weights, poses @ part.inverse_bind)


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_skinning_a_real_file_is_what_the_standard_defines(file: Path) -> None:
    character = quietly(file)
    poses = character.animation()[::5]
    part = character.parts[0]
    expected = part_blended(part, poses)
    extent = np.ptp(expected, axis=(0, 1)).max()
    assert np.allclose(character.skin(poses), expected, rtol=0, atol=1e-6 * extent)
    assert character.skin(poses, "dqbs").shape == expected.shape


def test_parts_with_other_skins_are_skinned_in_order() -> None:
    import random_characters

    seen = 0
    for seed in range(30):
        character = random_characters.character(seed)
        if not character.skinned_parts:
            continue
        poses = np.random.default_rng(seed).normal(size=(2, len(character.joints), 4, 4))
        poses[:, :, 3] = (0, 0, 0, 1)
        each = [part_blended(part, poses) for part in character.skinned_parts]
        assert np.allclose(character.skin(poses), np.concatenate(each, axis=1), atol=1e-4)
        seen += len(each) > 1
    assert seen > 5


def test_poses_of_another_shape_and_normals_that_are_not_there_are_refused() -> None:
    character = gmr.read_character(arm().glb())
    with pytest.raises(GmrError, match=r"must be \(frames, 3, 4, 4\)"):
        character.skin(np.zeros((2, 4, 4, 4)))
    with pytest.raises(GmrError, match="parts without normals"):
        character.skin(character.rest_pose(), normals=True)


def test_normals_turn_with_what_carries_them() -> None:
    character = gmr.read_character(RIGGED)
    places, normals = character.skin(character.animation()[[0, 20]], normals=True)
    a, b, c = (places[1][character.faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    sides = (across[:, None] * normals[1][character.faces]).sum(axis=2)
    assert (sides > -0.1 * np.linalg.norm(across, axis=1)[:, None]).mean() > 0.99


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_the_motion_has_the_places_and_the_turns_of_the_joints(file: Path) -> None:
    character = quietly(file)
    poses = character.animation()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        motion = gmr.read(file)
    count = len(character.joints)
    size = np.abs(poses[..., :3, 3]).max()
    assert motion.skeleton.names[:count] == character.joint_names
    assert motion.unit == 1
    assert np.allclose(motion.positions(dtype=float)[:, :count], poses[..., :3, 3], rtol=0, atol=2e-6 * size)
    turns = matrices(motion.joint_rotations(dtype=float)[:, :count])
    rest = character.rest_pose()[:, :3, :3]
    assert np.allclose(turns @ rest, poses[..., :3, :3], rtol=0, atol=1e-5)


def test_the_motion_of_an_arm_under_a_scaled_and_turned_node() -> None:
    motion = gmr.read(arm().glb(), fps=2)
    assert motion.frame_count == 5
    # At 0.5 s: upper is at (1, 0.5, 0) in a frame that is turned by -90 degrees about x and twice as large.
    places = motion.positions(joints=["upper", "lower", "hand"], dtype=float)[1]
    down = Rotation.from_euler("x", -90, degrees=True)
    hand = np.array([1, 1.5, 0]) + Rotation.from_euler("z", 60, degrees=True).apply([0, 1, 0])
    assert np.allclose(places, 2 * down.apply([[1, 0.5, 0], [1, 1.5, 0], hand]), atol=1e-6)


def test_the_skeleton_at_rest_has_world_offsets() -> None:
    character = gmr.read_character(arm().glb())
    skeleton = character.skeleton
    places = skeleton.offsets.cumsum(axis=0)  # one joint hangs on the other
    assert np.allclose(places, character.rest_pose()[:, :3, 3])
    assert np.allclose(skeleton.offsets[1], [0, 0, -2])
