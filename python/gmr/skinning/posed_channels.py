"""World matrices of joints, frame by frame, as channels of translation, rotation and scale."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import FormatError, GmrError
from gmr.skinning.character import Character
from gmr.skinning.keyframes import Animation, Channel
from gmr.skinning.nodes import Nodes
from gmr.skinning.transforms import continuous, decomposed

__all__ = ["as_transforms", "posed_animation"]

Array = NDArray[np.float64]

_SHEAR = 1e-4
"""Share of a matrix by which translation, rotation and scale may miss it."""
_SAME = 1e-6
"""Share of its size by which a value may change and count as one that stays."""


def posed_animation(
    character: Character, poses: ArrayLike, frame_time: float | None, name: str = "poses"
) -> Animation:
    """The animation that puts the joints of a character where the pose matrices say.

    Nodes that are no joints stay as at rest. Scale has channels where it is not that of rest in every frame.

    Args:
        character: of J joints.
        poses: (F, J, 4, 4) world matrices.
        frame_time: seconds from a frame to the next.
        name: of the animation.

    Raises:
        GmrError: the poses have another shape or are not finite, the frame time is missing or not above 0, or
            a joint would have to be sheared, which nodes cannot say.
    """
    found = np.asarray(poses, np.float64)
    count = len(character.joints)
    if found.ndim != 4 or found.shape[1:] != (count, 4, 4) or not len(found):
        raise GmrError(f"poses of the shape {found.shape} are given; they must be (frames, {count}, 4, 4)")
    if frame_time is None or not (math.isfinite(frame_time) and frame_time > 0):
        raise GmrError(f"a frame of {frame_time} seconds cannot be; give frame_time= above 0, in seconds")
    if not np.isfinite(found).all():
        frame, joint = np.argwhere(~np.isfinite(found))[0, :2]
        raise GmrError(f"pose {frame} of joint '{character.joint_names[joint]}' is not finite; mend it first")
    nodes = as_transforms(character.nodes, character.joints.tolist())
    times = np.arange(len(found), dtype=np.float64) * frame_time
    channels: list[Channel] = []
    for joint, node in enumerate(character.joints.tolist()):
        local = _local(character, found, joint)
        channels += _channels(nodes, node, local, times)
    return Animation(name, tuple(channels))


def as_transforms(nodes: Nodes, chosen: Iterable[int]) -> Nodes:
    """The same nodes, those of ``chosen`` with translation, rotation and scale where they had a matrix.

    Raises:
        FormatError: a node's matrix is sheared, which glTF does not allow.
    """
    arrays = [np.array(array) for array in (nodes.translations, nodes.rotations, nodes.scales)]
    matrices = dict(nodes.matrices)
    for node, matrix in nodes.matrices.items():
        parts = decomposed(matrix)
        if parts.error > _SHEAR:
            what = f"node '{nodes.names[node]}' is sheared, which glTF cannot say"
            raise FormatError(f"{what}; give it translation, rotation and scale")
        if node in chosen:
            del matrices[node]
            for array, values in zip(arrays, parts, strict=False):
                array[node] = values
    return replace(nodes, translations=arrays[0], rotations=arrays[1], scales=arrays[2], matrices=matrices)


def _local(character: Character, poses: Array, joint: int) -> Array:
    """(F, 4, 4) of a joint in the frame of the node that it hangs on."""
    nodes = character.nodes
    above = int(nodes.parents[character.joints[joint]])
    parent = int(character.joint_parents[joint])
    if above < 0:
        return poses[:, joint]
    if parent < 0:
        frame = nodes.world[above]
    else:
        frame = poses[:, parent] @ _between(nodes, int(character.joints[parent]), above)
    if (np.abs(np.linalg.det(frame[..., :3, :3])) <= 1e-30).any():
        raise GmrError(
            f"joint '{character.joint_names[joint]}' hangs on a node without extent (scale 0), "
            "so that nothing can put it in its place"
        )
    local: Array = np.linalg.inv(frame) @ poses[:, joint]
    error = decomposed(local).error
    if error.max() > _SHEAR:
        raise GmrError(
            f"joint '{character.joint_names[joint]}' would be sheared in frame {int(error.argmax())}, "
            "for what it hangs on is scaled by different amounts along its axes; glTF nodes have "
            "a translation, a rotation and a scale alone. Take the scale out of the poses"
        )
    return local


def _between(nodes: Nodes, joint: int, node: int) -> Array:
    """(4, 4) frame of a node in that of a joint above it, at rest."""
    matrix = np.eye(4)
    while node != joint:
        matrix = nodes.local[node] @ matrix
        node = int(nodes.parents[node])
    return matrix


def _channels(nodes: Nodes, node: int, local: Array, times: Array) -> list[Channel]:
    """The channels that move one node."""
    parts = decomposed(local, np.sign(nodes.scales[node]))
    found = [
        _channel(node, "translation", parts.translations, times),
        _channel(node, "rotation", continuous(parts.rotations), times),
    ]
    size = np.abs(nodes.scales[node]).max()
    if (np.abs(parts.scales - nodes.scales[node]) > 1e2 * _SAME * size).any():
        found.append(_channel(node, "scale", parts.scales, times))
    return found


def _channel(node: int, path: str, values: Array, times: Array) -> Channel:
    """A channel; what stays has a key at the beginning and one at the end."""
    size = np.abs(values).max(initial=0.0)
    if len(values) > 2 and np.ptp(values, axis=0).max() <= _SAME * size:
        values, times = values[[0, -1]], times[[0, -1]]
    return Channel(node, path, times.astype(np.float32), values.astype(np.float32))  # type: ignore[arg-type]
