"""Partial motions: some of the joints alone, in place.

Source: "General Motion Representation": a partial motion keeps a subset of the joints.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.errors import SkeletonError
from gmr.forest import carried, configuration
from gmr.frames import Pose
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["below", "select"]

Joint = str | int | np.integer[Any]


def below(skeleton: Skeleton, joint: Joint) -> tuple[int, ...]:
    """Indices of a joint and all that hang on it, in the order of the joints; for :func:`select`."""
    found = [skeleton.index(joint)]
    for one in found:  # grows while it is walked
        found.extend(skeleton.children[one])
    return tuple(sorted(found))


def select(motion: Motion, joints: Iterable[Joint]) -> Motion:
    """The motion of some of the joints alone: each where it was, its bone turned as it was.

    A joint whose parent at home is not among them is the beginning of a tree of its own, placed in the world
    in every frame. Dropped dummies are forgotten, and the channels are the standard ones.

    Args:
        motion: any, in any configuration; what is left of it stays.
        joints: names or indices, in any order.

    Raises:
        SkeletonError: a joint does not exist, or none is given.
    """
    skeleton = motion.skeleton
    kept = np.unique(skeleton.indices(joints))
    if not len(kept):
        raise SkeletonError("no joint is selected, and a motion needs one; name those to keep")
    at_home = skeleton if skeleton.home is None else skeleton.home
    above = at_home.parents
    begins = [joint for joint in kept.tolist() if above[joint] < 0 or above[joint] not in kept]
    freed = np.flatnonzero(
        (above >= 0) & np.isin(above, kept, invert=True) & np.isin(np.arange(len(above)), kept)
    )
    whole = carried(motion, configuration(skeleton, freed.tolist(), ()))
    part = _only(replace(whole, dropped=None), kept)

    places = np.full(skeleton.joint_count, -1)
    places[kept] = np.arange(len(kept))
    cut = [int(places[joint]) for joint in np.flatnonzero(skeleton.links >= 0) if joint in kept]
    cut = [joint for joint in cut if part.skeleton.parents[joint] >= 0]
    roots = [int(places[root]) for root in skeleton.roots if root in kept and root not in begins]
    return carried(part, configuration(part.skeleton, cut, roots))


def _only(motion: Motion, kept: NDArray[np.int32]) -> Motion:
    """The kept joints, none of which hangs on one that is not kept."""
    skeleton, pose = motion.skeleton, motion.pose
    joints = np.full(skeleton.joint_count + 1, -1, np.int32)
    joints[kept] = np.arange(len(kept))
    used = np.unique(skeleton.slots[kept])
    used = used[used >= 0]
    slots = np.full(skeleton.slot_count + 1, -1, np.int32)
    slots[used] = np.arange(len(used))
    part = Skeleton(
        names=tuple(skeleton.names[joint] for joint in kept),
        parents=joints[skeleton.parents[kept]],
        offsets=read_only(skeleton.offsets[kept]),
        slots=slots[skeleton.slots[kept]],
        slot_count=len(used),
        ends=skeleton.ends[kept],
    )
    moving = np.flatnonzero(np.isin(pose.translated, kept))
    source = Pose(
        read_only(np.ascontiguousarray(pose.rotations[:, used])),
        joints[pose.translated[moving]],
        read_only(np.ascontiguousarray(pose.translations[:, moving])),
    )
    return replace(motion, skeleton=part, source=source)
