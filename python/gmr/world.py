"""World positions and rotations of a motion, straight from what it holds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from gmr import _core
from gmr.errors import GmrError
from gmr.frames import Rows
from gmr.threads import threads_for

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["motion_positions", "motion_rotations", "quaternion_job"]

FloatArray = NDArray[Any]
"""float32 or float64, as asked."""

_FEW = 0.75
"""Share of the slots up to which rotations that move something are kept apart from the others."""


def motion_positions(
    motion: Motion,
    dtype: DTypeLike | None,
    joints: Iterable[str | int | np.integer[Any]] | None,
    out: FloatArray | None,
    threads: int | None,
) -> FloatArray:
    """World positions; see :meth:`gmr.Motion.positions`."""
    chosen = None if joints is None else motion.skeleton.indices(joints)
    count = motion.skeleton.joint_count if chosen is None else len(chosen)
    shape = (motion.frame_count, count, 3)
    if out is None:
        out = np.empty(shape, _float_type(dtype))
    else:
        _check_out(out, shape, dtype)
    _forward_kinematics(motion, chosen, None, out, None, threads)
    return out


def motion_rotations(
    motion: Motion, slots: NDArray[np.int32], dtype: DTypeLike | None, threads: int | None
) -> FloatArray:
    """(F, M, 4) world rotation of each of ``slots`` (-1: identity)."""
    out: FloatArray = np.empty((motion.frame_count, len(slots), 4), _float_type(dtype))
    _forward_kinematics(motion, np.empty(0, np.int32), slots, None, out, threads)
    return out


def _forward_kinematics(
    motion: Motion,
    joints: NDArray[np.int32] | None,
    slots: NDArray[np.int32] | None,
    positions: FloatArray | None,
    rotations: FloatArray | None,
    threads: int | None,
) -> None:
    """Runs the kernel that fits what the motion holds: Euler rows as read, or quaternions."""
    skeleton, source = motion.skeleton, motion.source
    thread_total = threads_for(motion.frame_count * skeleton.joint_count, threads)
    wanted = (joints, slots, positions, rotations, thread_total)
    if isinstance(source, Rows):
        layout = source.layout
        _core.forward_kinematics_euler(
            skeleton.topology, source.values, layout.rotation_columns, layout.rotation_axes,
            layout.translated, layout.translation_columns, layout.adds_offset, skeleton.offsets, *wanted,
        )  # fmt: skip
        return
    dtype = (positions if positions is not None else rotations).dtype  # type: ignore[union-attr]
    _core.forward_kinematics(*quaternion_job(motion, dtype, only_positions=rotations is None), *wanted)


def quaternion_job(
    motion: Motion, dtype: np.dtype[Any], *, only_positions: bool
) -> tuple[_core.Topology, FloatArray, NDArray[np.int32], FloatArray, FloatArray]:
    """What the kernel takes of a motion: topology, rotations, translated joints, translations, offsets.

    For positions in float32 rotations that move nothing are left out where they are many: they would only be
    read past.
    """
    skeleton, pose = motion.skeleton, motion.pose
    topology = skeleton.topology
    turns: FloatArray = pose.rotations
    moves: FloatArray = pose.translations
    if dtype == np.float32:
        slots, turning = skeleton.turning
        if only_positions and len(slots) <= _FEW * skeleton.slot_count:
            topology, (turns, moves) = turning, pose.single_of(slots)
        else:
            turns, moves = pose.single
    return topology, turns, pose.translated, moves, skeleton.offsets.astype(dtype, copy=False)


def _float_type(dtype: DTypeLike | None) -> np.dtype[Any]:
    try:
        found = np.dtype(np.float32 if dtype is None else dtype)
    except TypeError as error:
        raise GmrError(f"positions and rotations come as float32 or float64, not {dtype!r}") from error
    if found not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise GmrError(f"positions and rotations come as float32 or float64, not {found}")
    return found


def _check_out(out: FloatArray, shape: tuple[int, ...], dtype: DTypeLike | None) -> None:
    """Raises unless ``out`` can be written into as asked."""
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out must be an array to write into, not {out!r:.60}")
    wanted = _float_type(out.dtype if dtype is None else dtype)
    if out.shape != shape or out.dtype != wanted or not out.flags.c_contiguous or not out.flags.writeable:
        raise GmrError(
            f"out must be a writable, C-contiguous {wanted} array of shape {shape}; "
            f"this one is {out.dtype} {out.shape}"
        )
