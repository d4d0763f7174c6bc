"""Motions united: several partial motions become one, hung on each other where links say so.

It is the way back from :func:`gmr.partial.select`. Each root that is linked is at first a cut-off root with a
soft link, as if it had been split from its new parent; joining it gives its bone the vector that it has
between the two.
Source: "General Motion Representation", partial motions, join trees.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.configurations import configuration
from gmr.errors import GmrError, SkeletonError
from gmr.forest import home
from gmr.frames import Pose
from gmr.listing import quoted
from gmr.quaternions import conjugate, rotated
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["unite"]

Joint = str | int | np.integer[Any]
Floats = NDArray[np.float64]

_STILL = 1e-9
"""Share of a motion's reach by which the vector of a bone may vary and still be one offset."""

_SAME = 1e-10
"""Difference of quaternions below which siblings turn alike."""


def unite(
    parts: Sequence[Motion],
    links: Mapping[str, str] | None = None,
    *,
    order: Sequence[str] | None = None,
    join: bool = True,
) -> Motion:
    """One motion of all joints of several.

    Every joint keeps its place and every bone its rotation in the world.

    Args:
        parts: at least one; no two have a joint of the same name; same frames, rate and unit.
        links: for a root by name, the joint of another part that it is to hang on.
        order: the names of all joints in the order that the motion is to have; part by part by default.
        join: hangs linked roots on their parents; else they stay roots, with soft links to them. A bone that
            has the same vector in every frame becomes an offset; another is translated in every frame.

    Returns:
        A motion with the roots that are not linked. Siblings that turn alike in every frame share a slot.

    Raises:
        GmrError: nothing to unite, or rate, unit or number of frames differ.
        SkeletonError: a name is in two parts, a link names a joint that is no root or does not exist, or
            links go in a circle.
    """
    parts = [replace(home(part), dropped=None) for part in parts]
    _check_alike(parts)
    united = _side_by_side(parts)
    if order is not None:
        united = _ordered(united, order)
    if not links:
        return united
    skeleton = united.skeleton
    hung = {skeleton.index(root): skeleton.index(parent) for root, parent in links.items()}
    _check_links(skeleton, hung)
    loose = _linked(united, hung)
    return _sharing(home(loose)) if join else loose


def _side_by_side(parts: Sequence[Motion]) -> Motion:
    """All joints of all parts, part by part, none of them linked."""
    joints = np.cumsum([0, *(part.skeleton.joint_count for part in parts)])
    slots = np.cumsum([0, *(part.skeleton.slot_count for part in parts)])

    def moved(numbers: NDArray[np.int32], by: int) -> NDArray[np.int32]:
        return np.where(numbers >= 0, numbers + by, -1).astype(np.int32)

    skeletons = [part.skeleton for part in parts]
    skeleton = Skeleton(
        names=tuple(name for one in skeletons for name in one.names),
        parents=np.concatenate([moved(one.parents, by) for one, by in zip(skeletons, joints, strict=False)]),
        offsets=read_only(np.concatenate([one.offsets for one in skeletons])),
        slots=np.concatenate([moved(one.slots, by) for one, by in zip(skeletons, slots, strict=False)]),
        slot_count=int(slots[-1]),
        ends=np.concatenate([one.ends for one in skeletons]),
    )
    source = Pose(
        read_only(np.concatenate([part.rotations for part in parts], axis=1)),
        np.concatenate([moved(part.translated, by) for part, by in zip(parts, joints, strict=False)]),
        read_only(np.concatenate([part.translations for part in parts], axis=1)),
    )
    return replace(parts[0], skeleton=skeleton, source=source)


def _ordered(motion: Motion, order: Sequence[str]) -> Motion:
    """The same motion with its joints in another order."""
    skeleton, pose = motion.skeleton, motion.pose
    if sorted(order) != sorted(skeleton.names):
        odd = sorted(set(order).symmetric_difference(skeleton.names)) or sorted(order)
        raise SkeletonError(f"order= must name every joint once; look at {quoted(odd, 8)}")
    from_old = skeleton.indices(order)
    to_new = np.full(skeleton.joint_count + 1, -1, np.int32)
    to_new[from_old] = np.arange(len(from_old))
    arranged = Skeleton(
        names=tuple(order),
        parents=to_new[skeleton.parents[from_old]],
        offsets=skeleton.offsets[from_old],
        slots=skeleton.slots[from_old],
        slot_count=skeleton.slot_count,
        ends=skeleton.ends[from_old],
    )
    return replace(motion, skeleton=arranged, source=replace(pose, translated=to_new[pose.translated]))


def _linked(motion: Motion, hung: Mapping[int, int]) -> Motion:
    """The same motion, its roots ``hung`` cut off from the parents that they are to have."""
    skeleton, pose = motion.skeleton, motion.pose
    roots = list(hung)
    parents, offsets, slots = skeleton.parents.copy(), skeleton.offsets.copy(), skeleton.slots.copy()
    unturned = [root for root in roots if slots[root] < 0]
    slots[unturned] = skeleton.slot_count + np.arange(len(unturned))
    parents[roots] = list(hung.values())
    offsets[roots] = _bone_vectors(motion, hung)
    ends = skeleton.ends.copy()
    ends[list(hung.values())] = 0
    at_home = Skeleton(
        skeleton.names, parents, read_only(offsets), slots, skeleton.slot_count + len(unturned), ends
    )
    still = np.tile([0.0, 0.0, 0.0, 1.0], (motion.frame_count, len(unturned), 1))
    rotations = read_only(np.concatenate([pose.rotations, still], axis=1))
    loose = configuration(at_home, roots, ())
    return replace(motion, skeleton=loose, source=Pose(rotations, pose.translated, pose.translations))


def _bone_vectors(motion: Motion, hung: Mapping[int, int]) -> Floats:
    """(K, 3) offset of each root from the joint that it is hung on, in the frame of its own bone.

    It is the one that the part has where that is the vector in every frame, else the mean.
    """
    roots = list(hung)
    places = motion.positions(dtype=np.float64)
    frames = motion.bone_rotations(dtype=np.float64)[:, roots]
    vectors = rotated(conjugate(frames), places[:, roots] - places[:, list(hung.values())])
    own = motion.skeleton.offsets[roots]
    if not motion.frame_count:
        return own
    is_own = np.abs(vectors - own).max(axis=(0, 2)) <= _STILL * np.abs(places).max()
    return np.where(is_own[:, None], own, vectors.mean(axis=0))


def _sharing(motion: Motion) -> Motion:
    """The same motion with siblings that turn alike on one slot, and no slots that turn nothing."""
    skeleton, pose = motion.skeleton, motion.pose
    slots = skeleton.slots.copy()
    for children in skeleton.children:
        shared: list[int] = []
        for child in children:
            slot = int(slots[child])
            alike = next((one for one in shared if slot >= 0 and _turn_alike(pose, one, slot)), None)
            if alike is not None:
                slots[child] = alike
            elif slot >= 0:
                shared.append(slot)
    above = np.where(skeleton.parents >= 0, skeleton.parents, -1)
    used = list(dict.fromkeys(slots[np.argsort(above, kind="stable")].tolist()))
    used = [slot for slot in used if slot >= 0]
    numbers = np.full(skeleton.slot_count + 1, -1, np.int32)
    numbers[used] = np.arange(len(used))
    lean = replace(skeleton, slots=numbers[slots], slot_count=len(used))
    rotations = read_only(np.ascontiguousarray(pose.rotations[:, used]))
    return replace(motion, skeleton=lean, source=Pose(rotations, pose.translated, pose.translations))


def _turn_alike(pose: Pose, one: int, other: int) -> bool:
    if one == other:
        return True
    a, b = pose.rotations[:, one], pose.rotations[:, other]
    signs = np.where((a * b).sum(axis=1, keepdims=True) < 0, -1.0, 1.0)
    return bool(np.abs(a - signs * b).max(initial=0) <= _SAME)


def _check_alike(parts: Sequence[Motion]) -> None:
    """Raises where parts cannot be put side by side."""
    if not parts:
        raise GmrError("there is nothing to unite; give at least one motion")
    first = parts[0]
    seen: dict[str, int] = {}
    for number, part in enumerate(parts):
        for what, one, other in (
            ("frames", first.frame_count, part.frame_count),
            ("seconds a frame", first.frame_time, part.frame_time),
            ("metres a unit", first.unit, part.unit),
        ):
            if one != other:
                raise GmrError(
                    f"part {number} has {other} {what}, part 0 has {one}; cut, resample or convert them first"
                )
        for name in part.skeleton.names:
            if seen.setdefault(name, number) != number:
                raise SkeletonError(
                    f"joint '{name}' is in part {seen[name]} and in part {number}; select() the others "
                    "of one of them"
                )


def _check_links(skeleton: Skeleton, hung: Mapping[int, int]) -> None:
    """Raises where a link is not from a root to a joint of another tree."""
    names = skeleton.names
    for root, parent in hung.items():
        if skeleton.parents[root] >= 0:
            above = names[skeleton.parents[root]]
            raise SkeletonError(
                f"'{names[root]}' cannot be linked to '{names[parent]}': it is no root but hangs on '{above}'"
            )
        here, seen = parent, {root}
        while here >= 0:
            if here in seen:
                raise SkeletonError(
                    f"'{names[root]}' cannot be linked to '{names[parent]}', which hangs below it; links "
                    "must not go in a circle"
                )
            if skeleton.parents[here] < 0:
                seen.add(here)
            here = int(skeleton.parents[here]) if skeleton.parents[here] >= 0 else hung.get(here, -1)
