"""Forward kinematics in NumPy and SciPy, float64, straight from its formula; and random skeletons for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A skeleton in rotation slots, and poses."""

    parents: NDArray[np.int32]
    slots: NDArray[np.int32]
    slot_count: int
    offsets: Floats
    """(J, 3)"""
    rotations: Floats
    """(F, S, 4)"""
    translated: NDArray[np.int32]
    translations: Floats
    """(F, T, 3)"""

    @property
    def height(self) -> float:
        """The longest chain of bones: what an error is a share of."""
        lengths = np.linalg.norm(self.offsets, axis=-1)
        reach: list[float] = []
        for joint, parent in enumerate(self.parents.tolist()):
            reach.append(lengths[joint] + (reach[parent] if parent >= 0 else 0.0))
        return max(1.0, *reach, float(np.abs(self.translations).max(initial=0.0)))


def random_case(seed: int, joints: int, frames: int, *, root_count: int = 1, pre: bool = False) -> Case:
    """A forest of ``joints`` joints, parents first; siblings share slots unless ``pre``."""
    rng = np.random.default_rng(seed)
    parents = np.array([-1 if j < root_count else rng.integers(0, j) for j in range(joints)], np.int32)
    slots = np.arange(joints, dtype=np.int32) if pre else parents.copy()
    slots[rng.random(joints) < 0.05] = -1
    # All of a parent's children share its slot, or (where one lost it) hang in the world rotation above.
    moving = np.flatnonzero((parents < 0) | (rng.random(joints) < 0.2)).astype(np.int32)
    rotations = rng.normal(size=(frames, joints, 4))
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    return Case(
        parents, slots, joints, rng.normal(size=(joints, 3)), rotations,
        moving, rng.normal(size=(frames, len(moving), 3)),
    )  # fmt: skip


def world(case: Case) -> tuple[Floats, list[Rotation]]:
    """Positions (F, J, 3), and for each joint the world rotation of the bone that ends in it."""
    frames = len(case.rotations)
    positions = np.zeros((frames, len(case.parents), 3))
    turned: list[Rotation] = []
    place = {joint: k for k, joint in enumerate(case.translated.tolist())}
    for joint, (parent, slot) in enumerate(zip(case.parents.tolist(), case.slots.tolist(), strict=True)):
        above = turned[parent] if parent >= 0 else Rotation.identity(frames)
        turned.append(above * Rotation.from_quat(case.rotations[:, slot]) if slot >= 0 else above)
        vector = np.repeat(case.offsets[joint][None], frames, axis=0)
        if joint in place:
            vector = case.translations[:, place[joint]]
        positions[:, joint] = vector if parent < 0 else positions[:, parent] + turned[joint].apply(vector)
    return positions, turned
