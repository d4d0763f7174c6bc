"""How each joint is laid on the bone that it follows: see :mod:`gmr.skinning.driving.rest_poses`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.quaternions import IDENTITY, multiply, rotated
from gmr.skeleton import Skeleton
from gmr.skinning.driving.following import Following
from gmr.skinning.driving.rest_poses import heading_turn, shortest_turn

__all__ = ["Laid", "Pairs", "lay_on"]

Floats = NDArray[np.float64]

_FRAMES = ("hips", "clavicle", "head")
"""Parts whose bones point elsewhere in every skeleton; at rest they stand the same way in all."""
_FLAT = ("foot", "toe")
"""Parts that lie flat on the ground at rest, whatever their bones point to."""
_FIRST = ("arm", "up_leg")
"""Parts with which a limb begins."""
_NEXT = {
    "spine": ("spine", "neck", "head"),
    "neck": ("neck", "head"),
    "arm": ("forearm",),
    "forearm": ("hand",),
    "hand": ("middle", "index"),
    "up_leg": ("leg", "foot"),
    "leg": ("foot",),
    "foot": ("toe",),
}
"""Where the bone of a part leads to, the likeliest first; fingers lead to themselves."""


@dataclass(frozen=True)
class Pairs:
    """Which followed joint is above and below which.

    Args:
        character: its skeleton.
        motion: its skeleton, at home.
        following: who follows whom.
    """

    character: Skeleton
    motion: Skeleton
    following: Following

    @cached_property
    def above(self) -> dict[int, int]:
        """The nearest followed joint above each, by followed joint; -1: none."""
        return {joint: self.nearest(joint) for joint in self.following.bones}

    def nearest(self, joint: int) -> int:
        """The nearest followed joint above any joint of the character; -1: none."""
        here = int(self.character.parents[joint])
        while here >= 0 and here not in self.following.bones:
            here = int(self.character.parents[here])
        return here

    def all_above(self, joint: int) -> list[int]:
        """The followed joints above one."""
        found = []
        while (joint := self.nearest(joint)) >= 0:
            found.append(joint)
        return found

    @property
    def trunk(self) -> int:
        """The followed joint from which the limbs of something that is no known body go out; the topmost
        where it does not branch."""
        here = top = next(joint for joint in self.character.parents_first if joint in self.above)
        while below := [one for one, above in self.above.items() if above == here]:
            if len(below) > 1:
                return here
            (here,) = below
        return top

    def base(self, joint: int) -> str:
        """The part without its side; "" where it is not known."""
        part = self.following.parts.get(joint, "")
        return part.removeprefix("left_").removeprefix("right_")

    def next(self, joint: int, mine: Floats, theirs: Floats) -> int | None:
        """The followed joint to which the bone of a joint leads, in both skeletons; None where none does.

        Args:
            joint: followed.
            mine: (J, 3) places of the character at rest.
            theirs: (K, 3) places of the motion at rest.
        """
        below = [one for one, above in self.above.items() if above == joint]
        wanted = _NEXT.get(self.base(joint), (self.base(joint),))
        if self.base(joint):
            known = [one for base in wanted for one in below if self.base(one) == base]
            below = known[:1]
        if len(below) != 1:
            return None
        (found,) = below
        start, end = self.following.bones[joint].start, self.following.bones[found].start
        apart = np.linalg.norm(mine[found] - mine[joint]), np.linalg.norm(theirs[end] - theirs[start])
        long_enough = min(apart[0] / np.ptp(mine), apart[1] / np.ptp(theirs)) > 1e-4
        return found if long_enough and self._is_below(end, start) else None

    def _is_below(self, joint: int, top: int) -> bool:
        here = joint
        while here >= 0 and here != top:
            here = int(self.motion.parents[here])
        return here == top


@dataclass(frozen=True, eq=False)
class Laid:
    """A character laid on the rest pose of a motion.

    Args:
        turns: (4,) by followed joint: ``A W``.
        leads_to: by followed joint the one to which its bone leads, for bones whose directions are kept.
        angles_deg: by followed joint, how far its bone had to be turned at rest.
    """

    turns: dict[int, Floats]
    leads_to: dict[int, int]
    angles_deg: dict[int, float]


def lay_on(pairs: Pairs, mine: Floats, theirs: Floats, facing: Floats) -> Laid:
    """Turns of the character's joints that lay its rest on that of the motion.

    Args:
        pairs: who follows whom.
        mine: (J, 3) places of the character at rest.
        theirs: (K, 3) places of the motion at rest, +Y up.
        facing: (4,) turn of the whole character: ``W``.
    """
    own: dict[int, Floats] = {}
    leads_to: dict[int, int] = {}
    for joint in (one for one in pairs.character.parents_first if one in pairs.following.bones):
        base, above = pairs.base(joint), pairs.above[joint]
        led = pairs.next(joint, mine, theirs)
        before = own.get(above, IDENTITY) if base not in (*_FRAMES, *_FIRST) else IDENTITY
        is_chest = base == "spine" and (led is None or pairs.base(led) != "spine")
        if base in _FRAMES or is_chest or (base == "foot" and led is None):
            own[joint] = IDENTITY
        elif base == "toe" and pairs.base(above) == "foot":
            own[joint] = own[above]
        elif led is None:
            own[joint] = before
        else:
            one = rotated(facing, mine[led] - mine[joint])
            other = theirs[pairs.following.bones[led].start] - theirs[pairs.following.bones[joint].start]
            if base in _FLAT:
                own[joint] = heading_turn(one, other)
            else:
                own[joint] = multiply(shortest_turn(rotated(before, one), other), before)
                leads_to[joint] = led
    angles = {joint: float(np.degrees(2 * np.arccos(min(1.0, abs(turn[3]))))) for joint, turn in own.items()}
    return Laid({joint: multiply(turn, facing) for joint, turn in own.items()}, leads_to, angles)
