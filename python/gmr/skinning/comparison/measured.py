"""A character in a clip, blended in every way, and what each does to its surface."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import SkinError
from gmr.skinning.blending import Method
from gmr.skinning.capsule import Movement, measured_capsule
from gmr.skinning.character import Character
from gmr.skinning.distortion import Surface
from gmr.table import Table

__all__ = ["METHODS", "Comparison", "compare"]

METHODS: Final[dict[Method, str]] = {
    "lbs": "linear",
    "dqbs": "dual quaternion",
    "cor": "centres of rotation",
}
"""What each method is called."""

_ANGLES: Final[dict[Movement, float]] = {"bend": 150.0, "twist": 180.0}
_STEP: Final = 5.0
_AT_A_TIME: Final = 1 << 20
"""Vertices that are blended at a time, so that a long clip needs no more room than a short one."""


@dataclass(frozen=True)
class Comparison:
    """The methods side by side.

    Attributes:
        character: what was moved.
        poses: (F, J, 4, 4) world matrices of its joints.
        frame_time: seconds.
        motion: what the poses are called.
        frames: a row a frame and method: ``frame``, ``seconds``, ``method``, ``volume``, ``edge``,
            ``edge_worst``, ``area``, ``area_worst`` (see :class:`~gmr.skinning.distortion.Distortion`).
        apart: a row a frame: ``frame``, ``seconds``, ``apart_mean_mm``, ``apart_max_mm``, how far linear and
            dual quaternion blending put a vertex from each other, and ``joint``, what the one farthest
            follows most.
        capsule: a row a movement, angle and method: see :func:`~gmr.skinning.capsule.measured_capsule`.
        is_closed: whether the character's surface has no hole.
    """

    character: Character
    poses: NDArray[np.float64]
    frame_time: float
    motion: str
    frames: Table
    apart: Table
    capsule: Table
    is_closed: bool

    def most_apart(self, count: int) -> list[int]:
        """Frames in which the methods differ most, no two within a quarter of a second, in their order."""
        apart = self.apart["apart_max_mm"].astype(float)
        near = max(1, round(0.25 / self.frame_time))
        found: list[int] = []
        for frame in np.argsort(-apart, kind="stable").tolist():
            if all(abs(frame - other) > near for other in found):
                found.append(frame)
            if len(found) == count:
                break
        return sorted(found)


def compare(character: Character, poses: ArrayLike, frame_time: float, *, motion: str = "") -> Comparison:
    """Blends a character in every way and measures what becomes of its surface; and so for the capsule.

    Args:
        character: with at least one skinned part.
        poses: (F, J, 4, 4) world matrices of its joints, F at least 1.
        frame_time: seconds a frame.
        motion: what to call the poses.

    Raises:
        GmrError: the character has no skinned part, or the poses do not fit it.
        SkinError: its mesh has no surface, or there is no frame.
    """
    matrices = np.asarray(poses, np.float64)
    if not len(matrices):
        raise SkinError("the motion has no frame, so there is nothing to compare")
    surface = Surface(character.merged.vertices, character.faces)
    return Comparison(
        character,
        matrices,
        frame_time,
        motion,
        _frames(character, matrices, frame_time, surface),
        _apart(character, matrices, frame_time),
        _capsules(),
        surface.is_closed,
    )


def _frames(character: Character, poses: NDArray[np.float64], frame_time: float, surface: Surface) -> Table:
    tables = []
    for method in METHODS:
        parts = [surface.measured(character.skin(some, method)) for some in _pieces(character, poses)]
        frame = np.arange(len(poses))
        columns = {
            name: np.concatenate([getattr(part, name) for part in parts])
            for name in ("volume", "edge", "edge_worst", "area", "area_worst")
        }
        tables.append(
            Table(
                {
                    "frame": frame,
                    "seconds": frame * frame_time,
                    "method": [METHODS[method]] * len(frame),
                    **columns,
                }
            )
        )
    return _stacked(tables)


def _apart(character: Character, poses: NDArray[np.float64], frame_time: float) -> Table:
    mean, most, joint = [], [], []
    merged = character.merged
    strongest = merged.joints[np.arange(len(merged.joints)), merged.weights.argmax(axis=1)]
    names = character.joint_names
    for some in _pieces(character, poses):
        distance = np.linalg.norm(character.skin(some, "dqbs") - character.skin(some, "lbs"), axis=-1)
        mean.append(distance.mean(axis=1))
        most.append(distance.max(axis=1))
        joint += [names[j % len(names)] for j in strongest[distance.argmax(axis=1)].tolist()]
    frame = np.arange(len(poses))
    return Table(
        {
            "frame": frame,
            "seconds": frame * frame_time,
            "apart_mean_mm": 1000 * np.concatenate(mean).astype(float),
            "apart_max_mm": 1000 * np.concatenate(most).astype(float),
            "joint": joint,
        }
    )


def _capsules() -> Table:
    tables = []
    for movement, limit in _ANGLES.items():
        degrees = np.arange(0.0, limit + _STEP / 2, _STEP)
        for method, name in METHODS.items():
            table = measured_capsule(movement, method, degrees)
            columns = {column: table[column] for column in table.column_names}
            count = len(table)
            tables.append(Table({"movement": [movement] * count, "method": [name] * count, **columns}))
    return _stacked(tables)


def _pieces(character: Character, poses: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    count = max(1, _AT_A_TIME // len(character.merged.vertices))
    return (poses[start : start + count] for start in range(0, len(poses), count))


def _stacked(tables: Sequence[Table]) -> Table:
    return Table({name: np.concatenate([table[name] for table in tables]) for name in tables[0].column_names})
