"""How alike left and right turns are covered, at every speed and turn rate."""

from __future__ import annotations

from typing import Final

import numpy as np

from gmr.evaluation.coverage import density
from gmr.evaluation.coverage_cells import Bins
from gmr.table import Table

__all__ = ["SYMMETRY_CELLS", "coverage_symmetry", "symmetry_of"]

SYMMETRY_CELLS: Final = Bins(speed=0.25, turn_rate_deg=10.0, blur=0.0)
"""Wide enough that a step to either side does not decide."""


def coverage_symmetry(dataset: str, coverage: Table) -> Table:
    """The seconds of turning left against those of turning right.

    Args:
        dataset: its name.
        coverage: the windows, from :func:`gmr.evaluation.coverage.coverage_table`.

    Returns:
        One row a cell of 0.25 m/s by 10 degrees/s in which the clips turn, by speed, then turn rate:
        ``speed`` and ``turn_rate_deg`` (to either side) of its middle, ``left_seconds``, ``right_seconds``,
        and ``symmetry``, the smaller over the larger of them: 1 is alike, 0 is one side only.
        Windows within 5 degrees/s of straight ahead do not count.
    """
    held = density(coverage, SYMMETRY_CELLS)
    middle = held.seconds.shape[1] // 2
    left, right = held.seconds[:, middle + 1 :], held.seconds[:, :middle][:, ::-1]
    row, column = np.nonzero(left + right)
    left, right = left[row, column], right[row, column]
    return Table(
        {
            "dataset": np.full(len(row), dataset, object),
            "speed": (row + 0.5) * SYMMETRY_CELLS.speed,
            "turn_rate_deg": (column + 1.0) * SYMMETRY_CELLS.turn_rate_deg,
            "left_seconds": left,
            "right_seconds": right,
            "symmetry": np.minimum(left, right) / np.maximum(left, right),
        }
    )


def symmetry_of(table: Table) -> float:
    """One figure for a whole table: the shared seconds of all cells over the larger side's; NaN where nothing
    turns."""
    left, right = table["left_seconds"], table["right_seconds"]
    either = np.maximum(left, right).sum()
    return float(np.minimum(left, right).sum() / either) if either > 0 else float("nan")
