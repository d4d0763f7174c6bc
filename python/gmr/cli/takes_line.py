"""How far a corpus is: a line on stderr, kept up to date."""

from __future__ import annotations

import math
import sys
import time
from types import TracebackType
from typing import Self

__all__ = ["TakesLine"]

_SHOWN_EVERY = 0.1
_LOGGED_EVERY = 30.0


class TakesLine:
    """Says how many takes there are, how fast they come, and how long it will take.

    On a terminal the line changes in place; in a file or a pipe there is one every half minute.

    Args:
        label: what it begins with.
        quiet: say nothing.
    """

    def __init__(self, label: str, quiet: bool = False) -> None:
        self._label = label
        self._quiet = quiet
        self._live = not quiet and sys.stderr.isatty()
        self._began = self._shown = time.perf_counter()
        self._there = -1
        self._open = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._open:
            sys.stderr.write("\n")

    def tell(self, done: int, of: int, seconds: float) -> None:
        """Say that ``done`` of ``of`` takes are there, ``seconds`` of motion made since the first call."""
        now = time.perf_counter()
        if self._there < 0:
            self._there, self._began = done, now
        due = now - self._shown > (_SHOWN_EVERY if self._live else _LOGGED_EVERY)
        if self._quiet or not (due or (self._live and done >= of)):
            return
        self._shown = now
        text = f"{self._label}: {done:,} of {of:,} takes{self._speed(done, of, seconds, now - self._began)}"
        sys.stderr.write(f"\r\x1b[K{text}" if self._live else f"{text}\n")
        sys.stderr.flush()
        self._open = self._live

    def _speed(self, done: int, of: int, seconds: float, elapsed: float) -> str:
        made = done - self._there
        if not made or not elapsed:
            return ""
        left = duration((of - done) * elapsed / made)
        return f", {speed(made, seconds, elapsed)}, {left} left"


def speed(takes: int, seconds: float, elapsed: float) -> str:
    """Takes a second and how many times faster than real time, in words."""
    return f"{takes / elapsed:.3g} takes/s, {seconds / elapsed:.3g}x real time"


def duration(seconds: float) -> str:
    """A time in words: "12 s", "3 min 05 s", "2 h 40 min"."""
    whole = math.ceil(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
