"""How the character misses what is asked in trials that fail alike, in words."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.failing_blocks import FAST, MIXED, SLOW, STRAY, TURNS_LITTLE, TURNS_MUCH, Block
from gmr.evaluation.regions import Grid
from gmr.evaluation.words import beyond, listing

__all__ = ["symptom"]

SOME: Final = 0.1
"""What else goes wrong is told where it does in this share of the trials."""


def symptom(grid: Grid, block: Block) -> str:
    """What goes wrong in the trials of a block, as the rest of "the character ...".

    Of trials that switch speeds it is their error at the speed that they miss by more, as a share of it, for
    this is what they fail by.
    """
    if block.way == MIXED:
        return _each_way(grid, block)
    if block.way == STRAY:
        return f"keeps its speed and turn rate but {_wrong(grid, block)}"
    also = ("turn rate", grid.excess[1]) if block.way in (SLOW, FAST) else ("speed", grid.excess[0])
    return f"{_wrong(grid, block)}{_missed_too(block, *also)}"


def _wrong(grid: Grid, block: Block) -> str:
    """How far it is off; where one turn rate is asked for, which it turns at."""
    reached = _reached(grid, block)
    if reached is not None and reached.min() >= 1:
        return f"turns at {_typical(reached, ' degrees/s', 0.0, 'instead')}"
    verb, how = block.way.split(" ", 1)
    told = f"{verb} {_typical(*_missed_by(grid, block.cells, block.way), how)}"
    return f"{told}{_at_which(grid, block.way)}"


def _at_which(grid: Grid, way: str) -> str:
    """At which speed trials go too slowly or too fast that are asked for two."""
    two = way in (SLOW, FAST) and grid.switching is not None
    return " at the speed of the two that it misses by more" if two else ""


def _reached(grid: Grid, block: Block) -> NDArray[np.float64] | None:
    """(K,) degrees/s that it turns at to the side that it should turn to, of one turn rate only."""
    asked = grid.turn_rates_deg[block.cells[:, 1]]
    if block.way not in (TURNS_LITTLE, TURNS_MUCH) or len(np.unique(np.abs(asked))) > 1:
        return None
    return np.asarray(np.sign(asked) * (asked + grid.turn_rate_error_deg[tuple(block.cells.T)]))


def _each_way(grid: Grid, block: Block) -> str:
    """In how many trials what goes wrong, the most first, and by how much."""
    ways, many = np.unique(block.ways, return_counts=True)
    most_first = sorted(zip(ways.tolist(), many.tolist(), strict=True), key=lambda each: -each[1])
    parts: list[str] = []
    for way, trials in most_first:
        error, unit, limit = _missed_by(grid, block.cells[block.ways == way], way)
        by = f"{beyond(float(np.median(error)), limit)}{unit}"
        told = f"{way}{_at_which(grid, way)}"
        if not parts:
            parts.append(f"{told} in {trials} of them (by {by}{' in the median' if trials > 1 else ''})")
        else:
            parts.append(f"{told} in {trials} (by {by})")
    return listing(parts)


def _missed_by(grid: Grid, cells: NDArray[np.int64], way: str) -> tuple[NDArray[np.float64], str, float]:
    """How far trials that fail in a way are off, in which unit, and the limit where it has that unit."""
    at = tuple(cells.T)
    if way == STRAY:
        return grid.offset[at], " m", grid.limits.offset
    if way in (SLOW, FAST) and grid.switching is not None:
        return 100 * np.abs(grid.speed_error_share[at]), "%", 100 * grid.limits.speed
    if way in (SLOW, FAST):
        return np.abs(grid.speed_error[at]), " m/s", 0.0
    return np.abs(grid.turn_rate_error_deg[at]), " degrees/s", grid.limits.turn_rate_deg


def _typical(values: NDArray[np.float64], unit: str, limit: float, how: str) -> str:
    """The median, where the values differ with the lowest and the highest: "0.9 m/s too slowly in the median
    (0.4 to 2.1)"."""
    low, middle, high = (
        beyond(float(value), limit) for value in (values.min(), np.median(values), values.max())
    )
    typical = f"{middle}{unit} {how}"
    ends = f"{low} to {high}{unit if unit == '%' else ''}"
    return typical if low == high else f"{typical} in the median ({ends})"


def _missed_too(block: Block, what: str, excess: NDArray[np.float64]) -> str:
    """In how many trials the other of speed and turn rate is off, too, if in more than a few."""
    missed, among = int((excess[tuple(block.cells.T)] > 1).sum()), len(block.cells)
    if missed < SOME * among or not missed:
        return ""
    return f", and misses its {what}{'' if missed == among else f' in {missed} of them'}, too"
