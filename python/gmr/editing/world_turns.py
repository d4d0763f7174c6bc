"""Bones turned in the world, in the rotations of slots that a motion holds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gmr.motion import Motion
from gmr.quaternions import conjugate, multiply
from gmr.world import motion_rotations

__all__ = ["turned", "world_of"]

Floats = NDArray[np.float64]


def turned(motion: Motion, turns: Mapping[int, Floats]) -> Floats:
    """(F, S, 4) rotations of the motion's slots after some of them were turned in the world.

    With ``W`` the world rotation of the slot above, ``A`` its turn and ``D`` that of a slot, its rotation
    ``R`` becomes ``W^-1 A^-1 D W R``. A slot that is not named turns along with the one above it.

    Args:
        motion: in any configuration.
        turns: by slot, (F, 4) or (4,): what comes after its world rotation; the identity keeps it in place.
    """
    rotations = motion.rotations.copy()
    above = np.asarray(motion.skeleton.topology.slot_parents)
    for slot, turn in turns.items():
        here = int(above[slot])
        world = world_of(motion, here)
        while here >= 0 and here not in turns:
            here = int(above[here])
        relative = turn if here < 0 else multiply(conjugate(turns[here]), turn)
        local = multiply(multiply(conjugate(world), relative), world)
        rotations[:, slot] = multiply(local, rotations[:, slot])
    return rotations


def world_of(motion: Motion, slot: int) -> Floats:
    """(F, 4) world rotation of a slot; -1: the identity."""
    found: Floats = motion_rotations(motion, np.array([slot], np.int32), np.float64, None)[:, 0]
    return found
