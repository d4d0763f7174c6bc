"""How many threads are asked for."""

from __future__ import annotations

import operator

__all__ = ["thread_count"]

_MOST = 4096
"""More than any machine has cores; work is never cut into so many pieces that more would help."""


def thread_count(threads: int | None, default: int = 0) -> int:
    """The number of threads as the core takes it, 0 for all cores; ``default`` for None.

    Raises:
        TypeError: it is no whole number.
        ValueError: it is below 0.
    """
    if threads is None:
        return default
    try:
        count = operator.index(threads)
    except TypeError:
        raise TypeError(f"threads must be a whole number, not {threads!r}") from None
    if count < 0:
        raise ValueError(f"there cannot be {count} threads; give 0 for all cores, or how many to use")
    return min(count, _MOST)
