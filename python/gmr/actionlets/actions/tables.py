"""A table of a library file that knows its place: every reading of a key says what it expected and found."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from gmr.actionlets.actions.units import Extreme
from gmr.actionlets.actions.values import Curve, Value
from gmr.errors import FormatError

__all__ = ["Table", "nearest"]

_HALF = Value(0.5)

_GREATEST = 1e6
"""No number of a library is further from 0: what is made of them stays finite, and of a size."""

_NUMBER = "a number from -1e6 to 1e6"


def nearest(name: str, known: Iterable[str]) -> str:
    """A sentence that offers the names most like ``name``, or all where none is like it."""
    names = list(known)
    near = difflib.get_close_matches(name, names, n=2, cutoff=0.5)
    if near:
        return f"Did you mean {' or '.join(near)}?"
    return f"There are {', '.join(names)}." if names else "There are none."


@dataclass(frozen=True, slots=True)
class Table:
    """A TOML table, the file that it is in, and its place there as one would look for it."""

    file: str
    place: str
    held: Mapping[str, Any]

    def fault(self, key: str, value: Any, expected: str) -> FormatError:
        """The error of a key whose value is not what was expected."""
        return FormatError(
            f"[{self.place}] {key} = {_shown(value)}: expected {expected}",
            file=self.file,
            expected=expected,
        )

    def check_keys(self, known: Iterable[str]) -> None:
        """Refuses keys that mean nothing here."""
        names = list(known)
        for key in self.held:
            if key not in names:
                raise FormatError(f"[{self.place}] has no key '{key}'. {nearest(key, names)}", file=self.file)

    def table(self, key: str) -> Table:
        """The table below ``key``, empty where there is none."""
        value = self.held.get(key, {})
        if not isinstance(value, dict):
            raise self.fault(key, value, "a table")
        return Table(self.file, f"{self.place}.{key}", value)

    def tables(self) -> dict[str, Table]:
        """All that is below, each of which must be a table."""
        return {key: self.table(key) for key in self.held}

    def text(self, key: str, default: str | None = None) -> str:
        """A text; an error where there is none and no default."""
        value = self.held.get(key, default)
        if not isinstance(value, str):
            raise self.fault(key, value, "a text in quotes")
        return value

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts, empty where there is none."""
        value = self.held.get(key, [])
        if not isinstance(value, list) or not all(isinstance(text, str) for text in value):
            raise self.fault(key, value, "a list of texts in quotes")
        return tuple(value)

    def flag(self, key: str) -> bool:
        """true or false; false where there is none."""
        value = self.held.get(key, False)
        if not isinstance(value, bool):
            raise self.fault(key, value, "true or false")
        return value

    def choice(self, key: str, among: Iterable[str], default: str | None = None) -> str:
        """One of some words."""
        names = list(among)
        value = self.held.get(key, default)
        if value not in names:
            raise self.fault(key, value, f"one of {', '.join(names)}")
        return str(value)

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number; an error where there is none and no default."""
        value = self.held.get(key, default)
        if not _is_number(value):
            raise self.fault(key, value, _NUMBER)
        return float(value)

    def value(self, key: str, default: float | None = None) -> Value:
        """A number, or curves over parameters."""
        held = self.held.get(key, default)
        return self.as_value(key, held)

    def as_value(self, key: str, held: Any) -> Value:
        """``held``, found at ``key``, as a number or curves over parameters."""
        if _is_number(held):
            return Value(float(held))
        if not isinstance(held, dict) or not held:
            raise self.fault(
                key, held, f"{_NUMBER}, or {{ speed = [[0.5, 18], [1.4, 25]] }} with a parameter's name"
            )
        base = held.get("base", 0.0)
        if not _is_number(base):
            raise self.fault(f"{key}.base", base, _NUMBER)
        curves = [
            self._curve(f"{key}.{name}", name, points) for name, points in held.items() if name != "base"
        ]
        return Value(float(base), tuple(curves))

    def _curve(self, key: str, parameter: str, points: Any) -> Curve:
        if not isinstance(points, list) or len(points) < 2 or not all(_is_row(row, 2) for row in points):
            raise self.fault(key, points, f"two points or more, each [{parameter}, value]")
        at, gives = zip(*((float(x), float(y)) for x, y in points), strict=True)
        for before, after in pairwise(at):
            if not before < after:
                raise self.fault(
                    key, points, f"points with {parameter} rising; {after:g} comes after {before:g}"
                )
        return Curve(parameter, at, gives)

    def pairs(self, key: str) -> tuple[tuple[float, float], ...]:
        """Rows of two numbers."""
        rows = self.held.get(key, [])
        if not isinstance(rows, list) or not all(_is_row(row, 2) for row in rows):
            raise self.fault(key, rows, "rows of two numbers, [[0.0, 0], [1.5, 1]]")
        return tuple((float(first), float(second)) for first, second in rows)

    def span(self, key: str, held: Any) -> tuple[Value, Value]:
        """[begin, end]: two phases, the first before the second and less than a whole before it."""
        if not isinstance(held, list) or len(held) != 2:
            raise self.fault(key, held, "two phases, [begin, end]")
        begin, end = self.as_value(key, held[0]), self.as_value(key, held[1])
        if not begin.lowest <= end.highest:
            raise self.fault(key, held, "a begin before the end (an end may be above 1: [0.5, 1.1])")
        return begin, end

    def spans(self, key: str) -> tuple[tuple[Value, Value], ...]:
        """A list of [begin, end]."""
        rows = self.held.get(key, [])
        if not isinstance(rows, list):
            raise self.fault(key, rows, "a list of phases, [[begin, end]]")
        return tuple(self.span(f"{key}[{number}]", row) for number, row in enumerate(rows))

    def extremes(self, key: str) -> tuple[Extreme, ...]:
        """A list of [phase, angle] or [phase, angle, skew], by phase; or one angle that is held."""
        rows = self.held.get(key)
        if not isinstance(rows, list):
            return (Extreme(Value(0.0), self.as_value(key, rows), _HALF),)
        if not rows:
            raise self.fault(key, rows, "one row or more, each [phase, angle] or [phase, angle, skew]")
        found = [self._extreme(f"{key}[{number}]", row) for number, row in enumerate(rows)]
        for number, (one, other) in enumerate(pairwise(found)):
            if not (one.phase.lowest < other.phase.lowest and one.phase.highest < other.phase.highest):
                raise self.fault(
                    f"{key}[{number + 1}]", rows[number + 1],
                    f"phases that rise; the row before it has {_shown(rows[number][0])}, "
                    "and an actionlet must last",
                )  # fmt: skip
        return tuple(found)

    def _extreme(self, key: str, row: Any) -> Extreme:
        if not isinstance(row, list) or len(row) not in (2, 3):
            raise self.fault(key, row, "[phase, angle] or [phase, angle, skew]")
        phase = self.as_value(f"{key} phase", row[0])
        if not (phase.lowest >= 0 and phase.highest <= 1):
            raise self.fault(f"{key} phase", row[0], "a phase from 0 to 1")
        skew = self.as_value(f"{key} skew", row[2]) if len(row) == 3 else _HALF
        if not (skew.lowest > 0 and skew.highest < 1):
            raise self.fault(f"{key} skew", row[2], "a skew above 0 and below 1")
        return Extreme(phase, self.as_value(f"{key} angle", row[1]), skew)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= _GREATEST


def _is_row(row: Any, length: int) -> bool:
    return isinstance(row, list) and len(row) == length and all(map(_is_number, row))


def _shown(value: Any) -> str:
    if value is None:
        return "(nothing)"
    text = repr(value) if not isinstance(value, bool) else str(value).lower()
    return text if len(text) <= 60 else f"{text[:57]}..."
