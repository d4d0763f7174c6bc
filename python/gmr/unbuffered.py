"""Files without a buffer take a part of what is written where a disk is nearly full, and raise nothing."""

from __future__ import annotations

import io
from typing import IO, Any

__all__ = ["Whole", "write_all"]


def write_all(file: IO[bytes] | io.RawIOBase, data: bytes | memoryview) -> None:
    """Write all of ``data``, in as many parts as the file takes it, or raise its error."""
    rest = memoryview(data)
    while rest:
        taken = file.write(rest)
        rest = rest[len(rest) if taken is None else taken :]


class Whole(io.BufferedIOBase):
    """A file without a buffer as one that takes all, at once; closing it leaves the other open."""

    def __init__(self, raw: io.RawIOBase) -> None:
        self._raw = raw

    def writable(self) -> bool:
        """It is."""
        return True

    def fileno(self) -> int:
        """The descriptor of the file."""
        return self._raw.fileno()

    def write(self, data: Any, /) -> int:
        """Write all of ``data``."""
        view = memoryview(data).cast("B")
        write_all(self._raw, view)
        return len(view)
