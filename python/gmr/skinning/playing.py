"""Where an animation puts the joints of a character: local transforms, then world matrices down the tree."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.skinning.keyframes import Animation, Channel
from gmr.skinning.nodes import Nodes
from gmr.skinning.transforms import local_matrices

__all__ = ["world_matrices"]

Array = NDArray[np.float64]

_MOST_MATRICES = 1 << 20
"""Matrices that any animation may be sampled to; one with many keys may be sampled to more."""
_PER_KEY = 64
"""Matrices for each key that the animation has."""


def world_matrices(nodes: Nodes, wanted: Iterable[int], animation: Animation, times: Array) -> Array:
    """(F, K, 4, 4) float64 world matrices of K nodes at (F,) seconds.

    Nodes that the animation does not move stand as at rest.

    Raises:
        GmrError: there would be more matrices than the animation has keys for.
    """
    chosen = [int(node) for node in wanted]
    needed = _with_all_above(nodes, chosen)
    keys = sum(len(channel.times) for channel in animation.channels)
    if len(needed) * len(times) > max(_MOST_MATRICES, _PER_KEY * keys):
        raise GmrError(
            f"animation '{animation.name}' would be {len(times):,} frames of {len(needed):,} nodes, "
            f"but it has {keys:,} keys; check its times, or give a lower rate"
        )
    channels: dict[int, list[Channel]] = {}
    for channel in animation.channels:
        channels.setdefault(channel.node, []).append(channel)
    world: dict[int, Array] = {}
    for node in nodes.order:
        if node not in needed:
            continue
        moved = channels.get(node)
        local = _local(nodes, node, moved, times) if moved else nodes.local[node]
        parent = int(nodes.parents[node])
        world[node] = world[parent] @ local if parent >= 0 else local
    found = np.empty((len(times), len(chosen), 4, 4))
    for k, node in enumerate(chosen):
        found[:, k] = world[node]
    return found


def _with_all_above(nodes: Nodes, chosen: list[int]) -> set[int]:
    found: set[int] = set()
    for node in chosen:
        while node >= 0 and node not in found:
            found.add(node)
            node = int(nodes.parents[node])
    return found


def _local(nodes: Nodes, node: int, channels: list[Channel], times: Array) -> Array:
    """(F, 4, 4) of one node that moves."""
    found = {
        "translation": nodes.translations[node],
        "rotation": nodes.rotations[node],
        "scale": nodes.scales[node],
    }
    for channel in channels:
        found[channel.path] = channel.at(times)
    return local_matrices(found["translation"], found["rotation"], found["scale"])
