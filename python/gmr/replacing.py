"""A file appears whole or not at all: written beside its place under another name, then renamed."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

__all__ = ["check_place", "replacing"]

_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)


@contextlib.contextmanager
def replacing(*paths: str | os.PathLike[str]) -> Iterator[tuple[BinaryIO, ...]]:
    """Open binary files that take the places of ``paths`` together, when the block ends without an error.

    Any error, an interrupt or a full disk among them, leaves every place as it was. The new files are in
    the folders of the old ones, for only inside one file system is a renaming never half done. Where a link
    stands, the file that it leads to is replaced. What is no file, a device or a pipe, stays and is written
    to as it is. A file that is replaced is not lost when the power fails either: its successor is on the disk
    before. A new one, with nothing to lose, is not waited for.

    Args:
        paths: the files to write; their folders exist.

    Yields:
        One file open for writing per path, in their order.

    Raises:
        OSError: a folder is missing or may not be written to, or the disk is full.
    """
    with contextlib.ExitStack() as stack:
        made = [stack.enter_context(_opened(path)) for path in paths]
        yield tuple(file for file, _, _ in made)
        for file, path, place in made:
            file.flush()
            if path is not None and place.exists():
                os.fsync(file.fileno())
            file.close()
        for _, path, place in made:
            if path is not None:
                path.replace(place)


def check_place(path: str | os.PathLike[str]) -> None:
    """Find out before long work whether a file can be made at ``path``; nothing is made or changed.

    Folders that are still missing are taken for such that will be made.

    Raises:
        OSError: what making the file would end in.
    """
    place = Path(os.path.realpath(path))
    if _is_special(path):
        return
    folder = place.parent
    while not folder.exists():
        folder = folder.parent
    made, descriptor = _made_beside(folder / place.name)
    os.close(descriptor)
    made.unlink()


@contextlib.contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[tuple[BinaryIO, Path | None, Path]]:
    """A file to write to, the path under which it waits to be renamed (None: it is written in its place)."""
    place = Path(os.path.realpath(path))
    if _is_special(path):
        # By the name that was given: that of an open pipe leads to no path.
        with Path(path).open("wb") as file:
            yield file, None, place
        return
    with _beside(place) as (beside, file):
        yield file, beside, place


def _is_special(path: str | os.PathLike[str]) -> bool:
    """Whether there is something that is neither a file nor a folder."""
    try:
        mode = Path(path).stat().st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


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
