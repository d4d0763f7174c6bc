"""Shows BVH files in a real Blender, side by side, and measures how far apart they are.

For comparing by eye and by number a file with what an operation made of it. Run by hand, with Blender 3.4 or
newer on the path; Cycles renders on the CPU, so no display is needed:

    blender --background --factory-startup --python-exit-code 1 --python tests/oracles/render_blender.py -- \\
        --frames 0 100 200 --out pictures before.bvh after.bvh

It writes one picture a frame, ``frame_000100.png``: the files from left to right in the order given, each at
its own place in the world (``--overlay``: all in one place). Against the first file it prints, as a line of
JSON that is also written to ``distances.json``, the greatest distance in file units between heads of bones
with the same name, in the frames given (``--every-frame``: in all frames that both files have), and the names
that only one of the two files has.
"""

import argparse
import json
import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).parent))
from blender_bvh import import_bvh, pose_bones

COLOURS = [(0.05, 0.22, 0.55, 1), (0.75, 0.16, 0.06, 1), (0.07, 0.38, 0.12, 1), (0.45, 0.25, 0.02, 1)]
VIEW = Vector((0.5, -1.0, 0.35)).normalized()
"""Towards the camera: from the front, somewhat from the figure's left and from above."""

RIGHT = Vector((-VIEW.y, VIEW.x, 0)).normalized()
WIDTH = 0.09
"""Of a bone, as a share of its length."""


def arguments():
    parser = argparse.ArgumentParser(prog="render_blender.py")
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--frames", nargs="+", type=int, default=[0], help="counted from 0")
    parser.add_argument("--every-frame", action="store_true", help="measure in all frames; draw --frames")
    parser.add_argument("--overlay", action="store_true", help="draw all files in one place")
    parser.add_argument("--out", type=Path, required=True, help="folder for the pictures")
    parser.add_argument("--height", type=int, default=480, help="pixels")
    parser.add_argument("--samples", type=int, default=8)
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def main(options):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    armatures, counts = zip(*(import_bvh(file) for file in options.files), strict=True)
    for file, count in zip(options.files, counts, strict=True):
        missing = [frame for frame in options.frames if not 0 <= frame < count]
        if missing:
            raise SystemExit(f"{file} has frames 0 to {count - 1}, not {missing}")
    options.out.mkdir(parents=True, exist_ok=True)
    prepare_scene(options)
    for frame in options.frames:
        draw(armatures, frame, options)
    others = list(zip(options.files, armatures, counts, strict=True))[1:]
    reports = []
    for file, armature, count in others:
        frames = range(min(counts[0], count)) if options.every_frame else options.frames
        reports.append({"file": str(file), **distances(armatures[0], armature, frames)})
    text = json.dumps({"reference": str(options.files[0]), "compared": reports})
    (options.out / "distances.json").write_text(text + "\n", encoding="utf-8")
    print(text)


def distances(one, other, frames):
    """The greatest distance between heads of like-named bones, where and when, and what has no like."""
    worst = {"max_distance": None, "bone": None, "frame": None}
    for frame in frames:
        ours, theirs = heads(one, frame), heads(other, frame)
        for name in sorted(ours.keys() & theirs.keys()):
            distance = (ours[name] - theirs[name]).length
            if worst["max_distance"] is None or distance > worst["max_distance"]:
                worst = {"max_distance": distance, "bone": name, "frame": frame}
    ours, theirs = set(one.pose.bones.keys()), set(other.pose.bones.keys())
    return {
        **worst,
        "frames": len(frames),
        "bones": len(ours & theirs),
        "only_in_reference": sorted(ours - theirs),
        "only_in_file": sorted(theirs - ours),
    }


def heads(armature, frame):
    names, places, _ = pose_bones(armature, frame)
    return dict(zip(names, places, strict=True))


def prepare_scene(options):
    """What all pictures share: Cycles on the CPU, a white world, a sun, a camera without perspective."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = options.samples
    scene.cycles.max_bounces = 1
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.world = bpy.data.worlds.new("white")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.45
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 1.6
    sun.rotation_euler = (0.5, 0.3, 0)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.rotation_euler = VIEW.to_track_quat("Z", "Y").to_euler()
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera


def draw(armatures, frame, options):
    """Renders one frame of all files into a picture of its own."""
    poses = [pose_bones(armature, frame)[1:] for armature in armatures]
    points = [point for heads, tails in poses for point in heads + tails]
    across = [point.dot(RIGHT) for point in points]
    spacing = 0 if options.overlay else 1.1 * (max(across) - min(across))
    drawn = []
    for k, (starts, ends) in enumerate(poses):
        shift = k * spacing * RIGHT
        shifted = ([point + shift for point in starts], [point + shift for point in ends])
        drawn.append(figure(*shifted, COLOURS[k % len(COLOURS)]))
    places = [point + k * spacing * RIGHT for k, pose in enumerate(poses) for part in pose for point in part]
    drawn.append(ground(places))
    frame_camera(places, options.height)
    bpy.context.scene.render.filepath = str(options.out / f"frame_{frame:06d}.png")
    bpy.ops.render.render(write_still=True)
    for thing in drawn:
        bpy.data.objects.remove(thing)


def figure(starts, ends, colour):
    """One mesh of an octahedron for each bone."""
    vertices, faces = [], []
    for head, tail in zip(starts, ends, strict=True):
        along = tail - head
        if not along.length:
            continue
        side = along.orthogonal().normalized() * WIDTH * along.length
        other = along.cross(side).normalized() * WIDTH * along.length
        waist, first = head + 0.12 * along, len(vertices)
        vertices += [head, waist + side, waist + other, waist - side, waist - other, tail]
        for k in range(4):
            a, b = first + 1 + k, first + 1 + (k + 1) % 4
            faces += [(first, b, a), (first + 5, a, b)]
    return solid("figure", vertices, faces, colour)


def ground(places):
    """A plane below the lowest point, wide enough to take the shadows."""
    low = min(point.z for point in places)
    middle = sum(places, Vector()) / len(places)
    size = 4 * max((point - middle).length for point in places)
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    vertices = [Vector((middle.x + size * x, middle.y + size * y, low)) for x, y in corners]
    return solid("ground", vertices, [(0, 1, 2, 3)], (0.8, 0.8, 0.8, 1))


def solid(name, vertices, faces, colour):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = colour
    shader.inputs["Roughness"].default_value = 0.9
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def frame_camera(places, height):
    """Points the camera so that all places are in the picture, and makes the picture as wide as they need."""
    scene = bpy.context.scene
    up = VIEW.cross(RIGHT)
    across = [point.dot(RIGHT) for point in places]
    upward = [point.dot(up) for point in places]
    wide, high = 1.15 * (max(across) - min(across)), 1.15 * (max(upward) - min(upward))
    wide, high = max(wide, 0.5 * high), max(high, wide / 4)
    far = 2 * max(point.length for point in places) + 10 * max(wide, high)
    middle = RIGHT * (max(across) + min(across)) / 2 + up * (max(upward) + min(upward)) / 2
    scene.camera.location = middle + VIEW * far
    scene.camera.data.clip_end = 3 * far
    scene.camera.data.ortho_scale = max(wide, high)
    scene.render.resolution_y = height
    scene.render.resolution_x = math.ceil(height * wide / high)


main(arguments())
