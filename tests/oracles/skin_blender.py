"""Skins a glTF file in a real Blender and writes where its vertices are.

    blender --background --factory-startup --python-exit-code 1 --python tests/oracles/skin_blender.py -- \\
        FILE.glb OUT.json FPS NUMPY METHOD FRAME...

METHOD is linear, or volume for Blender's Preserve Volume (dual quaternions). OUT.json maps each frame
(counted from 0, FPS a second) to a list of meshes, each a list of vertices in the axes of the file: Blender's
Z-up is turned back, ``(x, y, z) = (X, Z, -Y)``. NUMPY is the folder that holds the package numpy for
Blender's Python, which its glTF importer needs and Debian's Blender lacks.
"""

import json
import sys
from pathlib import Path

import bpy


def main(file, out, fps, packages, method, *frames):
    sys.path.append(packages)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = int(fps)
    bpy.ops.import_scene.gltf(filepath=file)
    for modifier in (modifier for thing in bpy.data.objects for modifier in thing.modifiers):
        modifier.use_deform_preserve_volume = method == "volume"
    found = {frame: meshes(int(frame)) for frame in frames}
    Path(out).write_text(json.dumps(found), encoding="utf-8")


def meshes(frame):
    """The vertices of every mesh that an armature moves, in the order of their names."""
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    skinned = [thing for thing in bpy.data.objects if thing.type == "MESH" and thing.find_armature()]
    return [vertices(thing.evaluated_get(graph)) for thing in sorted(skinned, key=lambda thing: thing.name)]


def vertices(thing):
    world = [thing.matrix_world @ vertex.co for vertex in thing.data.vertices]
    return [(place.x, place.z, -place.y) for place in world]


main(*sys.argv[sys.argv.index("--") + 1 :])
