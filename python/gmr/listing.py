"""Names in a sentence: the first few, and a count of the rest, for a file may have a hundred thousand."""

from __future__ import annotations

from collections.abc import Collection
from itertools import islice

__all__ = ["listed", "quoted"]


def listed(names: Collection[str], limit: int) -> str:
    """The first ``limit`` names, the rest as a count: "a, b and 3 more"."""
    return _counted(list(islice(names, limit)), len(names))


def quoted(names: Collection[str], limit: int) -> str:
    """The same with each name in quotes: "'a', 'b' and 3 more"."""
    return _counted([f"'{name}'" for name in islice(names, limit)], len(names))


def _counted(shown: list[str], count: int) -> str:
    more = f" and {count - len(shown)} more" if count > len(shown) else ""
    return ", ".join(shown) + more
