"""Plays a glTF file without a mesh in a real Blender and writes where its nodes are.

    blender --background --factory-startup --python-exit-code 1 --python tests/oracles/nodes_blender.py -- \\
        FILE.glb OUT.json FPS NUMPY FRAME...

OUT.json maps each frame (counted from 0, FPS a second) to the places of the nodes by name, in the axes of the
file: Blender's Z-up is turned back, ``(x, y, z) = (X, Z, -Y)``. NUMPY as for skin_blender.py.
"""

import json
import sys
from pathlib import Path

import bpy


def main(file, out, fps, packages, *frames):
    sys.path.append(packages)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = int(fps)
    bpy.ops.import_scene.gltf(filepath=file)
    Path(out).write_text(json.dumps({frame: places(int(frame)) for frame in frames}), encoding="utf-8")


def places(frame):
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    found = {thing.name: thing.evaluated_get(graph).matrix_world.translation for thing in bpy.data.objects}
    return {name: (place.x, place.z, -place.y) for name, place in found.items()}


main(*sys.argv[sys.argv.index("--") + 1 :])
