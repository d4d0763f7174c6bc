"""A file appears whole or not at all: written beside its place under another name, then renamed."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

__all__ = ["replacing"]

_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)


@contextlib.contextmanager
def replacing(*paths: str | os.PathLike[str]) -> Iterator[tuple[BinaryIO, ...]]:
    """Open binary files that take the places of ``paths`` together, when the block ends without an error.

    Any error, an interrupt or a full disk among them, leaves every place as it was. The new files are in
    the folders of the old ones, for only inside one file system is a renaming never half done.

    Args:
        paths: the files to write; their folders exist.

    Yields:
        One file open for writing per path, in their order.

    Raises:
        OSError: a folder is missing or may not be written to, or the disk is full.
    """
    places = [Path(path) for path in paths]
    with contextlib.ExitStack() as stack:
        made = [stack.enter_context(_beside(place)) for place in places]
        yield tuple(file for _, file in made)
        for _, file in made:
            file.flush()
            os.fsync(file.fileno())
        for (path, _), place in zip(made, places, strict=True):
            path.replace(place)


@contextlib.contextmanager
def _beside(place: Path) -> Iterator[tuple[Path, BinaryIO]]:
    """A new file in the folder of ``place``; it goes when the block ends, unless it was renamed."""
    path, descriptor = _made_beside(place)
    with os.fdopen(descriptor, "wb") as file:
        try:
            yield path, file
        finally:
            path.unlink(missing_ok=True)


def _made_beside(place: Path) -> tuple[Path, int]:
    """A file under a name that nobody has, open for writing, with the permissions of any new file.

    The system takes the mask of the process from them. A module that makes temporary files gives them to
    their owner alone, and reading the mask in order to widen them means changing it for all threads.
    """
    while True:
        path = place.with_name(f".{place.name}.{secrets.token_hex(4)}")
        try:
            return path, os.open(path, _NEW, 0o666)
        except FileExistsError:
            continue
