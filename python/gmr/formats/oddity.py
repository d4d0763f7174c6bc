"""What is odd about a file: warned of, or an error where strict."""

from __future__ import annotations

import warnings

from gmr.errors import FormatError, FormatWarning

__all__ = ["say"]


def say(what: str, file: str | None, strict: bool) -> None:
    """Warns of something that is read all the same.

    Raises:
        FormatError: ``strict``.
    """
    error = FormatError(f"{what}.", file=file)
    if strict:
        raise error
    warnings.warn(FormatWarning(str(error)), stacklevel=3)
