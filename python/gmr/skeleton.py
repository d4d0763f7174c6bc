"""A skeleton: a forest of joints whose bones are turned by rotation slots.

The bone that ends in joint ``j`` is turned by slot ``slots[j]``. A file in post-rotation form (BVH, AMC,
glTF) is the case where siblings share the slot that carries their parent's rotation; the General Motion
Representation lets each bone have a slot of its own. Source: spec "General Motion Representation", rotation
slots.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.arrays import frozen, read_only
from gmr.errors import SkeletonError
from gmr.listing import listed, quoted

__all__ = ["ROOTS_SHOWN", "End", "Skeleton", "owned_slots"]

ROOTS_SHOWN = 5
"""Roots that a ``repr`` names; the others it counts."""

_SHOWN = 8
"""Names that an error lists; the others it counts."""


class End(IntEnum):
    """What a joint is to the file that it came from."""

    JOINT = 0
    """A joint proper."""
    SITE = 1
    """An ``End Site``, named "<parent>_end"."""
    TIP = 2
    """A zero-length tip that reading added below a turning leaf without ``End Site``; never written back."""


@dataclass(frozen=True, eq=False, repr=False)
class Skeleton:
    """Names, parents, rest offsets and rotation slots of J joints; immutable.

    Args:
        names: (J,) names as the file has them; they may repeat.
        parents: (J,) int32, -1 for a root.
        offsets: (J, 3) float64 vector from the parent to the joint at rest, in file units.
        slots: (J,) int32, the rotation slot that turns the bone ending in each joint; -1: the bone has its
            parent's world rotation.
        slot_count: S, the number of slots; slots that turn no bone are allowed.
        ends: (J,) uint8 of :class:`End`.
        home: the skeleton before any of its roots was moved; None: this is it. See :mod:`gmr.forest`.

    Raises:
        SkeletonError: the arrays do not fit each other, do not make a forest, or are no configuration of
            ``home``.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int32]
    offsets: NDArray[np.float64]
    slots: NDArray[np.int32]
    slot_count: int
    ends: NDArray[np.uint8]
    home: Skeleton | None = None

    def __post_init__(self) -> None:
        count = len(self.names)
        object.__setattr__(self, "names", tuple(self.names))
        for field, dtype, shape in (
            ("parents", np.int32, (count,)),
            ("offsets", np.float64, (count, 3)),
            ("slots", np.int32, (count,)),
            ("ends", np.uint8, (count,)),
        ):
            array = frozen(getattr(self, field), dtype)
            if array.shape != shape:
                raise SkeletonError(
                    f"{field} has the shape {array.shape} where {shape} is needed: one entry a joint"
                )
            object.__setattr__(self, field, array)
        # What is no forest is refused here, not where it is first used.
        if self.home is None:
            self.topology  # noqa: B018
        elif self.names != self.home.names or not np.array_equal(self.forest.topology.slots, self.slots):
            raise SkeletonError("these are not the slots of a configuration of home; use with_roots()")

    @classmethod
    def post_rotation(
        cls,
        names: Sequence[str],
        parents: ArrayLike,
        offsets: ArrayLike,
        *,
        ends: ArrayLike | None = None,
        turning: Iterable[int] = (),
    ) -> Skeleton:
        """Skeleton of a post-rotation file: the children of a joint share the slot that carries its rotation.

        Args:
            names: (J,) names in file order.
            parents: (J,) -1 for a root.
            offsets: (J, 3) file units.
            ends: (J,) of :class:`End`; all joints proper by default.
            turning: joints that own a slot although nothing hangs on them (they have channels).
        """
        parents = np.asarray(parents, np.int32).reshape(len(names))
        owned = owned_slots(parents, turning)
        none = np.full(len(names), -1, np.int32)
        return cls(
            names=tuple(names),
            parents=parents,
            offsets=np.asarray(offsets, np.float64).reshape(len(names), 3),
            slots=np.where(parents >= 0, owned[parents], -1).astype(np.int32) if len(names) else none,
            slot_count=int(owned.max(initial=-1)) + 1,
            ends=np.zeros(len(names), np.uint8) if ends is None else np.asarray(ends, np.uint8),
        )

    @property
    def joint_count(self) -> int:
        """J, end sites and tips included."""
        return len(self.names)

    @cached_property
    def topology(self) -> _core.Topology:
        """Parents and slots as the kernels take them, with what they derive from them."""
        try:
            return _core.Topology(self.parents, self.slots, self.slot_count)
        except ValueError as error:
            raise SkeletonError(f"{error} (joints: {quoted(self.names, _SHOWN)})") from error

    @cached_property
    def turning(self) -> tuple[NDArray[np.int32], _core.Topology]:
        """The slots that move some joint, and the topology with just these: enough for positions.

        The slot of a root on which nothing hangs moves nothing, and one that turns no bone neither.
        """
        world = np.asarray(self.topology.world_slots)
        moves = np.array([parent >= 0 or bool(self.children[j]) for j, parent in enumerate(self.parents)])
        slots = np.unique(world[moves & (world >= 0)]) if self.joint_count else world
        renumbered = np.full(self.slot_count + 1, -1, np.int32)
        renumbered[slots] = np.arange(len(slots))
        return read_only(slots), _core.Topology(self.parents, renumbered[self.slots], len(slots))

    @cached_property
    def forest(self) -> _core.Forest:
        """This configuration, as the core takes it."""
        home = self if self.home is None else self.home
        try:
            return _core.Forest(home.topology, None if self.home is None else self.parents)
        except ValueError as error:
            raise SkeletonError(f"{error} (joints: {quoted(self.names, _SHOWN)})") from error

    @property
    def links(self) -> NDArray[np.int32]:
        """(J,) int32: the soft links: for a joint that is cut off from its parent at home that parent, else
        -1."""
        return self.forest.links

    @cached_property
    def roots(self) -> tuple[int, ...]:
        """Indices of the joints without a parent, in file order."""
        return tuple(np.flatnonzero(self.parents < 0).tolist())

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """Indices of each joint's children, in file order."""
        found: list[list[int]] = [[] for _ in self.names]
        for joint, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                found[parent].append(joint)
        return tuple(tuple(joints) for joints in found)

    @cached_property
    def parents_first(self) -> tuple[int, ...]:
        """All joints so ordered that none comes before its parent."""
        order = list(self.roots)
        for joint in order:  # grows while it is walked
            order.extend(self.children[joint])
        return tuple(order)

    @cached_property
    def bone_slots(self) -> NDArray[np.int32]:
        """(J,) slot whose world rotation is that of each bone at home, by the joint in which it ends; -1: the
        world's."""
        carriers = np.empty(self.joint_count, np.intp)
        carriers[self.forest.bones] = np.arange(self.joint_count)
        return frozen(np.asarray(self.topology.world_slots)[carriers], np.int32)

    @cached_property
    def frame_slots(self) -> NDArray[np.int32]:
        """(J,) slot whose world rotation is each joint's frame as BVH means it (post-rotation); -1: the
        world's.

        It is the slot that the joint's children at home share; a joint without children has the frame of its
        own bone.

        Raises:
            SkeletonError: two children of a joint have different world rotations, so it has no one frame.
        """
        home = self if self.home is None else self.home
        world = np.asarray(home.topology.world_slots)
        found = self.bone_slots.copy()
        for joint, children in enumerate(home.children):
            if not children:
                continue
            first, *others = children
            found[joint] = self.bone_slots[first]
            for other in others:
                if world[other] != world[first]:
                    raise SkeletonError(
                        f"joint '{self.names[joint]}' has no one frame: its children '{self.names[first]}' "
                        f"and '{self.names[other]}' turn independently. Use bone_rotations(), or "
                        "restore_dummies() where dummies were dropped."
                    )
        return frozen(found, np.int32)

    def index(self, joint: str | int | np.integer[Any]) -> int:
        """Index of a joint given by name or by index.

        Raises:
            SkeletonError: no joint has the name (the nearest names are given), several have it, or the index
                is out of range.
        """
        if not isinstance(joint, str):
            if not isinstance(joint, int | np.integer):
                raise TypeError(f"a joint is given by its name or its index, not by {joint!r}")
            if 0 <= joint < self.joint_count:
                return int(joint)
            raise SkeletonError(
                f"there is no joint {joint}; the skeleton has joints 0 to {self.joint_count - 1}"
            )
        found = self._joints_by_name.get(joint, [])
        if len(found) == 1:
            return found[0]
        if found:
            raise SkeletonError(
                f"{len(found)} joints are named '{joint}': say which by index, "
                f"{listed([str(index) for index in found], _SHOWN)}"
            )
        near = difflib.get_close_matches(joint, self.names, n=3)
        hint = (
            f"did you mean {quoted(near, _SHOWN)}?"
            if near
            else f"the skeleton has {quoted(self.names, _SHOWN)}."
        )
        raise SkeletonError(f"there is no joint '{joint}'; {hint}")

    def indices(self, joints: Iterable[str | int | np.integer[Any]]) -> NDArray[np.int32]:
        """(K,) int32 indices of joints given by names or indices; see :meth:`index`."""
        if isinstance(joints, str):
            raise TypeError(f"several joints are asked for: put '{joints}' into a list")
        return np.array([self.index(joint) for joint in joints], np.int32)

    @cached_property
    def _joints_by_name(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for joint, name in enumerate(self.names):
            found.setdefault(name, []).append(joint)
        return found

    def __repr__(self) -> str:
        roots = listed([self.names[root] for root in self.roots], ROOTS_SHOWN) or "none"
        return f"Skeleton({self.joint_count} joints, roots: {roots})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Skeleton):
            return NotImplemented
        return self is other or (
            self.names == other.names
            and self.slot_count == other.slot_count
            and all(
                np.array_equal(getattr(self, field), getattr(other, field))
                for field in ("parents", "slots", "offsets", "ends")
            )
            and self.home == other.home
        )

    def __hash__(self) -> int:
        return hash((self.names, self.parents.tobytes(), self.slots.tobytes()))

    def __reduce__(self) -> tuple[Any, ...]:
        fields = (self.names, self.parents, self.offsets, self.slots, self.slot_count, self.ends, self.home)
        return Skeleton, fields


def owned_slots(parents: NDArray[np.int32], turning: Iterable[int] = ()) -> NDArray[np.int32]:
    """(J,) int32: the slot that each joint of a post-rotation file owns, numbered in file order; -1 for none.

    A joint owns a slot when it has children, or when it is one of ``turning`` (it has channels).
    """
    owns = np.zeros(len(parents), bool)
    owns[parents[parents >= 0]] = True
    owns[np.fromiter(turning, np.intp)] = True
    return np.where(owns, np.cumsum(owns) - 1, -1).astype(np.int32)
