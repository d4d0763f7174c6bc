"""What the reader of actions must know of the body: degrees of freedom, their ranges, what hangs on what."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from gmr.actionlets.actions.tables import nearest
from gmr.actionlets.actions.units import Extreme
from gmr.errors import FormatError

__all__ = ["Anatomy", "the_anatomy"]

Fault = Callable[[str], FormatError]
"""Makes an error of a sentence, at a place in a file."""

_ROUNDING: Final = 1e-6
_FARTHEST: Final = 100.0
_MOST_TURNED: Final = 36_000.0
"""Metres and degrees that the root, which has no limits, is moved from its path by at most."""
_ROOT: Final = {"pelvis": "root"}
"""By joint, what its degrees of freedom are named for, where that is something else."""


@dataclass(frozen=True)
class Anatomy:
    """The detailed body's degrees of freedom as library files name them.

    Args:
        ranges: by name, lowest and highest; degrees, metres for the root's lengths.
        lengths: names of those that are lengths.
        hangs_on: by joint, the joint above it; the root of the detailed body moves its pelvis.
    """

    ranges: Mapping[str, tuple[float, float]]
    lengths: frozenset[str]
    hangs_on: Mapping[str, str]

    def joint(self, name: str, has_side: bool, unit: str, fault: Fault, user: Fault) -> str:
        """The joint that a unit without a side means when it is used for the left.

        Args:
            fault: makes the error for the unit that names the joint.
            user: makes the error for the unit that uses it.
        """
        joints = tuple(dict.fromkeys(dof.partition(".")[0] for dof in self.ranges))
        if name in joints:
            return name
        if f"left_{name}" not in joints:
            sideless = dict.fromkeys(joint.removeprefix("left_").removeprefix("right_") for joint in joints)
            raise fault(f"moves the joint '{name}', which the body does not have. {nearest(name, sideless)}")
        if not has_side:
            raise user(
                f"uses '{unit}', which moves a {name}, without saying which; write side = 'left' or 'right'"
            )
        return f"left_{name}"

    def dof(self, joint: str, motion: str, fault: Fault) -> str:
        """The degree of freedom of a joint's motion."""
        motions = [dof.partition(".")[2] for dof in self.ranges if dof.startswith(f"{joint}.")]
        if motion not in motions:
            raise fault(
                f"gives {joint} the motion '{motion}', which it does not have. {nearest(motion, motions)}"
            )
        return f"{joint}.{motion}"

    def check_dof(self, dof: str, fault: Fault) -> None:
        """Refuses a name that is no degree of freedom."""
        if dof not in self.ranges:
            raise fault(
                f"names the degree of freedom '{dof}', which the body does not have. "
                f"{nearest(dof, self.ranges)}"
            )

    def check_range(self, dof: str, course: Sequence[Extreme], fault: Fault) -> None:
        """Refuses extremes that leave the range of motion for some values of the parameters."""
        far = _FARTHEST if dof in self.lengths else _MOST_TURNED
        low, high = np.clip(self.ranges[dof], -far, far).tolist()
        unit = "m" if dof in self.lengths else "degrees"
        for extreme in course:
            for angle in (extreme.angle.lowest, extreme.angle.highest):
                if not low - _ROUNDING <= angle <= high + _ROUNDING:
                    raise fault(
                        f"takes {dof} to {angle:.6g} {unit}; its range of motion is {low:g} to {high:g} "
                        f"{unit}"
                    )

    def check_connected(self, dofs: Iterable[str], fault: Fault) -> None:
        """Refuses a limb with joints that do not hang on one another."""
        joints = dict.fromkeys(dof.partition(".")[0] for dof in dofs)
        tops = [joint for joint in joints if self.hangs_on.get(joint) not in joints]
        if len(tops) > 1:
            raise fault(
                f"is a limb, and its joints are not connected: nothing between {' and '.join(tops)}. Make it "
                f"[group], or add the joints between them"
            )


@cache
def the_anatomy() -> Anatomy:
    """The detailed body's; the same for every height and sex."""
    from gmr.actionlets.body import Body

    body = Body.of()
    names = body.skeleton.names
    return Anatomy(
        ranges={dof.name: (dof.low_deg, dof.high_deg) for dof in body.dofs},
        lengths=frozenset(dof.name for dof in body.dofs if dof.is_length),
        hangs_on={
            name: _ROOT.get(names[parent], names[parent])
            for name, parent in zip(names, body.skeleton.parents, strict=True)
            if parent >= 0
        },
    )
