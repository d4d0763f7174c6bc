"""The actionlet: one cycle of acceleration and deceleration of one degree of freedom.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 2, Eq. 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.bell import bell, bell_slope, share
from gmr.errors import ActionletError

__all__ = ["SYMMETRIC", "Actionlet", "checked_duration", "checked_number", "on_the_way"]

Floats = NDArray[np.float64]

SYMMETRIC = 0.5
"""The skew of a bell whose two halves are alike."""


@dataclass(frozen=True, slots=True)
class Actionlet:
    """One movement of one degree of freedom, at rest at both ends: ``start + (end - start) s(t / duration)``.

    Args:
        start: angle where it begins, in radians.
        end: angle where it ends, in radians; the same as ``start``: a silence.
        duration: seconds, above 0.
        skew: T, the share of the duration after which it is fastest; above 0 and below 1.

    Raises:
        ActionletError: one of them is no finite number, or out of its range.

    Source: Zheng et al., "Human Motion Simulation and Action Corpus", Eq. 1, integrated in closed form.
    """

    start: float
    end: float
    duration: float
    skew: float = SYMMETRIC

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            value = checked_number(getattr(self, name), f"an actionlet's {name}", "give an angle in radians")
            object.__setattr__(self, name, value)
        object.__setattr__(self, "duration", checked_duration(self.duration, "an actionlet"))
        skew = checked_number(self.skew, "an actionlet's skew", "give a number between 0 and 1")
        if not 0 < skew < 1:
            raise ActionletError(
                f"an actionlet's skew T is {skew:g}; it is fastest after the share T of its duration,"
                " so T lies above 0 and below 1 (0.5: symmetric)"
            )
        object.__setattr__(self, "skew", skew)

    @classmethod
    def silence(cls, angle: float, duration: float) -> Actionlet:
        """``angle`` (radians) held for ``duration`` seconds: a static period."""
        return cls(angle, angle, duration)

    @property
    def travel(self) -> float:
        """``end - start``, in radians."""
        return self.end - self.start

    @property
    def is_silence(self) -> bool:
        """Whether it goes nowhere."""
        return self.start == self.end

    def angle(self, t: ArrayLike) -> Floats:
        """Angle after ``t`` seconds.

        Args:
            t: seconds since the actionlet began, any shape; clamped to [0, duration].

        Returns:
            Radians, the shape of ``t``; exactly ``start`` and ``end`` at the ends.
        """
        return on_the_way(self.start, self.end, share(self._phase(t), self.skew))

    def velocity(self, t: ArrayLike) -> Floats:
        """Radians a second after ``t`` seconds, the shape of ``t``; 0 at both ends and outside."""
        return np.asarray(2 * self.travel / self.duration * bell(self._phase(t), self.skew))

    def acceleration(self, t: ArrayLike) -> Floats:
        """Radians a second squared after ``t`` seconds, the shape of ``t``; 0 at both ends and outside."""
        slope = bell_slope(self._phase(t), self.skew)
        return np.asarray(2 * self.travel / self.duration**2 * slope)

    def between(self, start: float, end: float) -> Actionlet:
        """The same duration and skew between other angles."""
        return replace(self, start=start, end=end)

    def lasting(self, duration: float) -> Actionlet:
        """The same way in another time."""
        return replace(self, duration=duration)

    def backwards(self) -> Actionlet:
        """From its end to its start, each angle as long before the end as it was after the start."""
        return Actionlet(self.end, self.start, self.duration, 1 - self.skew)

    def _phase(self, t: ArrayLike) -> Floats:
        return np.clip(np.asarray(t, np.float64), 0, self.duration) / self.duration


def on_the_way(start: ArrayLike, end: ArrayLike, shares: Floats) -> Floats:
    """``start + (end - start) shares``, counted from the nearer end: exact at both, and in a silence."""
    a, b = np.asarray(start, np.float64), np.asarray(end, np.float64)
    return np.where(shares < 0.5, a + (b - a) * shares, b - (b - a) * (1 - shares))


def checked_duration(value: Any, whose: str) -> float:
    """``value`` as seconds above 0.

    Raises:
        ActionletError: it is no such number.
    """
    duration = checked_number(value, f"the duration of {whose}", "give seconds above 0")
    if duration <= 0:
        raise ActionletError(f"the duration of {whose} is {duration:g} s; give seconds above 0")
    return duration


def checked_number(value: Any, what: str, mend: str) -> float:
    """``value`` as a finite float.

    Raises:
        ActionletError: it is none; the message says ``what`` it was for and how to ``mend`` it.
    """
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise ActionletError(f"{what} is {value!r}, which is no number; {mend}") from None
    if not math.isfinite(number):
        raise ActionletError(f"{what} is {number}; {mend}")
    return number
