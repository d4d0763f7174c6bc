"""Bones that turn alike at home and do not any more: each gets a rotation of its own.

The children of a joint in a post-rotation file share its rotation. With its bone cut, a child is a root with
a rotation of its own, and whoever edits the motion may turn it by itself. The rotation that it shared at home
cannot say that, so the skeleton has to change before the bone is whole again: siblings that turn apart have
slots of their own, as in any pre-rotation motion, and a post-rotation file gets a dummy for each.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import frozen, read_only
from gmr.configurations import arranged
from gmr.frames import Pose
from gmr.quaternions import IDENTITY, conjugate, multiply
from gmr.world import motion_rotations

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton

__all__ = ["turned_apart"]

Floats = NDArray[np.float64]

_ALIKE: Final = 1e-6
"""Difference of quaternions up to which bones turn alike: what numbers of a file in float32 can tell."""


def turned_apart(motion: Motion, *, threads: int | None = None) -> Motion:
    """The same motion, in its configuration; bones that turn apart share no rotation at home any more.

    Args:
        motion: any, in any configuration.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Returns:
        The same motion where all bones with one world rotation at home have one still. Else one on a skeleton
        with a slot for each further world rotation; every joint keeps its place and every bone its rotation.
    """
    skeleton, source = motion.skeleton, motion.source
    # Rows that are still there are those of this very motion, in which siblings turn alike.
    if skeleton.home is None or not isinstance(source, Pose) or source.rows is not None:
        return motion
    classes = _classes(motion, skeleton.home, threads)
    if np.array_equal(classes, skeleton.home.topology.world_slots):
        return motion
    at_home = _separated(skeleton.home, classes)
    apart = arranged(at_home, _core.Forest(at_home.topology, skeleton.parents))
    rotations = read_only(_rotations_on(motion, apart, threads))
    return replace(motion, skeleton=apart, source=replace(source, rotations=rotations, acclaim=None))


def _classes(motion: Motion, at_home: Skeleton, threads: int | None) -> NDArray[np.int32]:
    """(J,) a number for each world rotation, by the joint in which a bone ends at home.

    It is that of the slot that makes it at home (-1: the world's own) for the first bone with it, and a
    further number for each that is another one now.
    """
    world, slots = np.asarray(at_home.topology.world_slots), motion.skeleton.bone_slots
    groups = [np.flatnonzero(world == number) for number in np.unique(world)]
    # One slot turns all of most groups, and nothing turns what hangs on the world.
    groups = [bones for bones in groups if np.ptp(slots[bones]) or (world[bones[0]] < 0 <= slots[bones[0]])]
    if not groups:
        return world
    rotations = _world_rotations(motion, np.unique(slots[np.concatenate(groups)]), threads)
    classes = world.copy()
    following = at_home.slot_count
    for bones in groups:
        number = int(world[bones[0]])
        found = [(IDENTITY, number)] if number < 0 else []
        for bone in bones.tolist():
            own = rotations[int(slots[bone])]
            known = next((one for rotation, one in found if _are_alike(rotation, own)), None)
            if known is None:
                known = following if found else number
                following += known == following
                found.append((own, known))
            classes[bone] = known
    return classes


def _world_rotations(motion: Motion, slots: NDArray[np.int32], threads: int | None) -> dict[int, Floats]:
    """(F, 4) world rotation of each slot; -1: the identity."""
    above = np.append(motion.skeleton.topology.slot_parents, 0)
    # That of a root is what the motion holds.
    held = {slot: motion.rotations[:, slot] for slot in slots[above[slots] < 0].tolist()}
    hung = frozen(slots[above[slots] >= 0], np.int32)
    if not len(hung):
        return held
    solved = motion_rotations(motion, hung, np.float64, threads)
    return held | {slot: solved[:, k] for k, slot in enumerate(hung.tolist())}


def _are_alike(one: Floats, other: Floats) -> bool:
    """Whether rotations (F, 4) are the same in every frame."""
    # Number by number: where rows of four lie far apart, a loop over each row takes three times as long.
    gaps = (one[..., k] - other[..., k] for k in range(4))
    if all(gap.max(initial=0) <= _ALIKE and gap.min(initial=0) >= -_ALIKE for gap in gaps):
        return True
    signs = np.where((one * other).sum(axis=1, keepdims=True) < 0, -1.0, 1.0)
    return bool(np.abs(one - signs * other).max(initial=0) <= _ALIKE)


def _separated(at_home: Skeleton, classes: NDArray[np.int32]) -> Skeleton:
    """The skeleton at home with a slot for every class that a bone does not have from above."""
    parents = at_home.parents
    above = np.where(parents >= 0, classes[parents], -1)
    over = np.asarray(at_home.topology.slot_parents)
    stays = (at_home.slots >= 0) & (classes == at_home.slots)
    # A slot leads from one rotation: where its bones hang on different ones now, those as before keep it.
    held = {slot: int(over[slot]) for slot in at_home.slots[stays & (over[at_home.slots] == above)].tolist()}
    slots = np.full(len(parents), -1, np.int32)
    made: dict[tuple[int, int], int] = {}
    for joint in np.flatnonzero(classes != above).tolist():
        span = int(above[joint]), int(classes[joint])
        if stays[joint] and held.setdefault(span[1], span[0]) == span[0]:
            slots[joint] = span[1]
        else:
            slots[joint] = made.setdefault(span, at_home.slot_count + len(made))
    return replace(at_home, slots=slots, slot_count=at_home.slot_count + len(made))


def _rotations_on(motion: Motion, apart: Skeleton, threads: int | None) -> Floats:
    """(F, S, 4) rotations of the slots of ``apart``, by which every bone turns as it does."""
    world = motion.bone_rotations(dtype=np.float64, threads=threads)
    bones = np.asarray(apart.forest.bones)
    above = np.asarray(apart.topology.slot_parents)
    turns: dict[int, Floats] = {}
    for joint in apart.parents_first:
        if apart.slots[joint] >= 0:
            turns.setdefault(int(apart.slots[joint]), world[:, bones[joint]])
    rotations = np.zeros((motion.frame_count, apart.slot_count, 4))
    rotations[..., 3] = 1
    for slot, own in turns.items():
        outer = int(above[slot])
        rotations[:, slot] = own if outer < 0 else multiply(conjugate(turns[outer]), own)
    return rotations
