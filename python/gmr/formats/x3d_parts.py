"""Which joint of a motion stands where H-Anim has which joint, and which bone turns it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.editing.scene import Scene
from gmr.errors import SkeletonError
from gmr.formats.hanim import FINGERS, LIMBS, LOA_1, NECK, SPINE, articulations
from gmr.listing import quoted
from gmr.motion import Motion
from gmr.skinning.driving.body_of_motion import body_of_motion
from gmr.skinning.driving.body_parts import Body
from gmr.skinning.driving.following import Bone, bones_of
from gmr.skinning.driving.parts import LEG_PARTS, named_parts, namings

__all__ = ["Stand", "find_parts", "levels", "named_stands", "tree_of"]

Floats = NDArray[np.float64]

_SIDES = {"l": "left", "r": "right"}
_SHOWN = 80


@dataclass(frozen=True, slots=True)
class Stand:
    """A joint of a motion, at home, in the place of one of H-Anim.

    Args:
        named: the joint of the motion that has the part's name.
        joint: the one that stands there: the same, or the one above where joints are named for the bones that
            end in them.
        carrier: the joint whose bone rotation (:meth:`Motion.bone_rotations`) turns what hangs on it; None:
            nothing turns there.
        part: of the body, as ``left_arm``.
    """

    named: int
    joint: int
    carrier: int | None
    part: str


def find_parts(motion: Motion, scene: Scene, stated: Mapping[str, str]) -> dict[str, tuple[Stand, ...]]:
    """The joints of a motion by part of the body; several for a chain, from the body outwards.

    Args:
        motion: at home.
        scene: its axes.
        stated: names of joints by part of the body, which go before any guess.

    Raises:
        SkeletonError: hips, legs or feet are not known; says what is missing and how to name it.
    """
    body, by_ends = body_of_motion(motion, scene, dict(stated))
    if body is None or any(part not in body.parts for part in LEG_PARTS):
        raise SkeletonError(_unknown(motion, body))
    bone_of = bones_of(motion.skeleton, by_ends=by_ends)
    return {
        part: tuple(_stand(joint, bone_of(joint), part) for joint in joints)
        for part, joints in body.parts.items()
    }


def named_stands(parts: Mapping[str, Sequence[Stand]], high: Floats) -> dict[str, Stand]:
    """The same by H-Anim's names, in its order.

    Args:
        parts: joints by part of the body.
        high: (J,) how high each joint of the motion is at rest.
    """
    found = {"humanoid_root": parts["hips"][0]} | _column(parts, high)
    for letter, side in _SIDES.items():
        for part, name in LIMBS.items():
            if f"{side}_{part}" in parts:
                found[f"{letter}_{name}"] = parts[f"{side}_{part}"][0]
        for finger, names in FINGERS.items():
            for name, stand in zip(names, parts.get(f"{side}_{finger}", ()), strict=False):
                found[f"{letter}_{name}"] = stand
    return {name: found[name] for name in articulations() if name in found}


def tree_of(names: Mapping[str, object]) -> dict[str, str]:
    """Parent by name, "" for the root, of all joints that a humanoid has: those given and those of the first
    level of articulation; none before its parent."""
    above: dict[str, str] = {}
    for name, joint in articulations().items():
        if name in names or name in LOA_1:
            parent = joint.parent
            while parent and parent not in above:
                parent = articulations()[parent].parent
            above[name] = parent
    return above


def _stand(joint: int, bone: Bone | None, part: str) -> Stand:
    return Stand(joint, joint, None, part) if bone is None else Stand(joint, bone.start, bone.carrier, part)


def _column(parts: Mapping[str, Sequence[Stand]], high: Floats) -> dict[str, Stand]:
    """Back, neck and head: each joint is the vertebra that is as high in H-Anim's own body, between hip,
    shoulder and head; the lowest of the back is the fifth of the loins, which no humanoid lacks."""
    found: dict[str, Stand] = {}

    def height(*names: str) -> float | None:
        known = [high[parts[name][0].joint] for name in names if name in parts]
        return float(np.mean(known)) if known else None

    def nominal(name: str) -> float:
        centre = articulations()[name].centre
        assert centre is not None
        return centre[1]

    hip, shoulder, head = (
        height("left_up_leg", "right_up_leg"),
        height("left_arm", "right_arm"),
        height("head"),
    )
    marks = [(nominal("l_hip"), hip), (nominal("l_shoulder"), shoulder), (nominal("skullbase"), head)]
    known = [(own, theirs) for own, theirs in marks if theirs is not None]
    for part, names in (("spine", SPINE), ("neck", NECK)):
        stands = _as_many(parts.get(part, ()), len(names))
        places = _along([high[stand.joint] for stand in stands], known)
        chosen = levels(places, [nominal(name) for name in names], first=part == "spine")
        found |= {names[level]: stand for level, stand in zip(chosen, stands, strict=True)}
    if "head" in parts:
        found["skullbase"] = parts["head"][0]
    return found


def _along(heights: Sequence[float], marks: Sequence[tuple[float, float]]) -> list[float]:
    """Heights as they would be in H-Anim's own body; beyond the outermost marks those of the marks."""
    own, theirs = (np.array(side) for side in zip(*marks, strict=True))
    if len(own) < 2 or np.any(np.diff(theirs) <= 0):
        return [float(own[0])] * len(heights)
    found: list[float] = np.interp(heights, theirs, own).tolist()
    return found


def levels(wanted: Sequence[float], offered: Sequence[float], *, first: bool) -> list[int]:
    """Which of the offered heights, which rise, each of the wanted ones is given: the nearest, each higher
    than the one before.

    Args:
        wanted: K heights.
        offered: N heights, at least K.
        first: the first of the wanted is given the first of the offered.
    """
    found: list[int] = []
    for k, height in enumerate(wanted):
        lowest = found[-1] + 1 if found else 0
        highest = 0 if first and not found else len(offered) - (len(wanted) - k)
        nearest = min(range(lowest, highest + 1), key=lambda level: abs(offered[level] - height))
        found.append(nearest)
    return found


def _as_many(stands: Sequence[Stand], most: int) -> list[Stand]:
    """The stands, evenly thinned out where there are more than that."""
    if len(stands) <= most:
        return list(stands)
    return [stands[round(k * (len(stands) - 1) / (most - 1))] for k in range(most)]


def _unknown(motion: Motion, body: Body | None) -> str:
    """What is missing of a body, and how to name it."""
    proper = [name for name, end in zip(motion.skeleton.names, motion.skeleton.ends, strict=True) if not end]
    guesses = [named_parts(proper, naming) for naming in namings()] if body is None else [body.parts]
    parts = max(guesses, key=lambda guess: sum(part in guess for part in LEG_PARTS))
    missing = [part for part in LEG_PARTS if part not in parts]
    example = ", ".join(f"'{part}': ..." for part in missing[:2])
    return (
        f"neither the names nor the shape of {motion.name or 'the motion'} tell which joints are "
        f"{', '.join(missing)}; H-Anim is for humans. The joints are {quoted(proper, _SHOWN)}. Name those of "
        "a body as H-Anim or another naming does (humanoid_root, l_hip, r_hip, l_talocrural, r_talocrural "
        f"...), or say which they are: gmr.formats.x3d.write_x3d(motion, path, names={{{example}}})"
    )
