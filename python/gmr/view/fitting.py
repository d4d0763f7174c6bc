"""A motion on the character that its skeleton is of: the same joints, at rest in the same places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr import quaternions
from gmr.body.measures import UP_TURNS, turned_upright
from gmr.errors import GmrError
from gmr.listing import quoted

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skinning.character import Character

__all__ = ["fitted_poses", "misfit"]

_SHOWN = 6
_APART = 0.01
"""Share of the skeleton's size by which an offset may differ and still be the same."""


def fitted_poses(character: Character, motion: Motion, scale: float, up: str = "+Y") -> NDArray[np.float64]:
    """(F, J, 4, 4) world matrices of the character's joints as the motion moves them.

    A joint's matrix is its turn since the rest pose times its matrix there, at the place where the motion has
    the joint: the other way round of :func:`gmr.skinning.as_motion.joint_motion`.

    Args:
        character: of J joints.
        motion: has joints of all these names, with the same offsets; it may have more.
        scale: metres per file unit of the motion.
        up: which of the motion's axes is up.

    Raises:
        GmrError: it lacks a joint, or its offsets are others: it is of another skeleton.
    """
    reason = misfit(character, motion, scale, up)
    if reason is not None:
        raise GmrError(f"{motion.name or 'the motion'} is not of character '{character.name}': {reason}")
    home = motion.skeleton.home or motion.skeleton
    names = character.joint_names
    chosen = [home.names.index(name) for name in names]
    world = quaternions.matrices(motion.joint_rotations(dtype=np.float64)[:, chosen])
    turn = quaternions.matrices(np.array(UP_TURNS[up]))
    matrices = np.zeros((motion.frame_count, len(names), 4, 4))
    matrices[..., :3, :3] = turn @ world @ turn.T @ character.rest_pose()[:, :3, :3]
    matrices[..., :3, 3] = turned_upright(motion.positions(joints=chosen, dtype=np.float64), up) * scale
    matrices[..., 3, 3] = 1.0
    return matrices


def misfit(character: Character, motion: Motion, scale: float, up: str = "+Y") -> str | None:
    """Why a motion's skeleton is another than the character's, as the rest of a sentence; None where it is
    the same. Arguments as of :func:`fitted_poses`."""
    names = character.joint_names
    home = motion.skeleton.home or motion.skeleton
    missing = [name for name in names if name not in home.names]
    if missing:
        return f"it has no joint {quoted(missing, _SHOWN)}"
    rest = character.skeleton.offsets
    offsets = turned_upright(home.offsets[[home.names.index(name) for name in names]], up) * scale
    apart = np.abs(offsets - rest).max(axis=1) > _APART * np.abs(rest).max(initial=0.0)
    elsewhere = np.flatnonzero(apart & (character.joint_parents >= 0))
    if not len(elsewhere):
        return None
    joint = int(elsewhere[0])
    return (
        f"joint '{names[joint]}' is at {_told(offsets[joint])} m from its parent, "
        f"in the character at {_told(rest[joint])} m"
    )


def _told(vector: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{number:.3f}" for number in vector) + ")"
