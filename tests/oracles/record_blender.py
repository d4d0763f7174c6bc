"""Records where a real Blender puts the joints and the bones of BVH files.

Run by hand, with Blender 3.4 or newer on the path, whenever a file is added:

    cd tests/data/blender
    blender --background --factory-startup --python ../../oracles/record_blender.py -- \\
        *.bvh ../cmu_07_01.bvh ../../../python/gmr/data/demo/09_01.bvh .

For each file it writes FILE.json into the folder named last: heads and tails of all bones at rest and in a
few frames, turned back from Blender's Z-up to the file's Y-up, ``(x, y, z) = (X, Z, -Y)``, in the nine digits
that tell a float32.
"""

import json
import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
from blender_bvh import import_bvh, pose_bones

FRAMES = 5


def to_file_axes(vector):
    return [float(f"{value:.9g}") for value in (vector.x, vector.z, -vector.y)]


def record(file):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    armature, count = import_bvh(file)
    frames = sorted({round(i * (count - 1) / (FRAMES - 1)) for i in range(FRAMES)})
    poses = [pose_bones(armature, frame) for frame in frames]
    world, bones = armature.matrix_world, armature.data.bones
    return {
        "blender": bpy.app.version_string,
        "file": file.name,
        "joints": [bone.name for bone in armature.pose.bones],
        "frames": frames,
        "heads": [[to_file_axes(head) for head in heads] for _, heads, _ in poses],
        "tails": [[to_file_axes(tail) for tail in tails] for _, _, tails in poses],
        "rest_heads": [to_file_axes(world @ bone.head_local) for bone in bones],
        "rest_tails": [to_file_axes(world @ bone.tail_local) for bone in bones],
    }


def main(arguments):
    *files, folder = (Path(argument) for argument in arguments)
    for file in files:
        text = json.dumps(record(file), indent=1)
        (folder / f"{file.stem}.json").write_text(text + "\n", encoding="utf-8")


main(sys.argv[sys.argv.index("--") + 1 :])
