"""What an edit leaves alone keeps its bits: numbers that went through other configurations come back rounded,
and are taken from the motion before the edit; a file that was read as rows stays such rows."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.channels import ChannelLayout, turning_freely
from gmr.dof_rows import DofRows
from gmr.editing.keeping_dofs import dofs_kept
from gmr.editing.nearest_angles import continued_angles
from gmr.forest import carried, home
from gmr.frames import Pose, Rows
from gmr.motion import Motion

__all__ = ["ROUNDING", "restored"]

Floats = NDArray[np.float64]

ROUNDING = 1e-12
"""Share of the motion's reach, and size of a quaternion's difference, that rounding alone accounts for."""


def restored(edited: Motion, before: Motion) -> Motion:
    """The edited motion with every number that only rounding changed as it was before.

    Args:
        edited: at home, of the same joints as ``before``.
        before: in any configuration, which the result is brought to.

    Returns:
        ``before`` itself where nothing was changed. Else a motion that holds rows of channels, or values of
        degrees of freedom, where it did: of all angles that name a rotation that changed, those are taken
        that go on best from what the file has before and after. A joint that turned and has fewer than three
        rotation channels gets three, and a bone three degrees of freedom if its own do not suffice.
    """
    old = home(before)
    rotations, turned = _kept_rotations(edited.rotations, old.rotations)
    translations, moved = _kept_translations(edited, old)
    if not turned.any() and not moved.any() and np.array_equal(edited.translated, old.translated):
        return before
    layout = _layout(old, edited, np.flatnonzero(turned.any(axis=0)))
    pose = Pose(read_only(rotations), edited.translated, read_only(translations), layout, acclaim=old.acclaim)
    source: Pose | Rows | DofRows = pose
    if isinstance(old.source, Rows) and layout == old.source.layout:
        source = _rows(old, pose, turned, moved)
    elif isinstance(old.source, DofRows) and np.array_equal(edited.translated, old.translated):
        source = dofs_kept(old.source, pose, turned, moved[:, 0])
    dropped = None if before.dropped is None else before.dropped.without_rows()
    return carried(replace(before, skeleton=old.skeleton, source=source, dropped=dropped), before.skeleton)


def _kept_rotations(new: Floats, old: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Rotations with the old bits and signs where they are the old ones, and (F, S) where they are not."""
    signed = np.where((new * old).sum(axis=-1, keepdims=True) < 0, -new, new)
    turned = np.abs(signed - old).max(axis=-1, initial=0) > ROUNDING
    return np.where(turned[..., None], signed, old), turned


def _kept_translations(edited: Motion, old: Motion) -> tuple[Floats, NDArray[np.bool_]]:
    """Translations with the old bits where they are the old ones, and (F, T) where they are not."""
    columns = {joint: k for k, joint in enumerate(old.translated.tolist())}
    new = edited.translations.copy()
    moved = np.ones(new.shape[:2], bool)
    reach = max(np.nanmax(np.abs(old.translations), initial=0), np.abs(old.skeleton.offsets).max(initial=0))
    for k, joint in enumerate(edited.translated.tolist()):
        if joint in columns:
            was = old.translations[:, columns[joint]]
            moved[:, k] = np.abs(new[:, k] - was).max(axis=-1, initial=0) > ROUNDING * reach
            new[~moved[:, k], k] = was[~moved[:, k]]
    return new, moved


def _layout(old: Motion, edited: Motion, slots: NDArray[np.intp]) -> ChannelLayout | None:
    """Channels that can write the edited motion; None where the standard ones have to."""
    layout = old.layout
    if layout is None or not set(edited.translated.tolist()) <= set(layout.translated.tolist()):
        return None
    if len(layout.slot_joints) != old.skeleton.slot_count or not _can_move(layout, edited):
        return None
    narrow = [slot for slot in slots.tolist() if (layout.rotation_columns[slot] < 0).any()]
    if not narrow:
        return layout
    names = list(layout.names)
    for joint in layout.slot_joints[narrow].tolist():
        names[joint] = turning_freely(names[joint])
    return replace(layout, names=tuple(names))


def _can_move(layout: ChannelLayout, edited: Motion) -> bool:
    """Whether each translation that has no channel is the joint's offset."""
    columns = dict(zip(layout.translated.tolist(), layout.translation_columns, strict=True))
    offsets = edited.skeleton.offsets
    return all(
        (edited.translations[:, k, columns[joint] < 0] == offsets[joint, columns[joint] < 0]).all()
        for k, joint in enumerate(edited.translated.tolist())
    )


def _rows(old: Motion, pose: Pose, turned: NDArray[np.bool_], moved: NDArray[np.bool_]) -> Rows:
    """The old rows, with the numbers of ``turned`` slots and ``moved`` joints written anew."""
    layout, was = cast(ChannelLayout, old.layout), old.rows
    values = was.copy()
    for slot in np.flatnonzero(turned.any(axis=0)).tolist():
        columns, axes = layout.rotation_columns[slot], layout.rotation_axes[slot]
        values[:, columns] = continued_angles(was[:, columns], pose.rotations[:, slot], turned[:, slot], axes)
    places = dict(zip(layout.translated.tolist(), layout.translation_columns, strict=True))
    for k in np.flatnonzero(moved.any(axis=0)).tolist():
        joint = int(pose.translated[k])
        frames, axes = np.flatnonzero(moved[:, k]), np.flatnonzero(places[joint] >= 0)
        base = old.skeleton.offsets[joint, axes] if layout.adds_offset else 0.0
        values[np.ix_(frames, places[joint][axes])] = pose.translations[:, k][np.ix_(frames, axes)] - base
    return Rows(read_only(values), layout)
