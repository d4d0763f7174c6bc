"""Single decimal numbers in text, and what to do about tokens that are none."""

from __future__ import annotations

import math
import re

from gmr.formats.text import shown

__all__ = ["number", "why_no_number"]

_DECIMAL = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_COMMA = re.compile(rb"[+-]?\d*,\d+")


def number(token: bytes) -> float | None:
    """The finite number that ``token`` is, None where it is none."""
    if not _DECIMAL.fullmatch(token):
        return None
    found = float(token)
    return found if math.isfinite(found) else None


def why_no_number(token: bytes) -> str:
    """What is wrong with a token that should be a finite decimal number, and how to mend it."""
    lower = token.lower()
    if _DECIMAL.fullmatch(token):
        return f"{shown(token)} is too large for a 64-bit number. Correct it."
    if b"nan" in lower or b"#" in lower or b"inf" in lower:
        return (
            f"{shown(token)} stands for no number: the program that wrote the file had no value here. "
            "Fill the gap there, or write a number."
        )
    if _COMMA.fullmatch(token):
        with_point = shown(token.replace(b",", b"."))
        return f"{shown(token)} has a decimal comma. Write a point, {with_point}, here and everywhere."
    if b"," in token:
        return f"{shown(token)} is not a number. Part numbers by blanks, not by commas."
    if b"\0" in token:
        return "a NUL byte stands where a number should: the file is damaged. Export it again."
    return f"{shown(token)} is not a number. Write a decimal number."
