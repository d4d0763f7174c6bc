"""A motion database as bytes: other processes get the same bits from it, in searches and in trials."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gmr.matching.database import Database

__all__ = ["packed", "unpacked"]

_NAME = "database"


def packed(database: Database) -> bytes:
    """What :meth:`gmr.matching.Database.save` would write."""
    with TemporaryDirectory(prefix="gmr-") as folder:
        path = Path(folder, _NAME)
        database.save(path)
        return path.read_bytes()


def unpacked(content: bytes) -> Database:
    """The database of these bytes, mapped from a file that has no name any more.

    Raises:
        FormatError: they are no database.
    """
    from gmr.matching.database import Database

    # Where a mapped file cannot be removed, its folder is left to the system's own cleaning.
    with TemporaryDirectory(prefix="gmr-", ignore_cleanup_errors=True) as folder:
        path = Path(folder, _NAME)
        path.write_bytes(content)
        return Database.open(path)
