"""What is known of a motion and of the character that it drives before anything moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import path
from gmr.editing.scene import Scene
from gmr.errors import GmrError
from gmr.motion import Motion
from gmr.skeleton import Skeleton
from gmr.skinning.character import Character
from gmr.skinning.driving.alignment import Pairs
from gmr.skinning.driving.following import Following
from gmr.skinning.driving.rest_poses import MotionRest

__all__ = ["Stage", "scale_of"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stage:
    """All that is known before anything moves.

    Args:
        motion: what is played.
        scene: its unit and axes.
        character: what plays it.
        following: who follows whom.
        rest: of the motion.
    """

    motion: Motion
    scene: Scene
    character: Character
    following: Following
    rest: MotionRest

    @property
    def places(self) -> Floats:
        """(J, 3) the character's joints at rest."""
        return np.asarray(self.character.rest_pose()[:, :3, 3], np.float64)

    def both(self, part: str) -> tuple[int, int] | None:
        """The joint of a part in the character, and where the bone that it follows begins in the motion."""
        return self._both.get(part)

    @cached_property
    def _both(self) -> dict[str, tuple[int, int]]:
        found: dict[str, tuple[int, int]] = {}
        for joint, part in self.following.parts.items():
            found.setdefault(part, (joint, self.following.bones[joint].start))
        return found

    def sides(self, part: str) -> tuple[tuple[int, int], tuple[int, int]] | None:
        """(left, right) of a part in the character and in the motion."""
        left, right = self.both(f"left_{part}"), self.both(f"right_{part}")
        return None if left is None or right is None else ((left[0], right[0]), (left[1], right[1]))


def scale_of(stage: Stage, pairs: Pairs, root_scale: float | None) -> tuple[float, str]:
    """Metres of the character for a unit of the motion, and what told it."""
    if root_scale is not None:
        if not (np.isfinite(root_scale) and root_scale > 0):
            raise GmrError(f"root_scale={root_scale}: give more than 0")
        return root_scale / stage.scene.unit.per_metre("root_scale="), "as stated"
    mine = theirs = 0.0
    for side in ("left", "right"):
        top, end = stage.both(f"{side}_up_leg"), stage.both(f"{side}_foot")
        if top and end:
            mine += _length(stage.character.skeleton, stage.places, top[0], end[0])
            theirs += _length(stage.motion.skeleton, stage.rest.places, top[1], end[1])
    if mine > 0 and theirs > 0:
        return mine / theirs, "by the legs"
    bones = stage.following.bones
    for joint, above in pairs.above.items():
        if above >= 0:
            mine += float(np.linalg.norm(stage.places[joint] - stage.places[above]))
            theirs += float(
                np.linalg.norm(stage.rest.places[bones[joint].start] - stage.rest.places[bones[above].start])
            )
    if mine > 0 and theirs > 0:
        return mine / theirs, "by all bones that follow"
    return 1 / stage.scene.unit.per_metre(
        "a character of which one joint follows"
    ), "none, for one joint follows"


def _length(skeleton: Skeleton, places: Floats, top: int, end: int) -> float:
    return float(np.linalg.norm(np.diff(places[path(skeleton, top, end)], axis=0), axis=1).sum())
