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
from gmr.configurations import configuration
from gmr.errors import SkeletonError
from gmr.forest import carried, configured
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


def select(motion: Motion, joints: Iterable[Joint], *, threads: int | None = None) -> Motion:
    """The motion of some of the joints alone: each where it was, its bone turned as it was.

    A joint whose parent at home is not among them is the beginning of a tree of its own, placed in the world
    in every frame. Dropped dummies are forgotten, and the channels are the standard ones.

    Args:
        motion: any, in any configuration; what is left of it stays.
        joints: names or indices, in any order.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Raises:
        SkeletonError: a joint does not exist, or none is given.
    """
    skeleton = motion.skeleton
    kept = np.unique(skeleton.indices(joints))
    if not len(kept):
        raise SkeletonError("no joint is selected, and a motion needs one; name those to keep")
    at_home = skeleton if skeleton.home is None else skeleton.home
    above = at_home.parents
    is_kept = np.zeros(skeleton.joint_count, bool)
    is_kept[kept] = True
    begins = is_kept & ((above < 0) | ~is_kept[above])
    freed = np.flatnonzero(begins & (above >= 0))
    part = _only(motion, configuration(skeleton, freed.tolist(), ()), kept, threads)

    places = np.full(skeleton.joint_count, -1)
    places[kept] = np.arange(len(kept))
    cut = [int(places[joint]) for joint in np.flatnonzero((skeleton.links >= 0) & is_kept)]
    cut = [joint for joint in cut if part.skeleton.parents[joint] >= 0]
    roots = [int(places[root]) for root in skeleton.roots if is_kept[root] and not begins[root]]
    return carried(part, configuration(part.skeleton, cut, roots), threads=threads)


def _only(motion: Motion, whole: Skeleton, kept: NDArray[np.int32], threads: int | None) -> Motion:
    """The kept joints, none of which hangs on one that is not kept in the configuration ``whole``."""
    if whole.home is None and isinstance(motion.source, Pose) and motion.source.rows is not None:
        motion = carried(motion, whole)
    joints = _renumbering(whole.joint_count, kept)
    used = np.unique(whole.slots[kept])
    used = used[used >= 0]
    part = Skeleton(
        names=tuple(whole.names[joint] for joint in kept),
        parents=joints[whole.parents[kept]],
        offsets=read_only(whole.offsets[kept]),
        slots=_renumbering(whole.slot_count, used)[whole.slots[kept]],
        slot_count=len(used),
        ends=whole.ends[kept],
    )
    rotations, translated, translations = configured(motion, whole, used, kept, threads=threads)
    source = Pose(read_only(rotations), joints[translated], read_only(translations))
    return replace(motion, skeleton=part, source=source, dropped=None)


def _renumbering(count: int, kept: NDArray[np.int32]) -> NDArray[np.int32]:
    """(count + 1,) the new index of each old one, -1 for those not kept and, as the last entry, for -1."""
    found = np.full(count + 1, -1, np.int32)
    found[kept] = np.arange(len(kept))
    return found
