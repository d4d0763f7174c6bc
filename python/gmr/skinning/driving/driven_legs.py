"""The legs of a character that follow those of a motion, ready to be set on the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gmr.body.measures import path
from gmr.editing.contacts import contacts
from gmr.quaternions import rotated
from gmr.skinning.driving.alignment import Laid
from gmr.skinning.driving.stage import Stage
from gmr.skinning.driving.standing import Leg, Steps, on_ground

__all__ = ["driven_legs", "feet_of_motion"]

Floats = NDArray[np.float64]


def driven_legs(stage: Stage, laid: Laid, changes: Floats, ways: Floats, scale: float) -> list[Leg]:
    """The legs that can be set on the ground."""
    found = []
    for side in ("left", "right"):
        hip, knee, ankle, toe = (stage.both(f"{side}_{part}") for part in ("up_leg", "leg", "foot", "toe"))
        if hip is None or knee is None or ankle is None:
            continue
        way = path(stage.character.skeleton, hip[0], ankle[0])
        if knee[0] not in way[1:-1]:
            continue
        steps = _steps(stage, changes, ways, scale, ankle, toe)
        rest = stage.places
        vector = None if toe is None else rotated(laid.turns[ankle[0]], rest[toe[0]] - rest[ankle[0]])
        joints = hip[0], knee[0], ankle[0], None if toe is None else toe[0]
        found.append(Leg(side, *joints, vector, _leftwards(stage), steps))
    return on_ground(found, stage.motion.frame_time) if found else []


def _steps(
    stage: Stage,
    changes: Floats,
    ways: Floats,
    scale: float,
    ankle: tuple[int, int],
    toe: tuple[int, int] | None,
) -> Steps:
    """How the motion's foot goes."""
    ball = (toe or ankle)[1]
    rest = stage.rest.places * scale
    return Steps(
        ankle=ways[:, ankle[1]],
        ball=ways[:, ball],
        turn=changes[:, stage.following.bones[ankle[0]].carrier],
        vector=rest[ball] - rest[ankle[1]],
        contacts=tuple(contacts(stage.motion, [ball])) if stage.motion.frame_time else (),
        metre=scale * stage.scene.unit.per_metre("setting feet on the ground"),
    )


def _leftwards(stage: Stage) -> Floats:
    """(3,) to the left of the character at rest."""
    sided = stage.sides("up_leg")
    assert sided is not None
    (left, right), _ = sided
    level = (stage.places[left] - stage.places[right]) * np.array([1.0, 0.0, 1.0])
    return np.asarray(level / np.linalg.norm(level), np.float64)


def feet_of_motion(stage: Stage) -> list[tuple[int, int | None, list[int]]]:
    """Ankle, ball and what turns them, of the motion's feet that are followed."""
    found = []
    for side in ("left", "right"):
        ankle, toe = stage.both(f"{side}_foot"), stage.both(f"{side}_toe")
        if ankle:
            followed = [stage.following.bones[joint[0]].carrier for joint in (ankle, toe) if joint]
            found.append((ankle[1], toe[1] if toe else None, followed))
    return found
