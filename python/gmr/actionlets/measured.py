"""The second kind of actionlet: a curve that was measured between two instants without velocity.

Source: Zheng et al., "Human Motion Simulation and Action Corpus", section 2: the angle series of an actionlet
"can be specified by users or obtained from motion capture data", Eqs. 4 and 5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.actionlet import SYMMETRIC, checked_duration
from gmr.actionlets.bell import share
from gmr.arrays import frozen
from gmr.errors import ActionletError

__all__ = ["Measured", "cubic", "level_at_the_ends"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One movement of one degree of freedom as sampled: a C1 cubic through the samples, at rest at both ends.

    Between samples it never leaves the interval of its two neighbours, so a curve that only rises keeps
    rising.

    Args:
        angles: (N,) radians at even times from 0 to ``duration``, N at least 2.
        duration: seconds, above 0.

    Raises:
        ActionletError: fewer than two angles, one that is no finite number, or such a duration.

    Source of the slopes: Fritsch and Butland, "A method for constructing local monotone piecewise cubic
    interpolants", SIAM J. Sci. Stat. Comput. 5, 1984.
    """

    angles: NDArray[np.float64]
    duration: float

    def __post_init__(self) -> None:
        angles = frozen(self.angles, np.float64)
        if angles.ndim != 1 or len(angles) < 2:
            raise ActionletError(
                f"a measured actionlet has angles of shape {angles.shape}; give a row of two or more"
            )
        wrong = np.flatnonzero(~np.isfinite(angles))
        if len(wrong):
            raise ActionletError(
                f"angle {wrong[0]} of a measured actionlet is {angles[wrong[0]]}; fill gaps before,"
                " all angles are finite radians"
            )
        object.__setattr__(self, "angles", angles)
        object.__setattr__(self, "duration", checked_duration(self.duration, "a measured actionlet"))

    def __eq__(self, other: object) -> bool:
        """The same angles in the same time."""
        if not isinstance(other, Measured):
            return NotImplemented
        return self.duration == other.duration and np.array_equal(self.angles, other.angles)

    def __hash__(self) -> int:
        return hash((self.duration, self.angles.tobytes()))

    @property
    def start(self) -> float:
        """Its first angle, radians."""
        return float(self.angles[0])

    @property
    def end(self) -> float:
        """Its last angle, radians."""
        return float(self.angles[-1])

    @property
    def travel(self) -> float:
        """``end - start``, in radians."""
        return self.end - self.start

    @property
    def is_silence(self) -> bool:
        """Whether it never moves."""
        return bool((self.angles == self.angles[0]).all())

    @property
    def knots(self) -> NDArray[np.float64]:
        """(N,) seconds of its samples."""
        return np.linspace(0, self.duration, len(self.angles))

    def slopes(self) -> NDArray[np.float64]:
        """(N,) radians a second at its samples."""
        return level_at_the_ends(self.angles, self.duration / (len(self.angles) - 1))

    def angle(self, t: ArrayLike) -> NDArray[np.float64]:
        """Radians after ``t`` seconds, any shape, clamped to [0, duration]."""
        return self._at(t, 0)

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """Radians a second after ``t`` seconds; 0 at both ends and outside."""
        return self._at(t, 1)

    def acceleration(self, t: ArrayLike) -> NDArray[np.float64]:
        """Radians a second squared after ``t`` seconds; it may jump at the samples, and is 0 outside."""
        seconds = np.asarray(t, np.float64)
        inside = (seconds >= 0) & (seconds <= self.duration)
        return np.where(inside, self._at(t, 2), 0.0)

    def between(self, start: float, end: float) -> Measured:
        """The same course between other angles: scaled; a course that is more to and fro than travel is left
        its size, and led over by a symmetric actionlet."""
        travels = 2 * abs(self.travel) > float(np.ptp(self.angles))
        scale = (end - start) / self.travel if travels else math.inf
        # A travel so small that no number tells how many times it must be scaled is none.
        if math.isfinite(scale):
            angles = start + (self.angles - self.start) * scale
        else:
            over = share(np.linspace(0, 1, len(self.angles)), SYMMETRIC)
            angles = self.angles + (start - self.start) * (1 - over) + (end - self.end) * over
        angles[[0, -1]] = start, end
        return replace(self, angles=angles)

    def lasting(self, duration: float) -> Measured:
        """The same way in another time."""
        return replace(self, duration=duration)

    def backwards(self) -> Measured:
        """From its end to its start."""
        return replace(self, angles=self.angles[::-1])

    def _at(self, t: ArrayLike, order: int) -> Floats:
        seconds = np.clip(np.asarray(t, np.float64), 0, self.duration)
        return cubic(self.knots, self.angles, self.slopes(), seconds, order)


def level_at_the_ends(values: Floats, step: float) -> Floats:
    """Slopes of a C1 cubic through even samples: 0 at both ends and where the samples turn, the harmonic mean
    of the two secants elsewhere (Fritsch and Butland 1984 for even steps)."""
    secants = np.diff(values) / step
    slopes = np.zeros_like(values)
    before, after = secants[:-1], secants[1:]
    same_way = before * after > 0
    one, other = before[same_way], after[same_way]
    slopes[1:-1][same_way] = 2 * one * (other / (one + other))  # no secant, however small, overflows
    return slopes


def cubic(knots: Floats, values: Floats, slopes: Floats, t: Floats, order: int = 0) -> Floats:
    """The cubic Hermite spline at ``t``, or its first or second derivative.

    Args:
        knots: (N,) rising; ``values`` and ``slopes`` (N,) there.
        t: any shape, within the knots.
        order: 0, 1 or 2.
    """
    i = np.clip(np.searchsorted(knots, t, side="right") - 1, 0, len(knots) - 2)
    step = knots[i + 1] - knots[i]
    w = (t - knots[i]) / step
    rise = values[i + 1] - values[i]
    one, other = slopes[i] * step, slopes[i + 1] * step
    # value = values[i] + one w + (3 rise - 2 one - other) w^2 + (one + other - 2 rise) w^3
    square, third = 3 * rise - 2 * one - other, one + other - 2 * rise
    match order:
        case 0:
            found = np.where(w < 1, values[i] + w * (one + w * (square + w * third)), values[i + 1])
        case 1:
            found = np.where(w < 1, one + w * (2 * square + 3 * w * third), other) / step
        case _:
            found = (2 * square + 6 * w * third) / step**2
    return np.asarray(found, np.float64)
