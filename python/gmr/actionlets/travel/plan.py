"""What is asked of a travelling body: when each foot is on the ground, how fast it goes and how fast it
turns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.errors import ActionletError

__all__ = ["SIDES", "Plan", "Planned", "Stance", "Travel", "asked", "kinds", "stances"]

Floats = NDArray[np.float64]

SIDES = ("left", "right")

Travel: TypeAlias = str | Sequence[tuple[float, str]]
""" "path" or "feet", or (seconds, one of them) from then on, in time."""

_FRAME = 1e-6
"""Part of a frame by which a contact may miss a frame and still hold it."""


class Planned(Protocol):
    """Anything that tells contacts, speed, turn rate and the kind of travel, as a performance does."""

    @property
    def contacts(self) -> Mapping[str, NDArray[Any]]:
        """(n, 2) seconds by "left" and "right": from first to last touch of the ground."""

    @property
    def speed(self) -> NDArray[Any]:
        """(n, 2) time in seconds, metres a second forward."""

    @property
    def turn_rate(self) -> NDArray[Any]:
        """(n, 2) time in seconds, radians a second to the left."""

    @property
    def travel(self) -> Travel:
        """ "path" or "feet", or which of them from when on."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan by itself, without a performance.

    Args:
        contacts: (n, 2) seconds by "left" and "right".
        speed: (n, 2) time and metres a second; linear between the times, level before and after.
        turn_rate: (n, 2) time and radians a second to the left, in the same way.
        travel: "path": the root follows speed and turn rate; "feet": the planted feet carry it;
            or (seconds, one of these) from then on, in time.
    """

    contacts: Mapping[str, NDArray[Any]]
    speed: NDArray[Any]
    turn_rate: NDArray[Any]
    travel: Travel = "path"


@dataclass(frozen=True, slots=True)
class Stance:
    """A foot on the ground in the frames from ``first`` to ``last``, both of them."""

    leg: int
    """0 for the left, 1 for the right."""
    first: int
    last: int
    lands: bool
    """Whether the foot comes down here, not before the motion begins."""
    leaves: bool
    """Whether it goes up again before the motion ends."""

    @property
    def frames(self) -> slice:
        """The frames as a slice."""
        return slice(self.first, self.last + 1)


def stances(plan: Planned, frame_count: int, fps: float, start: float) -> tuple[Stance, ...]:
    """The stances of both feet in time; the frame 0 is at ``start`` seconds.

    Raises:
        ActionletError: a contact is not a pair of times, ends before it begins, overlaps the one before, or
            begins within two frames of its end.
    """
    unknown = set(plan.contacts) - set(SIDES)
    if unknown:
        raise ActionletError(f"contacts of {sorted(unknown)!r}: the feet are called 'left' and 'right'")
    found = [
        stance
        for leg, side in enumerate(SIDES)
        for stance in _of_foot(leg, side, plan.contacts.get(side, ()), frame_count, fps, start)
    ]
    return tuple(sorted(found, key=lambda stance: (stance.first, stance.leg)))


def kinds(travel: Travel) -> tuple[tuple[float, str], ...]:
    """(seconds, "path" or "feet") in time, from a kind of travel or from such rows.

    Raises:
        ActionletError: another kind, no row, or rows that are not in time.
    """
    rows = ((0.0, travel),) if isinstance(travel, str) else tuple(travel)
    for _, kind in rows:
        if kind not in ("path", "feet"):
            raise ActionletError(f"travel is {kind!r}; a body travels by 'path' or by 'feet'")
    if not rows or not all(one < other for (one, _), (other, _) in pairwise(rows)):
        raise ActionletError(
            f"travel is {travel!r}; give (seconds, 'path' or 'feet') rows in time, one at least"
        )
    return rows


def asked(profile: ArrayLike, times: Floats, what: str) -> Floats:
    """(F,) a profile of (time, value) at each time: linear between, level outside.

    Raises:
        ActionletError: it is not an (n, 2) table of numbers in time.
    """
    table = np.asarray(profile, np.float64)
    if table.ndim != 2 or table.shape[1] != 2 or not len(table):
        raise ActionletError(f"{what} has the shape {table.shape}; expected rows of (time in seconds, value)")
    if not np.isfinite(table).all() or (np.diff(table[:, 0]) < 0).any():
        raise ActionletError(
            f"{what} must be finite numbers with times that do not go back: {table.tolist()}"
        )
    return np.interp(times, table[:, 0], table[:, 1])


def _of_foot(
    leg: int, side: str, contacts: ArrayLike, frame_count: int, fps: float, start: float
) -> list[Stance]:
    table = np.asarray(contacts, np.float64).reshape(-1, 2) if np.size(contacts) else np.empty((0, 2))
    found: list[Stance] = []
    before = -np.inf
    for begin, end in table[np.argsort(table[:, 0], kind="stable")].tolist():
        if not (math.isfinite(begin) and math.isfinite(end) and begin < end):
            raise ActionletError(
                f"the {side} foot's contact ({begin}, {end}) must begin before it ends, in seconds"
            )
        if begin < before:
            raise ActionletError(
                f"the {side} foot's contact ({begin}, {end}) begins before the one before ends, at {before}; "
                "let it lift between them, or make one of them"
            )
        before = end
        first = math.ceil((begin - start) * fps - _FRAME)
        last = math.floor((end - start) * fps + _FRAME)
        if last < 0 or first > frame_count - 1 or last < first:
            continue
        lands, leaves = first > 0, last < frame_count - 1
        first, last = max(first, 0), min(last, frame_count - 1)
        if found and first - found[-1].last <= 2:
            one = found.pop()
            found.append(Stance(leg, one.first, last, one.lands, leaves))
        else:
            found.append(Stance(leg, first, last, lands, leaves))
    return found
