"""Rows of Euler angles to poses and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.channels import ROTATIONS, ChannelLayout
from gmr.errors import SkeletonError
from gmr.frames import Pose, Rows
from gmr.quaternions import conjugate, multiply
from gmr.skeleton import Skeleton

__all__ = [
    "fewer_angles",
    "pose_from_rows",
    "rotations_of_rows",
    "rows_from_pose",
    "translations_of_rows",
]

_EXACT = 1e-6
"""Radians by which a rotation may miss what is written of it: the rounding of poses given in float32."""


def pose_from_rows(skeleton: Skeleton, rows: Rows) -> Pose:
    """Rotations and translations of rows of channels."""
    rotations, translations = rotations_of_rows(rows), translations_of_rows(skeleton, rows)
    return Pose(read_only(rotations), rows.layout.translated, read_only(translations), rows.layout)


def rows_from_pose(skeleton: Skeleton, pose: Pose) -> Rows:
    """Rows of channels of a pose, as its layout (or the standard one) writes them.

    Raises:
        SkeletonError: siblings turn independently, or a joint moves or turns as its channels cannot say.
    """
    layout = pose.layout or ChannelLayout.standard(skeleton, pose.translated)
    if not layout.fits(skeleton):
        raise SkeletonError(
            "this motion's bones turn independently of their siblings, or its roots were moved, which rows "
            "of channels cannot say. to_post_rotation() joins the roots and brings in dummy joints."
        )
    values = np.zeros((len(pose), layout.column_count))
    _write_angles(values, layout, skeleton, pose.rotations)
    _write_translations(values, layout, skeleton, pose)
    return Rows(read_only(values), layout)


def rotations_of_rows(rows: Rows) -> NDArray[np.float64]:
    """(F, S, 4): the rotation of each slot, in an array of its own."""
    layout = rows.layout
    rotations = np.empty((len(rows), len(layout.slot_joints), 4))
    _core.euler_to_quaternions(rows.values, layout.rotation_columns, layout.rotation_axes, rotations)
    return rotations


def translations_of_rows(skeleton: Skeleton, rows: Rows) -> NDArray[np.float64]:
    """(F, T, 3): the offset, with the position channels in its place or added to it."""
    layout = rows.layout
    columns = layout.translation_columns
    given = columns >= 0
    base = skeleton.offsets[layout.translated]
    found = np.empty((len(rows), *base.shape))
    found[:] = np.where(given, 0.0, base) if not layout.adds_offset else base
    found[:, given] += rows.values.take(columns[given], axis=1)
    return found


def _write_angles(
    values: NDArray[np.float64], layout: ChannelLayout, skeleton: Skeleton, rotations: NDArray[np.float64]
) -> None:
    """Writes the angles in degrees into the columns that the layout has for them."""
    columns, axes = layout.rotation_columns, layout.rotation_axes
    if not len(values):
        return
    whole = np.flatnonzero((columns >= 0).all(axis=1) & (axes[:, :-1] != axes[:, 1:]).all(axis=1))
    if len(whole):
        chosen = rotations if len(whole) == len(columns) else rotations.take(whole, axis=1)
        angles = _core.quaternions_to_euler(chosen, np.ascontiguousarray(axes[whole]))
        values[:, columns[whole]] = angles
    few = np.setdiff1d(np.arange(len(columns)), whole)
    for slot in few.tolist():
        steps = [
            k for k in range(3) if columns[slot, k] >= 0 and (k == 0 or axes[slot, k] != axes[slot, k - 1])
        ]
        if steps:
            found = fewer_angles(rotations[:, slot], [int(axes[slot, k]) for k in steps])
            values[:, columns[slot, steps]] = np.degrees(found)
    if len(few):
        _check_turns(values, layout, skeleton, few, rotations[:, few])


def _check_turns(
    values: NDArray[np.float64],
    layout: ChannelLayout,
    skeleton: Skeleton,
    slots: NDArray[np.intp],
    rotations: NDArray[np.float64],
) -> None:
    """Raises where the angles written for ``slots`` are not the (F, len(slots), 4) ``rotations``."""
    written = np.empty(rotations.shape)
    _core.euler_to_quaternions(values, layout.rotation_columns[slots], layout.rotation_axes[slots], written)
    missed = multiply(conjugate(written), rotations)
    off = 2 * np.arctan2(np.linalg.norm(missed[..., :3], axis=-1), np.abs(missed[..., 3]))
    wrong = np.argwhere(off > _EXACT)
    if not len(wrong):
        return
    frame, which = wrong[0].tolist()
    joint = layout.slot_joints[slots[which]]
    turns = [name for name in layout.names[joint] if name.lower() in ROTATIONS]
    raise SkeletonError(
        f"joint '{skeleton.names[joint]}' turns in frame {frame} as its rotation channels "
        f"({' '.join(turns) or 'none'}) cannot say: they miss it by "
        f"{np.degrees(off[frame, which]):.3g} degrees; give it three, or the whole motion no layout "
        "(layout=None), which writes it with the standard one."
    )


def fewer_angles(rotations: NDArray[np.float64], axes: Sequence[int]) -> NDArray[np.float64]:
    """Angles of rotations about one axis, or about two different ones in this order.

    ``q = q_a q_b`` has the components ``c_a c_b`` (w), ``s_a c_b`` (a), ``c_a s_b`` (b) and ``± s_a s_b``
    (the third) of the sines and cosines of half the angles; the larger of the two pairs that give the first
    angle is used.

    Args:
        rotations: (F, 4) xyzw.
        axes: one or two of 0, 1, 2.

    Returns:
        (F, len(axes)) radians, from -pi to pi.
    """
    w, a = rotations[:, 3], rotations[:, axes[0]]
    if len(axes) == 1:
        return _wrapped(2 * np.arctan2(a, w))[:, None]
    sign = 1.0 if (axes[1] - axes[0]) % 3 == 1 else -1.0
    b, third = rotations[:, axes[1]], sign * rotations[:, 3 - axes[0] - axes[1]]
    by_w = w * w + a * a >= b * b + third * third
    half = np.arctan2(np.where(by_w, a, third), np.where(by_w, w, b))
    cosine, sine = np.cos(half), np.sin(half)
    other = np.arctan2(b * cosine + third * sine, w * cosine + a * sine)
    return _wrapped(2 * np.stack([half, other], axis=1))


def _wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same angles within a half turn of 0."""
    return angles - 2 * np.pi * np.round(angles / (2 * np.pi))


def _write_translations(
    values: NDArray[np.float64], layout: ChannelLayout, skeleton: Skeleton, pose: Pose
) -> None:
    """Writes the positions into their columns; what has no column must be the offset."""
    columns = dict(zip(layout.translated.tolist(), layout.translation_columns, strict=True))
    none = np.full(3, -1, np.int32)
    for k, joint in enumerate(pose.translated.tolist()):
        given = columns.get(joint, none) >= 0
        moved, offset = pose.translations[:, k], skeleton.offsets[joint]
        if (moved[:, ~given] != offset[~given]).any():
            raise SkeletonError(
                f"joint '{skeleton.names[joint]}' moves, but its channels have no place for that; give it "
                "the channels Xposition Yposition Zposition, or the whole motion no layout (layout=None)."
            )
        if given.any():
            values[:, columns[joint][given]] = moved[:, given] - (offset[given] if layout.adds_offset else 0)
