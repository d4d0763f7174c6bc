"""A folder for one command at a time."""

from __future__ import annotations

import json
import os
import secrets
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from gmr.errors import GmrError

__all__ = ["exclusive", "is_held"]

_NAME: Final = ".lock"


@contextmanager
def exclusive(folder: Path) -> Iterator[str]:
    """Keeps other commands out of a folder; the system lets go when the process ends, however it does.

    Yields:
        A word that only the holder's workers know: by it they see whether they see the same folder.

    Raises:
        GmrError: another command is in it; or the file system has no locks.
    """
    descriptor = _locked(folder)
    word = secrets.token_hex(16)
    try:
        holder = {"process": os.getpid(), "machine": socket.gethostname(), "word": word}
        os.ftruncate(descriptor, 0)
        os.write(descriptor, json.dumps(holder).encode())
        yield word
    finally:
        with suppress(OSError):
            (folder / _NAME).unlink()
        os.close(descriptor)


def is_held(folder: Path, word: str) -> bool:
    """Whether this folder is the one that the holder of the word holds."""
    try:
        return bool(json.loads((folder / _NAME).read_text())["word"] == word)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _locked(folder: Path) -> int:
    """The lock's file, open and locked."""
    import fcntl

    path = folder / _NAME
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(path, descriptor):
                return descriptor
        except BlockingIOError:
            raise GmrError(
                f"{folder}: {_holder(descriptor)} is writing into this folder; wait for it"
            ) from None
        except OSError as error:
            os.close(descriptor)
            raise GmrError(
                f"{path}: cannot be locked: {error.strerror}; choose another file system"
            ) from error
        os.close(descriptor)  # its holder removed it after we had opened it


def _is_at(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _holder(descriptor: int) -> str:
    with os.fdopen(descriptor) as file:
        try:
            holder = json.load(file)
            return f"process {holder['process']} on {holder['machine']}"
        except (ValueError, KeyError, TypeError):
            return "another process"
