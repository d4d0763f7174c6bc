"""Blending: where the vertices of a skin are when the joints that they follow have moved.

Source: spec "Skinning"; Kavan et al. 2007, "Skinning with Dual Quaternions"; Le and Hodgins 2016, "Real-time
Skeletal Skinning with Optimized Centers of Rotation".
"""

from __future__ import annotations

from typing import Final, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.arrays import frozen, read_only
from gmr.errors import SkinError
from gmr.threads import thread_count

__all__ = ["Hemisphere", "Method", "Skin"]

Method = Literal["lbs", "dqbs", "cor"]
Hemisphere = Literal["pivot", "running"]
FloatArray = NDArray[np.float32]

_THREADING_PAYS = 500_000
"""Vertices times frames above which sharing the work among threads wins over starting them."""


class Skin:
    """Vertices at rest and the joints that each follows; immutable, checked once, blended at will.

    Args:
        vertices: (V, 3) at rest, in any unit, which is that of the answers.
        joints: (V, K) the joints that each vertex follows, from 0; where the weight is 0, any number.
        weights: (V, K) how much it follows each, not negative; taken as they are, so they should sum to 1.
        joint_count: how many joints the transforms are of; by default as many as ``joints`` needs.
        normals: (V, 3) of length 1, where there are any.
        faces: (T, 3) triangles of vertices, where there are any: ``method="cor"`` needs them.

    Raises:
        SkinError: a shape does not fit, a vertex follows a joint that is not there, or none at all, a weight
            is negative or not finite, or an index is no whole number.
    """

    def __init__(
        self,
        vertices: ArrayLike,
        joints: ArrayLike,
        weights: ArrayLike,
        joint_count: int | None = None,
        *,
        normals: ArrayLike | None = None,
        faces: ArrayLike | None = None,
    ) -> None:
        self.vertices: Final = _rows(vertices, 3, "vertices")
        self.weights: Final = _rows(weights, None, "weights")
        self.joints: Final = _indices(joints, None, "joints")
        self.normals: Final = None if normals is None else _rows(normals, 3, "normals")
        self.faces: Final = None if faces is None else _indices(faces, 3, "faces")
        for name, array in (("joints", self.joints), ("weights", self.weights)):
            if len(array) != len(self.vertices):
                raise SkinError(
                    f"{name} has {len(array)} rows for {len(self.vertices)} vertices; give one to each"
                )
        followed = self.joints[self.weights > 0] if self.joints.shape == self.weights.shape else self.joints
        if joint_count is None:
            joint_count = int(followed.max(initial=-1)) + 1
        try:
            self._core: Final = _core.Skin(
                self.vertices, self.joints, self.weights, joint_count, self.normals
            )
        except ValueError as error:
            raise SkinError(str(error)) from None
        self._centers: FloatArray | None = None

    @property
    def vertex_count(self) -> int:
        """V."""
        return self._core.vertex_count

    @property
    def joint_count(self) -> int:
        """How many joints the transforms are of."""
        return self._core.joint_count

    def centers(self, threads: int | None = None) -> FloatArray:
        """(V, 3) centres of rotation: the points about which ``method="cor"`` turns the vertices.

        A vertex that follows one joint alone is its own. Computed when first asked for, and kept.

        Raises:
            SkinError: the skin has no faces.

        Source: Le and Hodgins 2016, Eqs. 1 and 4, weights rounded to 1/256.
        """
        if self._centers is None:
            if self.faces is None:
                raise SkinError(
                    "centres of rotation lie on a surface, and this skin has none; give it its faces"
                )
            try:
                found = self._core.centers(self.faces.reshape(-1), thread_count(threads))
            except ValueError as error:
                raise SkinError(str(error)) from None
            self._centers = read_only(found.reshape(-1, 3))
        return self._centers

    @overload
    def blend(
        self,
        transforms: ArrayLike,
        method: Method = ...,
        *,
        hemisphere: Hemisphere = ...,
        normals: Literal[False] = ...,
        out: FloatArray | None = ...,
        threads: int | None = ...,
    ) -> FloatArray: ...

    @overload
    def blend(
        self,
        transforms: ArrayLike,
        method: Method = ...,
        *,
        hemisphere: Hemisphere = ...,
        normals: Literal[True] | FloatArray,
        out: FloatArray | None = ...,
        threads: int | None = ...,
    ) -> tuple[FloatArray, FloatArray]: ...

    def blend(
        self,
        transforms: ArrayLike,
        method: Method = "lbs",
        *,
        hemisphere: Hemisphere = "pivot",
        normals: bool | FloatArray = False,
        out: FloatArray | None = None,
        threads: int | None = None,
    ) -> FloatArray | tuple[FloatArray, FloatArray]:
        """The vertices in every frame, and their normals where asked for.

        Args:
            transforms: (F, B, 4, 4), or (B, 4, 4) for one frame: the world matrix of each joint now times the
                inverse of its bind matrix, for column vectors.
            method: ``"lbs"``, linear; ``"dqbs"``, dual quaternions, scale and shear linearly before them;
                ``"cor"``, about centres of rotation, which need the skin's faces.
            hemisphere: which of a rotation's two quaternions each influence gives to ``"dqbs"``: the one that
                points as that of the vertex's strongest joint (``"pivot"``), or as the sum of those before it
                (``"running"``, what Blender does).
            normals: whether they are wanted too, or a C-contiguous float32 array (F, V, 3) for them. They
                have length 1, and length 0 where transforms flatten what lies around the vertex.
            out: where the positions go, C-contiguous float32 (F, V, 3).
            threads: 0 for all cores; by default all where it pays. The answer is the same for every number.

        Returns:
            (F, V, 3) float32; with ``normals`` a pair of them. NaN in a transform stays with the vertices
            that follow its joint in that frame.

        Raises:
            SkinError: a shape does not fit, a transform is not affine, or the skin lacks what is asked for.
        """
        matrices = np.asarray(transforms, np.float64)
        if matrices.ndim == 3:
            matrices = matrices[None]
        if matrices.ndim != 4 or matrices.shape[1:] != (self.joint_count, 4, 4):
            raise SkinError(
                f"transforms have shape {np.shape(transforms)}; give (frames, {self.joint_count}, 4, 4), "
                "a matrix for each joint of the skin in each frame"
            )
        kernel = _kernel(method, hemisphere)
        centers = self.centers(threads)[None] if kernel == "centers" else None
        shape = (len(matrices), self.vertex_count, 3)
        positions = np.empty(shape, np.float32) if out is None else _room(out, shape, "out")
        turned = None
        if normals is not False:
            turned = np.empty(shape, np.float32) if normals is True else _room(normals, shape, "normals")
        pays = len(matrices) * self.vertex_count > _THREADING_PAYS
        count = thread_count(threads, default=0 if pays else 1)
        flat = np.ascontiguousarray(matrices).reshape(len(matrices), 16 * self.joint_count)
        try:
            self._core.blend(flat, kernel, positions, turned, centers, count)
        except ValueError as error:
            raise SkinError(str(error)) from None
        return positions if turned is None else (positions, turned)


def _kernel(method: str, hemisphere: str) -> str:
    if hemisphere not in ("pivot", "running"):
        raise SkinError(f"there is no hemisphere '{hemisphere}'; choose 'pivot' or 'running'")
    kernels = {"lbs": "linear", "dqbs": hemisphere, "cor": "centers"}
    if method not in kernels:
        raise SkinError(f"there is no method '{method}'; choose one of {', '.join(kernels)}")
    return kernels[method]


def _rows(array: ArrayLike, width: int | None, name: str) -> FloatArray:
    found = frozen(array, np.float32)
    _check(found, width, name)
    return found


def _indices(array: ArrayLike, width: int | None, name: str) -> NDArray[np.int32]:
    given = np.asarray(array)
    if given.size and not np.issubdtype(given.dtype, np.integer):
        raise SkinError(f"{name} holds numbers of type {given.dtype}; give whole numbers")
    limits = np.iinfo(np.int32)
    if given.size and (given.min() < limits.min or given.max() > limits.max):
        raise SkinError(f"{name} holds {given.max()}, which is more than any mesh has; indices count from 0")
    found = frozen(given, np.int32)
    _check(found, width, name)
    return found


def _check(array: NDArray[np.float32] | NDArray[np.int32], width: int | None, name: str) -> None:
    if array.ndim != 2 or (width is not None and array.shape[1] != width):
        wanted = "K" if width is None else width
        raise SkinError(f"{name} has shape {array.shape}; give (N, {wanted})")


def _room(array: FloatArray, shape: tuple[int, ...], name: str) -> FloatArray:
    if array.shape != shape or array.dtype != np.float32 or not array.flags.c_contiguous:
        raise SkinError(
            f"{name} is {array.dtype} of shape {array.shape}; give a C-contiguous float32 array of shape "
            f"{shape}"
        )
    return array
