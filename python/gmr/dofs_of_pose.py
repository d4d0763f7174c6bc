"""A pose as values of degrees of freedom: with the bones that an ASF gave it, or with bones made for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePath
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.acclaim import INCH, UNLIMITED, Acclaim, Bone, Root
from gmr.arrays import read_only
from gmr.dof_rows import DofRows
from gmr.errors import SkeletonError
from gmr.euler import fewer_angles
from gmr.frames import Pose
from gmr.listing import quoted
from gmr.post_rotation import at_home
from gmr.quaternions import conjugate, multiply
from gmr.skeleton import End, Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["dof_rows_of", "own_turns", "with_bones_of"]

_FREE: Final = ("rx", "ry", "rz")
_ORDER: Final = ("TX", "TY", "TZ", "RX", "RY", "RZ")
_EXACT: Final = 1e-9
"""Radians by which the angles of a bone with fewer than three degrees of freedom may miss its rotation."""

_SHOWN: Final = 4


def dof_rows_of(motion: Motion) -> DofRows:
    """The motion as an AMC file writes it; every joint keeps its place.

    What was read of an AMC is as it was read. A pose on the skeleton of an ASF keeps its axes, degrees of
    freedom and limits; a bone that turns as its degrees of freedom cannot say is given three, without limits.
    Any other motion gets a bone for each joint but the root, with axes along the world's and three degrees of
    freedom: each bone turns as its slot does, and the root as the slot that its children share. Roots that
    were split off are joined first.

    Raises:
        SkeletonError: several roots that cannot be joined, or another joint than the root moves.
    """
    motion = at_home(motion)
    if isinstance(motion.source, DofRows):
        return motion.source
    pose = motion.pose
    acclaim = pose.acclaim
    if acclaim is not None and _is_its(acclaim, motion.skeleton) and pose.translated.tolist() == [0]:
        return with_bones_of(acclaim, pose)
    return _anew(motion, pose)


def _is_its(acclaim: Acclaim, skeleton: Skeleton) -> bool:
    """Whether ``skeleton`` is the one that the ASF describes, to the rounding of a change of unit."""
    told = acclaim.skeleton
    return (
        told.names == skeleton.names
        and np.array_equal(told.parents, skeleton.parents)
        and np.array_equal(told.slots, skeleton.slots)
        and np.allclose(told.offsets, skeleton.offsets, rtol=1e-12, atol=0)
    )


def with_bones_of(acclaim: Acclaim, pose: Pose) -> DofRows:
    """A pose that moves but the root, with the bones of its ASF; those are given three degrees of freedom,
    without limits, that turn as theirs cannot say. Angles are in degrees."""
    values = _values(acclaim, pose.rotations, pose.translations[:, 0])
    missed = multiply(conjugate(_rotations(acclaim, values)), pose.rotations)
    off = 2 * np.arctan2(np.linalg.norm(missed[..., :3], axis=-1), np.abs(missed[..., 3]))
    freed = {acclaim.slot_joints[slot] for slot in np.flatnonzero((off > _EXACT).any(axis=0)).tolist()}
    place = np.array(acclaim.root.position)
    held = [acclaim.translation_columns[axis] >= 0 for axis in range(3)]
    if (pose.translations[:, 0] != place)[:, ~np.array(held)].any():
        freed.add(0)
    if not freed:
        return DofRows(read_only(values), acclaim)
    bones = [_freed(bone) if joint in freed else bone for joint, bone in enumerate(acclaim.bones, start=1)]
    root = replace(acclaim.root, order=_ORDER) if 0 in freed else acclaim.root
    freer = replace(acclaim, root=root, bones=tuple(bones))
    return DofRows(read_only(_values(freer, pose.rotations, pose.translations[:, 0])), freer)


def _freed(bone: Bone) -> Bone:
    return replace(bone, dofs=_FREE, limits=(UNLIMITED,) * 3)


def _rotations(acclaim: Acclaim, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, S, 4) what values in degrees say."""
    return DofRows(read_only(values), acclaim).pose.rotations


def _values(
    acclaim: Acclaim, rotations: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(F, C) values in degrees of (F, S, 4) rotations and (F, 3) places of the root."""
    values = np.zeros((len(rotations), acclaim.column_count))
    for axis, column in enumerate(acclaim.translation_columns):
        if column >= 0:
            values[:, column] = places[:, axis] - acclaim.root.position[axis]
    if not len(values):
        return values
    own = own_turns(acclaim, rotations)
    columns, axes = acclaim.rotation_columns, acclaim.rotation_axes
    counts = (columns >= 0).sum(axis=1)
    whole = np.flatnonzero(counts == 3)
    if len(whole):
        angles = _core.quaternions_to_euler(
            np.ascontiguousarray(own[:, whole]), np.ascontiguousarray(axes[whole])
        )
        values[:, columns[whole]] = angles
    for slot in np.flatnonzero((counts > 0) & (counts < 3)).tolist():
        count = int(counts[slot])
        angles = fewer_angles(own[:, slot], axes[slot, :count].tolist())
        values[:, columns[slot, :count]] = np.degrees(angles)
    return values


def own_turns(acclaim: Acclaim, rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, S, 4) rotations about each bone's own axes, ``A = C^-1 R C``."""
    return multiply(conjugate(acclaim.frames), multiply(rotations, acclaim.frames))


def _anew(motion: Motion, pose: Pose) -> DofRows:
    """The pose with bones made for it."""
    skeleton = motion.skeleton
    if len(skeleton.roots) != 1:
        raise SkeletonError(
            f"an ASF has one root, this motion has {len(skeleton.roots)} that were never joined "
            f"({quoted(motion.roots, _SHOWN)}); take one tree: motion.select([...])"
        )
    (root,) = skeleton.roots
    offsets = skeleton.offsets.copy()
    for k, joint in enumerate(pose.translated.tolist()):
        if joint == root:
            places = pose.translations[:, k]
        elif len(pose):
            offsets[joint] = _still(skeleton, joint, pose.translations[:, k])
    root_slot = _root_slot(skeleton, root)
    order = [root, *(joint for joint in range(skeleton.joint_count) if joint != root)]
    place = {joint: k for k, joint in enumerate(order)}
    turning = {
        joint: slot for joint in order[1:] if (slot := int(skeleton.slots[joint])) not in (-1, root_slot)
    }
    names = _names(skeleton, root)
    acclaim = Acclaim(
        root=Root(),
        bones=tuple(
            _bone(names[joint], offsets[joint], joint in turning, str(place[joint])) for joint in order[1:]
        ),
        parents=tuple(place[int(skeleton.parents[joint])] for joint in order[1:]),
        name="_".join(PurePath(motion.name or "gmr").stem.split()) or "gmr",
        length=1.0 if motion.unit is None else INCH / motion.unit,
        documentation=("  written by gmr",),
    )
    slots = [root_slot, *turning.values()]
    rotations = np.zeros((len(pose), len(slots), 4))
    rotations[..., 3] = 1
    used = [k for k, slot in enumerate(slots) if slot >= 0]
    rotations[:, used] = pose.rotations[:, [slots[k] for k in used]]
    return DofRows(read_only(_values(acclaim, rotations, places)), acclaim)


def _root_slot(skeleton: Skeleton, root: int) -> int:
    """The slot that turns the root: its own, or the one that its children share; -1 where there is none."""
    if skeleton.slots[root] >= 0:
        return int(skeleton.slots[root])
    shared = {int(skeleton.slots[child]) for child in skeleton.children[root]}
    return shared.pop() if len(shared) == 1 else -1


def _bone(name: str, offset: NDArray[np.float64], turns: bool, number: str) -> Bone:
    length = float(np.linalg.norm(offset))
    x, y, z = (offset / length).tolist() if length else (0.0, 1.0, 0.0)
    dofs = _FREE if turns else ()
    return Bone(name, (x, y, z), length, dofs=dofs, limits=(UNLIMITED,) * len(dofs), number=number)


def _still(skeleton: Skeleton, joint: int, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vector of a joint's bone, the same in all frames."""
    if (vectors != vectors[0]).any():
        frame = int(np.flatnonzero((vectors != vectors[0]).any(axis=1))[0])
        raise SkeletonError(
            f"joint '{skeleton.names[joint]}' moves (first in frame {frame}), but in an ASF only the root "
            "does; write another format, or leave the joint out."
        )
    still: NDArray[np.float64] = vectors[0]
    return still


def _names(skeleton: Skeleton, root: int) -> list[str]:
    """The joints' names. The root is called ``root``; another joint of that name, such as the root that the
    motion had before it was turned over, is numbered, and so are End Sites and tips, which share one where
    their parent has several."""
    is_joint = skeleton.ends == End.JOINT
    taken = {name for name, stays in zip(skeleton.names, is_joint, strict=True) if stays} | {"root"}
    found = list(skeleton.names)
    found[root] = "root"
    called_root = [joint for joint, name in enumerate(found) if name == "root" and joint != root]
    for joint in dict.fromkeys([*called_root, *np.flatnonzero(~is_joint).tolist()]):
        name, number = found[joint], 2
        while found[joint] in taken:
            found[joint] = f"{name}{number}"
            number += 1
        taken.add(found[joint])
    return found
