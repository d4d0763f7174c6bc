"""Sentences for a terminal: a headline, and a list of what stands behind it."""

from __future__ import annotations

import re
import shutil
import textwrap
from collections.abc import Iterable
from typing import Final

__all__ = ["listed_sentences", "paragraph"]

_WIDEST: Final = 100
_OPTION: Final = re.compile(r'(?<!\S)--[a-z-]+ (?:"[^"]*"|\S+)')
"""An option with its value, to be copied into a command: it stays on one line."""


def paragraph(text: str, *, first: str = "", then: str = "") -> list[str]:
    """The lines of a text, as wide as the terminal, no wider than 100; words and options stay whole.

    Args:
        text: to be wrapped.
        first: what its first line begins with.
        then: what the others begin with.
    """
    width = min(shutil.get_terminal_size((_WIDEST, 24)).columns, _WIDEST)
    whole = _OPTION.sub(lambda option: option[0].replace(" ", "\u00a0"), text)
    wrapper = textwrap.TextWrapper(
        width, initial_indent=first, subsequent_indent=then, break_on_hyphens=False, break_long_words=False
    )
    return [line.replace("\u00a0", " ") for line in wrapper.wrap(whole)]


def listed_sentences(sentences: Iterable[str]) -> list[str]:
    """The lines of a list of sentences."""
    return [line for sentence in sentences for line in paragraph(sentence, first="- ", then="  ")]
