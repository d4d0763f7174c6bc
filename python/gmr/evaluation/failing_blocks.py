"""Blocks of the grid whose trials fail alike: few of them tell most of the failures, each trial once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.regions import (
    EITHER,
    HOLDS,
    LEFT,
    LEFT_ONLY,
    MISSES_SPEED,
    MISSES_TURN_RATE,
    RIGHT,
    RIGHT_ONLY,
    STRAIGHT,
    STRAYS,
    Grid,
    mirror_columns,
)

__all__ = [
    "APART",
    "FAST",
    "MIXED",
    "SLOW",
    "STRAY",
    "TURNS_AWAY",
    "TURNS_LITTLE",
    "TURNS_MUCH",
    "Block",
    "failing_blocks",
]

MOST_BLOCKS: Final = 3

SMALLEST_SHARE: Final = 0.05
"""Blocks with a smaller share of the trials are told only where there are no others."""

STRAY: Final = "strays from its path"
SLOW: Final = "goes too slowly"
FAST: Final = "goes too fast"
TURNS_LITTLE: Final = "turns too slowly"
TURNS_MUCH: Final = "turns too fast"
TURNS_AWAY: Final = "turns all the same"
"""Where a straight line is asked for."""
MIXED: Final = "fails in several ways"

WORTH_MIXING: Final = 1.75
"""Trials that fail in several ways are told as one block where it tells so many times what one way can."""

APART: Final = "left and right apart"
"""Both ways, where the least or the steepest of the turn rates is asked for one way only."""

_WAYS: Final = (TURNS_AWAY, TURNS_LITTLE, TURNS_MUCH, SLOW, FAST, STRAY)

_SIGNS: Final = {STRAIGHT: (0,), EITHER: (1, -1), LEFT: (1,), RIGHT: (-1,)}


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Failing trials that are most of those within a span of speeds and a span of turn rates.

    Attributes:
        cells: (K, 2) index of speed and of turn rate of each.
        ways: (K,) STRAY, SLOW, FAST, TURNS_LITTLE, TURNS_MUCH or TURNS_AWAY of each.
        side: STRAIGHT; EITHER or APART; LEFT_ONLY or RIGHT_ONLY, where all of them hold to the other side;
            LEFT or RIGHT, where some do not, or are not asked for.
        spanned: trials within the span, these among them; of APART each side has a span of turn rates of
            its own.
        otherwise: (L, 2) index of the trials within the span that fail, too, but in another way.
        one_sided: how many of these trials hold to the other side.
    """

    cells: NDArray[np.int64]
    ways: NDArray[np.str_]
    side: str
    spanned: int
    otherwise: NDArray[np.int64]
    one_sided: int

    @property
    def way(self) -> str:
        """How all of them fail, MIXED where it is not one way."""
        return str(self.ways[0]) if np.all(self.ways == self.ways[0]) else MIXED


def failing_blocks(grid: Grid) -> list[Block]:
    """The blocks that tell most, the largest first; no trial is in two of them.

    A block is the rectangle of speeds by turn rates, to one side or either way, in which the trials that fail
    in one way outnumber all others by most: so more than half of its trials fail in that way, and so do at
    least half of those on each of its borders. The next one is looked for among those that are left. Trials
    that fail in several ways are a block where they would be many small ones.
    """
    ways = _ways(grid)
    for least in (SMALLEST_SHARE * grid.held.size, 1):
        left, blocks = ~grid.held, list[Block]()
        while len(blocks) < MOST_BLOCKS and (block := _next(grid, ways, left, least)):
            left[tuple(block.cells.T)] = False
            blocks.append(block)
        if blocks:
            return sorted(blocks, key=lambda block: -len(block.cells))
    return []


def _ways(grid: Grid) -> NDArray[np.str_]:
    """(V, W) in which way each trial fails; nothing where it holds."""
    side = np.sign(grid.turn_rates_deg)
    turns = np.where(grid.turn_rate_error_deg * side < 0, TURNS_LITTLE, TURNS_MUCH)
    how = {
        HOLDS: "",
        STRAYS: STRAY,
        MISSES_SPEED: np.where(grid.speed_error_share < 0, SLOW, FAST),
        MISSES_TURN_RATE: np.where(side == 0, TURNS_AWAY, turns),
    }
    return np.choose(grid.outcomes, [how[outcome] for outcome in sorted(how)])


def _next(grid: Grid, ways: NDArray[np.str_], left: NDArray[np.bool_], least: float) -> Block | None:
    """The block that tells most of the trials ``left``: of at least so many, or of straight ones."""
    alike = [_best(grid, ways == way, left, least) for way in _WAYS]
    worth, cells = max(alike, key=lambda each: each[0])
    mixed_worth, mixed = _best(grid, ~grid.held, left, least)
    if mixed_worth >= WORTH_MIXING * worth:
        cells = mixed
    if not len(cells):
        return None
    own, one_sided = ways[tuple(cells.T)], _held_to_the_other_side(grid, cells)
    side = _side(grid, cells, alone=one_sided == len(cells))
    span = _span(grid, cells, side)
    otherwise = np.argwhere(span & ~grid.held & ~np.isin(ways, own))
    return Block(cells, own, side, int(span.sum()), otherwise, one_sided)


def _best(
    grid: Grid, fails: NDArray[np.bool_], left: NDArray[np.bool_], least: float
) -> tuple[int, NDArray[np.int64]]:
    """What the best block of a way to fail is worth, and its cells; 0 and none where it is too small, or no
    more than half of it fails so."""
    found = [
        (worth, cells)
        for side, signs in _SIGNS.items()
        for worth, cells in _best_on_side(grid, fails, left, signs)
        if worth > fails.size and (len(cells) >= least or side == STRAIGHT)
    ]
    return max(found, key=lambda each: each[0], default=(0, np.zeros((0, 2), np.int64)))


def _best_on_side(
    grid: Grid, fails: NDArray[np.bool_], left: NDArray[np.bool_], signs: tuple[int, ...]
) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """The best block of a way to fail on a side, and its worth, if there is one."""
    steep, on_side = np.abs(grid.turn_rates_deg), np.isin(np.sign(grid.turn_rates_deg), signs)
    if not (fails & left)[:, on_side].any():
        return
    column = (steep[:, None] == np.unique(steep[on_side])) & on_side[:, None]
    worth, speeds, turns = _worthiest(_worths(fails, left) @ column.astype(np.int64))
    within = np.zeros(left.shape, bool)
    within[speeds] = column[:, turns].any(axis=1)
    yield worth, np.argwhere(within & fails & left)


def _worths(fails: NDArray[np.bool_], left: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(V, W) what each trial adds to a block: 1 where it fails so, -1 elsewhere, in units that let the larger
    of two equal blocks win; so little where it is told already that no block has it."""
    unit = fails.size + 1
    return np.where(fails & left, unit + 1, np.where(fails, -unit * unit, -unit))


def _worthiest(worths: NDArray[np.int64]) -> tuple[int, slice, slice]:
    """The rectangle with the largest sum, that sum first: for each band of columns the run of rows with the
    largest sum (Kadane's; Bentley 1984)."""
    rows, columns = worths.shape
    summed = np.zeros((rows + 1, columns + 1), np.int64)
    summed[1:, 1:] = worths.cumsum(axis=0).cumsum(axis=1)
    first, end = np.triu_indices(columns + 1, k=1)
    until = summed[:, end] - summed[:, first]
    gains = until[1:] - np.minimum.accumulate(until[:-1], axis=0)
    last, band = np.unravel_index(np.argmax(gains), gains.shape)
    start = np.argmin(until[: last + 1, band])
    return int(gains[last, band]), slice(int(start), int(last) + 1), slice(int(first[band]), int(end[band]))


def _span(grid: Grid, cells: NDArray[np.int64], side: str) -> NDArray[np.bool_]:
    """(V, W) the trials within the speeds and turn rates of some, on their side or sides."""
    speeds, turns = grid.speeds[cells[:, 0]], grid.turn_rates_deg[cells[:, 1]]
    steep, signs = np.abs(grid.turn_rates_deg), np.sign(turns)
    turning = np.zeros(len(steep), bool)
    for sign in np.unique(signs):
        own = np.abs(turns[signs == sign] if side == APART else turns)
        turning |= (np.sign(grid.turn_rates_deg) == sign) & (steep >= own.min()) & (steep <= own.max())
    fast = (grid.speeds >= speeds.min()) & (grid.speeds <= speeds.max())
    return np.asarray(fast[:, None] & turning)


def _held_to_the_other_side(grid: Grid, cells: NDArray[np.int64]) -> int:
    """How many trials of some hold where the same turn to the other side is asked for."""
    speeds, other = cells[:, 0], mirror_columns(grid.turn_rates_deg)[cells[:, 1]]
    return int((grid.held[speeds, other] & (other >= 0)).sum())


def _side(grid: Grid, cells: NDArray[np.int64], *, alone: bool) -> str:
    turns = np.sign(grid.turn_rates_deg[cells[:, 1]])
    if not turns.any():
        return STRAIGHT
    if turns.min() != turns.max():
        steep = np.abs(grid.turn_rates_deg[cells[:, 1]])
        ends = np.array([steep.min(), steep.max()])
        return EITHER if np.isin([*ends, *-ends], grid.turn_rates_deg).all() else APART
    if turns[0] > 0:
        return LEFT_ONLY if alone else LEFT
    return RIGHT_ONLY if alone else RIGHT
