"""A number of a library file: fixed, or following the action's parameters along curves through points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Curve", "Value", "hermite", "monotone", "prepared"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Curve:
    """What a parameter adds to a value: a curve through points, level outside of them.

    Args:
        parameter: its name.
        at: the parameter's values, rising; two or more.
        gives: what is added there, before the factor.
        factor: what all of it is multiplied with.
    """

    parameter: str
    at: tuple[float, ...]
    gives: tuple[float, ...]
    factor: float = 1.0

    def mirrored(self) -> Curve:
        """The curve for a parameter that changes its sign with the side, as a turn rate does."""
        return replace(self, at=tuple(-x for x in reversed(self.at)), gives=tuple(reversed(self.gives)))

    def scaled(self, factor: float) -> Curve:
        """The curve times a number."""
        return replace(self, factor=factor * self.factor)

    @property
    def range(self) -> tuple[float, float]:
        """The least and the most that it adds."""
        ends = self.factor * min(self.gives), self.factor * max(self.gives)
        return min(ends), max(ends)


@dataclass(frozen=True, slots=True)
class Value:
    """A number, and what each parameter adds to it."""

    base: float
    curves: tuple[Curve, ...] = ()

    def at(self, parameters: Mapping[str, ArrayLike]) -> Floats:
        """The value for values of the parameters, of any shapes that go together."""
        total: Floats = np.asarray(self.base, dtype=np.float64)
        for curve in self.curves:
            total = total + curve.factor * monotone(curve.at, curve.gives, parameters[curve.parameter])
        return total

    @property
    def lowest(self) -> float:
        """No parameters give less: between its points a curve does not leave their range."""
        return self.base + sum(curve.range[0] for curve in self.curves)

    @property
    def highest(self) -> float:
        """No parameters give more."""
        return self.base + sum(curve.range[1] for curve in self.curves)

    @property
    def parameters(self) -> frozenset[str]:
        """The names of the parameters that it follows."""
        return frozenset(curve.parameter for curve in self.curves)

    def scaled(self, factor: float) -> Value:
        """The value times a number."""
        return Value(factor * self.base, tuple(curve.scaled(factor) for curve in self.curves))

    def plus(self, other: Value) -> Value:
        """The sum of two."""
        return Value(self.base + other.base, self.curves + other.curves)

    def mirrored(self, sided: Iterable[str]) -> Value:
        """The value for the body's other side, where the parameters in ``sided`` change their sign."""
        names = frozenset(sided)
        return replace(self, curves=tuple(c.mirrored() if c.parameter in names else c for c in self.curves))


def monotone(at: Iterable[float], gives: Iterable[float], x: ArrayLike) -> Floats:
    """The monotone cubic through points, level outside of them: it rises only where they rise.

    Args:
        at: (n,) rising, two or more.
        gives: (n,) the values there.
        x: any shape.

    Source: Fritsch & Butland (1984), the weighted harmonic mean of neighbouring slopes, in SciPy's
    ``PchipInterpolator`` too; here with level ends where a curve goes on level.
    """
    points, values, steps, slopes = prepared(tuple(at), tuple(gives))
    asked = np.clip(np.asarray(x, dtype=np.float64), points[0], points[-1])
    piece = np.clip(np.searchsorted(points, asked, side="right") - 1, 0, len(steps) - 1)
    share = (asked - points[piece]) / steps[piece]
    return hermite(share, steps[piece], values[piece], values[piece + 1], slopes[piece], slopes[piece + 1])


def hermite(share: Floats, step: Floats, begin: Floats, end: Floats, rise: Floats, fall: Floats) -> Floats:
    """The cubic from ``begin``, with the slope ``rise`` there, to ``end`` with the slope ``fall``.

    Args:
        share: of the step that is behind, 0 to 1.
        step: from the one to the other.
    """
    rest = 1 - share
    result: Floats = (
        begin * (1 + 2 * share) * rest**2
        + end * (3 - 2 * share) * share**2
        + step * share * rest * (rise * rest - fall * share)
    )
    return result


@lru_cache(maxsize=4096)
def prepared(at: tuple[float, ...], gives: tuple[float, ...]) -> tuple[Floats, Floats, Floats, Floats]:
    """Points, values, steps between the points, slopes at them."""
    points, values = np.array(at, dtype=np.float64), np.array(gives, dtype=np.float64)
    steps = np.diff(points)
    rises = np.diff(values) / steps
    return points, values, steps, np.concatenate([rises[:1], _between(steps, rises), rises[-1:]])


def _between(steps: Floats, rises: Floats) -> Floats:
    """(n - 2,) slopes at the inner points; 0 at a peak, where neighbouring rises differ in sign."""
    before, after = rises[:-1], rises[1:]
    w_before, w_after = 2 * steps[1:] + steps[:-1], steps[1:] + 2 * steps[:-1]
    weighted = w_before * after + w_after * before
    same = (before * after > 0) & (weighted != 0)
    slopes: Floats = np.zeros_like(before)
    np.divide((w_before + w_after) * before * after, weighted, out=slopes, where=same)
    return slopes
