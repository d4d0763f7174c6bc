"""Mirrored copies: the same places as Motion.mirror gives, in the joint frames that the originals have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from gmr.errors import DatasetError
from gmr.matching import Database
from gmr.motion import Motion
from gmr.quaternions import conjugate, from_matrices, matrices, multiply
from gmr.skeleton import Skeleton
from kept_poses import shown
from walkers import walker


def in_other_frames(motion: Motion, turns: dict[int, NDArray[np.float64]]) -> Motion:
    """The same movement with the frames of some slots turned, as a rig with other axes would hold it."""
    skeleton = motion.skeleton
    frames = np.tile([0.0, 0.0, 0.0, 1.0], (skeleton.slot_count, 1))
    for slot, turn in turns.items():
        frames[slot] = turn
    above = skeleton.topology.slot_parents
    outer = np.where((above >= 0)[:, None], frames[above], [0.0, 0.0, 0.0, 1.0])
    rotations = multiply(multiply(conjugate(outer), motion.rotations), frames)
    offsets = skeleton.offsets.copy()
    for joint, slot in enumerate(skeleton.slots.tolist()):
        if slot >= 0:
            offsets[joint] = matrices(conjugate(frames[slot])) @ offsets[joint]
    turned = Skeleton.post_rotation(
        skeleton.names, skeleton.parents, offsets, turning=range(skeleton.joint_count)
    )
    return Motion.from_pose(
        turned, rotations, motion.translations, motion.frame_time, unit=motion.unit, name=motion.name
    )


HALF_TURN = np.array([0.0, 0.0, 1.0, 0.0])
ALONG_X = from_matrices(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
SLANTED = multiply(ALONG_X, np.array([0.5, -0.5, 0.5, 0.5]))

RIGS = {
    "frames as in the rest pose": {},
    "left and right against each other": {3: ALONG_X, 4: ALONG_X, 5: ALONG_X}
    | {slot: multiply(ALONG_X, np.array([1.0, 0.0, 0.0, 0.0])) for slot in (7, 8, 9)},
    "hips that point upward along x": {0: ALONG_X, 1: HALF_TURN, 11: SLANTED, 13: ALONG_X},
}


@pytest.mark.parametrize("rig", RIGS)
def test_images_keep_the_frames_of_the_originals_and_the_places_of_the_mirror(rig: str) -> None:
    motion = in_other_frames(walker(3.0, 1.3, 0.5, name="walk"), RIGS[rig])
    database = Database.build([motion], mirror=True)
    original, image = database.clip_rows(0), database.clip_rows(1)
    mirrored = Database.build([motion.mirror()])
    np.testing.assert_allclose(database.positions[image], mirrored.positions, atol=1e-5)
    np.testing.assert_allclose(shown(database, image), database.positions[image], atol=1e-5)
    np.testing.assert_allclose(
        database.core.offsets(image.start)[1:], database.core.offsets(original.start)[1:], atol=1e-6
    )
    apart = angles(mean_rotations(database, original), mean_rotations(database, image))
    assert apart.max() < np.radians(20), apart


def mean_rotations(database: Database, rows: slice) -> NDArray[np.float64]:
    """(S, 4) mean of the local rotations of each slot."""
    rotations = np.asarray(database.core.rotations[rows], np.float64)
    outer = np.einsum("fsi,fsj->sij", rotations, rotations)
    return np.asarray(np.linalg.eigh(outer)[1][:, :, -1], np.float64)


def angles(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(2 * np.arccos(np.clip(np.abs((a * b).sum(axis=1)), 0, 1)), np.float64)


def test_a_body_whose_sides_have_no_partners_is_refused_with_the_remedy() -> None:
    names: Sequence[str] = walker().skeleton.names
    odd = [name.replace("LeftHand", "LeftClaw") for name in names]
    motion = walker(2.0)
    skeleton = Skeleton.post_rotation(
        odd, motion.skeleton.parents, motion.skeleton.offsets, turning=range(len(odd))
    )
    lame = Motion.from_pose(skeleton, motion.rotations, motion.translations, 1 / 60, unit=1.0)
    with pytest.raises(
        DatasetError, match=r"cannot be mirrored: joint 'RightHand'.*pairs=.*without mirrored copies"
    ):
        Database.build([lame], mirror=True)
    assert len(Database.build([lame])) == 121
    assert len(Database.build([lame], mirror=True, pairs={"LeftClaw": "RightHand"})) == 242
