"""Dummy joints: joints of zero length, which a post-rotation file needs so that siblings can turn
independently.

The removal composes two rotations, so every joint that stays keeps its place: a dummy d with parent p and
children c goes by ``R''_c = R'_d R'_c``, c hanging on p with its own offset. Slots keep their numbers; the
slot of the dummy's own bone stays in the motion even where no bone uses it any more, and so the removal can
be undone.
Source: the General Motion Representation, dummy joints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.euler import rotations_of_rows, translations_of_rows
from gmr.forest import changed_at_home
from gmr.frames import Pose, Rows
from gmr.skeleton import End, Skeleton
from gmr.threads import threads_for

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Dropped", "drop_dummies", "find_dummies", "restore_dummies"]


@dataclass(frozen=True)
class Dropped:
    """What a motion was before its dummies were dropped, as far as it cannot be told from what is left.

    Args:
        skeleton: with the dummies, in the motion's own unit and on its own side.
        layout: its channels.
        translated: the joints of it that had a translation per frame.
        dummies: the joints of it that were dropped.
        before: what had been dropped earlier.
        rows: the frames as they were read, as long as nothing but their choice, side or unit has changed.
    """

    skeleton: Skeleton
    layout: ChannelLayout | None
    translated: tuple[int, ...]
    dummies: tuple[int, ...]
    before: Dropped | None
    rows: Rows | None = field(default=None, compare=False)

    def on(self, skeleton: Callable[[Skeleton], Skeleton], rows: Callable[[Rows], Rows | None]) -> Dropped:
        """The same record for a motion whose skeleton or frames were changed in this way."""
        return replace(
            self,
            skeleton=skeleton(self.skeleton),
            before=None if self.before is None else self.before.on(skeleton, rows),
            rows=None if self.rows is None else rows(self.rows),
        )

    def frames(self, part: slice) -> Dropped:
        """The same record for some of the frames."""
        return self.on(lambda skeleton: skeleton, lambda rows: rows.frames(part))

    def without_rows(self) -> Dropped:
        """The same record for a motion whose frames are others now."""
        return self.on(lambda skeleton: skeleton, lambda rows: None)


def find_dummies(motion: Motion) -> tuple[int, ...]:
    """Indices of the dummy joints: neither root nor end, with children, of zero length in every frame.

    In any configuration it is the bone above the joint at home that counts; one that is cut has no length.
    """
    skeleton = motion.skeleton
    at_home = skeleton if skeleton.home is None else skeleton.home
    lengths = np.abs(skeleton.offsets).max(axis=1)
    moving = [joint for joint in motion.translated.tolist() if skeleton.parents[joint] >= 0]
    if moving and motion.frame_count:
        source = motion.source
        translations = (
            translations_of_rows(skeleton, source) if isinstance(source, Rows) else motion.translations
        )
        lengths[motion.translated] = np.abs(translations).max(axis=(0, 2))
    zero = skeleton.forest.bones[(lengths == 0) & (skeleton.parents >= 0)]
    return tuple(
        joint
        for joint in sorted(zero.tolist())
        if at_home.children[joint] and skeleton.ends[joint] == End.JOINT and skeleton.parents[joint] >= 0
    )


def drop_dummies(motion: Motion, *, threads: int | None = None) -> Motion:
    """The motion without its dummy joints; all that stay keep their world positions and bone rotations.

    Args:
        motion: any, in any configuration.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Returns:
        A motion that remembers what was removed (:func:`restore_dummies`); the same motion where it has no
        dummies.
    """
    dummies = find_dummies(motion)
    if not dummies:
        return motion
    if motion.skeleton.home is not None:
        kept = np.setdiff1d(np.arange(motion.skeleton.joint_count), dummies)
        places = _renumbering(motion.skeleton.joint_count, kept)
        return changed_at_home(motion, lambda one: _without(one, dummies, threads), places, threads=threads)
    return _without(motion, dummies, threads)


def _without(motion: Motion, dummies: tuple[int, ...], threads: int | None) -> Motion:
    """The motion, at home, without these dummies."""
    gone = set(dummies)
    skeleton = motion.skeleton
    rotations, translations = _numbers(motion)
    parents, slots = skeleton.parents.copy(), skeleton.slots.copy()
    turned, by = [], []
    for dummy in (joint for joint in skeleton.parents_first if joint in gone):
        above, children = int(slots[dummy]), skeleton.children[dummy]
        if above >= 0:
            below = sorted({int(skeleton.slots[child]) for child in children} - {-1})
            turned += below
            by += [above] * len(below)
        for child in children:
            parents[child] = parents[dummy]
            slots[child] = slots[child] if slots[child] >= 0 else above
    _turn(rotations, turned, by, threads)
    kept = np.setdiff1d(np.arange(skeleton.joint_count), dummies)
    moved = np.flatnonzero(np.isin(motion.translated, kept))
    return replace(
        motion,
        skeleton=_subset(skeleton, kept, parents, slots),
        source=Pose(
            read_only(rotations),
            _renumbering(skeleton.joint_count, kept)[motion.translated[moved]],
            read_only(translations.take(moved, axis=1)),
        ),
        dropped=Dropped(
            skeleton,
            motion.layout,
            tuple(motion.translated.tolist()),
            dummies,
            motion.dropped,
            motion.source if isinstance(motion.source, Rows) else None,
        ),
    )


def restore_dummies(motion: Motion, *, threads: int | None = None) -> Motion:
    """The motion with the joints that :func:`drop_dummies` removed, where they were, turning as they did.

    Args:
        motion: any, in any configuration.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Returns:
        A motion on the skeleton that it had before, with the values that were read as long as frames were
        only chosen, mirrored or rescaled since; the same motion where nothing was dropped.
    """
    record = motion.dropped
    if record is None:
        return motion
    if motion.skeleton.home is not None:
        places = np.setdiff1d(np.arange(record.skeleton.joint_count), record.dummies)
        return changed_at_home(
            motion, lambda one: restore_dummies(one, threads=threads), places, threads=threads
        )
    if record.rows is not None:
        return replace(motion, skeleton=record.skeleton, source=record.rows, dropped=record.before)
    skeleton, pose = record.skeleton, motion.pose
    rotations = pose.rotations.copy()
    gone = set(record.dummies)
    turned, by = [], []
    for dummy in (joint for joint in reversed(skeleton.parents_first) if joint in gone):
        above = int(skeleton.slots[dummy])
        if above >= 0:
            below = sorted({int(skeleton.slots[child]) for child in skeleton.children[dummy]} - {-1})
            turned += below
            by += [above] * len(below)
    _turn(rotations, turned, by, threads, back=True)
    kept = np.setdiff1d(np.arange(skeleton.joint_count), record.dummies)
    moving = kept[pose.translated]
    # A joint that is at rest need not be among those that are translated now, and one that is translated now
    # need not have been then; a dummy has no length at all.
    translated = np.union1d(np.array(record.translated, np.intp), moving).astype(np.int32)
    rest = np.where(np.isin(translated, record.dummies)[:, None], 0.0, skeleton.offsets[translated])
    translations = np.tile(rest, (motion.frame_count, 1, 1))
    translations[:, np.searchsorted(translated, moving)] = pose.translations
    source = Pose(read_only(rotations), translated, read_only(translations), record.layout)
    return replace(motion, skeleton=skeleton, source=source, dropped=record.before)


def _numbers(motion: Motion) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The rotations, in an array of their own, and the translations."""
    source = motion.source
    if isinstance(source, Rows) and "pose" not in motion.__dict__:
        return rotations_of_rows(source), translations_of_rows(motion.skeleton, source)
    return motion.rotations.copy(), motion.translations


def _turn(
    rotations: NDArray[np.float64],
    slots: Sequence[int],
    by: Sequence[int],
    threads: int | None,
    *,
    back: bool = False,
) -> None:
    """Turns slots by others, in place and one after the other: ``R_slot <- R_by R_slot``; or back."""
    total = threads_for(rotations.size // 4, threads)
    _core.turn_slots(rotations, np.array(slots, np.int32), np.array(by, np.int32), back, total)


def _renumbering(count: int, kept: NDArray[np.intp]) -> NDArray[np.int32]:
    """(count + 1,) the new index of each old joint, -1 for those not kept and, as the last entry, for -1."""
    found = np.full(count + 1, -1, np.int32)
    found[kept] = np.arange(len(kept))
    return found


def _subset(
    skeleton: Skeleton,
    kept: NDArray[np.intp],
    parents: NDArray[np.int32],
    slots: NDArray[np.int32],
) -> Skeleton:
    """The kept joints, hanging and turning as ``parents`` and ``slots`` (in old numbers) say."""
    renumbered = _renumbering(skeleton.joint_count, kept)
    return Skeleton(
        names=tuple(skeleton.names[joint] for joint in kept),
        parents=renumbered[parents[kept]],
        offsets=skeleton.offsets[kept],
        slots=slots[kept],
        slot_count=skeleton.slot_count,
        ends=skeleton.ends[kept],
    )
