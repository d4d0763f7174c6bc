"""A file's bytes without reading them: the system brings in each page when it is looked at."""

from __future__ import annotations

import mmap
import stat
from pathlib import Path

__all__ = ["mapped"]


def mapped(path: Path) -> bytes | memoryview:
    """The bytes of a file, mapped into memory where that can be done, until nobody holds them any more.

    A file that is replaced (as gmr writes) stays what it was for those who hold it; one that somebody else
    cuts short meanwhile takes the process down with it, as any map does.

    Raises:
        OSError: the file cannot be opened.
    """
    with path.open("rb") as file:
        if not stat.S_ISREG(path.stat().st_mode) or not path.stat().st_size:
            return file.read()
        return memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
