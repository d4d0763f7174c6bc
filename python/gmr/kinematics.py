"""Forward kinematics of plain arrays: no motion, no file, any number of frames."""

from __future__ import annotations

from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.errors import GmrError, SkeletonError
from gmr.threads import threads_for

__all__ = ["forward_kinematics"]

FloatArray = NDArray[np.float32] | NDArray[np.float64]
RotationOrder = Literal["post", "pre"]


@overload
def forward_kinematics(
    parents: ArrayLike,
    offsets: ArrayLike,
    rotations: ArrayLike,
    translations: ArrayLike | None = ...,
    rotation_order: RotationOrder = ...,
    *,
    translated: ArrayLike | None = ...,
    joints: ArrayLike | None = ...,
    normalize: bool = ...,
    world_rotations: Literal[False] = ...,
    out: FloatArray | None = ...,
    threads: int | None = ...,
) -> FloatArray: ...


@overload
def forward_kinematics(
    parents: ArrayLike,
    offsets: ArrayLike,
    rotations: ArrayLike,
    translations: ArrayLike | None = ...,
    rotation_order: RotationOrder = ...,
    *,
    translated: ArrayLike | None = ...,
    joints: ArrayLike | None = ...,
    normalize: bool = ...,
    world_rotations: Literal[True],
    out: FloatArray | None = ...,
    threads: int | None = ...,
) -> tuple[FloatArray, FloatArray]: ...


def forward_kinematics(
    parents: ArrayLike,
    offsets: ArrayLike,
    rotations: ArrayLike,
    translations: ArrayLike | None = None,
    rotation_order: RotationOrder = "post",
    *,
    translated: ArrayLike | None = None,
    joints: ArrayLike | None = None,
    normalize: bool = True,
    world_rotations: bool = False,
    out: FloatArray | None = None,
    threads: int | None = None,
) -> FloatArray | tuple[FloatArray, FloatArray]:
    """World positions of a skeleton's joints from their local rotations.

    The float type of ``rotations`` is that of the computation and of the result; anything but float32 counts
    as float64.

    Args:
        parents: (J,) index of each joint's parent, -1 for a root; several roots and any order are welcome.
        offsets: (J, 3) vector from its parent to each joint; of a root, its place.
        rotations: (..., J, 4) xyzw, one for each joint; ``...`` is often the frames.
        translations: (..., 3) world place of the only root, or (..., T, 3) of all roots (or of
            ``translated``); None: all stay at their offsets.
        rotation_order: "post": a joint's rotation turns what hangs below it (BVH, glTF, game engines);
            "pre": it turns the bone from the parent to the joint, and all below (the General Motion
            Representation).
        translated: (T,) joints that ``translations`` is of; one that is no root moves by its bone's vector,
            before its rotation is applied. The roots by default.
        joints: (K,) indices of the joints wanted; all by default.
        normalize: divide each rotation by its length; one of zeros then gives NaN below it. With False they
            must be unit: a length of 1 + e scales bones by about 1 + 2e.
        world_rotations: return world rotations too.
        out: (..., K, 3) C-contiguous array of the result's type to write the positions into.
        threads: 0: all cores; None: all cores for large inputs. The bits do not depend on it.

    Returns:
        Positions (..., K, 3); with ``world_rotations`` also rotations (..., J, 4) xyzw: in "post" order each
        joint's frame, in "pre" order each bone's.

    Raises:
        SkeletonError: the parents form no trees.
        GmrError: a shape, type or index does not fit.
    """
    tree = _indices(parents, "parents", len(np.atleast_1d(parents)))
    joint_count = len(tree)
    turns = _floats(rotations, "rotations")
    if turns.ndim < 2 or turns.shape[-2:] != (joint_count, 4):
        raise GmrError(
            f"rotations have shape {turns.shape}; {joint_count} parents need (..., {joint_count}, 4)"
        )
    lead = turns.shape[:-2]
    roots = np.flatnonzero(tree < 0)
    moving = _indices(roots if translated is None else translated, "translated", joint_count)
    moves = _moves(translations, moving, lead, turns.dtype)
    if translations is None:
        moving = moving[:0]

    topology, vectors = _tree(tree, _vectors(offsets, joint_count), rotation_order)
    wanted = _indices(np.arange(joint_count) if joints is None else joints, "joints", joint_count)
    places = _room(out, (*lead, len(wanted), 3), turns.dtype)
    frames = int(np.prod(lead))
    turned = np.empty((frames, joint_count, 4), turns.dtype) if world_rotations else None
    thread_total = threads_for(frames * joint_count, threads)
    try:
        _core.forward_kinematics(
            topology, turns.reshape(frames, joint_count, 4), moving, moves.reshape(frames, len(moving), 3),
            vectors, wanted, np.arange(joint_count, dtype=np.int32), places.reshape(frames, len(wanted), 3),
            turned, thread_total, normalize=normalize,
        )  # fmt: skip
    except ValueError as error:
        raise GmrError(str(error)) from None
    return places if turned is None else (places, turned.reshape(*lead, joint_count, 4))


def _tree(
    parents: NDArray[np.int32], offsets: NDArray[np.float64], rotation_order: str
) -> tuple[_core.Topology, NDArray[np.float64]]:
    """The forest in rotation slots, one for each joint, and its offsets."""
    count = len(parents)
    if rotation_order == "post":
        # Joints without children get a tip, so that their rotation too has a bone to turn.
        leaves = np.setdiff1d(np.arange(count, dtype=np.int32), parents)
        parents = np.concatenate([parents, leaves])
        offsets = np.concatenate([offsets, np.zeros((len(leaves), 3))])
        slots = parents
    elif rotation_order == "pre":
        slots = np.arange(count, dtype=np.int32)
    else:
        raise GmrError(f"rotation_order is 'post' or 'pre', not {rotation_order!r}")
    try:
        return _core.Topology(parents, slots, count), offsets
    except ValueError as error:
        raise SkeletonError(str(error)) from None


def _indices(values: ArrayLike, name: str, count: int) -> NDArray[np.int32]:
    """Indices of ``count`` joints in one dimension; what -1 means is left to the kernel."""
    found = np.asarray(values)
    if found.ndim != 1 or (found.size and found.dtype.kind not in "iu"):
        raise GmrError(
            f"{name} must be whole numbers in one dimension, not {found.dtype} of shape {found.shape}"
        )
    if found.size and (found.min() < -1 or found.max() >= count):
        wrong = found[(found < -1) | (found >= count)][0]
        raise GmrError(f"{name} holds {wrong}, but there are {count} joints")
    return found.astype(np.int32)


def _floats(values: ArrayLike, name: str) -> NDArray[Any]:
    """A C-contiguous float32 or float64 array."""
    try:
        found = np.asarray(values)
    except ValueError as error:
        raise GmrError(f"{name} is no array: its rows are not equally long") from error
    if found.dtype.kind not in "fiu":
        raise GmrError(f"{name} must be real numbers, not {found.dtype}")
    return np.ascontiguousarray(found, found.dtype if found.dtype == np.float32 else np.float64)


def _vectors(offsets: ArrayLike, joint_count: int) -> NDArray[np.float64]:
    found = _floats(offsets, "offsets").astype(np.float64)
    if found.shape != (joint_count, 3):
        raise GmrError(f"offsets have shape {found.shape}; {joint_count} parents need ({joint_count}, 3)")
    return found


def _moves(
    translations: ArrayLike | None, moving: NDArray[np.int32], lead: tuple[int, ...], dtype: np.dtype[Any]
) -> NDArray[Any]:
    """(..., T, 3) of the computation's type; T is 0 where nothing is translated."""
    if translations is None:
        return np.empty((*lead, 0, 3), dtype)
    found = _floats(translations, "translations")
    shape = (*lead, len(moving), 3)
    if found.shape != shape and not (len(moving) == 1 and found.shape == (*lead, 3)):
        raise GmrError(
            f"translations have shape {found.shape}; rotations of {lead} poses and {len(moving)} translated "
            f"joints need {shape}" + (f" or {(*lead, 3)}" if len(moving) == 1 else "")
        )
    return found.reshape(shape).astype(dtype, copy=False)


def _room(out: FloatArray | None, shape: tuple[int, ...], dtype: np.dtype[Any]) -> FloatArray:
    """``out``, or a new array."""
    if out is None:
        return np.empty(shape, dtype)
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out must be an array to write into, not {out!r:.60}")
    if out.shape != shape or out.dtype != dtype or not (out.flags.c_contiguous and out.flags.writeable):
        raise GmrError(
            f"out must be a writable, C-contiguous {dtype} array of shape {shape}; "
            f"this one is {out.dtype} {out.shape}"
        )
    return out
