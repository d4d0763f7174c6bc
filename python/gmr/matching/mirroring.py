"""Mirrored copies of clips, in the joint frames of the originals.

A mirror image of a rotation is `S R S` with `S = diag(-1, 1, 1)`, and it turns a mirrored bone. In a file
whose left and right bones point along opposite axes of their frames (Bandai-Namco's do), such frames lie a
half turn from those of the originals. Playback blends rotations frame by frame, so each image is given in
the frames that its originals use: `C^-1 S R S C`, with one constant `C` a slot, found once for the dataset.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from gmr.matching.posed import Posed
from gmr.quaternions import conjugate, from_matrices, matrices, multiply
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

    def image(self, clip: Posed, translated: NDArray[np.int32]) -> Posed:
        """A clip seen in the mirror; ``translated`` (T,) holds the other side of each of its joints."""
        place = {joint: k for k, joint in enumerate(translated.tolist())}
        others = [place[joint] for joint in self.pair[translated].tolist()]
        return Posed(
            positions=np.ascontiguousarray(clip.positions[:, self.pair] * _POINT.astype(np.float32)),
            rotations=_each(clip.rotations[:, self.slots], self.turns),
            translations=_each(clip.translations[:, others], self.vectors[translated]),
            offsets=_each(clip.offsets[None, self.pair], self.vectors).reshape(clip.offsets.shape),
            root=clip.root.mirrored(),
        )


def _each(values: NDArray[np.float64], maps: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, K, n) rows times the map of each of the K, as a few large products instead of many small ones."""
    return np.ascontiguousarray(np.matmul(values.transpose(1, 0, 2), maps).transpose(1, 0, 2))


def find_mirror(
    skeleton: Skeleton, pair: NDArray[np.int32], clips: Sequence[Posed], translated: NDArray[np.int32]
) -> Mirror:
    """How clips of a skeleton are mirrored.

    Args:
        skeleton: J joints, S slots.
        pair: (J,) the joint of the other side, itself in the middle.
        clips: some poses of each clip.
        translated: (T,) the joints that the clips' translations are of.
    """
    slots = _paired_slots(skeleton, pair)
    frames = _frames(skeleton, clips, slots, pair, translated)
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
            image = multiply(conjugate(from_matrices(frames[parent])), image)
        turns[slot] = multiply(image, from_matrices(frames[slot]))
    return turns


def _paired_slots(skeleton: Skeleton, pair: NDArray[np.int32]) -> NDArray[np.intp]:
    slots = np.arange(skeleton.slot_count)
    turned = np.flatnonzero(skeleton.slots >= 0)
    slots[skeleton.slots[turned]] = skeleton.slots[pair[turned]]
    return slots


def _frames(
    skeleton: Skeleton,
    clips: Sequence[Posed],
    slots: NDArray[np.intp],
    pair: NDArray[np.int32],
    translated: NDArray[np.int32],
) -> NDArray[np.float64]:
    """(S, 3, 3) `C`: the frame of each slot's originals as seen from the frame of its images.

    It is the rotation nearest to all that it should do: turn the bones of the originals into those of the
    images (Wahba's problem, solved by Kabsch's singular value decomposition), and the mean pose into the
    mean image.
    """
    bones = np.asarray(np.mean([_bone_vectors(clip, translated) for clip in clips], axis=0), np.float64)
    poses = np.concatenate([_character_frames(skeleton, clip) for clip in clips])
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


def _bone_vectors(clip: Posed, translated: NDArray[np.int32]) -> NDArray[np.float64]:
    """(J, 3) mean bone vectors in the frames of their slots."""
    vectors = clip.offsets.copy()
    vectors[translated] = clip.translations.mean(axis=0)
    return vectors


def _character_frames(skeleton: Skeleton, clip: Posed) -> NDArray[np.float64]:
    """(F, S, 3, 3) rotations of the slots, seen from the simulation root."""
    above = skeleton.topology.slot_parents
    frames = matrices(clip.rotations)
    cos, sin = np.cos(clip.root.heading), np.sin(clip.root.heading)
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    away = np.array([[cos, zero, -sin], [zero, one, zero], [sin, zero, cos]]).transpose(2, 0, 1)
    for slot in _uppermost_first(above):
        frames[:, slot] = (away if above[slot] < 0 else frames[:, above[slot]]) @ frames[:, slot]
    return frames


def _uppermost_first(above: NDArray[np.int32]) -> list[int]:
    """The slots, each after the slot above it."""
    depth = np.zeros(len(above), int)
    for slot, parent in enumerate(above.tolist()):
        while parent >= 0:
            depth[slot] += 1
            parent = int(above[parent])
    return [int(slot) for slot in np.argsort(depth, kind="stable")]


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
