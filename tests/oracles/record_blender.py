"""Records where a real Blender puts the joints and the bones of BVH files.

Run by hand, with Blender 3.4 or newer on the path, whenever a file is added:

    cd tests/data/blender
    blender --background --factory-startup --python ../../oracles/record_blender.py -- \\
        *.bvh ../cmu_07_01.bvh ../../../python/gmr/data/demo/09_01.bvh .

For each file it writes FILE.json into the folder named last: heads and tails of all bones at rest and in a
few frames, turned back from Blender's Z-up to the file's Y-up, ``(x, y, z) = (X, Z, -Y)``, in the nine digits
that tell a float32.
"""

import builtins
import json
import sys
from pathlib import Path

import bpy

FRAMES = 5


def open_without_universal_newlines(file, mode="r", *args, **kwargs):
    """The importer of Blender 3.4 asks for the mode "rU", which Python 3.11 no longer has."""
    return original_open(file, mode.replace("U", ""), *args, **kwargs)


original_open = builtins.open
builtins.open = open_without_universal_newlines


def to_file_axes(vector):
    return [float(f"{value:.9g}") for value in (vector.x, vector.z, -vector.y)]


def record(file):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_anim.bvh(filepath=str(file), update_scene_duration=True, rotate_mode="NATIVE")
    armature = bpy.context.object
    world = armature.matrix_world
    count = int(armature.animation_data.action.frame_range[1])
    frames = sorted({round(i * (count - 1) / (FRAMES - 1)) for i in range(FRAMES)})
    heads, tails = [], []
    for frame in frames:
        bpy.context.scene.frame_set(frame + 1)
        heads.append([to_file_axes(world @ bone.head) for bone in armature.pose.bones])
        tails.append([to_file_axes(world @ bone.tail) for bone in armature.pose.bones])
    return {
        "blender": bpy.app.version_string,
        "file": file.name,
        "joints": [bone.name for bone in armature.pose.bones],
        "frames": frames,
        "heads": heads,
        "tails": tails,
        "rest_heads": [to_file_axes(world @ bone.head_local) for bone in armature.data.bones],
        "rest_tails": [to_file_axes(world @ bone.tail_local) for bone in armature.data.bones],
    }


def main(arguments):
    *files, folder = (Path(argument) for argument in arguments)
    for file in files:
        text = json.dumps(record(file), indent=1)
        (folder / f"{file.stem}.json").write_text(text + "\n", encoding="utf-8")


main(sys.argv[sys.argv.index("--") + 1 :])
