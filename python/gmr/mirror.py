"""The mirror image of a motion across the plane x = 0, left and right exchanged."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.dof_rows import DofRows
from gmr.dummies import Dropped
from gmr.errors import SkeletonError
from gmr.forest import changed_at_home
from gmr.frames import Pose, Rows
from gmr.sides import pair_joints
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["mirror"]

Pairs = tuple[tuple[str, str], ...] | None
_POINT = np.array([-1.0, 1.0, 1.0])
_QUATERNION = np.array([1.0, -1.0, -1.0, 1.0])


def mirror(motion: Motion, pairs: Mapping[str, str] | Iterable[tuple[str, str]] | None = None) -> Motion:
    """The mirror image: with ``pair`` the image of each joint, positions obey ``P'[pair] = P * (-1, 1, 1)``.

    Every number is moved and its sign kept or flipped, nothing else, so mirroring twice gives back every bit.
    The offsets are mirrored too: a skeleton that leans to its left comes out leaning to its right.

    Args:
        motion: any; in another configuration than at home, the roots are exchanged too.
        pairs: names of joints of the two sides, where their names do not tell (Left/Right, L/R, _l/_r,
            lfoot/rfoot).

    Raises:
        SkeletonError: a joint of one side has no partner on the other.
    """
    stated = None if pairs is None else tuple(pairs.items() if isinstance(pairs, Mapping) else pairs)
    if motion.skeleton.home is not None:
        pair = pair_joints(motion.skeleton.home, stated)
        return changed_at_home(motion, lambda motion: mirror(motion, stated), pair)
    if isinstance(motion.source, Rows):
        return _mirrored_rows(motion, motion.source, stated)
    if isinstance(motion.source, DofRows):
        return _mirrored_dofs(motion, motion.source, stated)
    return _mirrored_pose(motion, motion.source, stated)


def _mirrored_rows(motion: Motion, rows: Rows, pairs: Pairs) -> Motion:
    """Columns of the two sides exchanged: x positions and the angles about y and z change sign."""
    exchange = _exchange(motion.skeleton, rows.layout, pairs)
    return replace(motion, skeleton=exchange.skeleton, source=_exchanged(rows, exchange))


def _exchanged(rows: Rows, exchange: _Exchange) -> Rows:
    values = rows.values.take(exchange.columns, axis=1)
    values *= exchange.signs
    return Rows(read_only(values), exchange.layout)


def _mirrored_dofs(motion: Motion, rows: DofRows, pairs: Pairs) -> Motion:
    """As :func:`_mirrored_rows`, and the axes that the bones turn about are mirrored with the bones."""
    pair = pair_joints(motion.skeleton, pairs)
    acclaim = rows.acclaim.mirrored(pair.tolist())
    starts = rows.acclaim.starts
    columns = np.concatenate([np.arange(starts[image], starts[image + 1]) for image in pair])
    flipped = [name in ("tx", "ry", "rz") for names in acclaim.channels for name in names]
    values = rows.values.take(columns, axis=1) * np.where(flipped, -1.0, 1.0)
    source = replace(rows, values=read_only(values), acclaim=acclaim)
    return replace(motion, skeleton=acclaim.skeleton, source=source)


class _Exchange(NamedTuple):
    """What exchanging the sides of a file does to its rows, and whose rows they are then."""

    columns: NDArray[np.int32]
    """(C,) the column that each is taken from."""
    signs: NDArray[np.float64]
    """(C,) what it is multiplied by."""
    skeleton: Skeleton
    layout: ChannelLayout


@lru_cache(maxsize=16)  # the files of a folder mostly share one skeleton
def _exchange(skeleton: Skeleton, layout: ChannelLayout, pairs: Pairs) -> _Exchange:
    pair = pair_joints(skeleton, pairs)
    ranges = [np.arange(layout.starts[image], layout.starts[image + 1]) for image in pair]
    columns = np.concatenate(ranges).astype(np.int32) if ranges else np.empty(0, np.int32)
    flipped = (layout.column_axes == 0) != layout.column_turns
    mirrored = _mirrored_layout(layout, pair)
    body = Skeleton.post_rotation(
        skeleton.names,
        skeleton.parents,
        skeleton.offsets[pair] * _POINT,
        ends=skeleton.ends[pair],
        turning=np.flatnonzero(np.diff(mirrored.starts)).tolist(),
    )
    return _Exchange(columns, np.where(flipped, -1.0, 1.0)[columns], body, mirrored)


def _mirrored_pose(motion: Motion, pose: Pose, pairs: Pairs) -> Motion:
    """Slots and translations of the two sides exchanged."""
    levels = _levels(motion, pairs)
    skeleton, pair = levels[0]
    slots = _paired_slots(levels, pose.layout if motion.dropped is None else motion.dropped.layout)
    rotations = pose.rotations.take(slots, axis=1)
    rotations *= _QUATERNION
    source = Pose(
        read_only(rotations),
        pair[pose.translated],
        read_only(pose.translations * _POINT),
        None if pose.layout is None else _mirrored_layout(pose.layout, pair),
        acclaim=None if pose.acclaim is None else pose.acclaim.mirrored(pair.tolist()),
    )
    dropped = None if motion.dropped is None else _mirrored_record(motion.dropped, levels[1:], pairs)
    return replace(motion, skeleton=_mirrored_skeleton(skeleton, pair), source=source, dropped=dropped)


def _levels(motion: Motion, pairs: Pairs) -> list[tuple[Skeleton, NDArray[np.int32]]]:
    """The motion's skeleton and those it had before dummies were dropped, each with its pairs."""
    records: list[Dropped] = []
    record = motion.dropped
    while record is not None:
        records.append(record)
        record = record.before
    skeletons = [motion.skeleton, *(record.skeleton for record in records)]
    found = [(skeletons[-1], pair_joints(skeletons[-1], pairs))]
    for skeleton, record in zip(reversed(skeletons[:-1]), reversed(records), strict=True):
        found.append((skeleton, _pairs_left(found[-1][1], record)))
    return found[::-1]


def _pairs_left(pair: NDArray[np.int32], record: Dropped) -> NDArray[np.int32]:
    """The pairs among the joints that stayed when dummies were dropped."""
    kept = np.setdiff1d(np.arange(len(pair)), record.dummies)
    lost = kept[np.isin(pair[kept], record.dummies)]
    if len(lost):
        one, two = (record.skeleton.names[joint] for joint in (lost[0], pair[lost[0]]))
        raise SkeletonError(
            f"joint '{one}' has no mirror image: '{two}' was a dummy and is dropped. "
            "Mirror first, or bring it back with restore_dummies()."
        )
    return np.searchsorted(kept, pair[kept]).astype(np.int32)


def _paired_slots(
    levels: list[tuple[Skeleton, NDArray[np.int32]]], layout: ChannelLayout | None
) -> NDArray[np.intp]:
    """(S,) the image of each slot: that of the joints whose bones it turns, or of the joint that owns it."""
    slots = np.arange(levels[0][0].slot_count)
    if layout is not None and len(layout.slot_joints) == len(slots):
        owned = layout.owned_slots[levels[-1][1][layout.slot_joints]]
        slots = np.where(owned >= 0, owned, slots)
    for skeleton, pair in levels[::-1]:
        turned = np.flatnonzero(skeleton.slots >= 0)
        images = skeleton.slots[pair[turned]]
        if (images < 0).any():
            joint = skeleton.names[turned[np.argmin(images)]]
            raise SkeletonError(f"the bone of joint '{joint}' turns, but that of its mirror image cannot")
        slots[skeleton.slots[turned]] = images
    return slots


def _mirrored_skeleton(skeleton: Skeleton, pair: NDArray[np.int32]) -> Skeleton:
    """Offsets and end sites of the two sides exchanged; names, parents and slots stay."""
    return replace(skeleton, offsets=skeleton.offsets[pair] * _POINT, ends=skeleton.ends[pair])


def _mirrored_layout(layout: ChannelLayout, pair: NDArray[np.int32]) -> ChannelLayout:
    return replace(layout, names=tuple(layout.names[image] for image in pair))


def _mirrored_record(
    record: Dropped, levels: list[tuple[Skeleton, NDArray[np.int32]]], pairs: Pairs
) -> Dropped:
    """What was dropped, mirrored, so that it can still be brought back."""
    skeleton, pair = levels[0]
    mirrored = _mirrored_skeleton(skeleton, pair)
    rows = record.rows
    if rows is not None:
        exchange = _exchange(skeleton, rows.layout, pairs)
        rows = _exchanged(rows, exchange) if exchange.skeleton == mirrored else None
    return Dropped(
        skeleton=mirrored,
        layout=None if record.layout is None else _mirrored_layout(record.layout, pair),
        translated=tuple(pair[list(record.translated)].tolist()),
        dummies=tuple(sorted(pair[list(record.dummies)].tolist())),
        before=None if record.before is None else _mirrored_record(record.before, levels[1:], pairs),
        rows=rows,
    )
