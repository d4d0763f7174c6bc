"""What a value of a take may be: one, any of a range, or each of several in turn; and how it is drawn.

Written as ``1.2``, ``0.8..1.6``, ``0.8,1.2,1.6`` or ``0.8:1.6:0.4`` (first, last, step; as the list before).
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from typing import Final, TypeAlias

from gmr.errors import GmrError

__all__ = ["Choice", "Drawn", "Each", "Fixed", "Value", "choice", "seed_of", "share_of"]

Value: TypeAlias = float | str

_MOST_IN_TURN: Final = 10_000


@dataclass(frozen=True, slots=True)
class Fixed:
    """Always the same value."""

    value: Value

    def __str__(self) -> str:
        return _written(self.value)

    @property
    def values(self) -> tuple[Value, ...]:
        """The value, alone."""
        return (self.value,)


@dataclass(frozen=True, slots=True)
class Drawn:
    """Any value from ``low`` to ``high``, all as likely."""

    low: float
    high: float

    def __str__(self) -> str:
        return f"{_written(self.low)}..{_written(self.high)}"

    @property
    def values(self) -> tuple[Value, ...]:
        """The ends."""
        return (self.low, self.high)

    def at(self, share: float) -> float:
        """The value at a share in [0, 1) of the way."""
        return min(self.low + share * (self.high - self.low), self.high)


@dataclass(frozen=True, slots=True)
class Each:
    """Each of these values in turn."""

    values: tuple[Value, ...]

    def __str__(self) -> str:
        return ",".join(map(_written, self.values))


Choice: TypeAlias = Fixed | Drawn | Each


def choice(text: str, what: str) -> Choice:
    """The choice that a text means.

    Args:
        text: as the module says; what is no number is a name.
        what: the thing that is chosen, for the error.

    Raises:
        GmrError: it means none.
    """
    if ".." in text:
        ends = [_number(part, text, what) for part in text.split("..")]
        if len(ends) != 2 or ends[0] > ends[1]:
            raise GmrError(
                f"{what}: '{text}' is no range; write the lower end, two dots and the upper: 0.8..1.6"
            )
        return Drawn(*ends) if ends[0] < ends[1] else Fixed(ends[0])
    if ":" in text:
        return _in_steps([_number(part, text, what) for part in text.split(":")], text, what)
    values = tuple(_value(part.strip(), text, what) for part in text.split(","))
    if len(set(values)) < len(values):
        raise GmrError(f"{what}: '{text}' names a value twice; name each once")
    return Fixed(values[0]) if len(values) == 1 else Each(values)


def share_of(seed: int, *names: str | int) -> float:
    """A number in [0, 1), as likely here as there, that depends on the seed and the names alone.

    A hash is asked and not a generator, so that no draw depends on which others there were before, on which
    machine, or with which version of a library.
    """
    return (_hashed(seed, names) >> 11) * 2.0**-53


def seed_of(seed: int, *names: str | int) -> int:
    """A seed below 2^63, likewise."""
    return _hashed(seed, names) >> 1


def _hashed(seed: int, names: tuple[str | int, ...]) -> int:
    text = "/".join(map(str, (seed, *names)))
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little")


def _in_steps(parts: list[float], text: str, what: str) -> Choice:
    """First, last and step, both ends included."""
    if len(parts) == 3 and parts[2] > 0:
        first, last, step = parts
        count = (last - first) / step
        if 0 <= count < _MOST_IN_TURN:
            steps = range(math.floor(count + 1e-9) + 1)
            values = tuple(round(first + k * step, 9) for k in steps)
            return Fixed(values[0]) if len(values) == 1 else Each(values)
    raise GmrError(
        f"{what}: '{text}' is no list of at most {_MOST_IN_TURN:,} steps; write the first value, the last "
        "and a step above 0: 0.8:1.6:0.2"
    )


def _number(part: str, text: str, what: str) -> float:
    try:
        value = float(part)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise GmrError(f"{what}: '{part}' in '{text}' is no number")
    return value


def _value(part: str, text: str, what: str) -> Value:
    if not part:
        raise GmrError(f"{what}: a value is missing in '{text}'")
    try:
        value = float(part)
    except ValueError:
        return part
    if not math.isfinite(value):
        raise GmrError(f"{what}: '{part}' in '{text}' is no number that can be used")
    return value


def _written(value: Value) -> str:
    return value if isinstance(value, str) else repr(value).removesuffix(".0")
