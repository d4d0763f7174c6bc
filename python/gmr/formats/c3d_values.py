"""Parameters of a C3D file as ezc3d has read them: texts and numbers by group and name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

__all__ = ["Parameters", "number", "numbers", "parameters_of", "texts"]

Parameters = Mapping[str, Mapping[str, Any]]
"""Group -> name -> value, all in upper case; values are arrays of numbers or lists of strings."""


def parameters_of(found: Mapping[str, Any]) -> Parameters:
    """The parameters as ezc3d has them, without what it says of groups."""
    return {
        group.upper(): {key.upper(): held["value"] for key, held in keys.items() if "value" in held}
        for group, keys in found["parameters"].items()
    }


def texts(parameters: Parameters, group: str, key: str) -> list[str]:
    """The strings of a parameter and of those that continue it: LABELS, LABELS2, LABELS3, ..."""
    held = parameters.get(group, {})
    found, place = _strings(held.get(key)), 2
    while f"{key}{place}" in held:
        found += _strings(held[f"{key}{place}"])
        place += 1
    return found


def _strings(value: object) -> list[str]:
    """The strings of a value; none where it holds numbers. Bytes that are no UTF-8 are Latin-1."""
    return [_text(text) for text in value] if isinstance(value, list) else []


def _text(text: str) -> str:
    raw = text.encode("utf-8", "surrogateescape").split(b"\0")[0]
    try:
        return raw.decode().strip()
    except UnicodeDecodeError:
        return raw.decode("latin-1").strip()


def numbers(parameters: Parameters, group: str, key: str) -> list[float]:
    """The finite numbers of a value, the first dimension fastest; none where it holds text or one is not."""
    value = parameters.get(group, {}).get(key)
    if not isinstance(value, np.ndarray) or not np.isfinite(value).all():
        return []
    return [float(number) for number in value.ravel(order="F")]


def number(parameters: Parameters, key: str, default: float) -> float:
    """The first number of a parameter of the group POINT; the default where there is none."""
    return next(iter(numbers(parameters, "POINT", key)), default)
