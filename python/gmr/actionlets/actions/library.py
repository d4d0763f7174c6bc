"""A library: the actions that ship with gmr, and those of a user's own files, by name."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Final

from gmr.actionlets.actions.action import Action, SingleAction
from gmr.actionlets.actions.anatomy import the_anatomy
from gmr.actionlets.actions.parts import action_courses, check_unit, mirrored_contacts
from gmr.actionlets.actions.reading import MAX_BYTES, Content, read_files
from gmr.actionlets.actions.sequence import sequence_of
from gmr.actionlets.actions.tables import nearest
from gmr.actionlets.actions.units import Unit
from gmr.actionlets.actions.variation import Pool
from gmr.errors import ActionletError, FormatError

__all__ = ["Library", "contents", "library"]

_FOLDER: Final = "gmr/data/actions/"
"""What the names of the files that ship begin with."""


@dataclass(frozen=True)
class Library:
    """Actions by name, in the order of their files.

    Args:
        actions: by name.
        units: the joint, limb and group actions that they are made of, by name.
        aliases: other names of actions, to their names.
    """

    actions: Mapping[str, Action]
    units: Mapping[str, Unit]
    aliases: Mapping[str, str]

    def __getitem__(self, name: str) -> Action:
        """The action of that name or alias.

        Raises:
            ActionletError: there is none; the message offers the names nearest to it.
        """
        own = self.aliases.get(name, name)
        if own not in self.actions:
            offer = nearest(name, (*self.actions, *self.aliases))
            raise ActionletError(f"no action is called '{name}'. {offer}")
        return self.actions[own]

    def __contains__(self, name: object) -> bool:
        return name in self.actions or name in self.aliases

    def __iter__(self) -> Iterator[str]:
        return iter(self.actions)

    def __len__(self) -> int:
        return len(self.actions)


def library(*files: str | os.PathLike[str]) -> Library:
    """The actions that ship with gmr and those of your own files.

    Args:
        files: library files (``docs/actions.md``); they may use all names that ship, and each other's.

    Raises:
        FormatError: a file that is no library; names file, table, key, value and what was expected.
    """
    return _library(contents(*files)) if files else _shipped_alone()


def contents(*files: str | os.PathLike[str]) -> dict[str, bytes]:
    """What the files of a library hold, by name: of those that ship with gmr, and of your own.

    Raises:
        FormatError: a file that cannot be read.
    """
    found = _shipped()
    for file in files:
        try:
            with Path(file).open("rb") as opened:
                found[os.fspath(file)] = opened.read(MAX_BYTES + 1)
        except OSError as error:
            raise FormatError(f"it cannot be read: {error.strerror}", file=os.fspath(file)) from error
    return found


@cache
def _shipped_alone() -> Library:
    return _library(_shipped())


def _shipped() -> dict[str, bytes]:
    folder = resources.files("gmr") / "data" / "actions"
    files = sorted(
        (file for file in folder.iterdir() if file.name.endswith(".toml")), key=lambda file: file.name
    )
    return {f"{_FOLDER}{file.name}": file.read_bytes() for file in files}


def _library(files: Mapping[str, bytes]) -> Library:
    content, anatomy = read_files(files), the_anatomy()
    for part in content.units.values():
        check_unit(part, content.units, anatomy)
    written = {
        name: (mirrored_contacts(unit), action_courses(unit, content.units, anatomy))
        for name, unit in content.actions.items()
    }
    # A user's file does not change how what ships varies.
    pool = Pool([one for one in written.values() if one[0].file.startswith(_FOLDER)])
    actions: dict[str, Action] = {
        name: SingleAction.of(unit, courses, anatomy, pool) for name, (unit, courses) in written.items()
    }
    for name, (origin, steps) in content.sequences.items():
        actions[name] = sequence_of(origin, steps, actions)
    return Library(actions, content.units, _aliases(content, actions))


def _aliases(content: Content, actions: Mapping[str, Action]) -> dict[str, str]:
    found: dict[str, str] = {}
    for name, action in actions.items():
        for alias in action.aliases:
            other = alias if alias in actions else found.get(alias)
            if other is not None:
                file = content.actions[name].file if name in content.actions else None
                raise FormatError(f"[action.{name}] aliases: '{alias}' means '{other}' already", file=file)
            found[alias] = name
    return found
