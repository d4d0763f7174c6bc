"""A file appears whole or not at all: written beside its place under another name, then renamed."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

__all__ = ["replacing"]


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
        files: list[BinaryIO] = []
        for place in places:
            file = stack.enter_context(_beside(place))
            files.append(file)
        yield tuple(files)
        for file in files:
            file.flush()
            os.fsync(file.fileno())
        for file, place in zip(files, places, strict=True):
            _allow_as_usual(file)
            Path(file.name).replace(place)


@contextlib.contextmanager
def _beside(place: Path) -> Iterator[BinaryIO]:
    with tempfile.NamedTemporaryFile(dir=place.parent, prefix=f".{place.name}.", delete=False) as file:
        try:
            yield file  # type: ignore[misc]  # a wrapper of a binary file, which typeshed calls by another name
        finally:
            Path(file.name).unlink(missing_ok=True)


def _allow_as_usual(file: BinaryIO) -> None:
    """Give the permissions of an ordinary new file: a temporary one is for its owner's eyes only."""
    mask = os.umask(0)
    os.umask(mask)
    Path(file.name).chmod(0o666 & ~mask)
