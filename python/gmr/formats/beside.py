"""Files that another file names: opened only in its folder and below."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import Final

from gmr.formats.text import named

__all__ = ["NotBesideError", "read_beside"]

_MOST: Final = 1 << 31
"""Bytes of such a file at most."""


class NotBesideError(Exception):
    """The file cannot be had; says why, as the end of a sentence."""


def read_beside(folder: Path | None, path: str) -> bytes:
    """The bytes of a file.

    Args:
        folder: of the file that names it; None where it is from no folder.
        path: relative to that, as the file has it.

    Raises:
        NotBesideError: it is elsewhere, missing, or no file.
    """
    if folder is None:
        raise NotBesideError(f"in the file {named(path)}; read from a path, so that it can be found")
    if "\0" in path or not path or Path(path).is_absolute():
        raise NotBesideError(f"at {named(path)}; only files beside are read. Write a relative path")
    target = folder / path
    try:
        if not target.resolve().is_relative_to(folder.resolve()):
            raise NotBesideError(f"at {named(path)}, outside of the folder; put it beside the file")
        status = target.stat()
        if not stat.S_ISREG(status.st_mode) or status.st_size > _MOST:
            raise NotBesideError(f"at {named(path)}, which is no file, or one of more than 2 GB")
        return target.read_bytes()
    except OSError as error:
        why = error.strerror or str(error)
        raise NotBesideError(
            f"in the file {named(path)}, which cannot be read: {why}; put it there"
        ) from error
