"""Soles: the points of a character's feet that may touch the ground, and how high the lowest of them is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.quaternions import rotated
from gmr.skinning.character import Character

__all__ = ["Sole", "heights", "sole_of"]

Floats = NDArray[np.float64]

_OWN = 0.5
"""Weight above which a vertex goes with the foot."""
_SHARES = 4
"""Steps between 0 and 1 in which weights are told apart."""
_DIRECTIONS = 16
"""Around the vertical, in which the outermost points are looked for."""


@dataclass(frozen=True, eq=False)
class Sole:
    """Points of a foot, carried as linear blending carries them.

    Args:
        joints: (N, K) the joints that carry each.
        weights: (N, K)
        vectors: (N, K, 3) metres from those joints at rest.
        rest: (N, 3) places at rest.
    """

    joints: NDArray[np.int32]
    weights: Floats
    vectors: Floats
    rest: Floats


def sole_of(character: Character, ankle: int) -> Sole:
    """The outermost points of what the joints from the ankle down carry; those joints themselves, laid down
    to the lowest, where they carry nothing."""
    rest = character.rest_pose()[:, :3, 3]
    parents = character.joint_parents
    foot = [j for j in character.skeleton.parents_first if j == ankle or _is_below(parents, j, ankle)]
    found = _carried(character, foot) if character.skinned_parts else None
    if found is None:
        points = rest[foot] * np.array([1.0, 0, 1]) + np.array([0, rest[foot, 1].min(), 0])
        joints, weights = np.array(foot, np.int32)[:, None], np.ones((len(foot), 1))
    else:
        points, joints, weights = found
        outer = _outermost_of_each_kind(points, joints, weights)
        points, joints, weights = points[outer], joints[outer], weights[outer]
    return Sole(joints, weights, points[:, None] - rest[joints], points)


def _is_below(parents: NDArray[np.int32], joint: int, top: int) -> bool:
    here = int(parents[joint])
    while here >= 0 and here != top:
        here = int(parents[here])
    return here == top


def _carried(character: Character, foot: list[int]) -> tuple[Floats, NDArray[np.int32], Floats] | None:
    """The vertices that go with the foot: places at rest, joints and weights."""
    merged = character.merged
    joints = merged.joints % len(character.joints)
    own = np.where(np.isin(joints, foot), merged.weights, 0).sum(axis=1) > _OWN
    if not own.any():
        return None
    places = character.skin(character.rest_pose())[0, own].astype(np.float64)
    return places, joints[own], merged.weights[own].astype(np.float64)


def _outermost_of_each_kind(points: Floats, joints: NDArray[np.int32], weights: Floats) -> NDArray[np.intp]:
    """Indices of the outermost points among those that the same joints carry in about the same shares, for
    these move nearly as one."""
    shares = np.round(weights * _SHARES).astype(np.int64)
    kinds = np.concatenate([np.where(shares > 0, joints, -1), shares], axis=1)
    _, kind = np.unique(kinds, axis=0, return_inverse=True)
    groups = [np.flatnonzero(kind.ravel() == k) for k in range(kind.max() + 1)]
    return np.concatenate([group[_outermost(points[group])] for group in groups])


def _outermost(points: Floats) -> NDArray[np.intp]:
    """Indices of the points that are farthest in directions of the lower half and a little above."""
    around = np.linspace(0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    down = np.linspace(-np.pi / 2, np.pi / 6, 9)
    a, d = np.meshgrid(around, down)
    ways = np.stack([np.cos(d) * np.cos(a), np.sin(d), np.cos(d) * np.sin(a)], axis=-1).reshape(-1, 3)
    return np.unique((points @ ways.T).argmax(axis=0))


def heights(sole: Sole, turns: Floats, places: Floats) -> Floats:
    """(F,) height of the lowest point.

    Args:
        sole: of a foot.
        turns: (F, J, 4) of the character's joints, from rest.
        places: (F, J, 3) of the character's joints.
    """
    carried = places[:, sole.joints, 1] + rotated(turns[:, sole.joints], sole.vectors)[..., 1]
    return np.asarray((carried * sole.weights).sum(axis=-1).min(axis=1), np.float64)
