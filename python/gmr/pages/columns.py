"""Tables as the page carries them: columns of base64 bytes, which a browser reads as typed arrays.

A column of text is a list of its different values and their numbers. Numbers of a table that is short are
exact; those of a long one, of which only a picture is drawn, are 16-bit steps from the least to the greatest.
"""

from __future__ import annotations

import base64
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from gmr.table import Table

__all__ = ["packed", "packed_array", "steps"]

_EXACT_ROWS: Final = 2000
_UNKNOWN: Final = 65535


def packed(table: Table, *, exact: bool = False) -> dict[str, Any]:
    """The table for the page's JSON: its length, and every column by name; ``exact`` however long it is."""
    exact = exact or len(table) <= _EXACT_ROWS
    return {
        "length": len(table),
        "columns": {name: _column(table[name], exact) for name in table.column_names},
    }


def packed_array(values: NDArray[Any]) -> dict[str, str]:
    """An array of numbers as little-endian bytes, flattened, with the name of their type."""
    little = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"), copy=False)
    return {"type": values.dtype.str[1:], "bytes": base64.b64encode(little.tobytes()).decode("ascii")}


def steps(values: NDArray[Any]) -> dict[str, Any]:
    """An array of real numbers in 65,535 even steps from its least to its greatest value, NaN kept."""
    known = np.isfinite(values)
    low = float(values[known].min()) if known.any() else 0.0
    high = float(values[known].max()) if known.any() else 0.0
    size = (high - low) / (_UNKNOWN - 1) or 1.0
    number = np.where(known, np.rint((np.where(known, values, low) - low) / size), _UNKNOWN)
    return {**packed_array(number.astype(np.uint16)), "low": low, "step": size}


def _column(values: NDArray[Any], exact: bool) -> dict[str, Any]:
    match values.dtype.kind:
        case "O":
            labels = list(dict.fromkeys(values.tolist()))
            number = {label: place for place, label in enumerate(labels)}
            codes = np.fromiter((number[label] for label in values.tolist()), np.int64, len(values))
            return {**packed_array(_smallest(codes)), "labels": labels}
        case "f" if not exact:
            return steps(values)
        case "f":
            return packed_array(values.astype(np.float64))
        case "b":
            return packed_array(values.astype(np.uint8))
        case _:
            return packed_array(_smallest(values))


def _smallest(values: NDArray[Any]) -> NDArray[Any]:
    """The values in the narrowest integer type that a browser has an array of and that holds them."""
    low, high = (int(values.min()), int(values.max())) if len(values) else (0, 0)
    for kind in (np.uint8, np.int16, np.uint16, np.int32):
        if np.iinfo(kind).min <= low and high <= np.iinfo(kind).max:
            return values.astype(kind)
    return values.astype(np.float64)
