"""The parts of a body in a motion or a character: by their names, else by the body's shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.body.joints import find_joints
from gmr.body.measures import path
from gmr.errors import DatasetError
from gmr.skeleton import Skeleton
from gmr.skinning.driving.parts import Parts, parts_by_name

__all__ = ["Body", "find_body"]

Floats = NDArray[np.float64]

_UPRIGHT = 0.7
"""Cosine of the lean beyond which a trunk is no human's: what goes on four legs is told by that."""


@dataclass(frozen=True)
class Body:
    """Joints by part, and what told them: a naming's title, or "shape"."""

    parts: Parts
    found_by: str

    def one(self, part: str) -> int | None:
        """The joint of a part, the first of a chain; None where there is none."""
        return self.parts[part][0] if part in self.parts else None


def find_body(skeleton: Skeleton, rest: Floats) -> Body | None:
    """The body in a skeleton; None where neither names nor shape tell it.

    Args:
        skeleton: J joints at home.
        rest: (J, 3) places in a pose that stands, +Y up.
    """
    proper = ["" if end else name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True)]
    named = parts_by_name(proper)
    if named is not None:
        naming, parts = named
        return Body(parts, naming.title)
    shaped = _parts_by_shape(skeleton, rest)
    return None if shaped is None else Body(shaped, "shape")


def _parts_by_shape(skeleton: Skeleton, rest: Floats) -> Parts | None:
    """Legs are the lowest limbs, arms those whose ends are farthest to the sides, the head is between."""
    try:
        roles = find_joints(skeleton, rest[None]).roles
    except DatasetError:
        return None
    hips = roles["hips"]
    found: dict[str, tuple[int, ...]] = {"hips": (hips,)}
    for side in ("left", "right"):
        top, end = roles[f"{side}_up_leg"], roles[f"{side}_foot"]
        leg = path(skeleton, top, end)
        found[f"{side}_up_leg"], found[f"{side}_foot"] = (top,), (end,)
        if len(leg) > 2:
            found[f"{side}_leg"] = (_middle(leg, rest),)
        toe = _toe(skeleton, rest, end)
        if toe is not None:
            found[f"{side}_toe"] = (toe,)
    trunk = _trunk(skeleton, rest, hips, (roles["left_up_leg"], roles["right_up_leg"]))
    return None if trunk is None else {**found, **trunk}


def _middle(chain: Sequence[int], rest: Floats) -> int:
    """The joint within a chain that makes the shorter of the two parts as long as can be."""
    way = np.cumsum(np.linalg.norm(np.diff(rest[list(chain)], axis=0), axis=1))
    return chain[1 + int(np.minimum(way, way[-1] - way)[:-1].argmax())]


def _toe(skeleton: Skeleton, rest: Floats, foot: int) -> int | None:
    children = [child for child in skeleton.children[foot] if not skeleton.ends[child]]
    return max(children, key=lambda child: float(np.linalg.norm(rest[child] - rest[foot])), default=None)


def _trunk(skeleton: Skeleton, rest: Floats, hips: int, legs: tuple[int, int]) -> Parts | None:
    """Spine, arms, neck and head; None where what rises from the hips lies rather than stands."""
    left = rest[legs[0]] - rest[legs[1]]
    above = [joint for joint in _below(skeleton, hips) if not _is_below_any(skeleton, joint, legs)]
    leaves = [joint for joint in above if not any(child in above for child in skeleton.children[joint])]
    if not leaves:
        return {}
    aside = (rest[leaves] - rest[hips]) @ left / np.linalg.norm(left)
    hands = leaves[int(aside.argmax())], leaves[int(aside.argmin())]
    if hands[0] == hands[1] or aside.max() <= 0 or aside.min() >= 0:
        return {}
    ways = [path(skeleton, hips, hand) for hand in hands]
    shared = [one for one, other in zip(*ways, strict=False) if one == other]
    chest = shared[-1]
    arms = {one[len(shared)] for one in ways}
    heads = [leaf for leaf in leaves if not _is_below_any(skeleton, leaf, tuple(arms)) and leaf != chest]
    found: dict[str, tuple[int, ...]] = {"spine": tuple(shared[1:])} if len(shared) > 1 else {}
    if heads:
        top = max(heads, key=lambda leaf: float(rest[leaf, 1]))
        if not _stands(rest[top] - rest[hips]):
            return None
        chain = [joint for joint in path(skeleton, chest, top)[1:] if not skeleton.ends[joint]]
        found |= {"head": (chain[-1],)} if chain else {}
        found |= {"neck": tuple(chain[:-1])} if len(chain) > 1 else {}
    for side, way in zip(("left", "right"), ways, strict=True):
        found |= _arm(side, way[len(shared) - 1 :], skeleton, rest)
    return found


def _stands(way: Floats) -> bool:
    return bool(way[1] > _UPRIGHT * np.linalg.norm(way))


def _arm(side: str, chain: Sequence[int], skeleton: Skeleton, rest: Floats) -> Parts:
    """The two longest bones that follow each other, as far as the chain goes on after them."""
    lengths = np.linalg.norm(np.diff(rest[list(chain)], axis=0), axis=1)
    pairs = list(range(1, len(lengths) - 1))
    if not pairs:
        return {}
    upper = max(pairs, key=lambda k: float(min(lengths[k], lengths[k + 1])))
    arm, forearm, hand = chain[upper : upper + 3]
    found = {f"{side}_arm": (arm,), f"{side}_forearm": (forearm,)}
    if not skeleton.ends[hand]:
        found[f"{side}_hand"] = (hand,)
    if upper > 1:
        found[f"{side}_clavicle"] = (chain[1],)
    return found


def _below(skeleton: Skeleton, joint: int) -> list[int]:
    found = [joint]
    for one in found:  # grows while it is walked
        found.extend(skeleton.children[one])
    return found[1:]


def _is_below_any(skeleton: Skeleton, joint: int, tops: tuple[int, ...]) -> bool:
    """Whether a joint is one of ``tops`` or hangs below one."""
    here = joint
    while here >= 0 and here not in tops:
        here = int(skeleton.parents[here])
    return here >= 0
