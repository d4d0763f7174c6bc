"""Mirrored copies of clips, in the joint frames of the originals.

A mirror image of a rotation is `S R S` with `S = diag(-1, 1, 1)`, and it turns a mirrored bone. In a file
whose left and right bones point along opposite axes of their frames (Bandai-Namco's do), such frames lie a
half turn from those of the originals. Playback blends rotations frame by frame, so each image is given in
the frames that its originals use: `C^-1 S R S C`, with one constant `C` a slot, found once for the dataset.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from gmr.motion import Motion
from gmr.quaternions import conjugate, from_matrix, matrices, multiply
from gmr.sides import pair_joints
from gmr.skeleton import Skeleton

__all__ = ["Mirror", "find_mirror"]

_POINT = np.array([-1.0, 1.0, 1.0])
_QUATERNION = np.array([1.0, -1.0, -1.0, 1.0])

_POSES_COUNT = 0.25
"""How much the mean pose counts in finding a frame, against the bones that it turns: it tells the twist
about a single bone."""

_SNAP = 0.85
"""Mean cosine of the axes from which a frame counts as one whose axes are exchanged or turned round."""


@dataclass(frozen=True, slots=True)
class Mirror:
    """How arrays of a skeleton are mirrored across x = 0."""

    pair: NDArray[np.int32]
    """(J,) the joint of the other side, itself in the middle."""
    slots: NDArray[np.intp]
    """(S,) the slot of the other side."""
    turns: NDArray[np.float64]
    """(S, 4, 4) rows: what each component of the other side's local quaternion adds to that of a slot."""
    vectors: NDArray[np.float64]
    """(J, 3, 3) rows: what each component of the other side's bone vector adds to that of a joint."""

    def positions(self, positions: NDArray[np.float32]) -> NDArray[np.float32]:
        """Images of (F, J, 3) world positions."""
        return np.ascontiguousarray(positions[:, self.pair] * _POINT.astype(np.float32))

    def rotations(self, rotations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Images of (F, S, 4) local rotations."""
        return _each(rotations[:, self.slots], self.turns)

    def offsets(self, offsets: NDArray[np.float64]) -> NDArray[np.float64]:
        """Images of (J, 3) offsets."""
        return _each(offsets[None, self.pair], self.vectors).reshape(offsets.shape)

    def translations(
        self, translations: NDArray[np.float64], joints: NDArray[np.int32]
    ) -> NDArray[np.float64]:
        """Images of (F, T, 3) translations of T joints, which hold the other side of each of them."""
        place = {joint: k for k, joint in enumerate(joints.tolist())}
        others = [place[joint] for joint in self.pair[joints].tolist()]
        return _each(translations[:, others], self.vectors[joints])


def _each(values: NDArray[np.float64], maps: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, K, n) rows times the map of each of the K, as a few large products instead of many small ones."""
    return np.ascontiguousarray(np.matmul(values.transpose(1, 0, 2), maps).transpose(1, 0, 2))


def find_mirror(
    skeleton: Skeleton,
    clips: Sequence[Motion],
    across: tuple[int, int],
    pairs: Mapping[str, str] | None = None,
) -> Mirror:
    """How clips of a skeleton are mirrored.

    Args:
        skeleton: J joints, S slots.
        clips: some poses of each clip, Y up.
        across: a left and a right joint that tell the facing.
        pairs: names of joints of the two sides, where their names do not tell.

    Raises:
        SkeletonError: a joint of one side has no partner on the other.
    """
    pair = pair_joints(skeleton, pairs)
    slots = _paired_slots(skeleton, pair)
    frames = _frames(skeleton, clips, slots, pair, across)
    turns = _turns(skeleton, frames)
    bones = np.where((skeleton.slots >= 0)[:, None, None], frames[skeleton.slots], np.eye(3))
    vectors = bones * _POINT[:, None]
    return Mirror(pair, slots, turns, vectors)


def _turns(skeleton: Skeleton, frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """(S, 4, 4) rows: what becomes of each component of a quaternion in `C_parent^-1 (S q S) C`."""
    above = skeleton.topology.slot_parents
    turns = np.empty((skeleton.slot_count, 4, 4))
    for slot, parent in enumerate(above.tolist()):
        image = np.diag(_QUATERNION)
        if parent >= 0:
            image = multiply(conjugate(from_matrix(frames[parent])), image)
        turns[slot] = multiply(image, from_matrix(frames[slot]))
    return turns


def _paired_slots(skeleton: Skeleton, pair: NDArray[np.int32]) -> NDArray[np.intp]:
    slots = np.arange(skeleton.slot_count)
    turned = np.flatnonzero(skeleton.slots >= 0)
    slots[skeleton.slots[turned]] = skeleton.slots[pair[turned]]
    return slots


def _frames(
    skeleton: Skeleton,
    clips: Sequence[Motion],
    slots: NDArray[np.intp],
    pair: NDArray[np.int32],
    across: tuple[int, int],
) -> NDArray[np.float64]:
    """(S, 3, 3) `C`: the frame of each slot's originals as seen from the frame of its images.

    It is the rotation nearest to all that it should do: turn the bones of the originals into those of the
    images (Wahba's problem, solved by Kabsch's singular value decomposition), and the mean pose into the
    mean image.
    """
    bones = np.asarray(np.mean([_bone_vectors(clip) for clip in clips], axis=0), np.float64)
    poses = np.concatenate([_world_frames(clip, across) for clip in clips])
    images = poses[:, slots] * np.outer(_POINT, _POINT)
    found = np.tile(np.eye(3), (skeleton.slot_count, 1, 1))
    for slot in range(skeleton.slot_count):
        joints = np.flatnonzero(skeleton.slots == slot)
        if not len(joints):
            continue
        original, image = bones[joints], bones[pair[joints]] * _POINT
        size = max(float((original**2).sum()), 1e-12)
        alike = np.einsum("ja,jb->ab", image, original) / size
        posed = np.einsum("fca,fcb->ab", images[:, slot], poses[:, slot]) / len(poses)
        found[slot] = _axes_exchanged(_nearest_rotation(alike + _POSES_COUNT * posed))
    return found


def _bone_vectors(clip: Motion) -> NDArray[np.float64]:
    """(J, 3) mean bone vectors in the frames of their slots."""
    vectors = clip.skeleton.offsets.copy()
    vectors[clip.translated] = clip.translations.mean(axis=0)
    return vectors


def _world_frames(clip: Motion, across: tuple[int, int]) -> NDArray[np.float64]:
    """(F, S, 3, 3) world rotations of the slots, turned so that the body faces +Z."""
    skeleton = clip.skeleton
    frames = np.tile(np.eye(3), (clip.frame_count, skeleton.slot_count, 1, 1))
    turned = np.flatnonzero(skeleton.slots >= 0)
    frames[:, skeleton.slots[turned]] = matrices(clip.bone_rotations(dtype=np.float64)[:, turned])
    positions = clip.positions(dtype=np.float64)
    left = positions[:, across[0]] - positions[:, across[1]]
    left = left[:, [0, 2]] / np.linalg.norm(left[:, [0, 2]], axis=1, keepdims=True).clip(1e-9)
    cos, sin, zero, one = left[:, 0], -left[:, 1], np.zeros(len(left)), np.ones(len(left))
    facing = np.array([[cos, zero, -sin], [zero, one, zero], [sin, zero, cos]]).transpose(2, 0, 1)
    return np.asarray(np.einsum("fab,fsbc->fsac", facing, frames), np.float64)


def _nearest_rotation(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    u, _, vt = np.linalg.svd(matrix)
    return np.asarray((u * [1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt, np.float64)


def _axes_exchanged(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """The one of the 24 rotations that exchange axes that is near; the rotation itself where none is."""
    nearest = max(_AXIS_ROTATIONS, key=lambda axes: float((axes * rotation).sum()))
    return nearest if (nearest * rotation).sum() / 3 >= _SNAP else rotation


def _axis_rotations() -> list[NDArray[np.float64]]:
    signed = [
        np.eye(3)[list(order)] * np.array(signs)[:, None]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ]
    return [axes for axes in signed if np.linalg.det(axes) > 0]


_AXIS_ROTATIONS = _axis_rotations()
