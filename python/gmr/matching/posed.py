"""Clips as plain arrays, metres and Y up, with their simulation root: what a database is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.matching.root import RootTrack, root_track
from gmr.matching.survey import Survey
from gmr.motion import Motion
from gmr.quaternions import conjugate, multiply
from gmr.skeleton import Skeleton

__all__ = ["Posed", "posed", "translated_joints"]


@dataclass(frozen=True, slots=True)
class Posed:
    """The F frames of a clip."""

    positions: NDArray[np.float32]
    """(F, J, 3) world positions."""
    rotations: NDArray[np.float64]
    """(F, S, 4) local rotations."""
    translations: NDArray[np.float64]
    """(F, T, 3) of the joints that any clip of the dataset translates."""
    offsets: NDArray[np.float64]
    """(J, 3) of its skeleton."""
    root: RootTrack


def translated_joints(seen: Survey, pair: NDArray[np.int32] | None) -> NDArray[np.int32]:
    """(T,) the joints that need a translation in every frame: those that any clip translates, those that hang
    on a joint that stays behind, and with ``pair`` (J,) their mirror images."""
    moved = [motion.translated for motion in seen.motions.values()]
    hanging = np.flatnonzero(np.isin(seen.skeleton.parents, seen.left_behind))
    joints = np.unique(np.concatenate([*moved, hanging]))
    return (joints if pair is None else np.union1d(joints, pair[joints])).astype(np.int32)


def posed(seen: Survey, motion: Motion, translated: NDArray[np.int32]) -> Posed:
    """A motion of a dataset, in metres and Y up, as arrays.

    Args:
        seen: what the dataset is made of.
        motion: F frames.
        translated: (T,) as from :func:`translated_joints`.

    Raises:
        ValueError: no frame shows a facing.
    """
    positions = np.asarray(motion.positions(dtype=np.float32))
    translations = _translations(motion, translated)
    if seen.floor:
        positions[:, :, 1] -= seen.floor
        roots = np.isin(translated, seen.skeleton.roots)
        translations = translations - roots[:, None] * np.array([0.0, seen.floor, 0.0])
    root = root_track(motion, positions, seen.joints, seen.root)
    clip = Posed(positions, motion.rotations, translations, motion.skeleton.offsets, root)
    return _carried(clip, motion.skeleton, seen.left_behind, translated) if seen.left_behind else clip


def _translations(motion: Motion, joints: NDArray[np.int32]) -> NDArray[np.float64]:
    """(F, T, 3) of these joints; where the motion does not translate one, its offset."""
    if np.array_equal(motion.translated, joints):
        return motion.translations
    found = np.empty((motion.frame_count, len(joints), 3))
    found[:] = motion.skeleton.offsets[joints]
    found[:, np.searchsorted(joints, motion.translated)] = motion.translations
    return found


def _carried(
    clip: Posed, skeleton: Skeleton, left_behind: Sequence[int], translated: NDArray[np.int32]
) -> Posed:
    """The clip with the joints that stay behind in the world carried along by the simulation root.

    Seen from the body, a joint that rests at the world's origin swings about it at metres' length: blended
    from one clip into another it would fling the body about. The body itself stays where it is.
    """
    origin = np.zeros((len(clip.root.ground), 3))
    origin[:, ::2] = clip.root.ground
    facing = _about_y(clip.root.heading)
    away = conjugate(facing)
    positions, translations = clip.positions.copy(), clip.translations.copy()
    rotations, worlds = clip.rotations.copy(), _worlds(clip, skeleton, left_behind)
    for slot, above in enumerate(skeleton.topology.slot_parents.tolist()):
        if slot in worlds:
            rotations[:, slot] = [0.0, 0.0, 0.0, 1.0] if above in worlds else facing
        elif above in worlds:
            rotations[:, slot] = multiply(multiply(away, worlds[above]), clip.rotations[:, slot])
    positions[:, list(left_behind)] = origin[:, None]
    for column, joint in enumerate(translated.tolist()):
        if joint in skeleton.roots and joint in left_behind:
            translations[:, column] = origin
        elif skeleton.parents[joint] in left_behind:
            translations[:, column] = _turned(away, positions[:, joint] - origin)
    return Posed(positions, rotations, translations, clip.offsets, clip.root)


def _worlds(clip: Posed, skeleton: Skeleton, joints: Sequence[int]) -> dict[int, NDArray[np.float64]]:
    """(F, 4) world rotation of each slot that turns a bone hanging on one of ``joints``, the uppermost
    first."""
    above = skeleton.topology.slot_parents
    worlds: dict[int, NDArray[np.float64]] = {}
    for joint in joints:
        for slot in {int(skeleton.slots[child]) for child in skeleton.children[joint]}:
            local = clip.rotations[:, slot]
            outer = worlds.get(int(above[slot]))
            worlds[slot] = local if outer is None else multiply(outer, local)
    return worlds


def _about_y(heading: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, 4) rotations about the vertical."""
    turned = np.zeros((len(heading), 4))
    turned[:, 1], turned[:, 3] = np.sin(heading / 2), np.cos(heading / 2)
    return turned


def _turned(rotations: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F, 3) vectors, each turned by its rotation."""
    pure = np.concatenate([vectors, np.zeros((len(vectors), 1))], axis=1)
    return multiply(multiply(rotations, pure), conjugate(rotations))[:, :3]
