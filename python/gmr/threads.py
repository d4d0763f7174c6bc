"""How many threads are asked for."""

from __future__ import annotations

import operator

__all__ = ["thread_count", "threads_for"]

_MOST = 4096
"""More than any machine has cores; work is never cut into so many pieces that more would help."""


_SHARING_PAYS = 1_000_000
"""Joints times frames above which sharing the work among threads wins over starting them."""


def threads_for(work: int, threads: int | None) -> int:
    """The number of threads, as the core takes it, for ``work`` joints times frames.

    Args:
        work: joints, or rotations, times frames.
        threads: as a user asks; None: one for little work, all cores for much.

    Raises:
        TypeError: it is no whole number.
        ValueError: it is below 0.
    """
    return thread_count(threads, 0 if work > _SHARING_PAYS else 1)


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
