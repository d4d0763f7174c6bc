"""A character: meshes that the joints of a node tree carry, with materials and animations; immutable.

Skinning is that of glTF 2.0 (3.7.3 "Skins"): a vertex is carried by ``sum_i w_i M_i B_i`` where ``M_i`` is
the world matrix of its i-th joint and ``B_i`` that joint's inverse bind matrix; the transform of the node
that holds the mesh says nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.arrays import frozen
from gmr.errors import GmrError, SkeletonError
from gmr.listing import quoted
from gmr.skeleton import Skeleton
from gmr.skinning.appearance import Material, Texture
from gmr.skinning.blending import Hemisphere, Method, Skin
from gmr.skinning.keyframes import Animation
from gmr.skinning.nodes import Nodes
from gmr.skinning.part import Part
from gmr.skinning.playing import world_matrices

__all__ = ["Character", "Part"]

FloatArray = NDArray[np.float32]

_SHOWN = 8
"""Names that an error lists; the others it counts."""


@dataclass(frozen=True, eq=False, repr=False)
class Character:
    """Parts, the joints that carry them, and what those hang on.

    Args:
        name: what it is called.
        nodes: the tree, in metres; Y points up.
        joints: (J,) int32, which of the nodes are joints; parts count joints in this order.
        parts: meshes, in the order of the file.
        materials: what parts refer to.
        textures: what materials refer to.
        animations: the clips of the file.

    Raises:
        SkeletonError: a joint is no node, or one twice.
        GmrError: a part has matrices for another number of joints, or refers to what is not there.
    """

    name: str
    nodes: Nodes
    joints: NDArray[np.int32]
    parts: tuple[Part, ...]
    materials: tuple[Material, ...] = ()
    textures: tuple[Texture, ...] = ()
    animations: tuple[Animation, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", frozen(self.joints, np.int32))
        for key in ("parts", "materials", "textures", "animations"):
            object.__setattr__(self, key, tuple(getattr(self, key)))
        chosen = self.joints.tolist()
        if len(set(chosen)) < len(chosen) or not set(chosen) <= set(range(len(self.nodes))):
            raise SkeletonError("the joints of a character must be distinct nodes of its tree")
        for part in self.parts:
            if part.is_skinned and part.inverse_bind is not None and len(part.inverse_bind) != len(chosen):
                raise GmrError(
                    f"part '{part.name}' has {len(part.inverse_bind)} inverse bind matrices; "
                    f"it needs one for each of the {len(chosen)} joints"
                )
            if part.material is not None and not 0 <= part.material < len(self.materials):
                raise GmrError(f"part '{part.name}' has material {part.material}, which is not there")
            if not -1 <= part.node < len(self.nodes):
                raise GmrError(f"part '{part.name}' is held by node {part.node}, which is not there")

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """(J,) names of the joints."""
        return tuple(self.nodes.names[node] for node in self.joints.tolist())

    @cached_property
    def joint_parents(self) -> NDArray[np.int32]:
        """(J,) int32: the nearest joint above each, past nodes that are none; -1: there is none."""
        place = {node: joint for joint, node in enumerate(self.joints.tolist())}
        nearest = np.full(len(self.nodes), -1, np.int32)
        for node in self.nodes.order:
            parent = int(self.nodes.parents[node])
            if parent >= 0:
                nearest[node] = place.get(parent, nearest[parent])
        return frozen(nearest[self.joints], np.int32)

    @cached_property
    def skeleton(self) -> Skeleton:
        """The J joints at rest: offsets are world vectors in metres, all scale applied, no joint turned.

        A root's offset is its place in the world at rest.
        """
        places = self.rest_pose()[:, :3, 3]
        parents = self.joint_parents
        offsets = places - np.where(parents[:, None] >= 0, places[parents], 0.0)
        return Skeleton.post_rotation(self.joint_names, parents, offsets, turning=range(len(self.joints)))

    def rest_pose(self) -> NDArray[np.float64]:
        """(J, 4, 4) float64 world matrices of the joints where nothing moves them."""
        return self.nodes.world[self.joints]

    def find_animation(self, animation: str | int = 0) -> Animation:
        """The animation of this name or index.

        Raises:
            GmrError: there is none.
        """
        if not self.animations:
            raise GmrError(f"character '{self.name}' has no animation")
        names = [clip.name for clip in self.animations]
        if isinstance(animation, str) and names.count(animation) == 1:
            return self.animations[names.index(animation)]
        if not isinstance(animation, str) and 0 <= animation < len(names):
            return self.animations[animation]
        if isinstance(animation, str) and animation in names:
            raise GmrError(f"several animations are called '{animation}'; say which by its index")
        raise GmrError(
            f"there is no animation {animation!r}; there are {quoted(names, _SHOWN)}, with indices from 0"
        )

    def animation(self, animation: str | int = 0, fps: float | None = None) -> NDArray[np.float64]:
        """(F, J, 4, 4) float64 world matrices of the joints while an animation plays.

        Args:
            animation: name or index.
            fps: frames a second, from the first key to the last; the rate of the animation's own keys where
                left out (:attr:`Animation.fps`).

        Raises:
            GmrError: there is no such animation, or it would have too many frames.
        """
        clip = self.find_animation(animation)
        return world_matrices(self.nodes, self.joints.tolist(), clip, clip.frame_times(fps))

    @property
    def skinned_parts(self) -> tuple[Part, ...]:
        """The parts that joints carry, in order."""
        return tuple(part for part in self.parts if part.is_skinned)

    @cached_property
    def faces(self) -> NDArray[np.int32]:
        """(T, 3) int32 triangles of all skinned parts, into the vertices that :meth:`skin` gives."""
        counts = np.cumsum([0, *(len(part.vertices) for part in self.skinned_parts)])
        each = [part.faces + start for part, start in zip(self.skinned_parts, counts[:-1], strict=True)]
        return frozen(np.concatenate([np.zeros((0, 3), np.int32), *each]), np.int32)

    @overload
    def skin(
        self,
        pose_matrices: ArrayLike,
        method: Method = ...,
        *,
        hemisphere: Hemisphere = ...,
        normals: Literal[False] = ...,
        out: FloatArray | None = ...,
        threads: int | None = ...,
    ) -> FloatArray: ...

    @overload
    def skin(
        self,
        pose_matrices: ArrayLike,
        method: Method = ...,
        *,
        hemisphere: Hemisphere = ...,
        normals: Literal[True],
        out: FloatArray | None = ...,
        threads: int | None = ...,
    ) -> tuple[FloatArray, FloatArray]: ...

    def skin(
        self,
        pose_matrices: ArrayLike,
        method: Method = "lbs",
        *,
        hemisphere: Hemisphere = "pivot",
        normals: bool = False,
        out: FloatArray | None = None,
        threads: int | None = None,
    ) -> FloatArray | tuple[FloatArray, FloatArray]:
        """The vertices of all skinned parts in given poses; see :meth:`gmr.skinning.Skin.blend`.

        Args:
            pose_matrices: (F, J, 4, 4) world matrices of the joints, or (J, 4, 4) for one pose.
            method: "lbs", "dqbs" or "cor".
            hemisphere: for "dqbs": "pivot" or "running".
            normals: give them too.
            out: (F, V, 3) C-contiguous float32 array to write the vertices into.
            threads: 0: all cores; None: all where it pays.

        Returns:
            (F, V, 3) float32 metres in the world, F = 1 for one pose; V runs over the skinned parts in order.
            With ``normals`` a pair of such arrays.

        Raises:
            GmrError: the matrices have another shape, no part is skinned, or normals are asked for and a
                part has none.
        """
        poses = np.asarray(pose_matrices, np.float64)
        joint_count = len(self.joints)
        if poses.ndim not in (3, 4) or poses.shape[-3:] != (joint_count, 4, 4):
            raise GmrError(
                f"pose matrices of the shape {poses.shape} are given; "
                f"they must be (frames, {joint_count}, 4, 4), or ({joint_count}, 4, 4) for one pose"
            )
        if normals and self.merged.normals is None:
            raise GmrError(f"character '{self.name}' has parts without normals, so these cannot be skinned")
        frames = poses.reshape(-1, 1, joint_count, 4, 4)
        transforms = (frames @ self.merged.inverse_binds).reshape(len(frames), -1, 4, 4)
        blend = self._blending.blend
        if normals:
            return blend(transforms, method, hemisphere=hemisphere, normals=True, out=out, threads=threads)
        return blend(transforms, method, hemisphere=hemisphere, out=out, threads=threads)

    @cached_property
    def _blending(self) -> Skin:
        """The skinned parts as the kernels hold them: a :class:`gmr.skinning.Skin`, checked once."""
        merged = self.merged
        count = len(self.joints) * len(merged.inverse_binds)
        return Skin(
            merged.vertices, merged.joints, merged.weights, count, normals=merged.normals, faces=self.faces
        )

    @cached_property
    def merged(self) -> Merged:
        """All skinned parts as one mesh, as the kernels take it.

        Raises:
            GmrError: no part is skinned.
        """
        parts = self.skinned_parts
        if not parts:
            raise GmrError(
                f"character '{self.name}' has no part with weights; bind one with gmr.skinning.bind"
            )
        skins: dict[bytes, int] = {}
        width = max(part.joints.shape[1] for part in parts)
        joints, weights = [], []
        matrices: list[NDArray[np.float64]] = []
        for part in parts:
            assert part.inverse_bind is not None
            skin = skins.setdefault(part.inverse_bind.tobytes(), len(skins))
            if skin == len(matrices):
                matrices.append(part.inverse_bind)
            spare = ((0, 0), (0, width - part.joints.shape[1]))
            joints.append(np.pad(part.joints + skin * len(self.joints), spare, mode="edge"))
            weights.append(np.pad(part.weights, spare))
        normals = [part.normals for part in parts if part.normals is not None]
        return Merged(
            vertices=np.concatenate([part.vertices for part in parts]),
            normals=np.concatenate(normals) if len(normals) == len(parts) else None,
            joints=np.concatenate(joints),
            weights=np.concatenate(weights),
            inverse_binds=np.stack(matrices),
        )

    def __repr__(self) -> str:
        vertices = sum(len(part.vertices) for part in self.parts)
        return (
            f"Character({self.name!r}, {len(self.joints)} joints, {len(self.parts)} parts with {vertices:,} "
            f"vertices, {len(self.materials)} materials, {len(self.animations)} animations)"
        )


class Merged(NamedTuple):
    """All skinned parts of a character as one mesh of V vertices; S skins of J joints."""

    vertices: NDArray[np.float32]
    """(V, 3)"""
    normals: NDArray[np.float32] | None
    """(V, 3); None where a part has none."""
    joints: NDArray[np.int32]
    """(V, K) into the S * J matrices of a frame."""
    weights: NDArray[np.float32]
    """(V, K)"""
    inverse_binds: NDArray[np.float64]
    """(S, J, 4, 4)"""
