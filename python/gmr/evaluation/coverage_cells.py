"""The cells of a coverage map: which of them each one-second window falls into."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.table import Table

__all__ = ["Bins", "Cells", "cells_of"]


@dataclass(frozen=True, slots=True)
class Bins:
    """The cells of a coverage map.

    Attributes:
        speed: height of a cell, m/s; the first begins at 0.
        turn_rate_deg: width of a cell, degrees/s; one is centred on 0, so that left and right are alike.
        blur: standard deviation of the Gaussian that smooths the map, in cells; 0 for none.
    """

    speed: float = 0.1
    turn_rate_deg: float = 5.0
    blur: float = 1.0


@dataclass(frozen=True, eq=False)
class Cells:
    """M windows in a map of V speeds by W turn rates.

    Attributes:
        speed_edges: (V + 1,) m/s.
        turn_rate_edges_deg: (W + 1,) degrees/s, symmetrical about 0.
        cell: (M,) of each window: ``row * W + column``.
    """

    speed_edges: NDArray[np.float64]
    turn_rate_edges_deg: NDArray[np.float64]
    cell: NDArray[np.int64]

    @property
    def shape(self) -> tuple[int, int]:
        """V and W."""
        return len(self.speed_edges) - 1, len(self.turn_rate_edges_deg) - 1

    @cached_property
    def _order(self) -> NDArray[np.int64]:
        return np.argsort(self.cell, kind="stable")

    @cached_property
    def filled(self) -> NDArray[np.int64]:
        """(K,) the cells that are not empty, ascending: by speed, then turn rate."""
        return np.unique(self.cell)

    @cached_property
    def _windows(self) -> dict[int, NDArray[np.int64]]:
        ends = np.searchsorted(self.cell[self._order], self.filled, "right")
        return dict(zip(self.filled.tolist(), np.split(self._order, ends[:-1]), strict=False))

    def __iter__(self) -> Iterator[NDArray[np.int64]]:
        """The windows of every cell of :attr:`filled`."""
        return iter(self._windows.values())

    def with_neighbours(self) -> Iterator[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """For every cell of :attr:`filled` its windows, and those of it and its 8 neighbours, ascending."""
        rows, columns = self.shape
        for cell, windows in self._windows.items():
            row, column = divmod(cell, columns)
            about = [
                self._windows[there * columns + beside]
                for there in range(max(row - 1, 0), min(row + 2, rows))
                for beside in range(max(column - 1, 0), min(column + 2, columns))
                if there * columns + beside in self._windows
            ]
            yield windows, np.sort(np.concatenate(about))

    @property
    def speed(self) -> NDArray[np.float64]:
        """(K,) m/s in the middle of each cell of :attr:`filled`."""
        return _middles(self.speed_edges)[self.filled // self.shape[1]]

    @property
    def turn_rate_deg(self) -> NDArray[np.float64]:
        """(K,) degrees/s in the middle of each cell of :attr:`filled`."""
        return _middles(self.turn_rate_edges_deg)[self.filled % self.shape[1]]


def cells_of(coverage: Table, bins: Bins) -> Cells:
    """Sort the windows of a coverage table into cells."""
    speed, turn = coverage["speed"], coverage["turn_rate_deg"]
    speed_edges = bins.speed * np.arange(int(np.max(speed, initial=0.0) / bins.speed) + 2.0)
    widest = int(np.max(np.abs(turn), initial=0.0) / bins.turn_rate_deg + 0.5)
    turn_edges = bins.turn_rate_deg * (np.arange(2.0 * widest + 2) - widest - 0.5)
    row = np.searchsorted(speed_edges, speed, "right") - 1
    column = np.searchsorted(turn_edges, turn, "right") - 1
    return Cells(speed_edges, turn_edges, row * (len(turn_edges) - 1) + column)


def _middles(edges: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((edges[1:] + edges[:-1]) / 2)
