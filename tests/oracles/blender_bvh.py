"""BVH files in a running Blender: what the scripts beside this one share."""

import builtins

import bpy


def open_without_universal_newlines(file, mode="r", *args, **kwargs):
    """The importer of Blender 3.4 asks for the mode "rU", which Python 3.11 no longer has."""
    return original_open(file, mode.replace("U", ""), *args, **kwargs)


original_open = builtins.open


def import_bvh(file):
    """The armature that Blender makes of a file, and the number of its frames; frame k is Blender's k + 1."""
    builtins.open = open_without_universal_newlines
    try:
        bpy.ops.import_anim.bvh(filepath=str(file), update_scene_duration=True, rotate_mode="NATIVE")
    finally:
        builtins.open = original_open
    armature = bpy.context.object
    return armature, int(armature.animation_data.action.frame_range[1])


def pose_bones(armature, frame):
    """Names, heads and tails of the bones in a frame that counts from 0, in Blender's world: Z up."""
    bpy.context.scene.frame_set(frame + 1)
    world, bones = armature.matrix_world, armature.pose.bones
    return [b.name for b in bones], [world @ b.head for b in bones], [world @ b.tail for b in bones]
