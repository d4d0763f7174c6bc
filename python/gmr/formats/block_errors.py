"""What errors say of the blocks between braces in which text formats put their joints."""

from __future__ import annotations

from gmr.errors import FormatError
from gmr.formats.text import Text, shown

__all__ = ["no_offset", "unexpected_in_block"]


def no_offset(text: Text, title: str) -> FormatError:
    """The error for a block that ends without an OFFSET; ``title`` is the joint as errors call it."""
    what = f"{title} has no OFFSET. Write one, OFFSET 0 0 0 if it is where its parent is."
    return text.failure(what, expected="OFFSET")


def unexpected_in_block(text: Text, word: bytes, title: str, start: int, items: str) -> FormatError:
    """The error for a token that no block holds.

    Args:
        text: after the token.
        word: the token; b"" where the file ended.
        title: the joint as errors call it.
        start: the byte at which its block begins.
        items: what a block may hold, as part of a sentence.
    """
    where = f"{title}, which begins at line {text.line_of(start)}"
    match word.upper():
        case b"":
            what = f"the file ends inside {where}. It may be cut off: copy or export it again."
        case b"MOTION" | b"ROOT":
            what = f"{word.decode()} stands inside {where}. Write the closing brace '}}' that is missing."
        case b"{":
            what = f"there is a second '{{' in {where}. Remove it."
        case _:
            what = f"{shown(word)} stands inside {where}. Write {items} there."
    return text.failure(what, at=text.at - len(word), expected=items, column=True)
