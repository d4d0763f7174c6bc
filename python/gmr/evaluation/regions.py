"""Where on the grid of speeds and turn rates a dataset holds, and where it fails.

A trial *holds* when the character does what it was asked, within stated limits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.table import Table

__all__ = [
    *("EITHER", "LEFT", "LEFT_ONLY", "RIGHT", "RIGHT_ONLY", "STRAIGHT"),
    *("HOLDS", "MISSES_SPEED", "MISSES_TURN_RATE", "STRAYS"),
    *("Grid", "Limits", "Rectangle", "Region", "failures", "held_rectangle", "judged", "mirror_columns"),
]

STRAIGHT: Final = "straight"
EITHER: Final = "either way"
LEFT: Final = "left"
RIGHT: Final = "right"
LEFT_ONLY: Final = "left, though not right,"
RIGHT_ONLY: Final = "right, though not left,"

HOLDS: Final = 0
STRAYS: Final = 1
MISSES_SPEED: Final = 2
MISSES_TURN_RATE: Final = 3

FORWARD_SHARE: Final = 0.7
"""A window goes forward when this much of its speed is along the facing direction (within 45 degrees)."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Within which a trial holds, and from which on a movement counts as present in the clips.

    Attributes:
        offset: mean distance from where the path has the character, metres; when tracking "time" only.
        speed: mean error of the speed, as a share of the speed asked for.
        turn_rate_deg: mean error of the turn rate, degrees per second.
        facing_deg: mean error of the facing, degrees; where another way is asked for than ahead, and when
            tracking "time", only.
        covered: seconds of the clips in a cell of the grid.
    """

    offset: float = 0.5
    speed: float = 0.15
    turn_rate_deg: float = 10.0
    facing_deg: float = 20.0
    covered: float = 1.0

    def held(
        self,
        speed_error_share: NDArray[np.float64],
        turn_rate_error_deg: NDArray[np.float64],
        offset: NDArray[np.float64],
        timed: NDArray[np.bool_] | bool,
        facing_error_deg: NDArray[np.float64] | float = 0.0,
    ) -> NDArray[np.bool_]:
        """Which trials hold; offset and facing of those that are not ``timed`` do not count."""
        near = np.abs(speed_error_share) <= self.speed
        near &= np.abs(turn_rate_error_deg) <= self.turn_rate_deg
        placed = np.asarray(offset <= self.offset) & (facing_error_deg <= self.facing_deg)
        return np.asarray(near & (np.logical_not(timed) | placed))


@dataclass(frozen=True, slots=True)
class Grid:
    """The trials of constant speed and turn rate, V speeds by W turn rates.

    Attributes:
        speeds: (V,) m/s, ascending.
        turn_rates_deg: (W,) degrees/s, ascending, positive to the left.
        offset, speed_error, speed_error_share, turn_rate_error_deg: (V, W) of the trials.
        held: (V, W) bool, whether the trial holds.
        seconds: (V, W) how long the clips go forward at about this speed and turn rate: nearer to it than
            to the next ones of the grid.
        limits: what "holds" means.
        timed: whether the character was steered to where the path has it at each time.
        switching: the other speed, m/s, and the seconds from switch to switch, where the trials switch from
            their speed to it and back; None where they keep their speed. Then ``speed_error_share`` is at the
            one of the two speeds that is missed by more, but ``speed_error`` is in the mean of both, where
            one may make up for the other.
    """

    speeds: NDArray[np.float64]
    turn_rates_deg: NDArray[np.float64]
    offset: NDArray[np.float64]
    speed_error: NDArray[np.float64]
    speed_error_share: NDArray[np.float64]
    turn_rate_error_deg: NDArray[np.float64]
    held: NDArray[np.bool_]
    seconds: NDArray[np.float64]
    limits: Limits
    timed: bool
    switching: tuple[float, float] | None = None

    @classmethod
    def of(cls, trials: Table, coverage: Table, limits: Limits) -> Grid:
        """Lay the trials of one dataset that the verdict judges out as a grid; see :func:`judged`."""
        trials = trials.take(judged(trials))
        speeds, row = np.unique(trials["speed"], return_inverse=True)
        turn_rates, column = np.unique(trials["turn_rate_deg"], return_inverse=True)

        def laid_out(name: str) -> NDArray[np.float64]:
            cells = np.full((len(speeds), len(turn_rates)), np.nan)
            cells[row, column] = trials[name]
            return cells

        offset, speed_error = laid_out("offset_mean"), laid_out("speed_error")
        share, turn_rate_error = laid_out("speed_error_share"), laid_out("turn_rate_error_deg")
        timed = not np.any(trials["tracking"] == "velocity")
        held = limits.held(share, turn_rate_error, offset, timed)
        return cls(
            speeds=speeds,
            turn_rates_deg=turn_rates,
            offset=offset,
            speed_error=speed_error,
            speed_error_share=share,
            turn_rate_error_deg=turn_rate_error,
            held=held,
            seconds=_seconds_in_cells(coverage, speeds, turn_rates),
            limits=limits,
            timed=timed,
            switching=_switching(trials),
        )

    @property
    def outcomes(self) -> NDArray[np.int64]:
        """(V, W) HOLDS, or what a trial fails by: MISSES_SPEED or MISSES_TURN_RATE, whichever is off by more
        of its limit, and STRAYS only where it keeps both, for who misses them strays for that reason."""
        speed, turn = self.excess
        missed = np.where(speed >= turn, MISSES_SPEED, MISSES_TURN_RATE)
        return np.where(self.held, HOLDS, np.where(np.maximum(speed, turn) > 1, missed, STRAYS))

    @property
    def excess(self) -> NDArray[np.float64]:
        """(2, V, W) the errors of speed and turn rate as multiples of their limits."""
        speed, turn = np.abs(self.speed_error_share), np.abs(self.turn_rate_error_deg)
        return np.stack([speed / self.limits.speed, turn / self.limits.turn_rate_deg])

    @property
    def borders(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(V + 1,) m/s and (W + 1,) degrees/s: half-way between the trials, and as far out at both ends."""
        return _borders(self.speeds, 0.25), _borders(self.turn_rates_deg, 25.0)


def judged(trials: Table) -> NDArray[np.bool_]:
    """Which trials the verdict judges: those of constant speed on a timed path, else the first."""
    kinds = {"scenario": "constant", "tracking": "time"}
    chosen = np.ones(len(trials), bool)
    for column, usual in kinds.items():
        present = trials[column][chosen]
        chosen &= trials[column] == (usual if np.any(present == usual) else present[0])
    return chosen


def _switching(trials: Table) -> tuple[float, float] | None:
    """The other speed and the seconds from switch to switch, of trials that are all of one scenario."""
    if "switched_speed" not in trials or not len(trials) or np.isnan(trials["switched_speed"][0]):
        return None
    return float(trials["switched_speed"][0]), float(trials["switch_every"][0])


def _seconds_in_cells(
    coverage: Table, speeds: NDArray[np.float64], turn_rates: NDArray[np.float64]
) -> NDArray[np.float64]:
    forward = coverage["forward_speed"] >= FORWARD_SHARE * coverage["speed"]
    seconds, _, _ = np.histogram2d(
        coverage["speed"][forward],
        coverage["turn_rate_deg"][forward],
        bins=(_borders(speeds, 0.25), _borders(turn_rates, 25.0)),
        weights=coverage["weight"][forward],
    )
    return np.asarray(seconds)


def _borders(centres: NDArray[np.float64], usual: float) -> NDArray[np.float64]:
    """Half-way between neighbours, and as far out at both ends."""
    if len(centres) == 1:
        return np.array([centres[0] - usual / 2, centres[0] + usual / 2])
    between = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - between[0]], between, [2 * centres[-1] - between[-1]]])


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A block of the grid without a failure, borders included."""

    speeds: tuple[float, float]
    turn_rates_deg: tuple[float, float]
    trials: int


def held_rectangle(grid: Grid) -> Rectangle | None:
    """The block of most trials that all hold; of equals the one that goes straight, then the slowest."""
    found = max(_rectangles(grid), key=lambda block: _worth(grid, block), default=None)
    if found is None:
        return None
    (v0, v1), (w0, w1) = found
    return Rectangle(
        (float(grid.speeds[v0]), float(grid.speeds[v1])),
        (float(grid.turn_rates_deg[w0]), float(grid.turn_rates_deg[w1])),
        (v1 - v0 + 1) * (w1 - w0 + 1),
    )


def _worth(grid: Grid, block: tuple[tuple[int, int], tuple[int, int]]) -> tuple[float, ...]:
    (v0, v1), (w0, w1) = block
    straight = grid.turn_rates_deg[w0] <= 0 <= grid.turn_rates_deg[w1]
    return ((v1 - v0 + 1) * (w1 - w0 + 1), straight, -v0, -w0)


def _rectangles(grid: Grid) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    """For every band of the shorter side of the grid, the blocks that hold all through it."""
    tall = len(grid.speeds) > len(grid.turn_rates_deg)
    held = grid.held.T if tall else grid.held
    for first in range(len(held)):
        for last in range(first, len(held)):
            for run in _runs(np.all(held[first : last + 1], axis=0)):
                yield (run, (first, last)) if tall else ((first, last), run)


def _runs(flags: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """First and last index of every unbroken run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    for first, end in edges.reshape(-1, 2).tolist():
        yield first, end - 1


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """Failing trials that are neighbours on the grid.

    Attributes:
        side: STRAIGHT; EITHER, where left and right both fail; LEFT_ONLY or RIGHT_ONLY, where only that side
            does; LEFT or RIGHT, where the grid does not ask for the other.
        cells: (K, 2) index of speed and of turn rate of every failing trial, of EITHER on both sides.
    """

    side: str
    cells: NDArray[np.int64]


def failures(grid: Grid) -> list[Region]:
    """All failing trials in regions, the largest first."""
    failed = ~grid.held
    mirrored = mirror_columns(grid.turn_rates_deg)
    asked = mirrored >= 0
    also = asked & failed[:, mirrored]
    left, right = failed & (grid.turn_rates_deg > 0), failed & (grid.turn_rates_deg < 0)
    sides = {
        STRAIGHT: failed & (grid.turn_rates_deg == 0),
        EITHER: left & also,
        LEFT_ONLY: left & asked & ~also,
        RIGHT_ONLY: right & asked & ~also,
        LEFT: left & ~asked,
        RIGHT: right & ~asked,
    }
    regions = [
        Region(side, _with_mirrored(cells, mirrored) if side == EITHER else cells)
        for side, where in sides.items()
        for cells in _connected(where)
    ]
    return sorted(regions, key=lambda region: -len(region.cells))


def mirror_columns(turn_rates: NDArray[np.float64]) -> NDArray[np.int64]:
    """(W,) index of the opposite turn rate, -1 where the grid has none."""
    place = np.minimum(np.searchsorted(turn_rates, -turn_rates), len(turn_rates) - 1)
    return np.where(turn_rates[place] == -turn_rates, place, -1)


def _with_mirrored(cells: NDArray[np.int64], mirrored: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.concatenate([cells, np.stack([cells[:, 0], mirrored[cells[:, 1]]], axis=1)])


def _connected(where: NDArray[np.bool_]) -> Iterator[NDArray[np.int64]]:
    """The cells of every group of True cells that share an edge, in the order of the grid."""
    left = set(map(tuple, np.argwhere(where).tolist()))
    while left:
        waiting = [min(left)]
        left.remove(waiting[0])
        group = []
        while waiting:
            row, column = waiting.pop()
            group.append((row, column))
            around = {(row - 1, column), (row + 1, column), (row, column - 1), (row, column + 1)} & left
            left -= around
            waiting.extend(sorted(around))
        yield np.array(sorted(group), np.int64)
