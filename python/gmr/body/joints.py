"""Which joints are the hips, the legs, the feet and the shoulders: by name, else by the body's shape, else
as told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gmr.body.measures import Poses, fault, path, toe_directions, turned_upright, up_axis
from gmr.body.naming import CONVENTIONS, REQUIRED, ROLES, roles_by_name
from gmr.errors import DatasetError, SkeletonError
from gmr.listing import quoted
from gmr.skeleton import Skeleton

__all__ = ["Joints", "find_joints", "named_roles"]


@dataclass(frozen=True, slots=True)
class Joints:
    """The joints of a skeleton that have a role, checked against the poses that they were found in."""

    roles: Mapping[str, int]
    """Joint index by role; see :data:`gmr.body.naming.ROLES`."""
    found_by: str
    """``"names"``, ``"shape"`` or ``"given"``."""

    def __getitem__(self, role: str) -> int:
        return self.roles[role]

    def __contains__(self, role: str) -> bool:
        return role in self.roles

    @property
    def across(self) -> list[tuple[int, int]]:
        """(left, right) pairs whose direction tells the facing: the upper legs, and the shoulders where
        known."""
        sided = [(self.roles["left_up_leg"], self.roles["right_up_leg"])]
        if "left_shoulder" in self.roles and "right_shoulder" in self.roles:
            sided.append((self.roles["left_shoulder"], self.roles["right_shoulder"]))
        return sided

    def described(self, skeleton: Skeleton) -> dict[str, str]:
        """The joints' names by role."""
        return {role: skeleton.names[joint] for role, joint in self.roles.items()}


def find_joints(skeleton: Skeleton, poses: Poses, names: Mapping[str, str | int] | None = None) -> Joints:
    """The joints of a body that have a role.

    Args:
        skeleton: J joints.
        poses: (n, J, 3) some world poses, in any unit and with any axis up.
        names: joints that the caller knows, by role: ``{"left_foot": "foot_l"}``; they go before any guess.

    Raises:
        DatasetError: hips, upper legs or feet are not found, or those found contradict the poses; the message
            lists the skeleton's joints and says how to name them.
    """
    given = _given(skeleton, names or {})
    proper = _proper(skeleton)
    reasons = []
    for words in CONVENTIONS:
        roles = roles_by_name(proper, words) | given
        missing = [role for role in REQUIRED if role not in roles]
        reason = _missing(missing) if missing else _fault(skeleton, poses, roles)
        if reason is None:
            return Joints(roles, "given" if given else "names")
        reasons.append((len(missing), reason))
    shape = _by_shape(skeleton, poses)
    if shape and _fault(skeleton, poses, shape | given) is None:
        return Joints(shape | given, "shape")
    raise DatasetError(f"{min(reasons)[1]}. {_remedy(skeleton)}")


def named_roles(skeleton: Skeleton) -> dict[str, int] | None:
    """The joints whose names alone give them a role, whatever the poses say; None without a whole body."""
    found = (roles_by_name(_proper(skeleton), words) for words in CONVENTIONS)
    return next((roles for roles in found if all(role in roles for role in REQUIRED)), None)


def _proper(skeleton: Skeleton) -> list[str]:
    """(J,) names of the joints, "" for ends, which have no role."""
    return ["" if end else name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True)]


def _given(skeleton: Skeleton, names: Mapping[str, str | int]) -> dict[str, int]:
    unknown = [role for role in names if role not in ROLES]
    if unknown:
        raise DatasetError(f"no role is called '{unknown[0]}'; the roles are {', '.join(ROLES)}")
    found = {}
    for role, joint in names.items():
        try:
            found[role] = skeleton.index(joint)
        except SkeletonError as error:
            raise DatasetError(f"{role}={joint}: {error}") from error
    return found


def _missing(missing: list[str]) -> str:
    parts = [role.replace("_", " ") for role in missing]
    listed = parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} or {parts[-1]}"
    return f"the skeleton has no joint that is known as {listed}"


def _fault(skeleton: Skeleton, poses: Poses, roles: Mapping[str, int]) -> str | None:
    return fault(skeleton, turned_upright(poses, up_axis(poses, roles)), roles)


def _remedy(skeleton: Skeleton) -> str:
    joints = quoted([name for name in _proper(skeleton) if name], 80)
    return (
        f"The joints are {joints}. Say which are hips, left_up_leg, right_up_leg, left_foot and right_foot: "
        "names={'hips': ..., ...} in Python, --name hips=... on the command line."
    )


def _by_shape(skeleton: Skeleton, poses: Poses) -> dict[str, int] | None:
    """Roles of the two lowest limbs of a body that stands along +Y or +Z on average; None where there are
    none."""
    for up in ("+Y", "+Z"):
        upright = turned_upright(poses, up)
        legs = _lowest_limbs(skeleton, upright)
        roles = legs and _sided(skeleton, upright, *legs)
        if roles and fault(skeleton, upright, roles) is None:
            return roles
    return None


def _lowest_limbs(skeleton: Skeleton, poses: Poses) -> tuple[list[int], list[int]] | None:
    """The chains from a common joint down to the lowest leaf and to the next lowest that is not of the
    same limb."""
    height = poses[:, :, 1].mean(axis=0)
    extent = height.max() - height.min()
    leaves = [joint for joint, children in enumerate(skeleton.children) if not children]
    first, *others = sorted(leaves, key=lambda leaf: (height[leaf], leaf)) or [-1]
    tops = _branchings(skeleton, first)
    for second in others:
        top = tops[second]
        if top >= 0 and height[top] - max(height[first], height[second]) > 0.3 * extent:
            return path(skeleton, top, first), path(skeleton, top, second)
    return None


def _branchings(skeleton: Skeleton, leaf: int) -> list[int]:
    """(J,) the lowest joint above each joint and ``leaf``, -1 for a joint of another root."""
    tops = [-1] * skeleton.joint_count
    above = leaf
    while above >= 0:
        tops[above] = above
        above = int(skeleton.parents[above])
    for joint in skeleton.parents_first:
        if tops[joint] < 0 and skeleton.parents[joint] >= 0:
            tops[joint] = tops[skeleton.parents[joint]]
    return tops


def _sided(skeleton: Skeleton, poses: Poses, one: list[int], other: list[int]) -> dict[str, int] | None:
    """Roles of two legs, left and right told by where the toes point; None where that cannot be told."""
    legs = [_thigh_and_shin(poses, chain) for chain in (one, other)]
    if legs[0] is None or legs[1] is None:
        return None
    (up_one, foot_one), (up_other, foot_other) = legs[0], legs[1]
    toes = toe_directions(skeleton, poses, (foot_one, foot_other))
    if toes is None or one[0] != other[0]:
        return None
    across = poses[:, up_one] - poses[:, up_other]
    forward = np.stack([-across[:, 2], across[:, 0]], axis=1)
    one_is_left = (toes[:, [0, 2]] * forward).sum(axis=1).mean() > 0
    left, right = (legs[0], legs[1]) if one_is_left else (legs[1], legs[0])
    return {
        "hips": one[0],
        "left_up_leg": left[0],
        "right_up_leg": right[0],
        "left_foot": left[1],
        "right_foot": right[1],
    }


def _thigh_and_shin(poses: Poses, chain: list[int]) -> tuple[int, int] | None:
    """Where the two longest bones of a leg begin and end, when they follow each other."""
    lengths = np.linalg.norm(np.diff(poses[:, chain], axis=1), axis=2).mean(axis=0)
    if len(lengths) < 2:
        return None
    thigh, shin = sorted(np.argsort(lengths, kind="stable")[-2:].tolist())
    return (
        None if np.any(lengths[thigh + 1 : shin] > 0.1 * lengths[shin]) else (chain[thigh], chain[shin + 1])
    )
