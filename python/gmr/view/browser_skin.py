"""A skin as a browser can carry it: four joints a vertex, and joints that turn and move but do not stretch.

The browser blends linearly, ``v' = sum_i w_i E_i v`` with ``E_i`` the joint's matrix times its inverse bind
matrix. Where all ``E_i`` of a skin stretch alike and always, ``E_i = G_i A`` with rigid ``G_i``, the points
``A v`` carried by ``G_i`` are the same points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr import quaternions
from gmr.view.figure import finite_poses

if TYPE_CHECKING:
    from gmr.view.figure import Worn

__all__ = ["BrowserSkin", "browser_skin"]

_INFLUENCES = 4
_RIGID = 1e-3


@dataclass(frozen=True, eq=False)
class BrowserSkin:
    """V vertices that B joints carry over F frames."""

    vertices: NDArray[np.float32]
    """(V, 3) points ``A v``."""
    weights: NDArray[np.float32]
    """(V, B), at most four above 0 in a row."""
    wxyzs: NDArray[np.float64]
    """(F, B, 4) turns of the joints, w first; of an unknown pose those of the first known one."""
    positions: NDArray[np.float64]
    """(F, B, 3)"""


def browser_skin(worn: Worn) -> BrowserSkin | None:
    """The skin in that form; None where it has none: a joint stretches, or a vertex follows five."""
    merged = worn.character.merged
    if (np.count_nonzero(merged.weights, axis=1) > _INFLUENCES).any():
        return None
    known = finite_poses(worn.poses)
    poses = np.where(known[:, None, None, None], worn.poses, worn.poses[known][0])
    used = np.unique(merged.joints[merged.weights > 0])
    skins, joints = np.divmod(used, len(worn.character.joints))
    carried = poses[:, joints] @ merged.inverse_binds[skins, joints]
    vertices = merged.vertices.astype(np.float64)
    rigid = np.empty_like(carried[..., :3, :3])
    # A vertex follows joints of one skin only.
    skin_of_vertex = merged.joints[np.arange(len(vertices)), merged.weights.argmax(axis=1)]
    skin_of_vertex = skin_of_vertex // len(worn.character.joints)
    for skin in np.unique(skins):
        own = skins == skin
        stretch = _stretch(carried[0, own][0, :3, :3])
        if stretch is None:
            return None
        rigid[:, own] = carried[:, own, :3, :3] @ np.linalg.inv(stretch)
        mine = skin_of_vertex == skin
        vertices[mine] = vertices[mine] @ stretch.T
    gram = rigid @ np.swapaxes(rigid, -1, -2)
    if np.abs(gram - np.eye(3)).max() > _RIGID or (np.linalg.det(rigid) < 0).any():
        return None
    xyzw = quaternions.from_matrices(rigid)
    return BrowserSkin(
        vertices.astype(np.float32),
        _dense(merged.joints, merged.weights, used),
        np.roll(xyzw, 1, axis=-1),
        carried[..., :3, 3],
    )


def _stretch(matrix: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """``A`` of ``matrix = G A`` with ``G`` a rotation; None where the matrix is flat."""
    left, scales, right = np.linalg.svd(matrix)
    if scales[-1] <= 1e-9 * scales[0]:
        return None
    if np.linalg.det(matrix) < 0:
        left = left * np.array([1.0, 1.0, -1.0])
    return np.asarray(right.T @ left.T @ matrix, np.float64)


def _dense(
    joints: NDArray[np.int32], weights: NDArray[np.float32], used: NDArray[np.int32]
) -> NDArray[np.float32]:
    """(V, B) weights of the used joints."""
    found = np.zeros((len(joints), len(used)), np.float32)
    columns = np.searchsorted(used, joints).clip(max=len(used) - 1)
    for k in range(joints.shape[1]):
        np.add.at(found, (np.arange(len(joints)), columns[:, k]), weights[:, k])
    return found
