"""Measures of a body in sampled poses: which way is up, how long a leg is, and whether roles fit its
shape."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gmr.skeleton import Skeleton

__all__ = [
    "UP_TURNS",
    "Poses",
    "fault",
    "leg_length",
    "path",
    "toe_directions",
    "turned_from_upright",
    "turned_upright",
    "up_axis",
]

Poses = NDArray[np.float64]
"""(n, J, 3) world positions of sampled poses, in any one unit."""

_HALF = np.sqrt(0.5)

UP_TURNS: Mapping[str, tuple[float, float, float, float]] = {
    "+Y": (0.0, 0.0, 0.0, 1.0),
    "-Y": (1.0, 0.0, 0.0, 0.0),
    "+Z": (-_HALF, 0.0, 0.0, _HALF),
    "-Z": (_HALF, 0.0, 0.0, _HALF),
    "+X": (0.0, 0.0, _HALF, _HALF),
    "-X": (0.0, 0.0, -_HALF, _HALF),
}
"""Quaternion (xyzw) that turns each axis to +Y."""

_MATRICES: Mapping[str, tuple[tuple[int, int, int], ...]] = {
    "+Y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-Y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "+Z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-Z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "+X": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-X": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}


def turned_upright(vectors: NDArray[np.float64], up: str) -> NDArray[np.float64]:
    """(..., 3) vectors of a world whose up axis is ``up``, turned so that +Y is up."""
    return vectors if up == "+Y" else vectors @ np.array(_MATRICES[up], np.float64).T


def turned_from_upright(vectors: NDArray[np.float64], up: str) -> NDArray[np.float64]:
    """(..., 3) vectors of a world whose up axis is +Y, turned so that ``up`` is: undoes
    :func:`turned_upright`."""
    return vectors if up == "+Y" else vectors @ np.array(_MATRICES[up], np.float64)


def up_axis(poses: Poses, roles: Mapping[str, int]) -> str:
    """The axis along which the hips lie above the feet on average: a key of :data:`UP_TURNS`."""
    feet = poses[:, [roles["left_foot"], roles["right_foot"]]].mean(axis=1)
    above = (poses[:, roles["hips"]] - feet).mean(axis=0)
    axis = int(np.argmax(np.abs(above)))
    return f"{'+' if above[axis] >= 0 else '-'}{'XYZ'[axis]}"


def leg_length(skeleton: Skeleton, poses: Poses, roles: Mapping[str, int]) -> float:
    """Mean length of the legs from the upper leg's joint to the foot's, along the bones between them."""
    lengths = []
    for side in ("left", "right"):
        bones = path(skeleton, roles[f"{side}_up_leg"], roles[f"{side}_foot"])
        steps = np.diff(poses[:, bones], axis=1)
        lengths.append(np.linalg.norm(steps, axis=2).sum(axis=1).mean())
    return float(np.mean(lengths))


def path(skeleton: Skeleton, top: int, bottom: int) -> list[int]:
    """The joints from ``top`` down to ``bottom``; only these two where ``top`` is not above ``bottom``."""
    joints = [bottom]
    while joints[-1] != top:
        above = int(skeleton.parents[joints[-1]])
        if above < 0:
            return [top, bottom]
        joints.append(above)
    return joints[::-1]


def toe_directions(skeleton: Skeleton, poses: Poses, feet: tuple[int, int]) -> NDArray[np.float64] | None:
    """(n, 3) mean vector of the feet from the foot's joint to the farthest joint below it; None without
    one."""
    tips = [_farthest_below(skeleton, poses, foot) for foot in feet]
    if tips[0] == feet[0] or tips[1] == feet[1]:
        return None
    return np.asarray((poses[:, tips] - poses[:, list(feet)]).mean(axis=1), np.float64)


def _farthest_below(skeleton: Skeleton, poses: Poses, joint: int) -> int:
    below = list(skeleton.children[joint])
    for child in below:
        below.extend(skeleton.children[child])
    away = np.linalg.norm(poses[:, below] - poses[:, [joint]], axis=2).mean(axis=0)
    return below[int(np.argmax(away))] if below and away.max() > 1e-6 else joint


def fault(skeleton: Skeleton, poses: Poses, roles: Mapping[str, int]) -> str | None:
    """What contradicts the roles in poses whose up axis is +Y, as the rest of a sentence; None when
    nothing does."""
    name = {role: f"'{skeleton.names[joint]}' ({role})" for role, joint in roles.items()}
    required = ("hips", "left_up_leg", "right_up_leg", "left_foot", "right_foot")
    at = {role: poses[:, roles[role]] for role in required}
    if roles["left_foot"] == roles["right_foot"]:
        return f"{name['left_foot']} cannot be the right foot too"
    leg = leg_length(skeleton, poses, roles)
    if not leg > 0:
        return f"the leg from {name['left_up_leg']} to {name['left_foot']} has no length"
    width = np.linalg.norm(at["left_up_leg"] - at["right_up_leg"], axis=1).mean()
    if width < 0.05 * leg:
        both = f"{name['left_up_leg']} and {name['right_up_leg']}"
        return f"{both} are in the same place, so the body has no facing"
    for side in ("left", "right"):
        up_leg, foot = f"{side}_up_leg", f"{side}_foot"
        if (at[up_leg] - at[foot])[:, 1].mean() < 0.3 * leg:
            return f"{name[foot]} does not lie below {name[up_leg]}"
        if np.linalg.norm(at[up_leg] - at["hips"], axis=1).mean() > 0.7 * leg:
            return f"{name[up_leg]} lies farther from {name['hips']} than a leg begins"
    return _wrong_side(skeleton, poses, roles, name)


def _wrong_side(
    skeleton: Skeleton, poses: Poses, roles: Mapping[str, int], name: Mapping[str, str]
) -> str | None:
    """Whether the toes point backward when left is left, which means that sides are swapped or the data
    mirrored."""
    toes = toe_directions(skeleton, poses, (roles["left_foot"], roles["right_foot"]))
    if toes is None:
        return None
    across = poses[:, roles["left_up_leg"]] - poses[:, roles["right_up_leg"]]
    forward = np.stack([-across[:, 2], across[:, 0]], axis=1)
    along = (toes[:, [0, 2]] * forward).sum(axis=1).mean()
    if along < 0:
        return (
            f"the toes of {name['left_foot']} and {name['right_foot']} point backward: left and right are "
            "swapped, or the data is a mirror image"
        )
    return None
