"""What an edit leaves alone keeps its bits: numbers that went through other configurations come back rounded,
and are taken from the motion before the edit; a file that was read as rows of channels stays such rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.channels import ChannelLayout, turning_freely
from gmr.forest import carried, home
from gmr.frames import Pose, Rows
from gmr.motion import Motion

__all__ = ["ROUNDING", "continued_angles", "nearest_angles", "restored"]

Floats = NDArray[np.float64]

ROUNDING = 1e-12
"""Share of the motion's reach, and size of a quaternion's difference, that rounding alone accounts for."""


def restored(edited: Motion, before: Motion) -> Motion:
    """The edited motion with every number that only rounding changed as it was before.

    Args:
        edited: at home, of the same joints as ``before``.
        before: in any configuration, which the result is brought to.

    Returns:
        ``before`` itself where nothing was changed. Else a motion that holds rows of channels where it did:
        of all angles that name a rotation that changed, those are taken that go on best from what the file
        has before and after. A joint that turned and has fewer than three rotation channels gets
        three.
    """
    old = home(before)
    rotations, turned = _kept_rotations(edited.rotations, old.rotations)
    translations, moved = _kept_translations(edited, old)
    if not turned.any() and not moved.any() and np.array_equal(edited.translated, old.translated):
        return before
    layout = _layout(old, edited, np.flatnonzero(turned.any(axis=0)))
    pose = Pose(read_only(rotations), edited.translated, read_only(translations), layout)
    source: Pose | Rows = pose
    if isinstance(old.source, Rows) and layout == old.source.layout:
        source = _rows(old, pose, turned, moved)
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
    reach = max(np.abs(old.translations).max(initial=0), np.abs(old.skeleton.offsets).max(initial=0))
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


def continued_angles(
    was: Floats, rotations: Floats, turned: NDArray[np.bool_], axes: NDArray[np.uint8]
) -> Floats:
    """Angles of a joint in which some frames turn otherwise than they did, without needless jumps.

    In each run of such frames the angles either go on from frame to frame, from those that the first one had,
    or are each the nearest to what they were; whichever jumps less, the frames before and after counted.

    Args:
        was: (F, 3) degrees.
        rotations: (F, 4) xyzw, as they are now.
        turned: (F,) the frames that turn otherwise.
        axes: (3,) 0, 1 or 2, in composing order.
    """
    found = was.copy()
    edges = np.flatnonzero(np.diff(np.concatenate([[False], turned, [False]]).astype(np.int8)))
    for first, end in edges.reshape(-1, 2).tolist():
        run = np.ascontiguousarray(rotations[first:end, None])
        going_on = np.asarray(_core.quaternions_to_euler(run, np.ascontiguousarray(axes[None])))[:, 0]
        ways = [
            _alike(going_on, was[max(first - 1, 0)], axes),
            nearest_angles(going_on, was[first:end], axes.tolist()),
        ]
        around = slice(max(first - 1, 0), first), slice(end, end + 1)
        steps = [np.diff(np.concatenate([was[around[0]], way, was[around[1]]]), axis=0) for way in ways]
        found[first:end] = min(zip(ways, steps, strict=True), key=lambda one: np.abs(one[1]).max(initial=0))[
            0
        ]
    return found


def _alike(angles: Floats, to: Floats, axes: NDArray[np.uint8]) -> Floats:
    """(n, 3) angles that go on from frame to frame, all named in that of their ways that is nearest to ``to``
    in the first frame."""
    (start,) = nearest_angles(angles[:1], to[None], axes.tolist())
    shift = start - angles[0]
    if np.abs(shift - 360 * np.round(shift / 360)).max() < 1e-6:
        return np.asarray(angles + 360 * np.round(shift / 360), np.float64)
    other = _other_name(angles, axes.tolist())
    return np.asarray(other + 360 * np.round((start - other[0]) / 360), np.float64)


def nearest_angles(angles: Floats, to: Floats, axes: Sequence[int]) -> Floats:
    """Of all angles that name the same rotations, those nearest to others.

    ``(a, b, c)`` about three different axes is ``(a + 180, 180 - b, c + 180)`` too; where the first axis is
    the third, it is ``(a + 180, -b, c + 180)``; and full turns may be added to each.

    Args:
        angles: (F, 3) degrees.
        to: (F, 3) degrees.
        axes: 0, 1 or 2 for each of the three.
    """
    candidates = np.stack([angles, _other_name(angles, axes)])
    candidates = candidates + 360 * np.round((to - candidates) / 360)
    chosen = np.abs(candidates - to).max(axis=-1).argmin(axis=0)
    return np.asarray(candidates[chosen, np.arange(len(angles))], np.float64)


def _other_name(angles: Floats, axes: Sequence[int]) -> Floats:
    """The same rotations by the other three angles."""
    mirrored = -angles[:, 1] if axes[0] == axes[2] else 180 - angles[:, 1]
    return np.stack([angles[:, 0] + 180, mirrored, angles[:, 2] + 180], axis=1)
