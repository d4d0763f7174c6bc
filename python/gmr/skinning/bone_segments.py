"""The bones that carry a mesh: a segment from each joint to each of its children, turning with the joint.

That is the rule ``per_child`` of :func:`gmr.bones`, except for what has no length: a stub of 0.1 file units
is for eyes, and would carry a mesh in metres and one in inches differently.

Source: spec "Joints, bones and tails" and "Skinning".
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.errors import SkeletonError
from gmr.listing import quoted
from gmr.skeleton import End, Skeleton

__all__ = ["FARTHEST", "BoneSegments", "bone_segments", "rest_places"]

Floats = NDArray[np.float64]

FARTHEST = 1e100
"""The largest number in a place: squares of such are numbers still."""

_SHORTEST = 1e-6
"""Diagonals of the skeleton's box: joints nearer to each other than this are at one place."""

_LEAF = 1.5
"""How long a leaf's bone is, in lengths of the bone before it. Artists' weights of a man and of a fox are met
better than with 1, which is met better than 0.5."""

_SHOWN = 8
"""Names that an error lists; the others it counts."""


class BoneSegments(NamedTuple):
    """B bones at rest."""

    joints: NDArray[np.int32]
    """(B,) the joint that turns each; ascending."""
    heads: Floats
    """(B, 3) file units."""
    tails: Floats
    """(B, 3) file units."""
    open: NDArray[np.bool_]
    """(B, 2) whether no other bone meets this one at its head, at its tail."""


def bone_segments(skeleton: Skeleton, joints: Iterable[str | int] | None = None) -> BoneSegments:
    """The bones of some joints, at home and at rest.

    A leaf without ``End Site`` goes on as the bone before it does, :data:`_LEAF` times as far; so does one
    whose ``End Site`` has no length. Between joints at one place there is no bone; a joint whose children are
    all where it is has none. A skeleton of one place only has bones without length.

    Args:
        skeleton: J joints.
        joints: the joints whose bones are wanted, by names or indices; by default all.

    Raises:
        SkeletonError: an offset is not finite, a joint is not there, or none of the joints has a bone.
    """
    home = skeleton.home or skeleton
    places = rest_places(home)
    shortest = _SHORTEST * float(np.linalg.norm(np.ptp(places, axis=0))) if home.joint_count else 0.0
    ends = home.ends.tolist()
    proper = [joint for joint in range(home.joint_count) if ends[joint] == End.JOINT]
    wanted = proper if joints is None else sorted(set(home.indices(joints).tolist()) & set(proper))
    meeting = _meeting_points(home, places, shortest)
    found: list[tuple[int, Floats, int, int]] = []
    for joint in wanted:
        below = [child for child in home.children[joint] if ends[child] != End.TIP]
        tails = [child for child in below if np.linalg.norm(places[child] - places[joint]) > shortest]
        found += [(joint, places[child], meeting[joint], meeting[child]) for child in tails]
        if not tails and all(ends[child] == End.SITE for child in below):
            before = _place_before(home, joint, places, shortest)
            # No other bone ends where this one does: the number is its own.
            tail = places[joint] + _LEAF * (places[joint] - before)
            found.append((joint, tail, meeting[joint], -1 - joint))
    if not found:
        names = [home.names[joint] for joint in wanted]
        raise SkeletonError(
            f"no bone is there to carry a mesh: {quoted(names, _SHOWN) or 'no joint'} has none. "
            "Name joints whose children are elsewhere than they"
        )
    met = Counter(point for _, _, *points in found for point in points)
    carriers = np.array([joint for joint, *_ in found], np.int32)
    return BoneSegments(
        joints=carriers,
        heads=places[carriers],
        tails=np.array([tail for _, tail, *_ in found]),
        open=np.array([[met[point] == 1 for point in points] for _, _, *points in found]),
    )


def rest_places(skeleton: Skeleton) -> Floats:
    """(J, 3) file units: where joints are when nothing turns and each root is at its offset.

    Raises:
        SkeletonError: one is nowhere.
    """
    places = skeleton.offsets.copy()
    for joint in skeleton.parents_first:
        if skeleton.parents[joint] >= 0:
            places[joint] += places[skeleton.parents[joint]]
        if not (np.abs(places[joint]) <= FARTHEST).all():
            raise SkeletonError(
                f"joint '{skeleton.names[joint]}' is at {places[joint].tolist()} at rest; "
                f"its offset is {skeleton.offsets[joint].tolist()}, and no number may be beyond {FARTHEST:g}"
            )
    return places


def _meeting_points(skeleton: Skeleton, places: Floats, shortest: float) -> list[int]:
    """(J,) for each joint the topmost of those that bones without length join to it."""
    found = list(range(skeleton.joint_count))
    for joint in skeleton.parents_first:
        parent = int(skeleton.parents[joint])
        if parent >= 0 and np.linalg.norm(places[joint] - places[parent]) <= shortest:
            found[joint] = found[parent]
    return found


def _place_before(skeleton: Skeleton, joint: int, places: Floats, shortest: float) -> Floats:
    """Where the nearest joint above is that is elsewhere; where there is none, the joint's own place."""
    above = int(skeleton.parents[joint])
    while above >= 0 and np.linalg.norm(places[joint] - places[above]) <= shortest:
        above = int(skeleton.parents[above])
    found: Floats = places[above if above >= 0 else joint]
    return found
