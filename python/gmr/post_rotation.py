"""The post-rotation form, which BVH, AMC and glTF need: the children of a joint share its rotation.

A motion whose siblings turn independently gets back as many of its dropped dummies as that takes, and no
more; where it never had any, a dummy joint of zero length comes between a joint and those of its children
that turn otherwise than the first. Roots that were split off are joined first.
Source: the General Motion Representation, its way out to a post-rotation format.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.channels import ChannelLayout, turning_freely
from gmr.configurations import configuration
from gmr.dummies import restore_dummies
from gmr.forest import carried
from gmr.frames import Pose, Rows
from gmr.quaternions import conjugate, multiply
from gmr.skeleton import End, Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["at_home", "to_post_rotation"]

_GONE: Final = -2
_STILL: Final = 1e-12
"""Sine of half the angle below which a joint counts as never turning."""


def to_post_rotation(motion: Motion) -> Motion:
    """The motion as rows of channels can say it; every joint keeps its place.

    Roots that were split off are joined; a joint whose bone is not what it was then gets position channels.
    A tree that was turned over stays so, with the root that it has. A
    dropped dummy stays away where its rotation can go elsewhere: it was its parent's only child, or never
    turned. The others come back. Where siblings still turn independently, new dummies named
    "<parent>_to_<child>" are brought in.

    Returns:
        A motion at home with a layout that fits its skeleton; the same motion where it has one already.
    """
    motion = at_home(motion)
    if motion.dropped is not None:
        return _needed_only(to_post_rotation(restore_dummies(motion)), motion.dropped.dummies)
    if isinstance(motion.source, Rows):
        return motion
    pose, skeleton = motion.pose, motion.skeleton
    layout = pose.layout or ChannelLayout.standard(skeleton, pose.translated)
    moving = _without_place(motion, layout)
    layout = layout.with_positions(moving)
    if layout.fits(skeleton) and not skeleton.ends[moving].any():
        return motion if layout == pose.layout else replace(motion, source=replace(pose, layout=layout))
    return _in_shared_slots(motion, pose, moving)


def _without_place(motion: Motion, layout: ChannelLayout) -> list[int]:
    """The joints that move in a direction for which they have no channel."""
    pose, offsets = motion.pose, motion.skeleton.offsets
    columns = dict(zip(layout.translated.tolist(), layout.translation_columns, strict=True))
    found = []
    for k, joint in enumerate(pose.translated.tolist()):
        lacking = columns[joint] < 0 if joint in columns else np.ones(3, bool)
        if (pose.translations[:, k, lacking] != offsets[joint, lacking]).any():
            found.append(joint)
    return found


def at_home(motion: Motion) -> Motion:
    """The motion with all roots joined that were split off; a tree turned over begins at its root."""
    skeleton = motion.skeleton
    if skeleton.home is None:
        return motion
    roots = [root for root in skeleton.roots if skeleton.links[skeleton.forest.top_of(root)] < 0]
    motion = carried(motion, configuration(skeleton, (), roots))
    skeleton = motion.skeleton
    if skeleton.home is None:
        return motion
    # An end site that others hang on now is a joint like any other.
    is_inner = np.array([bool(children) for children in skeleton.children]) | (skeleton.parents < 0)
    turned = replace(skeleton, home=None, ends=np.where(is_inner, int(End.JOINT), skeleton.ends))
    return replace(motion, skeleton=turned, source=replace(motion.pose, layout=None, rows=None), dropped=None)


def _in_shared_slots(motion: Motion, pose: Pose, moving: Sequence[int]) -> Motion:
    """The motion with siblings sharing one slot, where need be through new dummies, and a layout for it.

    End sites that are ``moving`` become joints like any other.
    """
    ends = motion.skeleton.ends.copy()
    ends[list(moving)] = int(End.JOINT)
    motion = replace(motion, skeleton=replace(motion.skeleton, ends=ends))
    skeleton = motion.skeleton
    names, parents = list(skeleton.names), skeleton.parents.tolist()
    turns: dict[int, NDArray[np.float64]] = {}
    for joint, children in enumerate(skeleton.children):
        groups = _by_slot(skeleton, children)
        if not groups:
            continue
        (shared, _), *others = groups.items()
        turns[joint] = _rotation(pose, shared)
        for slot, group in others:
            dummy = len(names)
            names.append(_new_name(names, f"{names[joint]}_to_{names[group[0]]}"))
            parents.append(joint)
            turns[dummy] = multiply(conjugate(turns[joint]), _rotation(pose, slot))
            for child in group:
                parents[child] = dummy
    for root in skeleton.roots:
        if root in turns:
            turns[root] = multiply(_rotation(pose, int(skeleton.slots[root])), turns[root])
    return _post_rotation_of(motion, pose, names, parents, turns)


def _post_rotation_of(
    motion: Motion,
    pose: Pose,
    names: list[str],
    parents: list[int],
    turns: dict[int, NDArray[np.float64]],
) -> Motion:
    """The motion on these joints, the new ones at their parents, each frame turned as ``turns`` says."""
    skeleton = motion.skeleton
    new = len(names) - skeleton.joint_count
    ends = [*skeleton.ends.tolist(), *[int(End.JOINT)] * new]
    offsets = np.concatenate([skeleton.offsets, np.zeros((new, 3))])
    plain = Skeleton.post_rotation(names, parents, offsets, ends=ends)
    layout = ChannelLayout.standard(plain, pose.translated)
    turning = np.flatnonzero(np.diff(layout.starts)).tolist()
    body = Skeleton.post_rotation(names, parents, offsets, ends=ends, turning=turning)
    rotations = np.zeros((len(pose), len(layout.slot_joints), 4))
    rotations[..., 3] = 1
    for slot, joint in enumerate(layout.slot_joints.tolist()):
        if joint in turns:
            rotations[:, slot] = turns[joint]
    source = Pose(read_only(rotations), pose.translated, pose.translations, layout)
    return replace(motion, skeleton=body, source=source)


def _by_slot(skeleton: Skeleton, children: Sequence[int]) -> dict[int, list[int]]:
    """Children by the slot that turns them, in their order."""
    groups: dict[int, list[int]] = {}
    for child in children:
        groups.setdefault(int(skeleton.slots[child]), []).append(child)
    return groups


def _rotation(pose: Pose, slot: int) -> NDArray[np.float64]:
    """(F, 4) rotation of a slot; -1: none."""
    if slot < 0:
        return np.tile([0.0, 0.0, 0.0, 1.0], (len(pose), 1))
    return pose.rotations[:, slot]


def _new_name(names: Sequence[str], wanted: str) -> str:
    """``wanted``, with a number where a joint has that name."""
    name, number = wanted, 1
    while name in names:
        number += 1
        name = f"{wanted}_{number}"
    return name


def _needed_only(motion: Motion, dummies: Sequence[int]) -> Motion:
    """The motion, whose layout fits, without those ``dummies`` that the post-rotation form can do without."""
    layout = cast(ChannelLayout, motion.layout)
    names, parents = list(layout.names), list(layout.parents)
    children = [set(joints) for joints in motion.skeleton.children]
    rotations = motion.rotations.copy()
    composed = False
    for dummy in dummies:
        parent = parents[dummy]
        above, own = layout.owned_slots[[parent, dummy]]
        turns = np.abs(rotations[:, own, :3]).max(initial=0) > _STILL
        if turns and len(children[parent]) > 1:
            continue
        if turns:
            rotations[:, above] = multiply(rotations[:, above], rotations[:, own])
            names[parent] = turning_freely(names[parent])
            composed = True
        for child in children[dummy]:
            parents[child] = parent
        parents[dummy] = _GONE
        children[parent] = children[parent] - {dummy} | children[dummy]
    kept = [joint for joint, parent in enumerate(parents) if parent != _GONE]
    place = {joint: k for k, joint in enumerate(kept)} | {-1: -1}
    lean = ChannelLayout(
        tuple(names[joint] for joint in kept),
        tuple(place[parents[joint]] for joint in kept),
        layout.adds_offset,
    )
    if isinstance(motion.source, Rows) and not composed:
        source: Rows | Pose = _columns_of(motion.source, kept, lean)
    else:
        source = _slots_of(motion, rotations, kept, lean)
    return replace(motion, skeleton=_skeleton_of(motion.skeleton, lean, kept), source=source)


def _columns_of(rows: Rows, kept: Sequence[int], lean: ChannelLayout) -> Rows:
    """The values of the kept joints as they were read."""
    starts = rows.layout.starts
    columns = [column for joint in kept for column in range(starts[joint], starts[joint + 1])]
    return Rows(read_only(rows.values.take(columns, axis=1)), lean)


def _slots_of(
    motion: Motion, rotations: NDArray[np.float64], kept: Sequence[int], lean: ChannelLayout
) -> Pose:
    """The rotations and translations of the kept joints."""
    place = {joint: k for k, joint in enumerate(kept)}
    owned = cast(ChannelLayout, motion.layout).owned_slots
    staying = [k for k, joint in enumerate(motion.translated.tolist()) if joint in place]
    return Pose(
        read_only(rotations.take([owned[kept[joint]] for joint in lean.slot_joints.tolist()], axis=1)),
        np.array([place[joint] for joint in motion.translated[staying].tolist()], np.int32),
        read_only(motion.translations.take(staying, axis=1)),
        lean,
    )


def _skeleton_of(skeleton: Skeleton, layout: ChannelLayout, kept: Sequence[int]) -> Skeleton:
    """The post-rotation skeleton of the kept joints."""
    return Skeleton.post_rotation(
        [skeleton.names[joint] for joint in kept],
        layout.parents,
        skeleton.offsets[list(kept)],
        ends=skeleton.ends[list(kept)],
        turning=np.flatnonzero(np.diff(layout.starts)).tolist(),
    )
