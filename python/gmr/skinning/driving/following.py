"""Who follows whom: each joint of a character, and the bone of a motion that turns it."""

from __future__ import annotations

import difflib
import json
import os
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gmr.body.measures import path
from gmr.body.naming import side_and_part
from gmr.errors import FormatError, SkeletonError
from gmr.listing import quoted
from gmr.skeleton import Skeleton
from gmr.skinning.driving.body_parts import Body
from gmr.skinning.driving.parts import CHAINS

__all__ = ["Bone", "Following", "Names", "bones_of", "follow", "read_names", "with_stated"]

Names = Mapping[str, Any] | str | os.PathLike[str]
"""Character's joint -> motion's joint; or tables ``follows``, ``character`` and ``motion``; or a file."""

_TABLES = ("follows", "character", "motion")
_SHOWN = 24
_NEAREST = 8
_NEAR = 0.55
"""Likeness of names, 0 to 1, above which an error offers one."""
_ALIKE = 0.8
"""Share of the character's joints that must be called the same for both to be one skeleton."""


@dataclass(frozen=True, slots=True)
class Bone:
    """A bone of a motion.

    Args:
        start: the joint in which it begins.
        carrier: the joint whose bone rotation (:meth:`Motion.bone_rotations`) turns it.
        name: what the motion calls it.
    """

    start: int
    carrier: int
    name: str


@dataclass(frozen=True)
class Following:
    """Which bone each joint of a character follows.

    Args:
        bones: by joint of the character.
        parts: the part of the body that each is, where that is known.
        how: what told it, in words.
        is_same: whether both are one skeleton, by the names of their joints.
    """

    bones: Mapping[int, Bone]
    parts: Mapping[int, str]
    how: str
    is_same: bool

    @property
    def begins(self) -> dict[str, int]:
        """By part the joint of the motion in which the bone begins, the first of a chain."""
        found: dict[str, int] = {}
        for joint, part in self.parts.items():
            found.setdefault(part, self.bones[joint].start)
        return found


def read_names(names: Names | None) -> dict[str, dict[str, str]]:
    """The three tables of a map, empty where it has none.

    Raises:
        FormatError: the file is missing, is neither TOML nor JSON, or holds something else than names.
    """
    if names is None:
        return {table: {} for table in _TABLES}
    file = None
    if isinstance(names, str | os.PathLike):
        file = str(names)
        names = _content(Path(names))
    nested = bool(names) and all(isinstance(value, Mapping) for value in names.values())
    tables = dict(names) if nested else {"follows": names}
    unknown = [table for table in tables if table not in _TABLES]
    if unknown:
        what = f"there is no table '{unknown[0]}' in a map of names; there are {quoted(_TABLES, 3)}"
        raise FormatError(what, file=file or "<names>")
    for table in tables.values():
        for key, value in table.items():
            if not (isinstance(key, str) and isinstance(value, str)):
                what = f"{key!r} is {value!r}; a map has the name of a joint for each name"
                raise FormatError(what, file=file or "<names>")
    return {table: dict(tables.get(table, {})) for table in _TABLES}


def _content(file: Path) -> dict[str, Any]:
    try:
        text = file.read_text(encoding="utf-8")
        found: Any = json.loads(text) if file.suffix.lower() == ".json" else tomllib.loads(text)
    except OSError as error:
        raise FormatError(f"the map of names cannot be read: {error.strerror}", file=str(file)) from error
    except ValueError as error:
        raise FormatError(f"a map of names is TOML, or JSON as .json: {error}", file=str(file)) from error
    if not isinstance(found, dict):
        raise FormatError("a map of names is a table of names", file=str(file))
    return found


def with_stated(body: Body | None, skeleton: Skeleton, stated: Mapping[str, str]) -> Body | None:
    """The body with the parts that a map names: ``left_arm = "Bip01 L UpperArm"``, chains as ``spine.0``."""
    if not stated:
        return body
    chains: dict[str, dict[int, int]] = {}
    for key, name in stated.items():
        part, _, place = key.partition(".")
        chains.setdefault(part, {})[int(place) if place.isdigit() else 0] = skeleton.index(name)
    parts = {part: tuple(joints[k] for k in sorted(joints)) for part, joints in chains.items()}
    return Body({**(body.parts if body else {}), **parts}, "given")


def follow(
    character: Skeleton,
    motion: Skeleton,
    bodies: tuple[Body | None, Body | None],
    stated: Mapping[str, str],
    *,
    by_ends: bool,
) -> Following:
    """Which bone of a motion each joint of a character follows.

    What is stated goes first. A character most of whose joints have their names in the motion follows those;
    else the parts of both bodies are matched: a part follows the same part, and a chain (spine, neck, finger)
    its first and last joints those of the other's, with the joints between spread evenly.

    Args:
        character: J joints.
        motion: at home.
        bodies: the parts of the character and of the motion.
        stated: character's joint -> motion's joint; "" follows nothing.
        by_ends: the motion's joints are named for the bones that end in them, as in ASF.

    Raises:
        SkeletonError: a stated joint is not there, or nothing follows anything.
    """
    mine, theirs = bodies
    same = [(j, motion.names.index(name)) for j, name in enumerate(character.names) if name in motion.names]
    is_same = len(same) >= _ALIKE * len(character.names)
    bone_of = bones_of(motion, by_ends=by_ends and not is_same)
    if is_same:
        how = "by their names, which are the same"
        found = same
    elif mine and theirs:
        how = f"as parts of a body: character by {mine.found_by}, motion by {theirs.found_by}"
        found = [pair for part in mine.parts if part in theirs.parts for pair in _pairs(part, mine, theirs)]
    else:
        how, found = "as stated", []
    left_out = {character.index(name) for name in stated}
    bones: dict[int, Bone] = {}
    for joint, other in found:
        bone = bone_of(other)
        if joint not in left_out and bone is not None:
            bones.setdefault(joint, bone)
    for name, followed in stated.items():
        if followed:
            bone = bone_of(motion.index(followed))
            if bone is None:
                raise SkeletonError(f"'{followed}' has no bone that turns, so '{name}' cannot follow it")
            bones[character.index(name)] = bone
    if not bones:
        raise SkeletonError(_nothing(character, motion, bodies))
    if stated and found:
        how += f"; {len(stated)} as stated"
    return Following(dict(sorted(bones.items())), _parts(bones, bodies, bone_of), how, is_same)


def _parts(
    bones: Mapping[int, Bone], bodies: tuple[Body | None, Body | None], bone_of: Callable[[int], Bone | None]
) -> dict[int, str]:
    """The part that each joint of the character is; where its body is not known, the part that it follows."""
    mine, theirs = bodies
    found: dict[int, str] = {}
    for part, joints in mine.parts.items() if mine else ():
        for joint in joints:
            if joint in bones:
                found.setdefault(joint, part)
    if mine is None and theirs is not None:
        followers = {bone: joint for joint, bone in bones.items()}
        for part, joints in theirs.parts.items():
            for bone in map(bone_of, joints):
                if bone in followers:
                    found.setdefault(followers[bone], part)
    return found


def _pairs(part: str, mine: Body, theirs: Body) -> list[tuple[int, int]]:
    """Joints of a part matched: of two chains the ends, and evenly what is between."""
    one, other = mine.parts[part], theirs.parts[part]
    if part not in CHAINS:
        return [(one[0], other[0])]
    count = min(len(one), len(other))
    if count == 1 and part == "spine":
        return [(one[-1], other[-1])]  # the chest, which carries the arms
    return [(one[_spread(k, count, len(one))], other[_spread(k, count, len(other))]) for k in range(count)]


def _spread(k: int, count: int, length: int) -> int:
    return 0 if count == 1 else round(k * (length - 1) / (count - 1))


def bones_of(motion: Skeleton, *, by_ends: bool) -> Callable[[int], Bone | None]:
    """What makes a bone of a joint; None for a joint that turns nothing.

    Args:
        motion: at home.
        by_ends: its joints are named for the bones that end in them, as in ASF.
    """

    def named_for_end(joint: int) -> Bone | None:
        above = int(motion.parents[joint])
        return named_for_start(joint) if above < 0 else Bone(above, joint, motion.names[joint])

    def named_for_start(joint: int) -> Bone | None:
        below = motion.children[joint]
        if motion.slots[joint] >= 0 and motion.parents[joint] < 0:
            return Bone(joint, joint, motion.names[joint])
        return Bone(joint, _widest(motion, below), motion.names[joint]) if below else None

    return named_for_end if by_ends else named_for_start


def _widest(motion: Skeleton, joints: tuple[int, ...]) -> int:
    """Of siblings the one that carries most: where they turn independently, that is the way of the body."""
    return max(joints, key=lambda joint: (_count_below(motion, joint), -joint))


def _count_below(motion: Skeleton, joint: int) -> int:
    return 1 + sum(_count_below(motion, child) for child in motion.children[joint])


def names_for_ends(motion: Skeleton, body: Body | None, roles: Mapping[str, int]) -> bool:
    """Whether joints are named for the bones that end in them: the joint called thigh is then the knee.

    Args:
        motion: at home.
        body: the parts by their names.
        roles: the joints by what poses say of them, see :mod:`gmr.body.joints`.
    """
    if body is None or "left_up_leg" not in roles or body.one("left_up_leg") is None:
        return False
    thigh = body.one("left_up_leg")
    assert thigh is not None
    up_leg = roles["left_up_leg"]
    return (
        thigh != up_leg and path(motion, up_leg, thigh) == [up_leg, thigh] and motion.parents[thigh] == up_leg
    )


def _nothing(character: Skeleton, motion: Skeleton, bodies: tuple[Body | None, Body | None]) -> str:
    """Why nothing is matched, with both sides' names and the nearest of them."""
    which = [label for label, body in zip(("character", "motion"), bodies, strict=True) if body is None]
    near = [f"'{name}': '{alike}'" for name in character.names if (alike := _nearest(name, motion.names))]
    nearest = f" Nearest in name: {', '.join(near[:_NEAREST])}." if near else ""
    return (
        "no joint of the character is matched with one of the motion: neither names nor shape tell the body "
        f"of the {' and of the '.join(which) or 'two'}. The character's joints are "
        f"{quoted(character.names, _SHOWN)}; the motion's are {quoted(motion.names, _SHOWN)}.{nearest} Say "
        "who follows whom: names={'character joint': 'motion joint', ...} in Python, --map FILE on the "
        "command line"
    )


def _nearest(name: str, others: Sequence[str]) -> str | None:
    """The name that is most like another, sides apart."""
    side, part = side_and_part(name)
    theirs = {other: side_and_part(other) for other in others}
    same_side = [other for other, (its, _) in theirs.items() if its in (side, "")]
    words = {theirs[other][1]: other for other in reversed(same_side)}
    found = difflib.get_close_matches(part, list(words), n=1, cutoff=_NEAR)
    return words[found[0]] if found else None
