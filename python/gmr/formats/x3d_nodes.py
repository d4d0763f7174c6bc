"""Elements of an X3D file."""

from __future__ import annotations

import re
from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from gmr import _core

__all__ = ["closed", "element", "numbers", "opened", "rotation"]

Floats = NDArray[np.float64]

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no way to say (production 2, Char)."""
_LENGTH_DECIMALS, _TURN_DECIMALS = 6, 7
"""Micrometres; and what a number of single precision, which X3D's fields hold, can tell apart near 1."""


def element(tag: str, /, **fields: str | float | Floats | None) -> str:
    """``<tag field="value"/>``; a field that is None is left out, ``def_`` is ``DEF``, ``use`` is ``USE``."""
    return f"<{tag}{_fields(fields)}/>"


def opened(tag: str, /, **fields: str | float | Floats | None) -> str:
    """``<tag field="value">``."""
    return f"<{tag}{_fields(fields)}>"


def closed(tag: str) -> str:
    """``</tag>``."""
    return f"</{tag}>"


def _fields(fields: dict[str, str | float | Floats | None]) -> str:
    names = {"def_": "DEF", "use": "USE", "global_": "global"}
    said = {names.get(name, name): _value(value) for name, value in fields.items() if value is not None}
    return "".join(f" {name}={quoteattr(value)}" for name, value in said.items())


def _value(value: str | float | Floats) -> str:
    if isinstance(value, str):
        return _NO_XML.sub("\ufffd", value)
    return " ".join(numbers(np.atleast_1d(value)[None]).decode().split())


def numbers(rows: Iterable[Floats] | Floats, decimals: int = _LENGTH_DECIMALS) -> bytes:
    """(n, k) numbers, a row a line: rounded, in the shortest decimals that say so."""
    rounded = np.round(np.asarray(rows, np.float64), decimals) + 0.0  # no negative zero
    return _core.format_rows(np.ascontiguousarray(rounded))


def rotation(turns: Floats) -> bytes:
    """(n, 4) quaternions as X3D says turns, axis and radians, a turn a line."""
    short = turns * np.where(turns[:, 3:] < 0, -1.0, 1.0)
    size = np.linalg.norm(short[:, :3], axis=1)
    axes = np.where(size[:, None] > 0, short[:, :3] / np.where(size > 0, size, 1.0)[:, None], [0.0, 0.0, 1.0])
    return numbers(np.column_stack([axes, 2 * np.arctan2(size, short[:, 3])]), _TURN_DECIMALS)
