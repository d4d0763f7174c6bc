"""Many values of a library file at once: their curves as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.actions.values import Value, hermite, prepared

__all__ = ["Values", "within"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Values:
    """N values and the C curves that they follow, those of a value beside each other.

    Args:
        base: (N,) what each is without its curves.
        lowest, highest: (N,) no parameters give less, or more.
        names: of the parameters that they follow.
        first: (N + 1,) the first curve of each value; C at the end.
        parameter: (C,) the number of the name that each curve follows.
        factor: (C,) what a curve is multiplied with.
        points, gives, steps, slopes: (C, P) of the curves, as :func:`monotone` goes along them; a curve of
            fewer points has its points at infinity from there on.
    """

    base: Floats
    lowest: Floats
    highest: Floats
    names: tuple[str, ...]
    first: Ints
    parameter: Ints
    factor: Floats
    points: Floats
    gives: Floats
    steps: Floats
    slopes: Floats

    @classmethod
    def of(cls, values: Sequence[Value]) -> Values:
        """Those values, numbered as they come."""
        curves = [curve for value in values for curve in value.curves]
        names = tuple(dict.fromkeys(curve.parameter for curve in curves))
        courses = [prepared(curve.at, curve.gives) for curve in curves]
        return cls(
            np.array([value.base for value in values], np.float64),
            np.array([value.lowest for value in values], np.float64),
            np.array([value.highest for value in values], np.float64),
            names,
            np.cumsum([0, *(len(value.curves) for value in values)]),
            np.array([names.index(curve.parameter) for curve in curves], np.intp),
            np.array([curve.factor for curve in curves], np.float64),
            *(_padded([course[part] for course in courses]) for part in range(4)),
        )

    def __len__(self) -> int:
        return len(self.base)

    def at(self, which: Ints, parameters: Mapping[str, ArrayLike]) -> Floats:
        """(K,) the values of the numbers ``which``, for one value or (K,) of each parameter."""
        counts = np.diff(self.first)[which]
        rows = np.repeat(np.arange(len(which)), counts)
        curve = self.first[which][rows] + within(counts)
        asked = np.zeros((len(self.names), len(which)))
        for row, name in zip(asked, self.names, strict=True):
            row[:] = parameters[name]
        added = self.factor[curve] * self._along(curve, asked[self.parameter[curve], rows])
        found: Floats = self.base[which] + np.bincount(rows, added, len(which))
        return found

    def all_at(self, parameters: Mapping[str, float]) -> Floats:
        """(N,) all values for one value of each of the parameters."""
        return self.at(np.arange(len(self)), parameters)

    @property
    def following(self) -> list[int]:
        """The numbers of those that follow a parameter."""
        return list(np.flatnonzero(np.diff(self.first)).tolist())

    def _along(self, curve: Ints, asked: Floats) -> Floats:
        """(K,) what curves give where each is asked."""
        points = self.points[curve]
        last = np.isfinite(points).sum(axis=1) - 1
        ahead = np.arange(len(curve))
        asked = np.clip(asked, points[:, 0], points[ahead, last])
        piece = np.minimum((points[:, 1:] <= asked[:, None]).sum(axis=1), last - 1)
        step, share = self.steps[curve, piece], (asked - points[ahead, piece]) / self.steps[curve, piece]
        gives, slopes = self.gives, self.slopes
        ends = gives[curve, piece], gives[curve, piece + 1], slopes[curve, piece], slopes[curve, piece + 1]
        return hermite(share, step, *ends)


def within(counts: Ints) -> Ints:
    """0, 1, ... ``counts[0] - 1``, then 0, 1, ... for each of the others."""
    found: Ints = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return found


def _padded(rows: Sequence[Floats]) -> Floats:
    found = np.full((len(rows), max(map(len, rows), default=1)), np.inf)
    for place, row in zip(found, rows, strict=True):
        place[: len(row)] = row
    return found
