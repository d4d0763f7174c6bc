"""Text that is read line by line, comments left out, and knows for every line the number to blame."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from gmr.errors import FormatError
from gmr.formats.numerals import number, why_no_number
from gmr.formats.text import Text

__all__ = ["Line", "failure", "leading_comments", "lines_of", "numbers_of"]

_LINE = re.compile(rb"[^\r\n]+")
_COMMENT = re.compile(rb"\s*+#([^\r\n]*)")
_PADDING = b"\0\x1a \t"


class Line(NamedTuple):
    """A line that holds more than blanks and a comment."""

    at: int
    """The byte at which it begins."""
    words: list[bytes]
    """What stands between its blanks, up to a ``#``; at least one."""
    whole: bytes
    """The line as it is."""

    @property
    def keyword(self) -> str:
        """The first word in lower case."""
        return self.words[0].lower().decode(errors="replace")


def lines_of(text: Text) -> Iterator[Line]:
    """The lines from where ``text`` stands on; it is moved along with them.

    NUL bytes and the end-of-file mark, which some programs put after the last line, are no line.
    """
    while match := _LINE.search(text.data, text.at):
        text.at = match.end()
        words = match[0].partition(b"#")[0].split()
        if words and match[0].strip(_PADDING):
            yield Line(match.start(), words, match[0])
    text.at = len(text.data)


def leading_comments(text: Text) -> tuple[str, ...]:
    """The comments before anything else, each without its ``#``."""
    found = []
    while match := text.take_match(_COMMENT):
        found.append(match[1].decode(errors="replace").rstrip())
    return tuple(found)


def numbers_of(text: Text, line: Line, what: str, count: int) -> list[float]:
    """The ``count`` numbers after the first word of a line; what follows them is not looked at.

    Raises:
        FormatError: there are fewer, or one is none.
    """
    words = line.words[1 : count + 1]
    if len(words) < count:
        wanted = "it" if count == 1 else f"all {count}"
        raise failure(text, line, f"{what} has {len(words)} of {count} numbers. Write {wanted}.")
    found = []
    for word in words:
        value = number(word)
        if value is None:
            raise failure(text, line, f"{what}: {why_no_number(word)}")
        found.append(value)
    return found


def failure(text: Text, line: Line, what: str, expected: str | None = None) -> FormatError:
    """The error to raise for what is wrong in a line."""
    return text.failure(what, at=line.at, expected=expected)
