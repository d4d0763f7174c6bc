"""Tables into files: all of them, or none."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from gmr.replacing import replacing
from gmr.table import FORMATS, Table

__all__ = ["write_tables"]


def write_tables(
    tables: Mapping[str, Table], folder: str | os.PathLike[str], formats: Sequence[str] = ("csv",)
) -> tuple[Path, ...]:
    """Write every table into a folder, in every format: all of the files, or none of them.

    Args:
        tables: by the name of their file.
        folder: where to; made where it is missing.
        formats: of "csv", "json" and "parquet".

    Returns:
        The files written.

    Raises:
        ValueError: an unknown format.
        MissingExtraError: Parquet is asked for and pyarrow is not installed.
        OSError: the folder may not be written to, or the disk is full.
    """
    if unknown := sorted(set(formats) - set(FORMATS)):
        raise ValueError(f"unknown table format {unknown[0]!r}; known are {', '.join(FORMATS)}")
    made_here = not Path(folder).exists()
    Path(folder).mkdir(parents=True, exist_ok=True)
    files = [
        (Path(folder) / f"{name}.{suffix}", table, FORMATS[suffix])
        for suffix in formats
        for name, table in tables.items()
    ]
    try:
        with replacing(*(path for path, _, _ in files)) as opened:
            for file, (_, table, write) in zip(opened, files, strict=True):
                write(table, file)
    except BaseException:
        if made_here:
            with contextlib.suppress(OSError):
                Path(folder).rmdir()
        raise
    return tuple(path for path, _, _ in files)
