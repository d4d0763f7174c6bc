"""Text that is read token by token, and knows for every token the line to blame."""

from __future__ import annotations

import codecs
import re
import warnings

from gmr.errors import FormatError, FormatWarning

__all__ = ["Text", "named", "shown"]

_TOKEN = re.compile(rb"\s*+([{}]|[^\s{}]+)")
_PHRASE = re.compile(rb"\s*+([^\r\n{}]*)")

_LONGEST_SHOWN = 60

_BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


class Text:
    """Bytes of a text file with a place at which reading goes on.

    Args:
        data: the file; UTF-8, or UTF-16 or UTF-32 with a byte order mark.
        name: what to call the file in errors.
        strict: oddities are errors instead of warnings.

    Raises:
        FormatError: the text is not what its byte order mark says.
    """

    def __init__(self, data: bytes, *, name: str | None = None, strict: bool = False) -> None:
        self.name = name
        self.strict = strict
        self.oddities = 0
        self._said: set[str] = set()
        self._said_latin = False
        self.data = self._utf8(data)
        self.at = len(codecs.BOM_UTF8) if data.startswith(codecs.BOM_UTF8) else 0

    def _utf8(self, data: bytes) -> bytes:
        for mark, encoding in _BYTE_ORDER_MARKS:
            if data.startswith(mark):
                try:
                    return data.decode(encoding).encode()
                except UnicodeError as error:
                    what = f"the file begins as {encoding.upper()} but is not: {error}. Save it as UTF-8."
                    raise FormatError(what, file=self.name) from error
        if data[1:2] == b"\0" or data[:1] == b"\0":
            what = (
                "NUL bytes where text should be: the file is UTF-16 without a byte order mark, or damaged. "
            )
            raise FormatError(what + "Save it as UTF-8.", file=self.name, line=1, column=1)
        return data

    def peek(self) -> bytes:
        """The next token without taking it: a brace, or what stands between blanks and braces; b"" at the
        end."""
        match = _TOKEN.match(self.data, self.at)
        return match[1] if match else b""

    def peek_at(self) -> int:
        """The byte at which the next token begins; the length of the text at the end."""
        match = _TOKEN.match(self.data, self.at)
        return match.start(1) if match else len(self.data)

    def take(self) -> bytes:
        """The next token; b"" at the end."""
        match = _TOKEN.match(self.data, self.at)
        if match is None:
            self.at = len(self.data)
            return b""
        self.at = match.end()
        return match[1]

    def take_phrase(self) -> bytes:
        """What stands before the next brace or line end after any blanks and line ends; may be empty."""
        match = _PHRASE.match(self.data, self.at)
        assert match is not None
        self.at = match.end()
        return match[1].rstrip()

    def take_match(self, pattern: re.Pattern[bytes]) -> re.Match[bytes] | None:
        """The match of ``pattern`` right here, else None."""
        match = pattern.match(self.data, self.at)
        if match is not None:
            self.at = match.end()
        return match

    def decoded(self, raw: bytes, what: str) -> str:
        """``raw`` as a string; bytes that are no UTF-8 are read as Latin-1, which is odd."""
        try:
            return raw.decode()
        except UnicodeDecodeError:
            if not self._said_latin:
                self._said_latin = True
                read = named(raw.decode("latin-1"))
                self.odd(f"{what} {read} is not written in UTF-8; read as Latin-1. Save the file as UTF-8.")
            return raw.decode("latin-1")

    def line_of(self, at: int) -> int:
        """1-based line of a byte."""
        new_lines, returns, both = (self.data.count(end, 0, at) for end in (b"\n", b"\r", b"\r\n"))
        return 1 + new_lines + returns - both

    def column_of(self, at: int) -> int:
        """1-based character of a byte in its line."""
        start = max(self.data.rfind(b"\n", 0, at), self.data.rfind(b"\r", 0, at)) + 1
        return len(self.data[start:at].decode(errors="replace")) + 1

    def failure(
        self, what: str, *, at: int | None = None, expected: str | None = None, column: bool = False
    ) -> FormatError:
        """The error to raise for what is wrong at byte ``at``, by default where the last token ends."""
        at = self.at if at is None else at
        return FormatError(
            what,
            file=self.name,
            line=self.line_of(at),
            column=self.column_of(at) if column else None,
            expected=expected,
        )

    def odd(self, what: str, *, at: int | None = None, kind: str | None = None) -> None:
        """Warns of something that is read all the same; under ``strict`` it is an error.

        Of many of one ``kind`` only the first is told.
        """
        self.oddities += 1
        if kind is not None:
            if kind in self._said:
                return
            self._said.add(kind)
        error = self.failure(what, at=at)
        if self.strict:
            raise error
        warnings.warn(FormatWarning(str(error)), stacklevel=4)


def shown(token: bytes) -> str:
    """A token in quotes as an error shows it."""
    # Four bytes make a character at most.
    return named(token[: 4 * _LONGEST_SHOWN + 4].decode(errors="replace"))


def named(name: str) -> str:
    """A name in quotes as an error shows it: what cannot be printed is escaped, the rest of a long one left
    out."""
    escaped = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in name[:_LONGEST_SHOWN])
    return f"'{escaped}'" if len(name) <= _LONGEST_SHOWN else f"'{escaped}...'"
