"""A motion becomes a .glb: a node a joint, and one animation that moves them; no mesh."""

from __future__ import annotations

from pathlib import PurePath

import numpy as np

from gmr.errors import FormatError
from gmr.formats.gltf_writer import glb_pieces
from gmr.motion import Motion
from gmr.skinning.character import Character
from gmr.skinning.keyframes import Animation, Channel
from gmr.skinning.nodes import Nodes
from gmr.skinning.transforms import continuous
from gmr.units import to_unit

__all__ = ["glb_of_motion"]


def glb_of_motion(motion: Motion) -> list[bytes]:
    """The pieces, in order, of a .glb file in which nodes with the names of the joints move as they do.

    A node's rotation is its joint's, from the rest pose in which no joint is turned; lengths are metres, keys
    are float32, one a frame. End Sites are nodes that nothing moves. Source: glTF 2.0, sections 3.5.3 and
    3.11.

    Raises:
        MissingExtraError: pygltflib is not installed (the extra ``gltf``).
        FormatError: the motion does not say its unit, or has no frames.
        SkeletonError: it cannot be brought into post-rotation form.
    """
    if motion.unit is None:
        raise FormatError(
            "glTF is in metres, and this motion does not say in what unit it is; declare it: "
            "motion.with_unit('cm'), or --unit m on the command line",
            file=motion.name,
        )
    if not motion.frame_count:
        raise FormatError(
            "a motion without frames cannot be written as glTF, which has keys in every channel",
            file=motion.name,
        )
    moving = to_unit(motion.to_post_rotation(), "m")
    skeleton = moving.skeleton
    count = skeleton.joint_count
    still, upright = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    offsets = np.where((skeleton.parents < 0)[:, None], still, skeleton.offsets)
    nodes = Nodes(skeleton.names, skeleton.parents, offsets, upright, np.ones((count, 3)))
    name = PurePath(motion.name).stem if motion.name else "motion"
    animation = Animation(name, tuple(_channels(moving)))
    return glb_pieces(Character(name, nodes, np.arange(count, dtype=np.int32), (), animations=(animation,)))


def _channels(motion: Motion) -> list[Channel]:
    """What moves the nodes: roots and joints that leave their offsets, and all joints that something hangs
    on."""
    times = (np.arange(motion.frame_count) * motion.frame_time).astype(np.float32)
    found = [
        Channel(int(joint), "translation", times, motion.translations[:, k].astype(np.float32))
        for k, joint in enumerate(motion.translated)
    ]
    turns = continuous(motion.rotations).astype(np.float32)
    owners = {
        int(slot): int(parent)
        for slot, parent in zip(motion.skeleton.slots, motion.skeleton.parents, strict=True)
        if slot >= 0
    }
    return found + [
        Channel(joint, "rotation", times, turns[:, slot]) for slot, joint in sorted(owners.items())
    ]
