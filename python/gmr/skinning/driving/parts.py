"""The parts of a body in a tree of joints, by the names that common skeletons give them.

A part is where a bone of the body begins: ``left_arm`` is the shoulder in which the upper arm turns,
``left_forearm`` the elbow. Spine, neck and fingers are chains of joints. What joints are called is told by
the files in ``gmr/data/joint_names``; a naming is added by adding a file there.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources

from gmr.body.naming import side_and_part

__all__ = ["CHAINS", "LEG_PARTS", "Naming", "named_parts", "namings", "parts_by_name"]

Parts = Mapping[str, tuple[int, ...]]
"""Joints by part; several for a chain, from the body outwards."""

_FINGERS = ("thumb", "index", "middle", "ring", "pinky")
_SIDED = ("clavicle", "arm", "forearm", "hand", "up_leg", "leg", "foot", "toe", *_FINGERS)
CHAINS = ("spine", "neck", *(f"{side}_{finger}" for side in ("left", "right") for finger in _FINGERS))
"""Parts that are several joints one below the other."""

LEG_PARTS = ("hips", "left_up_leg", "right_up_leg", "left_foot", "right_foot")
"""Parts without which a tree of joints is no body."""

_NUMBER_OF_NODE = re.compile(r"(?<=\D)_\d+$")
"""What exporters of glTF append to names: ``b_LeftFoot01_017``."""


@dataclass(frozen=True)
class Naming:
    """What one family of skeletons calls the parts of a body.

    Args:
        title: for people.
        words: by part without its side: the words for it, the likeliest first; for a chain, its joints from
            the body outwards, as many as a skeleton has.
    """

    title: str
    words: Mapping[str, tuple[str, ...]]


@cache
def namings() -> tuple[Naming, ...]:
    """All that ship with gmr."""
    folder = resources.files("gmr").joinpath("data", "joint_names")
    files = sorted((file for file in folder.iterdir() if file.name.endswith(".toml")), key=lambda f: f.name)
    return tuple(_naming(file.read_text(encoding="utf-8")) for file in files)


def _naming(text: str) -> Naming:
    content = tomllib.loads(text)
    title, sides = content.pop("title"), content.pop("sides")
    words = {part: _listed(value) for part, value in {**content, **sides}.items()}
    unknown = words.keys() - {"hips", "spine", "neck", "head", *_SIDED}
    if unknown:
        raise ValueError(f"the naming '{title}' has unknown parts: {sorted(unknown)}")
    return Naming(title, words)


def _listed(value: str | list[str]) -> tuple[str, ...]:
    return (value,) if isinstance(value, str) else tuple(value)


def parts_by_name(names: Sequence[str]) -> tuple[Naming, Parts] | None:
    """The naming that knows most of the names, and the joints of its parts; None where none knows a leg.

    Args:
        names: (J,) joints, "" for those that can be no part (ends).
    """
    found = [(naming, named_parts(names, naming)) for naming in namings()]
    bodies = [(naming, parts) for naming, parts in found if all(part in parts for part in LEG_PARTS)]
    return max(bodies, key=lambda one: sum(map(len, one[1].values())), default=None)


def named_parts(names: Sequence[str], naming: Naming) -> dict[str, tuple[int, ...]]:
    """The joints that a naming knows, by part; the first joint where several have a name."""
    by_word: dict[tuple[str, str], int] = {}
    for joint, name in enumerate(names):
        if name:
            for key in _keys(name):
                by_word.setdefault(key, joint)
    found: dict[str, tuple[int, ...]] = {}
    for part, words in naming.words.items():
        for side in ("left", "right") if part in _SIDED else ("",):
            label = f"{side}_{part}" if side else part
            known = [by_word[side, _plain(word)] for word in words if (side, _plain(word)) in by_word]
            if known:
                found[label] = tuple(dict.fromkeys(known)) if label in CHAINS else (known[0],)
    return found


def _keys(name: str) -> list[tuple[str, str]]:
    """What a name may mean: a side and a word; with the number of a node and without."""
    return [key for form in (name, _NUMBER_OF_NODE.sub("", name)) for key in _meanings(form)]


def _meanings(name: str) -> list[tuple[str, str]]:
    side, part = side_and_part(name)
    if side:
        return [(side, part), ("", _plain(name))]  # L5 is a vertebra
    # lradius: an l or r before a word that only a naming knows.
    own = _plain(part)
    guesses = [(_SIDE_LETTERS[own[0]], own[1:])] if own[:1] in _SIDE_LETTERS else []
    return [("", own), *guesses]


_SIDE_LETTERS = {"l": "left", "r": "right"}


def _plain(word: str) -> str:
    return re.sub(r"[^a-z0-9]", "", word.lower())
