"""The post-rotation form, which BVH, AMC and glTF need: the children of a joint share its rotation.

A motion whose siblings turn independently gets back as many of its dropped dummies as that takes, and no
more.
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
from gmr.dummies import restore_dummies
from gmr.frames import Pose, Rows
from gmr.quaternions import multiply
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["to_post_rotation"]

_GONE: Final = -2
_STILL: Final = 1e-12
"""Sine of half the angle below which a joint counts as never turning."""


def to_post_rotation(motion: Motion) -> Motion:
    """The motion as rows of channels can say it; every joint keeps its place.

    A dropped dummy stays away where its rotation can go elsewhere: it was its parent's only child, or never
    turned. The others come back.

    Returns:
        A motion with a layout that fits its skeleton; the same motion where it has one already.

    Raises:
        SkeletonError: siblings turn independently for another reason than dropped dummies.
    """
    if motion.dropped is not None:
        return _needed_only(to_post_rotation(restore_dummies(motion)), motion.dropped.dummies)
    if isinstance(motion.source, Rows):
        return motion
    pose, skeleton = motion.source, motion.skeleton
    layout = pose.layout or ChannelLayout.standard(skeleton, pose.translated)
    if layout.fits(skeleton):
        return motion if pose.layout else replace(motion, source=replace(pose, layout=layout))
    return _renumbered(motion, pose, ChannelLayout.standard(skeleton, pose.translated))


def _renumbered(motion: Motion, pose: Pose, layout: ChannelLayout) -> Motion:
    """The motion with its slots numbered as ``layout`` does: by the joints that own them, in file order."""
    skeleton = motion.skeleton
    if not len(skeleton.frame_slots):
        return motion
    rotations = np.zeros((len(pose), len(layout.slot_joints), 4))
    rotations[..., 3] = 1
    for slot, joint in enumerate(layout.slot_joints.tolist()):
        children = skeleton.children[joint]
        if children and skeleton.slots[children[0]] >= 0:
            rotations[:, slot] = pose.rotations[:, skeleton.slots[children[0]]]
    source = Pose(read_only(rotations), pose.translated, pose.translations, layout)
    return replace(
        motion, skeleton=_skeleton_of(skeleton, layout, range(skeleton.joint_count)), source=source
    )


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
