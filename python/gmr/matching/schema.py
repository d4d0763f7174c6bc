"""What poses are compared by, as data: groups of features, their times and weights."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gmr.errors import DatasetError
from gmr.listing import quoted
from gmr.skeleton import Skeleton

__all__ = ["LOCOMOTION", "Group", "Measure", "Schema"]

Measure = Literal["position", "velocity", "root_position", "root_facing"]

_WIDTHS: Mapping[str, int] = {"position": 3, "velocity": 3, "root_position": 2, "root_facing": 2}
_OF_JOINTS = ("position", "velocity")


@dataclass(frozen=True, slots=True)
class Group:
    """Features that are scaled together.

    Args:
        name: for tables and cost breakdowns.
        measure: ``"position"`` or ``"velocity"`` of a joint (3 numbers: metres, metres a second), or
            ``"root_position"`` or ``"root_facing"`` of the simulation root (2 numbers: x, z), all seen
            from the simulation root of the frame that they describe.
        joint: a role (``"left_foot"``), a joint's name or its index; None for the root.
        times: seconds after the frame; negative: before.
        weight: how much it counts once it is scaled to a mean standard deviation of 1; 0 or more.
    """

    name: str
    measure: Measure
    joint: str | int | None = None
    times: tuple[float, ...] = (0.0,)
    weight: float = 1.0

    @property
    def width(self) -> int:
        """How many numbers it has."""
        return _WIDTHS.get(self.measure, 0) * len(self.times)

    def __post_init__(self) -> None:
        if self.measure not in _WIDTHS:
            raise DatasetError(
                f"feature group '{self.name}' measures '{self.measure}'; use one of {', '.join(_WIDTHS)}"
            )
        if (self.joint is None) == (self.measure in _OF_JOINTS):
            wanted = "needs a joint" if self.joint is None else "is about the root and takes no joint"
            raise DatasetError(f"feature group '{self.name}' ({self.measure}) {wanted}")


@dataclass(frozen=True, slots=True)
class Schema:
    """The feature groups of a database, in the order of their numbers."""

    groups: tuple[Group, ...]

    @property
    def dims(self) -> int:
        """D, how many numbers a frame has."""
        return sum(group.width for group in self.groups)

    @property
    def span(self) -> float:
        """Seconds from the earliest to the latest time that a frame's features look at."""
        times = [0.0, *(time for group in self.groups for time in group.times)]
        return max(times) - min(times)

    @property
    def columns(self) -> tuple[str, ...]:
        """A name for each of the D numbers: ``"trajectory position +0.333 s x"``."""
        return tuple(
            f"{group.name}{f' {time:+.3f} s' if time else ''} {axis}"
            for group in self.groups
            for time in group.times
            for axis in ("xyz" if group.measure in _OF_JOINTS else "xz")
        )

    def slices(self) -> dict[str, slice]:
        """The columns of each group, by its name."""
        found, start = {}, 0
        for group in self.groups:
            found[group.name] = slice(start, start + group.width)
            start += group.width
        return found

    def spread(self, weights: Mapping[str, float]) -> NDArray[np.float32]:
        """(D,) weights of a search, from those of groups by their names; groups left out count as ever.

        Raises:
            DatasetError: no group is called so.
        """
        slices, spread = self.slices(), np.ones(self.dims, np.float32)
        for name, weight in weights.items():
            if name not in slices:
                raise DatasetError(f"no feature group is called '{name}'; there are {quoted(slices, 20)}")
            spread[slices[name]] = weight
        return spread

    def weighed(self, weights: Mapping[str, float]) -> Schema:
        """The same features with other weights.

        Args:
            weights: by the names of groups, 0 or more; ``"foot position"`` stands for those of the left and
                the right. Groups left out keep theirs.

        Raises:
            DatasetError: no group is called so; or a weight is none.
        """
        named = {name: [group.name for group in self.groups if _is(group, name)] for name in weights}
        for name, weight in weights.items():
            if not named[name]:
                known = quoted([group.name for group in self.groups], 20)
                raise DatasetError(f"no feature group is called '{name}'; there are {known}")
            if not 0 <= weight < math.inf:
                raise DatasetError(f"the weight of '{name}' is {weight:g}; give a number, 0 or more")
        found = {group: weight for name, weight in weights.items() for group in named[name]}
        return Schema(
            tuple(replace(group, weight=found.get(group.name, group.weight)) for group in self.groups)
        )

    def resolve(
        self, skeleton: Skeleton, roles: Mapping[str, int], rate: float
    ) -> list[tuple[str, str, int | None, list[int], float]]:
        """The groups as the core takes them: joints as indices, times as frames.

        Args:
            skeleton: whose joints are meant.
            roles: the joint of each role that was found.
            rate: frames a second.
        """
        return [
            (
                group.name,
                group.measure,
                None if group.joint is None else _joint(group, skeleton, roles),
                [round(time * rate) for time in group.times],
                group.weight,
            )
            for group in self.groups
        ]


def _is(group: Group, name: str) -> bool:
    sideless = " ".join(word for word in group.name.split() if word not in ("left", "right"))
    return name in (group.name, sideless)


def _joint(group: Group, skeleton: Skeleton, roles: Mapping[str, int]) -> int:
    if isinstance(group.joint, str) and group.joint in roles:
        return roles[group.joint]
    assert group.joint is not None
    return skeleton.index(group.joint)


_AHEAD = (20 / 60, 40 / 60, 60 / 60)

LOCOMOTION = Schema(
    (
        Group("left foot position", "position", "left_foot", weight=0.75),
        Group("right foot position", "position", "right_foot", weight=0.75),
        Group("left foot velocity", "velocity", "left_foot"),
        Group("right foot velocity", "velocity", "right_foot"),
        Group("hips velocity", "velocity", "hips"),
        Group("trajectory position", "root_position", times=_AHEAD),
        Group("trajectory facing", "root_facing", times=_AHEAD, weight=1.5),
    )
)
"""The 27 numbers of Holden et al., "Learned Motion Matching" (2020), Sec. 3, with its weights."""
