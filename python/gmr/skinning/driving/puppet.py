"""A character's joints on strings: where they are when each is turned from its rest by a world rotation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.quaternions import matrices, rotated
from gmr.skinning.character import Character

__all__ = ["Puppet", "pose_matrices", "strung"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Puppet:
    """The joints of a character in F frames.

    Args:
        character: of J joints.
        turns: (F, J, 4) world rotation of each joint from how it is at rest.
        places: (F, J, 3) metres.
    """

    character: Character
    turns: Floats
    places: Floats


def strung(character: Character, turns: Floats, anchor: int, placed: Mapping[int, Floats]) -> Puppet:
    """Places of the joints: each at its rest vector from its parent, turned as the parent is.

    Args:
        character: of J joints.
        turns: (F, J, 4) world rotations from rest.
        anchor: the joint that the others hang on; those that it hangs on itself, and other trees, go along
            with it unless they have places of their own.
        placed: (F, 3) metres, the places of the anchor and of others.
    """
    place = placed[anchor]
    rest = character.rest_pose()[:, :3, 3]
    parents = character.joint_parents
    found = np.empty((*turns.shape[:2], 3))
    for joint in character.skeleton.parents_first:
        parent = int(parents[joint])
        if joint in placed:
            found[:, joint] = placed[joint]
        elif parent < 0 or _hangs_above(parents, joint, anchor):
            found[:, joint] = place + rotated(turns[:, anchor], rest[joint] - rest[anchor])
        else:
            found[:, joint] = found[:, parent] + rotated(turns[:, parent], rest[joint] - rest[parent])
    return Puppet(character, turns, found)


def _hangs_above(parents: NDArray[np.int32], joint: int, anchor: int) -> bool:
    here = anchor
    while here >= 0 and here != joint:
        here = int(parents[here])
    return here == joint


def pose_matrices(puppet: Puppet) -> Floats:
    """(F, J, 4, 4) world matrices, with the scale that the joints have at rest."""
    rest = puppet.character.rest_pose()
    found = np.zeros((*puppet.turns.shape[:2], 4, 4))
    found[..., :3, :3] = matrices(puppet.turns) @ rest[:, :3, :3]
    found[..., :3, 3] = puppet.places
    found[..., 3, 3] = 1
    return found
