"""Three numbers in a row: the OFFSETs of text formats."""

from __future__ import annotations

import re
from collections.abc import Callable

from gmr.errors import FormatError
from gmr.formats.numerals import number, why_no_number
from gmr.formats.text import Text

__all__ = ["Vector", "take_vector"]

Vector = tuple[float, float, float]

_VECTOR = re.compile(rb"\s*+([^\s{}]++)\s++([^\s{}]++)\s++([^\s{}]++)")


def take_vector(text: Text, keyword: str, title: Callable[[], str], keywords: frozenset[bytes]) -> Vector:
    """Reads x, y and z after a keyword.

    Args:
        text: after the keyword.
        keyword: for errors.
        title: the joint as errors call it.
        keywords: words, in upper case, that stand for no number but for what follows: one is missing.

    Raises:
        FormatError: there are no three finite numbers.
    """
    start = text.at
    match = text.take_match(_VECTOR)
    if match is not None:
        x, y, z = (number(token) for token in match.groups())
        if x is not None and y is not None and z is not None:
            return x, y, z
    text.at = start
    raise _no_vector(text, keyword, title(), keywords)


def _no_vector(text: Text, keyword: str, title: str, keywords: frozenset[bytes]) -> FormatError:
    """The error for what stands where three numbers should."""
    for count in range(3):
        end = text.at
        word = text.take()
        if word in (b"", b"{", b"}") or word.upper() in keywords:
            what = f"{keyword} has {count} number{'s' * (count != 1)}. Write three: x, y and z."
            return text.failure(f"{title}: {what}", at=end, expected="three numbers")
        if number(word) is None:
            what = f"{title}, {keyword}: {why_no_number(word)}"
            return text.failure(what, at=text.at - len(word), expected="a number", column=True)
    raise AssertionError("three numbers are a vector")
