"""The motion of a character's joints, from their world matrices frame by frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import quaternions
from gmr.skeleton import End, Skeleton
from gmr.skinning.transforms import continuous, nearest_rotations

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skinning.character import Character

__all__ = ["JointMotion", "joint_motion"]

Array = NDArray[np.float64]

_STILL = 1e-6
"""Share of the skeleton's size by which a bone may leave its offset and count as not moved."""
_RIGID = 1e-3
"""How far a joint's turn may be from a rotation before it is said."""


class JointMotion(NamedTuple):
    """What :func:`joint_motion` finds."""

    motion: Motion
    deformed: tuple[str, ...]
    """Joints that are stretched or sheared against how they are at rest, which a motion cannot say."""


def joint_motion(character: Character, poses: Array, frame_time: float) -> JointMotion:
    """The motion whose joints are where the pose matrices put them.

    The skeleton is the character's (``character.skeleton``) at rest: no joint is turned there, and
    ``motion.joint_rotations()`` turns each joint from how it is at rest: ``R_now R_rest^-1``, in the world.
    So that leaves keep their turns, each has a zero-length tip ("<name>_end") after the J joints.

    Args:
        character: of J joints.
        poses: (F, J, 4, 4) world matrices.
        frame_time: seconds.
    """
    from gmr.motion import Motion

    rest = character.rest_pose()
    skeleton = _with_tips(character)
    turns, deformed = _turns(poses[..., :3, :3], rest[:, :3, :3])
    parents = character.joint_parents
    offsets = skeleton.offsets[: len(parents)]
    places = poses[..., :3, 3]
    has_parent = np.flatnonzero(parents >= 0)
    bones = places[:, has_parent] - places[:, parents[has_parent]]
    vectors = quaternions.rotated(quaternions.conjugate(turns[:, parents[has_parent]]), bones)
    size = np.abs(offsets).max(initial=0.0)
    moving = np.abs(vectors - offsets[has_parent]).max(axis=(0, 2), initial=0.0) > _STILL * size
    roots = np.flatnonzero(parents < 0)
    translated = np.concatenate([roots, has_parent[moving]])
    order = np.argsort(translated)
    local = turns.copy()
    local[:, has_parent] = quaternions.multiply(
        quaternions.conjugate(turns[:, parents[has_parent]]), turns[:, has_parent]
    )
    motion = Motion.from_pose(
        skeleton,
        continuous(local),
        np.concatenate([places[:, roots], vectors[:, moving]], axis=1)[:, order],
        frame_time,
        translated=translated[order].astype(np.int32),
        unit=1.0,
        name=character.name,
    )
    return JointMotion(motion, tuple(np.array(character.joint_names, object)[deformed]))


def _with_tips(character: Character) -> Skeleton:
    """The skeleton at rest, with a tip for each leaf, after the joints."""
    home = character.skeleton
    leaves = [joint for joint, children in enumerate(home.children) if not children]
    return Skeleton.post_rotation(
        [*home.names, *(f"{home.names[leaf]}_end" for leaf in leaves)],
        np.concatenate([home.parents, np.array(leaves, np.int32)]),
        np.concatenate([home.offsets, np.zeros((len(leaves), 3))]),
        ends=[End.JOINT] * len(home.names) + [End.TIP] * len(leaves),
    )


def _turns(poses: Array, rest: Array) -> tuple[Array, NDArray[np.bool_]]:
    """(F, J, 4) rotation of each joint from how it is at rest, and (J,) whether there is more than that.

    ``M R^-1`` leaves out what scale and mirroring both have. A joint that is flat at rest has no inverse; it
    is turned as its matrix is.
    """
    flat = np.abs(np.linalg.det(rest)) <= 1e-12 * np.abs(rest).max(axis=(1, 2), initial=0.0) ** 3
    inverse = np.linalg.inv(np.where(flat[:, None, None], np.eye(3), rest))
    change = poses @ inverse
    rotations = nearest_rotations(change)
    apart = np.abs(rotations - change).max(axis=(0, 2, 3), initial=0.0) > _RIGID
    return quaternions.from_matrices(rotations), apart | flat
