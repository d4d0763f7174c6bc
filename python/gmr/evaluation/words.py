"""Figures in plain English: lists, plurals, spans, and what a turn rate means to someone who walks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

__all__ = [
    "GAITS",
    "STANDS",
    "beyond",
    "capital",
    "circles",
    "count",
    "duration",
    "ends",
    "gait_of",
    "going",
    "hold",
    "listing",
    "number",
    "percent",
    "some_of",
    "span",
    "switching",
    "turning",
]

FASTEST_WALK: Final = 1.75
SLOWEST_RUN: Final = 2.25
"""Metres per second: people change from walking to running at about 2 m/s."""

STANDS: Final = 0.1
"""Metres per second below which a body is said to stand."""

GAITS: Final = ("a walk", "a jog", "a run")


def listing(parts: Sequence[str]) -> str:
    """Join as "a", "a and b", "a, b and c"."""
    return " and ".join(part for part in (", ".join(parts[:-1]), *parts[-1:]) if part)


def some_of(names: Sequence[str], most: int) -> str:
    """List the first ``most`` names and count the others."""
    if len(names) <= most:
        return listing(names)
    return listing([*names[:most], f"{len(names) - most} more"])


def count(number: int, thing: str, things: str | None = None) -> str:
    """Count things in the right number: "no clips", "1 clip", "2 clips"."""
    return f"{number or 'no':{',' if number else ''}} {thing if number == 1 else things or f'{thing}s'}"


def number(value: float) -> str:
    """Two digits that matter, and never an exponent: "0.034", "1.2", "12", "340"."""
    if abs(value) >= 10:
        return f"{value:.0f}"
    return _plain(value, 2)


def beyond(value: float, limit: float) -> str:
    """A number that is larger than a limit, with as many digits as show it: 0.501 beyond 0.5 as "0.501"."""
    told = number(value)
    digits = 2
    while value > limit and not float(told) > limit and digits < 9:
        digits += 1
        told = _plain(value, digits)
    return told


def _plain(value: float, digits: int) -> str:
    """So many digits that matter, without an exponent."""
    return f"{float(f'{value:.{digits}g}'):.10f}".rstrip("0").rstrip(".")


def capital(sentence: str) -> str:
    """A sentence with a capital at its beginning; the rest as it is."""
    return f"{sentence[:1].upper()}{sentence[1:]}"


def hold(trials: int) -> str:
    """The verb behind a number of trials: 1 holds, others hold."""
    return "holds" if trials == 1 else "hold"


def percent(share: float) -> str:
    """A share of 1 in whole per cent, "under 1%" where it is less."""
    if 0 < share < 0.01:
        return "under 1%"
    return f"{100 * share:.0f}%"


def duration(seconds: float) -> str:
    """A time span, in minutes from two of them on."""
    if seconds >= 120:
        return f"{number(seconds / 60)} minutes"
    if round(seconds, 1) in (0, 1):
        return "1 second" if seconds > 0.5 else "0 seconds"
    return f"{seconds:.0f} seconds" if seconds >= 9.95 else f"{round(seconds, 1):g} seconds"


def span(low: float, high: float, unit: str) -> str:
    """A range of figures with its unit, or the one figure that it is."""
    return f"{ends(low, high)} {unit}"


def ends(low: float, high: float) -> str:
    """A range of figures, or the one figure that it is."""
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def switching(speed: float, every: float) -> str:
    """What trials do that go on at another speed every so many seconds, beside what else they do."""
    return f"switching to {speed:g} m/s and back every {every:g} s"


def turning(low_deg: float, high_deg: float) -> str:
    """In words what turn rates from ``low_deg`` to ``high_deg`` (positive to the left) let a character do."""
    if low_deg == high_deg == 0:
        return "going straight"
    if low_deg > 0:
        return f"turning left by {span(low_deg, high_deg, 'degrees/s')}"
    if high_deg < 0:
        return f"turning right by {span(-high_deg, -low_deg, 'degrees/s')}"
    if low_deg == -high_deg:
        return f"going straight and turning up to {high_deg:g} degrees/s either way"
    sides = [
        f"{rate:g} degrees/s to the {side}"
        for rate, side in ((high_deg, "left"), (-low_deg, "right"))
        if rate
    ]
    return f"going straight and turning up to {listing(sides)}"


def going(speed: float, turn_rate_deg: float) -> str:
    """A movement as the rest of a sentence: "going straight at 1.4 m/s", "standing"."""
    if speed >= STANDS:
        return f"{turning(turn_rate_deg, turn_rate_deg)} at {speed:.3g} m/s"
    return f"{turning(turn_rate_deg, turn_rate_deg)} on the spot" if turn_rate_deg else "standing"


def gait_of(speed: float) -> str:
    """What people do at a speed in metres per second: one of ``GAITS``."""
    return GAITS[(speed > FASTEST_WALK) + (speed >= SLOWEST_RUN)]


def circles(smallest: float, largest: float) -> str:
    """The circles to walk, from their radii in metres."""
    if number(smallest) == number(largest):
        return f"circles of {number(smallest)} m radius"
    return f"circles of {number(smallest)} to {number(largest)} m radius"
