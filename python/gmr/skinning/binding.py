"""Binding: which joints each vertex of a mesh follows, found from where mesh and skeleton are at rest.

Source: spec "Skinning", "Binding".
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.errors import SkinError, SkinWarning
from gmr.listing import listed
from gmr.skeleton import Skeleton
from gmr.skinning.bone_segments import FARTHEST, BoneSegments, bone_segments
from gmr.threads import thread_count

__all__ = ["BindMethod", "Binding", "BindingReport", "bind"]

BindMethod = Literal["gradient", "heat"]

_THREADING_PAYS = 1_000_000
"""Vertices times bones above which sharing the work among threads wins over starting them."""

_TOO_LARGE = 8.0
"""A mesh whose box is more than this many times as large as the skeleton's is in another unit."""

_TOO_SMALL = 1 / 30
"""The same for a mesh that is smaller: a hand may be bound to a whole skeleton, so more is let pass."""

_SHOWN = 8
"""Names that a text lists; the others it counts."""


@dataclass(frozen=True, eq=False, slots=True)
class BindingReport:
    """How a mesh was bound, for people to look at."""

    names: tuple[str, ...]
    """(J,) the names of the joints."""
    strongest: NDArray[np.intp]
    """(J,) how many vertices follow each joint more than any other."""
    followers: NDArray[np.intp]
    """(J,) how many vertices follow each joint at all."""
    outside: NDArray[np.intp]
    """(N,) the vertices that were in no bone's box, and took the nearest bone; none by ``"heat"``."""
    torn: int
    """Edges whose ends followed no joint in common before smoothing; what is moved there stretches."""
    still_torn: int
    """Those that are left after it."""

    def __str__(self) -> str:
        idle = [name for name, count in zip(self.names, self.followers, strict=True) if not count]
        joints = f"{len(self.names) - len(idle)} of {len(self.names)} joints"
        without = f" (none follows {listed(idle, _SHOWN)})" if idle else ""
        return (
            f"{self.strongest.sum():,} vertices follow {joints}{without}\n"
            f"{len(self.outside):,} in no bone's box; {self.torn:,} edges torn, "
            f"{self.still_torn:,} after smoothing"
        )


@dataclass(frozen=True, eq=False, slots=True)
class Binding:
    """What each of V vertices follows; ``weights, joints = binding`` takes it apart. Arrays are read-only."""

    weights: NDArray[np.float32]
    """(V, 4) not negative, the strongest first; each row sums to 1."""
    joints: NDArray[np.int32]
    """(V, 4) indices of the skeleton's joints; 0 where the weight is 0."""
    report: BindingReport

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return iter((self.weights, self.joints))


def bind(
    vertices: ArrayLike,
    faces: ArrayLike,
    skeleton: Skeleton,
    *,
    method: BindMethod = "gradient",
    joints: Iterable[str | int] | None = None,
    threads: int | None = None,
) -> Binding:
    """Weights for a mesh that a skeleton is to carry; ``weights, joints = bind(vertices, faces, skeleton)``.

    Both stand at rest in one place and one unit. The bone from joint j to its child turns with j, so what
    lies beside it follows j: the joint that turns a bone, as glTF and BVH have it, not the one in which it
    ends. End Sites turn nothing and carry nothing. Where roots were moved, the joints are meant as they hang
    at home.

    - ``"gradient"``: each bone has an oriented box round the vertices beside it; in it the weight is 1 along
      the bone and falls linearly through each of its joints, across to the box's edge, and the farther the
      bone is than the nearest. The largest of a joint's bones counts.
      A vertex in no box follows the nearest bone, and is then smoothed over the edges of the mesh.
    - ``"heat"``: bone heat: ``(C + M H) w = M H p``, C the cotangent Laplacian of the mesh, M the areas of
      its vertices, ``H = 1/d^2`` with d the distance to the nearest bone, p 1 for its joint; bones are not
      tested for being hidden. Needs SciPy.

    Both give the same for mesh and skeleton moved, turned or scaled together, but for rounding.

    Args:
        vertices: (V, 3) at rest, in the skeleton's unit. Those at one place get the same weights.
        faces: (T, 3) triangles of vertices; (0, 3) where there are none. They may be degenerate, share edges
            as they like, and leave vertices out.
        skeleton: J joints, at rest where the mesh is.
        method: "gradient" or "heat".
        joints: the joints that may carry something, by names or indices; by default all. Leave out those that
            move the figure as a whole, such as a root on the ground.
        threads: for "gradient", 0 for all cores; by default all where it pays. The answer is the same.

    Returns:
        (V, 4) float32 weights, (V, 4) int32 joints, and a report.

    Raises:
        SkinError: a shape does not fit, a vertex is not finite (it is named), there is no vertex, or a
            triangle names one that is not there.
        SkeletonError: the skeleton has no bone, or not the joints named.
        MissingExtraError: ``"heat"`` without SciPy.

    Warns:
        SkinWarning: mesh and skeleton are apart, or of sizes so different that their units must be.

    Source: spec "Skinning", "Binding"; Baran and Popović 2007, "Automatic Rigging and Animation of 3D
    Characters", section 4, for the heat.
    """
    if method not in ("gradient", "heat"):
        raise SkinError(f"there is no method {method!r}; choose 'gradient' or 'heat'")
    places, triangles = _places(vertices), _triangles(faces)
    bones = bone_segments(skeleton, joints)
    _warn_of_units(places, bones)
    if method == "heat":
        from gmr.skinning.heat import heat_weights

        found = heat_weights(places, triangles, bones)
    else:
        default = 0 if len(places) * len(bones.joints) > _THREADING_PAYS else 1
        count = thread_count(threads, default)
        try:
            found = _core.bind_skin(
                places, triangles.reshape(-1), bones.heads, bones.tails, bones.joints, bones.open, count
            )
        except ValueError as error:
            raise SkinError(str(error)) from None
    followed, weights, outside, torn, still_torn = found
    joint_count = skeleton.joint_count
    return Binding(
        weights=read_only(weights),
        joints=read_only(followed),
        report=BindingReport(
            names=skeleton.names,
            strongest=np.bincount(followed[:, 0], minlength=joint_count),
            followers=np.bincount(followed[weights > 0], minlength=joint_count),
            outside=outside.astype(np.intp),
            torn=torn,
            still_torn=still_torn,
        ),
    )


def _places(vertices: ArrayLike) -> NDArray[np.float64]:
    found = np.ascontiguousarray(vertices, np.float64)
    if found.ndim != 2 or found.shape[1] != 3:
        raise SkinError(f"vertices has shape {np.shape(vertices)}; give (V, 3)")
    if not len(found):
        raise SkinError("the mesh has no vertices, so there is nothing to bind")
    lost = np.flatnonzero(~(np.abs(found) <= FARTHEST).all(axis=1))
    if len(lost):
        raise SkinError(
            f"vertex {lost[0]} lies at {found[lost[0]].tolist()}, and {len(lost) - 1} more are like it; "
            f"places are finite, and no number is beyond {FARTHEST:g}"
        )
    return found


def _triangles(faces: ArrayLike) -> NDArray[np.int32]:
    found = np.asarray(faces)
    if not found.size:
        return np.zeros((0, 3), np.int32)
    if found.ndim != 2 or found.shape[1] != 3:
        raise SkinError(f"faces has shape {found.shape}; give (T, 3), triangles of vertices")
    if not np.issubdtype(found.dtype, np.integer):
        raise SkinError(f"faces holds numbers of type {found.dtype}; give whole numbers")
    limits = np.iinfo(np.int32)
    if found.min() < limits.min or found.max() > limits.max:
        raise SkinError(f"faces holds {found.max()}, which is more than any mesh has; indices count from 0")
    return np.ascontiguousarray(found, np.int32)


def _warn_of_units(vertices: NDArray[np.float64], bones: BoneSegments) -> None:
    """Warns where mesh and bones cannot be in one place and one unit."""
    ends = np.concatenate([bones.heads, bones.tails])
    of_mesh, of_bones = (np.ptp(places, axis=0) for places in (vertices, ends))
    sizes = f"the mesh's box is {_by(of_mesh)}, that of the skeleton's bones {_by(of_bones)}"
    large, small = float(np.linalg.norm(of_mesh)), float(np.linalg.norm(of_bones))
    apart = np.any((vertices.max(0) < ends.min(0)) | (vertices.min(0) > ends.max(0)))
    if not small:
        return
    if not _TOO_SMALL * small <= large <= _TOO_LARGE * small:
        warnings.warn(
            f"{sizes}: the one is {large / small:.3g} times the other, so they seem to be in different "
            "units, and weights between them say nothing. Scale one to the unit of the other",
            SkinWarning,
            stacklevel=3,
        )
    elif apart:
        warnings.warn(
            f"mesh and skeleton are apart: {sizes}, and they do not touch. Move one to where the other is",
            SkinWarning,
            stacklevel=3,
        )


def _by(size: NDArray[np.float64]) -> str:
    return " x ".join(f"{length:.3g}" for length in size)
