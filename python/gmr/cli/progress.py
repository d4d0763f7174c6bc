"""Progress on stderr: one line a phase, kept up to date where a person watches."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Self

__all__ = ["Phases"]


class Phases:
    """Says what is being done, how far it has come, and how long it took.

    On a terminal the line of the running phase changes in place; in a file or a pipe each phase gives one
    line, when it is done.

    Args:
        quiet: say nothing.
    """

    def __init__(self, quiet: bool = False) -> None:
        self.current = "starting"
        self._quiet = quiet
        self._live = not quiet and sys.stderr.isatty()
        self._began = time.perf_counter()
        self._shown = 0.0
        self._open_line = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._open_line:
            sys.stderr.write("\n")
            self._open_line = False

    def tell(self, phase: str, done: int, of: int) -> None:
        """Say that ``done`` of ``of`` parts of a phase are done."""
        now = time.perf_counter()
        if phase != self.current:
            self.current, self._began = phase, now
        if self._quiet:
            return
        if done >= of:
            self._line(f"{phase}{_parts(of)}, {now - self._began:.2f} s", ended=True)
        elif self._live and (now - self._shown > 0.1 or done == 0):
            self._line(f"{phase} ... {f'{done} of {of}' if of > 1 else ''}", ended=False)
            self._shown = now

    def _line(self, text: str, *, ended: bool) -> None:
        rewind = "\r\x1b[K" if self._live else ""
        sys.stderr.write(f"{rewind}{text}{chr(10) if ended else ''}")
        sys.stderr.flush()
        self._open_line = not ended


def _parts(of: int) -> str:
    return f": {of}" if of > 1 else ""
