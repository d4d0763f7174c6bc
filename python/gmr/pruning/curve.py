"""Quality for size: frames go, those that matter least first, and after each step the trials are run again.

Clips that are there twice go first, then what nobody needs, the longest ranges before the others. From there
on a greedy search: of the moves that touch least of what is played (a range goes, or a second at one of its
ends) each is simulated alone, those that cost least a second are made until a step is full, and all of it is
simulated again together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError
from gmr.evaluation.elsewhere import Runs
from gmr.matching.database import Database
from gmr.pruning.lossless import lossless_part
from gmr.pruning.outcomes import Outcomes, Score, needed_rows
from gmr.pruning.part import Part, Range, gaps, recordings_of, whole
from gmr.pruning.rerun import Again, Rerun
from gmr.table import Table

__all__ = ["Curve", "Point", "curve_of"]

STEP = 0.05
"""Share of all seconds that goes from one point to the next."""

TRIM = 1.0
"""Seconds that go at an end of a range."""

CHOICE = 3.0
"""Steps' worth of seconds among which the moves of a step are chosen."""

MOST_MOVES = 48

Progress = Callable[[str, int, int], object]


@dataclass(frozen=True, eq=False)
class Point:
    """A smaller dataset, and how well it does.

    Attributes:
        part: what is left.
        score: of all runs on it, simulated.
        lossless: whether all that is gone is what no run needs.
    """

    part: Part
    score: Score
    lossless: bool


@dataclass(frozen=True, eq=False)
class Curve:
    """Points from the whole dataset to smaller and smaller ones.

    Attributes:
        points: the whole first.
    """

    points: tuple[Point, ...]

    @property
    def lossless(self) -> Point:
        """The smallest point at which no trial has changed."""
        return [point for point in self.points if point.lossless][-1]

    def reached(self, share: float) -> Point:
        """The first point at which at least this share of the seconds is gone.

        Raises:
            GmrError: there is none.
        """
        every = self.points[0].part.seconds
        for point in self.points:
            if point.part.seconds <= (1 - share) * every * (1 + 1e-9):
                return point
        most = math.floor(100 * (1 - self.points[-1].part.seconds / every) + 1e-9)
        remedy = f"ask for {most}% at most" if most else "ask for lossless, or add clips"
        raise GmrError(
            f"{100 * share:g}% of the seconds cannot go: beyond {most}% there is hardly anything left to "
            f"play; {remedy}"
        )

    @property
    def table(self) -> Table:
        """One row a point: ``seconds`` kept, ``share_kept`` of all, ``offset_mean`` in metres, ``held`` and
        ``runs``, ``clips`` of which something is left, and whether it is ``lossless``."""
        every = self.points[0].part.seconds
        return Table(
            {
                "seconds": np.array([point.part.seconds for point in self.points]),
                "share_kept": np.array([point.part.seconds / every for point in self.points]),
                "offset_mean": np.array([point.score.offset for point in self.points]),
                "held": np.array([point.score.held for point in self.points], np.int64),
                "runs": np.array([point.score.runs for point in self.points], np.int64),
                "clips": np.array(
                    [sum(map(bool, point.part.ranges.values())) for point in self.points], np.int64
                ),
                "lossless": np.array([point.lossless for point in self.points], bool),
            }
        )


@dataclass(frozen=True, slots=True)
class _Move:
    """A range that goes, and what of it is played."""

    clip: str
    gone: Range
    seconds: float
    played: float


def curve_of(
    asked: Runs, outcomes: Outcomes, rerun: Rerun, progress: Progress, goal: float, until: float
) -> Curve:
    """Remove frames until a share of the seconds is gone, or nothing more can go.

    Args:
        asked: what the runs are made of.
        outcomes: what became of them on the whole.
        rerun: makes runs again.
        progress: called with what is being done, how much of it is, and of how much.
        goal: a share of the seconds, 0 to 1, at which there shall be a point.
        until: the share of the seconds that shall be gone at the last one.
    """
    database = asked.database
    everything = whole(database)
    points = [Point(everything, outcomes.score, True)]
    unneeded = _unneeded_go(database, everything, lossless_part(database, outcomes), goal)
    points.extend(Point(part, outcomes.score, True) for part in unneeded)
    last, percent = max(goal, until), round(100 * max(goal, until))
    part = points[-1].part
    while (gone := 1 - part.seconds / everything.seconds) < last - 1e-9:
        progress("removing frames", min(round(100 * gone), percent - 1), percent)
        aim = goal if gone < goal - 1e-9 else last
        room = (aim - gone) * everything.seconds
        found = _step(asked, part, outcomes, rerun, min(STEP * everything.seconds, room), room)
        if found is None:
            break
        part, outcomes = found
        points.append(Point(part, outcomes.score, False))
    progress("removing frames", percent, percent)
    return Curve(tuple(points))


def _unneeded_go(database: Database, part: Part, lossless: Part, goal: float) -> Iterator[Part]:
    """Smaller and smaller parts, a step apart and one at the goal, until only what is needed is left."""
    every = part.seconds
    for name in database.duplicates:
        part = part.without(name, part.ranges[name][0])
    if database.duplicates:
        yield part
    gone = [
        (recording.name, gap)
        for recording in recordings_of(database)
        for gap in gaps(recording.frames, lossless.ranges[recording.name])
    ]
    gone.sort(key=lambda each: each[1][0] - each[1][1])
    told = part.seconds
    aim = (1 - goal) * every
    for name, gap in gone:
        part = part.without(name, gap)
        if told - part.seconds >= STEP * every or part.seconds <= aim < told:
            told = part.seconds
            yield part
    if part.seconds < told:
        yield part


def _step(
    asked: Runs, part: Part, outcomes: Outcomes, rerun: Rerun, seconds: float, room: float
) -> tuple[Part, Outcomes] | None:
    """What is left when the cheapest moves of so many seconds are made, and what becomes of the runs.

    Where moves of less do, no more than ``room`` seconds and a trim go.
    """
    database = asked.database
    needed = needed_rows(database, outcomes)
    left = part.rows(database)
    moves = _moves(database, part, outcomes, seconds, room + TRIM)
    jobs = [_without(database, part, [move], needed, left) for move in moves]
    before, losses = outcomes.score, np.full(len(moves), np.inf)
    touching = [number for number, job in enumerate(jobs) if len(job.runs)]
    losses[[number for number, job in enumerate(jobs) if not len(job.runs)]] = 0.0
    for place, found in rerun(asked, [jobs[number] for number in touching]):
        number = touching[place]
        if found is not None:
            after = outcomes.put(jobs[number].runs, found).score
            losses[number] = after.worse_than(before) / moves[number].seconds
    order = [number for number in np.argsort(losses, kind="stable").tolist() if np.isfinite(losses[number])]
    cheapest = [moves[number] for number in order]
    return _made(asked, part, outcomes, rerun, cheapest, seconds, room + TRIM)


def _made(
    asked: Runs,
    part: Part,
    outcomes: Outcomes,
    rerun: Rerun,
    moves: list[_Move],
    seconds: float,
    most: float,
) -> tuple[Part, Outcomes] | None:
    """Make moves in their order until so many seconds are gone; fewer where nothing would be left to play."""
    database, begun = asked.database, part.seconds
    chosen: list[_Move] = []
    smaller = part
    for move in moves:
        if begun - smaller.seconds >= seconds * (1 - 1e-9):
            break
        after = smaller.without(move.clip, move.gone)
        if chosen and begun - after.seconds > most:
            continue
        chosen.append(move)
        smaller = after
    needed, left = needed_rows(database, outcomes), part.rows(database)
    while chosen:
        job = _without(database, part, chosen, needed, left)
        if not len(job.runs):
            return _after(part, chosen), outcomes
        found = next(iter(rerun(asked, [job])))[1]
        if found is not None:
            return _after(part, chosen), outcomes.put(job.runs, found)
        chosen = chosen[: len(chosen) // 2]
    return None


def _after(part: Part, moves: list[_Move]) -> Part:
    for move in moves:
        part = part.without(move.clip, move.gone)
    return part


def _without(
    database: Database, part: Part, moves: list[_Move], needed: NDArray[np.bool_], left: NDArray[np.bool_]
) -> Again:
    """The runs that some moves touch, on what is left after them."""
    after = _after(part, moves).rows(database)
    return Again(after, np.flatnonzero(needed[:, left & ~after].any(axis=1)))


def _moves(database: Database, part: Part, outcomes: Outcomes, step: float, most: float) -> list[_Move]:
    """The moves that touch least of what is played a second, some steps' worth of them; of those that take
    ``most`` seconds at most, where there are any."""
    played = _played(database, outcomes)
    past, future = database.reach
    shortest = past + future + 1 + round(TRIM * database.rate)
    trim = round(TRIM * database.rate)
    found = []
    for recording in recordings_of(database):
        own = recording.total(played)
        for first, end in part.ranges[recording.name]:
            ranges = {(first, end)}
            if end - first >= shortest + trim:
                ranges |= {(first, first + trim), (end - trim, end)}
            for gone in ranges:
                # Frames before a cut lose their future, and can only be played on to.
                lost = slice(max(first, gone[0] - future), min(end, gone[1] + past))
                seconds = (gone[1] - gone[0]) / database.rate
                found.append(_Move(recording.name, gone, seconds, float(np.sum(own[lost]))))
    found = [move for move in found if move.seconds <= most] or found
    found.sort(key=lambda move: (move.played / move.seconds, move.clip, move.gone))
    chosen: list[_Move] = []
    total = 0.0
    for move in found:
        if len(chosen) >= MOST_MOVES or (total >= CHOICE * step and len(chosen) >= 2):
            break
        chosen.append(move)
        total += move.seconds
    return chosen


def _played(database: Database, outcomes: Outcomes) -> NDArray[np.int64]:
    """(N,) at how many steps of all runs a row is shown."""
    rows = outcomes.rows[outcomes.rows >= 0]
    return np.bincount(rows, minlength=len(database))
