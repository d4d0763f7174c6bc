"""The node tree of a character: what hangs on what, and how each node stands at rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import frozen
from gmr.errors import SkeletonError
from gmr.skinning.transforms import local_matrices

__all__ = ["Nodes", "parents_first"]


@dataclass(frozen=True, eq=False)
class Nodes:
    """N nodes: the joints of a character and all that they hang on.

    Args:
        names: (N,) names; they may repeat.
        parents: (N,) int32, -1 for a root; in any order.
        translations: (N, 3) float64 metres, in the parent's frame.
        rotations: (N, 4) float64 unit quaternions xyzw, in the parent's frame.
        scales: (N, 3) float64 along the node's own axes, applied first.
        matrices: node -> (4, 4) float64 for nodes given by a matrix instead, which may hold what the three
            cannot say; the three of such a node are not looked at.

    Raises:
        SkeletonError: the arrays do not fit each other, or the nodes hang on each other in a circle.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int32]
    translations: NDArray[np.float64]
    rotations: NDArray[np.float64]
    scales: NDArray[np.float64]
    matrices: Mapping[int, NDArray[np.float64]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        count = len(self.names)
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "parents", frozen(self.parents, np.int32))
        for key, width in (("translations", 3), ("rotations", 4), ("scales", 3)):
            array = frozen(getattr(self, key), np.float64)
            if array.shape != (count, width):
                raise SkeletonError(f"{key} has the shape {array.shape} where {(count, width)} is needed")
            object.__setattr__(self, key, array)
        matrices = {int(node): frozen(matrix, np.float64) for node, matrix in self.matrices.items()}
        if any(not 0 <= node < count or matrix.shape != (4, 4) for node, matrix in matrices.items()):
            raise SkeletonError("matrices must be (4, 4) each, of nodes that are there")
        object.__setattr__(self, "matrices", matrices)
        if self.parents.shape != (count,):
            raise SkeletonError(f"parents has the shape {self.parents.shape} where {(count,)} is needed")
        self.order  # noqa: B018  (what is no tree is refused here)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def order(self) -> tuple[int, ...]:
        """All nodes so ordered that none comes before its parent."""
        found, circle = parents_first(self.parents)
        if circle is not None:
            raise SkeletonError(f"node {circle} ('{self.names[circle]}') hangs on itself; give it a parent")
        return found

    @cached_property
    def local(self) -> NDArray[np.float64]:
        """(N, 4, 4) float64: each node's frame in its parent's, at rest."""
        # A file's single precision leaves quaternions a little longer or shorter than 1.
        turns = self.rotations / np.linalg.norm(self.rotations, axis=1, keepdims=True)
        found = local_matrices(self.translations, turns, self.scales)
        for node, matrix in self.matrices.items():
            found[node] = matrix
        return frozen(found, np.float64)

    @cached_property
    def world(self) -> NDArray[np.float64]:
        """(N, 4, 4) float64: each node's frame in the world, at rest."""
        found = self.local.copy()
        for node in self.order:
            if self.parents[node] >= 0:
                found[node] = found[self.parents[node]] @ found[node]
        return frozen(found, np.float64)


def parents_first(parents: NDArray[np.int32]) -> tuple[tuple[int, ...], int | None]:
    """Nodes so ordered that none comes before its parent, and one that hangs in a circle (None: none)."""
    children: list[list[int]] = [[] for _ in range(len(parents))]
    for node, parent in enumerate(parents.tolist()):
        if parent >= 0:
            children[parent].append(node)
    order = [node for node, parent in enumerate(parents.tolist()) if parent < 0]
    for node in order:  # grows while it is walked
        order.extend(children[node])
    if len(order) == len(parents):
        return tuple(order), None
    return tuple(order), min(set(range(len(parents))) - set(order))
