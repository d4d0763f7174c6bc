"""A skeleton in other configurations: which bones are cut, and which joint of each tree is its root."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gmr import _core
from gmr.arrays import read_only
from gmr.skeleton import Skeleton

__all__ = ["arranged", "configuration"]


def arranged(skeleton: Skeleton, forest: _core.Forest) -> Skeleton:
    """The skeleton in another configuration."""
    at_home = skeleton if skeleton.home is None else skeleton.home
    topology = forest.topology
    parents, bones = np.asarray(topology.parents), np.asarray(forest.bones)
    if np.array_equal(parents, at_home.parents):
        return at_home
    is_turned = bones != np.arange(len(bones))
    offsets = np.where(is_turned[:, None], -at_home.offsets[bones], at_home.offsets)
    offsets[is_turned & (parents < 0)] = 0
    return Skeleton(
        at_home.names, parents, read_only(offsets), topology.slots, topology.slot_count, at_home.ends, at_home
    )


def configuration(skeleton: Skeleton, cut: Iterable[int], roots: Iterable[int]) -> Skeleton:
    """The configuration in which the bones that end at home in the joints ``cut`` are cut.

    Each tree hangs on the one of ``roots`` that is in it; one without hangs on its joint nearest to home.
    """
    at_home = skeleton if skeleton.home is None else skeleton.home
    parents = at_home.parents.copy()
    parents[list(cut)] = -1
    for root in roots:
        below, here = -1, root
        while here >= 0:
            above = int(parents[here])
            parents[here] = below
            below, here = here, above
    return arranged(at_home, _core.Forest(at_home.topology, parents))
