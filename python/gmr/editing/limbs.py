"""Limbs of two bones: from a hip over the knee to the ankle, from a shoulder over the elbow to the wrist."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from gmr.body.joints import named_roles
from gmr.body.naming import HANDS, side_and_part
from gmr.errors import SkeletonError
from gmr.listing import quoted
from gmr.skeleton import Skeleton

__all__ = ["Limb", "feet_of", "hands_of", "limb_of", "limb_that_moves", "path_down"]

Joint = str | int | np.integer[Any]

_SHOWN = 40
_TOPS = ("left_up_leg", "right_up_leg", "left_shoulder", "right_shoulder")


@dataclass(frozen=True, slots=True)
class Limb:
    """A limb by the indices of three joints at home, each above the next; joints may lie between them."""

    top: int
    middle: int
    end: int

    @classmethod
    def of(cls, skeleton: Skeleton, top: Joint, middle: Joint, end: Joint) -> Limb:
        """The limb of these joints, by names or indices.

        Raises:
            SkeletonError: a joint does not exist, or they do not hang on each other.
        """
        limb = cls(skeleton.index(top), skeleton.index(middle), skeleton.index(end))
        path_down(skeleton, limb.top, limb.middle)
        path_down(skeleton, limb.middle, limb.end)
        return limb


def limb_of(skeleton: Skeleton, end: Joint, roles: Mapping[str, int] | None = None) -> Limb:
    """The limb that ends in a joint.

    It begins in the hip of a foot and the upper arm of a hand, where names tell those; else it is made of the
    two nearest bones above the joint that have a length. Between top and end, the middle is the joint that
    makes the shorter of the two parts as long as can be.

    Args:
        skeleton: in any configuration; the limb is that at home.
        end: name or index.
        roles: the joints of the body, as :func:`gmr.editing.roles.known_roles` finds them in a motion; by
            their names alone where not given.

    Raises:
        SkeletonError: there are no two bones above the joint.
    """
    at_home = skeleton if skeleton.home is None else skeleton.home
    last = at_home.index(end)
    top = _known_top(at_home, last, _roles(at_home, roles))
    if top is None:
        above = _with_length_above(at_home, last)
        if len(above) < 2:
            raise SkeletonError(
                f"'{at_home.names[last]}' cannot be placed: a limb needs two bones above its end, and there "
                f"{'is one' if above else 'is none'}; name a joint farther from the root"
            )
        return Limb(above[1], above[0], last)
    joints = path_down(at_home, top, last)
    to_joint = np.cumsum(np.linalg.norm(at_home.offsets[joints], axis=1))
    shorter = np.minimum(to_joint, to_joint[-1] - to_joint)[:-1]
    return Limb(top, joints[int(shorter.argmax())], last)


def limb_that_moves(skeleton: Skeleton, joint: Joint, roles: Mapping[str, int] | None = None) -> Limb:
    """The limb whose end carries a joint along rigidly: the leg for a toe, the arm for a finger; else the
    limb that ends in the joint. Arguments and errors are those of :func:`limb_of`."""
    at_home = skeleton if skeleton.home is None else skeleton.home
    index = at_home.index(joint)
    known = _roles(at_home, roles)
    feet = feet_of(at_home, known)
    here = index
    while here >= 0:
        if here in feet or side_and_part(at_home.names[here])[1] in HANDS:
            return limb_of(at_home, here, known)
        here = int(at_home.parents[here])
    return limb_of(at_home, index, known)


def feet_of(skeleton: Skeleton, roles: Mapping[str, int] | None = None) -> set[int]:
    """The ankles, as far as they are known."""
    known = _roles(skeleton, roles)
    return {known[role] for role in ("left_foot", "right_foot") if role in known}


def hands_of(skeleton: Skeleton) -> tuple[int, int]:
    """The left and the right hand, by their names.

    Raises:
        SkeletonError: a side has no joint named so.
    """
    parts = [side_and_part(name) for name in skeleton.names]
    found = []
    for side in ("left", "right"):
        known = (parts.index((side, word)) for word in HANDS if (side, word) in parts)
        hand = next(known, None)
        if hand is None:
            raise SkeletonError(
                f"no joint is named as the {side} hand; name both: joints=('LeftHand', 'RightHand') or as "
                f"this skeleton calls them: {quoted(skeleton.names, _SHOWN)}"
            )
        found.append(hand)
    return found[0], found[1]


def path_down(skeleton: Skeleton, top: int, bottom: int) -> list[int]:
    """The joints below ``top`` down to ``bottom``.

    Raises:
        SkeletonError: ``bottom`` does not hang below ``top``.
    """
    found = []
    here = bottom
    while here != top:
        found.append(here)
        here = int(skeleton.parents[here])
        if here < 0:
            raise SkeletonError(
                f"'{skeleton.names[bottom]}' does not hang below '{skeleton.names[top]}', so they are not of "
                "one limb; name its joints from the top to the end"
            )
    if not found:
        raise SkeletonError(f"'{skeleton.names[top]}' is named twice in a limb; name three joints")
    return found[::-1]


def _with_length_above(skeleton: Skeleton, joint: int) -> list[int]:
    """The joints in which the bones above a joint begin, those without length left out; the nearest first."""
    found, here = [], joint
    while skeleton.parents[here] >= 0:
        above = int(skeleton.parents[here])
        if np.any(skeleton.offsets[here] != 0):
            found.append(above)
        here = above
    return found


def _known_top(skeleton: Skeleton, end: int, roles: Mapping[str, int]) -> int | None:
    """The hip or upper arm above a foot or hand, where it is known and a joint lies between."""
    tops = [roles[role] for role in _TOPS if role in roles]
    return next((top for top in tops if _is_well_above(skeleton, top, end)), None)


def _is_well_above(skeleton: Skeleton, top: int, end: int) -> bool:
    """Whether ``top`` is above ``end`` with at least one joint between them."""
    here, steps = end, 0
    while here >= 0 and here != top:
        here, steps = int(skeleton.parents[here]), steps + 1
    return here == top and steps >= 2


def _roles(skeleton: Skeleton, roles: Mapping[str, int] | None) -> Mapping[str, int]:
    return (named_roles(skeleton) or {}) if roles is None else roles
