"""A relation: which marker is on which part of the body, and how the parts hang together.

It is a text that people write (TOML); ``docs/markers.md`` describes it. Two ship with gmr, in
``gmr/data/relations``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Final

from gmr.errors import FormatError
from gmr.listing import quoted
from gmr.markers.anatomy import Rule

__all__ = ["Direction", "Part", "Relation", "load_relation", "shipped_relations"]

_SHOWN: Final = 8


@dataclass(frozen=True, slots=True)
class Direction:
    """From the middle of some points to the middle of others, along an axis of the body.

    Args:
        axis: 0 left, 1 up, 2 forward.
        start, end: markers of the part, its joint, or the joints of the parts that hang on it.
    """

    axis: int
    start: tuple[str, ...]
    end: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the body that moves as one.

    Args:
        name: as the relation calls it.
        joint: name of the joint at its upper end, which turns it.
        parent: the part above; None for the part that all hangs on.
        markers: markers on it.
        loose: markers on it that slide so much that they have no say in where it is.
        directions: two directions in the part; the first is kept, the second made square to it.
        centre: where anatomy says that its joint is; None: the motion alone says it.
        at: for a part without a parent, the points in whose middle its joint is put.
        tip: the points in whose middle the part ends; () where others hang on it.
    """

    name: str
    joint: str
    parent: str | None
    markers: tuple[str, ...]
    loose: tuple[str, ...]
    directions: tuple[Direction, Direction]
    centre: Rule | None
    at: tuple[str, ...]
    tip: tuple[str, ...]


@dataclass(frozen=True)
class Relation:
    """Markers, parts and joints.

    Args:
        name: what the marker set is called.
        about: where it is described.
        parts: parents before children.
        aliases: other labels for its markers: what a file may have -> what the relation calls it.
        file: the file it was read from.
    """

    name: str
    about: str
    parts: tuple[Part, ...]
    aliases: Mapping[str, str]
    file: str

    @cached_property
    def by_name(self) -> Mapping[str, Part]:
        """The parts by their names."""
        return {part.name: part for part in self.parts}

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """All markers that it names, each once."""
        named = (label for part in self.parts for label in (*part.markers, *part.loose))
        return tuple(dict.fromkeys(named))

    @cached_property
    def joints(self) -> Mapping[str, Part]:
        """The part that each joint turns."""
        return {part.joint: part for part in self.parts}


def shipped_relations() -> tuple[str, ...]:
    """Names of the relations that ship with gmr."""
    folder = files("gmr") / "data" / "relations"
    return tuple(sorted(entry.name[:-5] for entry in folder.iterdir() if entry.name.endswith(".toml")))


def load_relation(source: Relation | str | Path) -> Relation:
    """A relation: itself, one that ships with gmr by its name, or one from a file.

    Raises:
        FormatError: there is none of that name and no such file, or it is no relation.
    """
    if isinstance(source, Relation):
        return source
    from gmr.markers.relation_text import read_relation

    if str(source) in shipped_relations():
        return _shipped(str(source))
    path = Path(source)
    try:
        data = path.read_bytes()
    except OSError as error:
        names = quoted(shipped_relations(), _SHOWN)
        what = f"there is no relation '{source}': it is neither a file ({error.strerror}) nor one of {names}"
        raise FormatError(what, file=str(source)) from error
    return read_relation(data, str(path))


@lru_cache(maxsize=8)
def _shipped(name: str) -> Relation:
    from gmr.markers.relation_text import read_relation

    data = (files("gmr") / "data" / "relations" / f"{name}.toml").read_bytes()
    return read_relation(data, f"{name}.toml")
