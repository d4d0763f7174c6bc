"""Hostile files for tests: changed anywhere, cut anywhere; and how they may be received."""

from __future__ import annotations

import tracemalloc
import warnings
from collections.abc import Callable, Iterator, Sequence

from hypothesis import strategies as st

from gmr import FormatError, FormatWarning, Motion

LONGEST_MESSAGE = 1000

Change = tuple[int, int, bytes]
"""Where, how many bytes go, and what comes in their place."""


def refused_or_read(read: Callable[[], Motion], begins: str = "") -> Motion | None:
    """The motion, or None where it is refused in a sentence; anything else that is raised fails the test."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        try:
            return read()
        except FormatError as error:
            said = str(error)
    assert said.startswith(begins)
    assert len(said) < LONGEST_MESSAGE
    return None


def cut_anywhere(data: bytes, read: Callable[[bytes], Motion]) -> Iterator[tuple[Motion, bool]]:
    """What is read of the file cut after each byte, where it is not refused, and whether that is said."""
    for length in range(len(data)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                motion = read(data[:length])
            except FormatError:
                continue
        assert all(warning.category is FormatWarning for warning in caught)
        yield motion, bool(caught)


def changes(words: Sequence[bytes], *, least: int = 1, most: int = 4) -> st.SearchStrategy[list[Change]]:
    """Some changes, by any bytes or by words that mean something."""
    new = st.binary(max_size=8) | st.sampled_from(words)
    one = st.tuples(st.integers(0, 1 << 14), st.integers(0, 12), new)
    return st.lists(one, min_size=least, max_size=most)


def changed(data: bytes, some: Sequence[Change]) -> bytes:
    """The file with something else in a few places."""
    for at, length, new in some:
        place = at % (len(data) + 1)
        data = data[:place] + new + data[place + length :]
    return data


def overwritten(data: bytes, some: Sequence[Change]) -> bytes:
    """The file, as long as it was, with other bytes in a few places."""
    held = bytearray(data)
    for at, _, new in some:
        place = at % len(data)
        held[place : place + len(new)] = new[: len(data) - place]
    return bytes(held)


def peak_of(work: Callable[[], object]) -> int:
    """Bytes that were allocated at most."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
