"""The body that actionlets move: 15 joints, its degrees of freedom, sizes and masses.

The paper's body has 22 degrees of freedom; the detailed one has wrists, ankles and a root that moves beside.
Both stand on the same skeleton, in metres, whose rest is the anatomical standing posture.
Source: Zheng et al., "Human Motion Simulation and Action Corpus", the body; sizes are cited in
``gmr/data/body/proportions.toml``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.dofs import DETAILED, PAPER, Dof
from gmr.actionlets.proportions import Foot, Segment, segments_of, sizes, skeleton_of, stature_of
from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.errors import ActionletError
from gmr.listing import quoted
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Body", "Dof", "Foot", "Segment"]


@dataclass(frozen=True, eq=False, repr=False)
class Body:
    """A body of some height and build; make one with :meth:`of` or :meth:`like`.

    Args:
        name: ``"paper"`` (22 degrees of freedom) or ``"detailed"`` (40).
        dofs: D degrees of freedom; the columns of all arrays of angles. The paper's 22 come first, in the
            order of its numbers.
        skeleton: 15 joints and 5 end sites, metres; the offsets are those of the anatomical standing posture.
        height: stature, metres.
        sex: ``"male"``, ``"female"`` or ``"average"``: whose proportions and masses it has.
        percentile: of the stature among those; 0 to 100.
        foot: where its heel and its ball are.
        segments: mass and centre of mass of what each joint turns.
    """

    name: str
    dofs: tuple[Dof, ...]
    skeleton: Skeleton
    height: float
    sex: str
    percentile: float
    foot: Foot
    segments: tuple[Segment, ...] = field(default=())

    @classmethod
    def of(
        cls,
        height: float | None = None,
        sex: str = "average",
        percentile: float | None = None,
        detailed: bool = True,
    ) -> Body:
        """A body of published proportions.

        Args:
            height: stature in metres, 1.2 to 2.3; 1.75 where neither it nor a percentile is given.
            sex: ``"male"``, ``"female"`` or ``"average"``, the mean of both.
            percentile: of the stature instead of the height, above 0 and below 100.
            detailed: with wrists, ankles and root (40 degrees of freedom), else the paper's 22.

        Raises:
            ActionletError: a height, sex or percentile out of bounds, or both height and percentile.
        """
        size = sizes(height, sex, percentile)
        return cls(
            "detailed" if detailed else "paper",
            DETAILED if detailed else PAPER,
            size.skeleton,
            size.height,
            sex,
            size.percentile,
            size.foot,
            size.segments,
        )

    @classmethod
    def like(cls, measured: Motion | Skeleton, sex: str = "average", detailed: bool = True) -> Body:
        """A body with the lengths of a measured skeleton; see :mod:`gmr.actionlets.likeness`.

        Args:
            measured: a motion, or a skeleton in metres, of a body that gmr knows.
            sex: whose masses, and whose proportions where nothing is measured.
            detailed: as in :meth:`of`.

        Raises:
            ActionletError: the body is not found, its unit is not known, or it is no adult's size.
        """
        from gmr.actionlets.likeness import lengths_like

        height, lengths = lengths_like(measured, sex)
        return cls(
            "detailed" if detailed else "paper",
            DETAILED if detailed else PAPER,
            skeleton_of(lengths),
            height,
            sex,
            100 * stature_of(sex).cdf(height),
            lengths.foot,
            segments_of(lengths, sex),
        )

    @property
    def dof_count(self) -> int:
        """D."""
        return len(self.dofs)

    @property
    def names(self) -> tuple[str, ...]:
        """(D,) names of the degrees of freedom."""
        return tuple(dof.name for dof in self.dofs)

    @cached_property
    def columns(self) -> dict[str, int]:
        """Column of each degree of freedom, by its name."""
        return {dof.name: column for column, dof in enumerate(self.dofs)}

    def dof(self, name: str) -> Dof:
        """A degree of freedom by its name.

        Raises:
            ActionletError: there is none of that name; the message offers the nearest.
        """
        return self.dofs[self.column(name)]

    def column(self, name: str) -> int:
        """The column of a degree of freedom; see :meth:`dof`."""
        if name in self.columns:
            return self.columns[name]
        import difflib

        near = difflib.get_close_matches(name, self.names, n=3)
        hint = f"did you mean {quoted(near, 3)}?" if near else f"there are {quoted(self.names, 40)}."
        raise ActionletError(f"the {self.name} body has no degree of freedom '{name}'; {hint}")

    @cached_property
    def low(self) -> NDArray[np.float64]:
        """(D,) lowest values, radians and metres."""
        return read_only(np.array([dof.low for dof in self.dofs]))

    @cached_property
    def high(self) -> NDArray[np.float64]:
        """(D,) highest values, radians and metres."""
        return read_only(np.array([dof.high for dof in self.dofs]))

    @cached_property
    def rest(self) -> NDArray[np.float64]:
        """(J, 3) places of the joints in the anatomical standing posture on the ground, metres."""
        places = self.skeleton.offsets.copy()
        for joint in self.skeleton.parents_first:
            if self.skeleton.parents[joint] >= 0:
                places[joint] += places[self.skeleton.parents[joint]]
        return read_only(places + np.array([0.0, self.hip_height, 0.0]))

    @cached_property
    def leg_length(self) -> float:
        """Length of a leg from hip to ankle, metres."""
        names = self.skeleton.names
        return float(
            -sum(self.skeleton.offsets[names.index(f"left_{joint}"), 1] for joint in ("knee", "ankle"))
        )

    @cached_property
    def hip_height(self) -> float:
        """Height of the pelvis above the ground in the standing posture, metres."""
        names = self.skeleton.names
        leg = [self.skeleton.offsets[names.index(f"left_{joint}"), 1] for joint in ("hip", "knee", "ankle")]
        return float(self.foot.ankle_height - np.sum(leg))

    @cached_property
    def layout(self) -> ChannelLayout:
        """Channels that a post-rotation file writes: each joint's turns in the order of its degrees of
        freedom."""
        letters = "XYZ"
        names = []
        for name, end in zip(self.skeleton.names, self.skeleton.ends.tolist(), strict=True):
            turns = [letters[_axis(dof)] for dof in DETAILED if dof.joint == name and not dof.is_length]
            turns += [letter for letter in "XZY" if letter not in turns]
            if name == "pelvis":
                turns = ["Y", "X", "Z"]
            rotations = tuple(f"{letter}rotation" for letter in turns)
            moves = ("Xposition", "Yposition", "Zposition") if name == "pelvis" else ()
            names.append(() if end else (*moves, *rotations))
        return ChannelLayout.of(self.skeleton, names)

    def check(self, angles: ArrayLike | Any, times: ArrayLike | None = None, what: str = "") -> None:
        """Raises where a degree of freedom leaves its range of motion.

        Args:
            angles: (F, D) or (D,) radians and metres; or a score, whose extremes are looked at.
            times: (F,) seconds, for the message.
            what: what they are of, for the message.

        Raises:
            ActionletError: names joint, degree of freedom, value and range, in degrees.
        """
        from gmr.actionlets.ranges import check

        check(self, angles, times, what)

    def clipped(self, angles: ArrayLike) -> NDArray[np.float64]:
        """(..., D) the angles, each moved into its range."""
        return np.clip(np.asarray(angles, np.float64), self.low, self.high)

    def subset(self, names: Iterable[str]) -> NDArray[np.intp]:
        """Columns of some degrees of freedom."""
        return np.array([self.column(name) for name in names], np.intp)

    def __repr__(self) -> str:
        return (
            f"Body({self.name!r}, {self.dof_count} degrees of freedom, {self.height:.3f} m, {self.sex}, "
            f"percentile {self.percentile:.3g})"
        )


def _axis(dof: Dof) -> int:
    """0, 1, 2: about which axis a degree of freedom turns."""
    return int(np.abs(dof.axis).argmax())
