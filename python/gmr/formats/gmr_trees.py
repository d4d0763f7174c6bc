"""Trees as a GMR file has them, and the skeleton that they make: what each bone is at home.

A tree of the file may hang on another joint than at home. The joint nearest to home is its *top*: there it
hangs on a joint of another tree (its soft link) or is a root. The bones between the tree's root and its top
are turned over; each joint on that way carries the bone of the joint above it, and the root that of the top.
Source: docs/gmr-format.md, "Home".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.configurations import arranged
from gmr.formats.text import named
from gmr.skeleton import Skeleton

__all__ = ["Bones", "Top", "Trees", "TreesError", "bones_at_home", "skeleton_of", "trees_of"]


class Top(NamedTuple):
    """Where a tree hung at home."""

    above: int
    """The joint that its top hung on; -1: it is a root there."""
    offset: tuple[float, float, float]


@dataclass(frozen=True)
class Trees:
    """J joints as the file nests them.

    Args:
        parents: (J,) -1 for a root.
        offsets: (J, 3) from the parent in the file.
        turns: (J,) the number of the world rotation that turns each joint's bone, -1: none does.
        tops: by joint, for each tree that does not simply begin where it does at home.
    """

    parents: NDArray[np.int32]
    offsets: NDArray[np.float64]
    turns: NDArray[np.int32]
    tops: Mapping[int, Top]


class Bones(NamedTuple):
    """The bones at home, by the joints in which they end there."""

    parents: NDArray[np.int32]
    offsets: NDArray[np.float64]
    turns: NDArray[np.int32]


class TreesError(Exception):
    """What is wrong with trees, and with which joint."""

    def __init__(self, joint: int, what: str) -> None:
        super().__init__(what)
        self.joint = joint


def trees_of(skeleton: Skeleton) -> Trees:
    """The trees of a skeleton, in whatever configuration it is."""
    home = skeleton.home or skeleton
    forest = skeleton.forest
    turns = np.asarray(home.topology.world_slots)[forest.bones]
    links = skeleton.links
    tops = {}
    for root in skeleton.roots:
        top = forest.top_of(root)
        above = int(links[top])
        if top != root or above >= 0:
            x, y, z = home.offsets[top].tolist()
            tops[top] = Top(above, (x, y, z))
    return Trees(skeleton.parents, skeleton.offsets, turns, tops)


def skeleton_of(
    trees: Trees, bones: Bones, names: Sequence[str], ends: NDArray[np.uint8], least_slots: int
) -> Skeleton:
    """The skeleton that the trees are a configuration of, in that configuration.

    Args:
        trees: what each joint says.
        bones: what :func:`bones_at_home` makes of them.
        names: (J,)
        ends: (J,) of :class:`gmr.skeleton.End`.
        least_slots: slots at home at least, more where more turn a bone.

    Raises:
        TreesError: bones that are no siblings have the same turn.
        SkeletonError: these are no trees of a skeleton, in a way that only the whole shows.
    """
    slots = _home_slots(bones, names)
    count = max(int(slots.max(initial=-1)) + 1, least_slots)
    home = Skeleton(tuple(names), bones.parents, bones.offsets, slots, count, ends)
    if not trees.tops:
        return home
    return arranged(home, _core.Forest(home.topology, trees.parents))


def bones_at_home(trees: Trees, names: Sequence[str]) -> Bones:
    """What the trees say of each bone at home.

    Raises:
        TreesError: a tree has two tops, trees hang on each other in a circle, or a root's offset is not that
            of the bone above its top.
    """
    parents, offsets, turns = trees.parents.copy(), trees.offsets.copy(), trees.turns.copy()
    topped: dict[int, int] = {}
    for top, (above, offset) in trees.tops.items():
        joint = top
        while (below := int(trees.parents[joint])) >= 0:
            parents[below] = joint
            offsets[below] = -trees.offsets[joint]
            turns[below] = trees.turns[joint]
            joint = below
        if joint in topped:
            what = f"and {named(names[topped[joint]])} are both the top of one tree"
            raise TreesError(top, f"{what}. Remove LINK or TOP from the one that is not nearest to home.")
        topped[joint] = top
        _check_root(trees, names, joint, top, offset)
        turns[top] = trees.turns[joint]
        parents[top], offsets[top] = above, offset
    _check_links(trees, names)
    return Bones(parents, offsets, turns)


def _check_root(
    trees: Trees, names: Sequence[str], root: int, top: int, offset: tuple[float, float, float]
) -> None:
    """Raises unless the root's own offset is the one that it has in this configuration."""
    if root != top:
        if trees.offsets[root].any():
            what = f"is the root of a tree whose top is {named(names[top])}, so that its OFFSET says nothing"
            raise TreesError(root, f"{what}. Write OFFSET 0 0 0.")
    elif trees.tops[top].above < 0:
        raise TreesError(root, "is the root and the top of its tree. Remove TOP: its OFFSET says all.")
    elif (trees.offsets[root] != offset).any():
        raise TreesError(
            root, "has an OFFSET and a LINK of different lengths. Write the same numbers in both."
        )


def _check_links(trees: Trees, names: Sequence[str]) -> None:
    """Raises where trees hang on each other in a circle."""
    roots = _roots(trees.parents)
    above = {
        int(roots[top]): (top, int(roots[link.above])) for top, link in trees.tops.items() if link.above >= 0
    }
    done: set[int] = set()
    for start in above:
        path: set[int] = set()
        root = start
        while root in above and root not in done:
            if root in path:
                top = above[root][0]
                what = f"hangs on {named(names[trees.tops[top].above])}, which hangs on it in turn"
                raise TreesError(top, f"{what}. Link it elsewhere.")
            path.add(root)
            root = above[root][1]
        done |= path


def _roots(parents: NDArray[np.int32]) -> NDArray[np.intp]:
    """(J,) the root of each joint's tree."""
    found = np.where(parents < 0, np.arange(len(parents)), parents).astype(np.intp)
    while True:
        further = found[found]
        if np.array_equal(further, found):
            return found
        found = further


def _home_slots(bones: Bones, names: Sequence[str]) -> NDArray[np.int32]:
    """(J,) the slot of each bone: its turn, or -1 where it turns as the bone above it.

    Raises:
        TreesError: a turn is used by bones that are no siblings.
    """
    parents, turns = bones.parents, bones.turns
    above = np.where(parents >= 0, turns[parents], -1)
    slots = np.where(turns == above, -1, turns).astype(np.int32)
    lost = np.flatnonzero((turns < 0) & (above >= 0))
    if len(lost):
        joint = int(lost[0])
        what = f"has no TURN, but hangs at home on {named(names[parents[joint]])}, which has one"
        raise TreesError(joint, f"{what}. Write the same number if its bone turns as one with that.")
    users: dict[int, int] = {}
    for joint in np.flatnonzero(slots >= 0).tolist():
        other = users.setdefault(int(slots[joint]), joint)
        if other != joint and (parents[other] != parents[joint] or parents[joint] < 0):
            what = (
                f"has the same TURN {slots[joint]} as {named(names[other])}, but they are no siblings at home"
            )
            raise TreesError(joint, f"{what}. Give one of them another number.")
    return slots
