"""What JSON leaves open and no file needs: names that stand twice in an object, and words for no number.

Hooks for :func:`json.loads`; each refuses in words, as a ValueError.
"""

from __future__ import annotations

from typing import Any, NoReturn

from gmr.formats.text import named

__all__ = ["no_constant", "unique_object"]


def unique_object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object, none of whose names stands twice."""
    found = dict(pairs)
    if len(found) < len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise ValueError(f"{named(twice)} stands twice in an object")
    return found


def no_constant(word: str) -> NoReturn:
    """For NaN and Infinity, which Python reads and JSON does not know."""
    raise ValueError(f"{word} is no number")
