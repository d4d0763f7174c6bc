"""Rows of Euler angles to poses and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.errors import SkeletonError
from gmr.frames import Pose, Rows
from gmr.skeleton import Skeleton

__all__ = ["pose_from_rows", "rows_from_pose"]


def pose_from_rows(skeleton: Skeleton, rows: Rows) -> Pose:
    """Rotations and translations of rows of channels."""
    layout = rows.layout
    rotations = np.empty((len(rows), len(layout.slot_joints), 4))
    _core.euler_to_quaternions(rows.values, layout.rotation_columns, layout.rotation_axes, rotations)
    translations = _translations(skeleton, rows)
    return Pose(read_only(rotations), layout.translated, read_only(translations), layout)


def rows_from_pose(skeleton: Skeleton, pose: Pose) -> Rows:
    """Rows of channels of a pose, as its layout (or the standard one) writes them.

    Raises:
        SkeletonError: siblings turn independently, or a joint moves that has no position channels.
    """
    layout = pose.layout or ChannelLayout.standard(skeleton, pose.translated)
    if not layout.fits(skeleton):
        raise SkeletonError(
            "this motion's bones turn independently of their siblings, which rows of channels cannot say. "
            "Where dummy joints were dropped, restore_dummies() brings them back."
        )
    values = np.zeros((len(pose), layout.column_count))
    _write_angles(values, layout, pose.rotations)
    _write_translations(values, layout, skeleton, pose)
    return Rows(read_only(values), layout)


def _translations(skeleton: Skeleton, rows: Rows) -> NDArray[np.float64]:
    """(F, T, 3): the offset, with the position channels in its place or added to it."""
    layout = rows.layout
    columns = layout.translation_columns
    given = columns >= 0
    base = skeleton.offsets[layout.translated]
    found = np.empty((len(rows), *base.shape))
    found[:] = np.where(given, 0.0, base) if not layout.adds_offset else base
    found[:, given] += rows.values[:, columns[given]]
    return found


def _write_angles(values: NDArray[np.float64], layout: ChannelLayout, rotations: NDArray[np.float64]) -> None:
    """Writes the angles in degrees into the columns that the layout has for them."""
    columns = layout.rotation_columns
    if not len(columns) or not len(values):
        return
    angles = _core.quaternions_to_euler(rotations, _whole_orders(layout))
    given = columns >= 0
    values[:, columns[given]] = angles[:, given]


def _whole_orders(layout: ChannelLayout) -> NDArray[np.uint8]:
    """(S, 3) axes in which every slot has three steps: missing ones come last and stay 0."""
    axes = layout.rotation_axes.copy()
    for slot, count in enumerate((layout.rotation_columns >= 0).sum(axis=1).tolist()):
        for step in range(count, 3):
            axes[slot, step] = next(axis for axis in (0, 1, 2) if axis not in axes[slot, :step])
    return axes


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
