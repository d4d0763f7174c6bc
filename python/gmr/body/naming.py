"""What joints are called: roles of a body found by the names that common skeletons give them.

Known: CMU (cgspeed and 43-joint conversions), Bandai-Namco, Mixamo, LaFAN1, HumanIK, Xsens, OptiTrack,
Rokoko, Unreal, Rigify, 3ds Max Biped, SMPL, Poser and DAZ, and ASF names, where a joint is named for the
bone that starts or that ends in it. A skeleton is added by adding its words here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

__all__ = [
    "CONVENTIONS",
    "HANDS",
    "OPTIONAL",
    "REQUIRED",
    "ROLES",
    "roles_by_name",
    "side_and_part",
    "split_role",
]

Side = str
"""``"left"``, ``"right"`` or ``""``."""

REQUIRED = ("hips", "left_up_leg", "right_up_leg", "left_foot", "right_foot")
"""Roles without which a body cannot be evaluated. A foot is the ankle: the joint that the foot turns
about."""

OPTIONAL = ("left_shoulder", "right_shoulder", "left_toe", "right_toe", "head")
"""Roles that help where a skeleton has them. A shoulder is the joint in which the upper arm begins."""

ROLES = REQUIRED + OPTIONAL

_SIDES: Mapping[str, Side] = {
    "left": "left", "lft": "left", "l": "left",
    "right": "right", "rgt": "right", "r": "right",
}  # fmt: skip

_PREFIXES = {
    "mixamorig", "bip", "biped", "valve", "bone", "b", "j", "jnt", "joint", "cc", "base", "def", "org", "mch",
    "character", "ctrl", "skel", "skeleton",
}  # fmt: skip
"""First words of a name that say nothing of the body."""

_Words = Mapping[str, tuple[str, ...]]

_BONE_STARTS: _Words = {
    "hips": ("hips", "pelvis", "hip", "midhip", "spinebase", "root"),
    "up_leg": ("upleg", "upperleg", "thigh", "femur", "thighbend", "hip", "buttock"),
    "foot": ("ankle", "foot"),
    "toe": ("toebase", "toe", "toes", "toe0", "ball", "forefoot", "foot"),
    "shoulder": ("upperarm", "arm", "shldr", "humerus", "shldrbend", "shoulder"),
    "head": ("head",),
}
"""Words for each role where a joint is named for what begins in it, the most telling first."""

_BONE_ENDS: _Words = {
    "hips": ("root",),
    "up_leg": ("hipjoint",),
    "foot": ("tibia",),
    "toe": ("foot",),
    "shoulder": ("clavicle",),
    "head": ("upperneck",),
}
"""Words where a joint is named for the bone that ends in it, as in ASF."""

CONVENTIONS: tuple[_Words, ...] = (_BONE_STARTS, _BONE_ENDS)
"""Ways of naming, in the order in which they are tried; the body's shape decides whether one fits."""

HANDS = ("hand", "wrist")
"""Words for a hand, which is no role; the most telling first."""

_VOCABULARY = frozenset((*HANDS, *(w for words in CONVENTIONS for listed in words.values() for w in listed)))
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def side_and_part(name: str) -> tuple[Side, str]:
    """Which side a joint's name says, and the rest of it in one lower-case word.

    ``"mixamorig:LeftUpLeg"``, ``"upleg_l"`` and ``"L UpLeg"`` all give ``("left", "upleg")``; ``"lfoot"``
    gives ``("left", "foot")``, but ``"lowerback"`` gives ``("", "lowerback")``.
    """
    words = [word.lower() for word in _WORD.findall(re.split(r"[:|/]", name)[-1])]
    while len(words) > 1 and (words[0] in _PREFIXES or words[0].isdigit()):
        words.pop(0)
    for place, word in enumerate(words):
        if word in _SIDES:
            return _SIDES[word], "".join(words[:place] + words[place + 1 :])
    part = "".join(words)
    for prefix, side in _SIDES.items():
        if part.startswith(prefix) and part[len(prefix) :] in _VOCABULARY:
            return side, part[len(prefix) :]
    return "", part


def roles_by_name(names: Sequence[str], words: _Words) -> dict[str, int]:
    """The joints that ``words`` gives a role to, as role -> index; the first joint where several have the
    name.

    Args:
        names: (J,) joint names, "" for joints that cannot have a role (ends).
        words: words of each role, as in :data:`CONVENTIONS`.
    """
    joints: dict[tuple[Side, str], int] = {}
    for joint, name in enumerate(names):
        if name:
            joints.setdefault(side_and_part(name), joint)
    found: dict[str, int] = {}
    for role in ROLES:
        side, part = split_role(role)
        known = (joints[side, word] for word in words[part] if (side, word) in joints)
        taken = next((joint for joint in known if joint not in found.values()), None)
        if taken is not None:
            found[role] = taken
    return found


def split_role(role: str) -> tuple[Side, str]:
    """Side and part of a role: ``"left_foot"`` -> ``("left", "foot")``, ``"hips"`` -> ``("", "hips")``."""
    side, _, part = role.partition("_")
    return (side, part) if side in _SIDES else ("", role)
