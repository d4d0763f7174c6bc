"""The General Motion Representation: a motion is a forest, and any of its joints can be a root.

A *configuration* says which bones are cut and which joint of each tree is its root; every root carries its
place in the world in every frame. The operations go from one configuration to another and keep every joint's
world position and every bone's world rotation. A configuration alone determines the motion, whatever
operations led to it. The bone above a promoted joint is remembered as a soft link, so that the promotion can
be undone.
Source: "General Motion Representation", shift root, split tree, join trees.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.apart import turned_apart
from gmr.arrays import read_only
from gmr.configurations import arranged, configuration
from gmr.errors import SkeletonError
from gmr.frames import Pose, Rows
from gmr.skeleton import Skeleton
from gmr.threads import threads_for

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = [
    "carried",
    "changed_at_home",
    "configured",
    "home",
    "join",
    "shift_root",
    "split",
    "with_roots",
]

Joint = str | int | np.integer[Any]

_STILL = 1e-11
"""Share of the motion's reach by which a bone that was cut may miss its offset by rounding alone."""


def with_roots(motion: Motion, roots: Iterable[Joint], *, threads: int | None = None) -> Motion:
    """The same motion with just these roots: every other bone is whole.

    Where the joint at which a tree begins at home is not among them, the tree hangs on the first of them, in
    the order of the joints; the bones above all others are cut.

    Args:
        motion: any, in any configuration.
        roots: names or indices, in any order.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Raises:
        SkeletonError: a joint does not exist or is named twice, or a tree would have no root.
    """
    names = motion.skeleton.names
    wanted = motion.skeleton.indices(roots).tolist()
    return _moved(motion, lambda forest: forest.with_roots(wanted, names), threads)


def shift_root(
    motion: Motion, joint: Joint, root: Joint | None = None, *, threads: int | None = None
) -> Motion:
    """The same motion with ``joint`` as the root of its tree, which is turned over; other trees stay.

    It is its own inverse: shifting back to the old root gives back every number, to rounding.

    Args:
        motion: any, in any configuration.
        joint: name or index.
        root: the root that is to give up its place, as a check; that of the joint's tree by default.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Raises:
        SkeletonError: there is no such joint, or it does not hang below ``root``.
    """
    names, index = motion.skeleton.names, motion.skeleton.index(joint)
    old = motion.skeleton.forest.root_of(index)
    if root is not None and motion.skeleton.index(root) != old:
        stated = names[motion.skeleton.index(root)]
        raise SkeletonError(
            f"'{names[index]}' does not hang below the root '{stated}' but below '{names[old]}'; a root "
            "moves inside its tree. Join the trees first, or choose all roots at once: with_roots"
        )
    return _moved(motion, lambda forest: forest.shift_root(index, names), threads)


def split(motion: Motion, joint: Joint, *, threads: int | None = None) -> Motion:
    """The same motion with ``joint`` as a further root; the bone above it is cut and remembered.

    Args:
        motion: any, in any configuration.
        joint: name or index.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Raises:
        SkeletonError: there is no such joint, or it is a root already.
    """
    names, index = motion.skeleton.names, motion.skeleton.index(joint)
    return _moved(motion, lambda forest: forest.split(index, names), threads)


def join(motion: Motion, root: Joint, *, threads: int | None = None) -> Motion:
    """The same motion without this root: its tree hangs on the joint that it was cut from.

    A tree that was turned over since is turned back first. Where somebody edited the motion in between, so
    that the bone is not what it was, the joint is translated in every frame; else it has its old offset.

    Args:
        motion: any, in any configuration.
        root: name or index.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Raises:
        SkeletonError: there is no such joint, it is no root, it is the last root, or its tree was cut from
            nothing.
    """
    names, index = motion.skeleton.names, motion.skeleton.index(root)
    return _moved(motion, lambda forest: forest.join(index, names), threads)


def home(motion: Motion, *, threads: int | None = None, looks_for_turns: bool = True) -> Motion:
    """The same motion in the configuration that it had before any root was moved; see :func:`carried`.

    Rows that were read come back as they were.
    """
    if motion.skeleton.home is None:
        return motion
    return carried(motion, motion.skeleton.home, threads=threads, looks_for_turns=looks_for_turns)


def carried(
    motion: Motion, skeleton: Skeleton, *, threads: int | None = None, looks_for_turns: bool = True
) -> Motion:
    """The same motion on its skeleton in another configuration, ``skeleton``.

    Args:
        motion: any, in any configuration.
        skeleton: the configuration. Where the motion was edited so that bones which turn alike at home do
            not, the answer is on a skeleton that gives them rotations of their own.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.
        looks_for_turns: False: bones that turn alike at home do so in this motion, or need not any more.
    """
    if looks_for_turns and motion.skeleton != skeleton:
        motion, skeleton = _with_turns_of_their_own(motion, skeleton, threads)
    source = motion.source
    total = threads_for(motion.frame_count * skeleton.joint_count, threads)
    if motion.skeleton == skeleton:
        return motion
    if isinstance(source, Pose) and source.rows is not None and skeleton.home is None:
        return replace(motion, skeleton=skeleton, source=source.rows)
    rotations, translated, translations = configured(motion, skeleton, threads=total)
    rows = source.rows if isinstance(source, Pose) else source
    pose = Pose(
        read_only(rotations), translated, read_only(translations), source.layout, rows, motion.acclaim
    )
    return replace(motion, skeleton=skeleton, source=pose)


def configured(
    motion: Motion,
    skeleton: Skeleton,
    slots: NDArray[np.int32] | None = None,
    joints: NDArray[np.int32] | None = None,
    *,
    threads: int | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float64]]:
    """The numbers of a motion as another configuration of its skeleton has them.

    Args:
        motion: any.
        skeleton: the configuration.
        slots: (P,) the slots of ``skeleton`` whose rotations are wanted; all by default.
        joints: the joints whose translations are wanted, as far as they are translated; all by default.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

    Returns:
        Rotations (F, P, 4); the joints that are translated (U,); their translations (F, U, 3).
    """
    rotations, translated, translations = _configured(motion, skeleton, slots, joints, threads)
    return rotations, *_without_still_bones(motion, skeleton, translated, translations)


def changed_at_home(
    motion: Motion,
    change: Callable[[Motion], Motion],
    places: NDArray[np.integer[Any]],
    *,
    threads: int | None = None,
) -> Motion:
    """``change`` of the motion at home, brought back to the configuration that the motion is in.

    Args:
        motion: not at home.
        change: what is to be done to it there.
        places: (J,) where the change puts each joint; -1: it is removed, and its children hang on its parent.
        threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.
    """
    skeleton = motion.skeleton
    at_home = cast(Skeleton, skeleton.home)
    changed = change(home(motion, threads=threads))
    cut = set()
    waiting = np.flatnonzero(skeleton.links >= 0).tolist()
    for joint in waiting:  # grows while it is walked
        if places[joint] >= 0:
            cut.add(int(places[joint]))
        else:
            waiting.extend(at_home.children[joint])
    roots = [int(places[root]) for root in skeleton.roots if places[root] >= 0]
    return carried(changed, configuration(changed.skeleton, cut, roots), threads=threads)


def _moved(motion: Motion, change: Callable[[_core.Forest], _core.Forest], threads: int | None) -> Motion:
    """The motion in the configuration that ``change`` makes of its own."""
    try:
        forest = change(motion.skeleton.forest)
    except ValueError as error:
        raise SkeletonError(str(error)) from None
    return carried(motion, arranged(motion.skeleton, forest), threads=threads)


def _with_turns_of_their_own(
    motion: Motion, skeleton: Skeleton, threads: int | None
) -> tuple[Motion, Skeleton]:
    """The motion as :func:`gmr.apart.turned_apart` has it, and the configuration on its skeleton."""
    apart = turned_apart(motion, threads=threads)
    if apart is motion:
        return motion, skeleton
    at_home = cast(Skeleton, apart.skeleton.home)
    return apart, arranged(at_home, _core.Forest(at_home.topology, skeleton.parents))


def _configured(
    motion: Motion,
    skeleton: Skeleton,
    slots: NDArray[np.int32] | None,
    joints: NDArray[np.int32] | None,
    threads: int | None,
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float64]]:
    """Rotations, the joints that may be translated, and their translations, as ``skeleton`` arranges them."""
    before, after, offsets = motion.skeleton.forest, skeleton.forest, motion.skeleton.offsets
    total = threads_for(motion.frame_count * skeleton.joint_count, threads)
    source = motion.source
    if isinstance(source, Rows) and "pose" not in motion.__dict__:
        layout = source.layout
        rows = (
            source.values, layout.rotation_columns, layout.rotation_axes, layout.translation_columns,
            layout.adds_offset,
        )  # fmt: skip
        return _core.configure(before, after, offsets, layout.translated, rows, total, slots, joints)
    pose = motion.pose
    quaternions = pose.rotations, pose.translations
    return _core.configure(before, after, offsets, pose.translated, quaternions, total, slots, joints)


def _without_still_bones(
    motion: Motion, skeleton: Skeleton, translated: NDArray[np.int32], translations: NDArray[np.float64]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """The joints that are translated, without those whose bones were cut and are their offsets again.

    A joint that has position channels at home stays translated all the same.
    """
    bones = np.asarray(skeleton.forest.bones)[translated]
    mended = (np.asarray(motion.skeleton.links)[bones] >= 0) & (skeleton.parents[translated] >= 0)
    if not mended.any() or not len(translations):
        return translated, translations
    low, high = translations.min(axis=0), translations.max(axis=0)
    offsets = skeleton.offsets[translated]
    near = _STILL * max(-low.min(), high.max(), np.abs(skeleton.offsets).max())
    as_offset = mended[:, None] & (high - offsets <= near) & (offsets - low <= near)
    layout = motion.layout
    moving = np.zeros(len(translated), bool) if layout is None else np.isin(bones, layout.translated)
    still = as_offset.all(axis=1) & ~moving
    for k in np.flatnonzero(as_offset.any(axis=1) & ~still).tolist():
        translations[:, k, as_offset[k]] = offsets[k, as_offset[k]]
    return translated[~still], translations[:, ~still] if still.any() else translations
