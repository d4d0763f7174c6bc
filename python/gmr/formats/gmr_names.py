"""Names of joints in a GMR file, and how one joint refers to another.

A name is a word, or a JSON string where it is none: empty, with blanks, braces, quotation marks or control
characters, or beginning with ``#``. A reference is a name that only one joint has, or ``#`` and the joint's
number.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence

from gmr.formats.text import Text, shown

__all__ = ["Reference", "spelled_name", "spelled_reference", "take_name", "take_reference"]

Reference = int | str
"""A joint by its number or by its name."""

_WORD = re.compile(r'[^\s{}"#\x00-\x1f\x7f][^\s{}\x00-\x1f\x7f]*')
_QUOTED = re.compile(rb'\s*+("(?:[^"\\\x00-\x1f\x7f]|\\[^\x00-\x1f\x7f])*+")(?=[\s{}]|\Z)')
_NUMBER = re.compile(rb"#(\d{1,9})")


def spelled_name(name: str) -> str:
    """The name as the file has it."""
    if _WORD.fullmatch(name) and name.isprintable():
        return name
    return json.dumps(name, ensure_ascii=not name.isprintable())


def spelled_reference(joint: int, names: Sequence[str], unique: frozenset[str]) -> str:
    """What refers to a joint, ``unique`` being the names that only one joint has."""
    return spelled_name(names[joint]) if names[joint] in unique else f"#{joint}"


def take_name(text: Text) -> str:
    """Reads a name.

    Raises:
        FormatError: there is none, or it is no UTF-8 or JSON string.
    """
    start = text.peek_at()
    match = text.take_match(_QUOTED)
    word = text.take() if match is None else match[1]
    try:
        if match is not None:
            return str(json.loads(word.decode()))
        if not word.startswith((b'"', b"{", b"}")) and word:
            return word.decode()
    except UnicodeDecodeError:
        what = f"the name {shown(word)} is no UTF-8. Save the file as UTF-8."
        raise text.failure(what, at=start, column=True) from None
    except json.JSONDecodeError as error:
        what = f"the name {shown(word)} is no JSON string: {error.msg}. Escape what must be."
        raise text.failure(what, at=start, column=True) from None
    found = shown(word) if word else "the end of the file"
    what = f"{found} stands where a name should. Write a word, or a JSON string on one line."
    raise text.failure(what, at=start, expected="a name", column=True)


def take_reference(text: Text) -> Reference:
    """Reads a reference, to whichever joint.

    Raises:
        FormatError: there is none.
    """
    start = text.peek_at()
    word = text.peek()
    if not word.startswith(b"#"):
        return take_name(text)
    text.take()
    match = _NUMBER.fullmatch(word)
    if match is None:
        what = f"{shown(word)} refers to no joint. Write '#' and its number, or its name."
        raise text.failure(what, at=start, expected="a joint", column=True)
    return int(match[1])
