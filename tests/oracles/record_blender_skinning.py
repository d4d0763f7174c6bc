"""Records where a real Blender puts the vertices of characters in extreme poses, both ways that it can skin.

Run by hand, with Blender 3.4 or newer on the path, whenever a character is added:

    PYTHONPATH=tests python tests/oracles/record_blender_skinning.py CHARACTER... tests/data/blender/skin

Each joint is turned against its parent by a random angle of up to 179 degrees. For each character it writes
NAME.json: the poses, and about 200 of the vertices with Blender's Armature modifier without (linear) and
with Preserve Volume (dual quaternions), in the axes of the file.
"""

import json
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

import gmr
from blender_skinning import blenders_vertices

FRAMES = 4
KEPT = 200


def random_poses(character, seed):
    rng = np.random.default_rng(seed)
    rest = character.rest_pose()
    parents = character.joint_parents
    poses = np.broadcast_to(rest, (FRAMES, *rest.shape)).copy()
    below = sorted(range(len(rest)), key=lambda joint: depth(parents, joint))
    for frame in range(FRAMES):
        for joint in below:
            axis = rng.normal(size=3)
            angle = np.radians(rng.uniform(0, (30, 90, 150, 179)[frame]))
            turn = np.eye(4)
            turn[:3, :3] = Rotation.from_rotvec(axis / np.linalg.norm(axis) * angle).as_matrix()
            above = parents[joint]
            local = rest[joint] if above < 0 else np.linalg.inv(rest[above]) @ rest[joint]
            poses[frame, joint] = (local if above < 0 else poses[frame, above] @ local) @ turn
    return poses


def depth(parents, joint):
    return 0 if parents[joint] < 0 else 1 + depth(parents, parents[joint])


def main(*arguments):
    *files, folder = (Path(argument) for argument in arguments)
    warnings.simplefilter("ignore", gmr.FormatWarning)
    for file in files:
        character = gmr.read_character(file)
        poses = random_poses(character, seed=7)
        step = max(1, len(character.merged.vertices) // KEPT)
        with tempfile.TemporaryDirectory() as room:
            moving = Path(room) / "moving.glb"
            gmr.write_character(character, moving, poses, 1 / 24)
            found = {
                method: [
                    [[float(f"{x:.9g}") for x in vertex] for vertex in meshes[0][::step]]
                    for meshes in blenders_vertices(moving, 24, range(FRAMES), method, Path(room))
                ]
                for method in ("linear", "volume")
            }
        record = {"file": file.name, "step": step, "poses": poses.tolist(), **found}
        (folder / f"{file.stem}.json").write_text(json.dumps(record) + "\n", encoding="utf-8")


main(*sys.argv[1:])
