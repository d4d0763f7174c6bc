"""Another performer of an action: one cycle of it, mutated, tells how every cycle is changed.

Extremes of a degree of freedom move by shares of the way to their neighbours, so that the change is in
proportion whatever the parameters are. Phases are warped alike in all degrees of freedom, in contacts and in
labels: what was synchronised stays so, and the contacts follow. What a right limb does half a period after
the left one it goes on doing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import Actionlet
from gmr.actionlets.actions.parts import Courses
from gmr.actionlets.actions.units import ActionUnit, Extreme
from gmr.actionlets.actions.values import Value
from gmr.actionlets.mutation import mutate, substituted
from gmr.actionlets.score import Score
from gmr.actionlets.track import Piece, Track

__all__ = ["Pool", "Variation", "varied"]

Floats = NDArray[np.float64]

_MOST: Final = 0.6
"""Amount of the mutation that a variation of 1 asks for: beyond it steps stumble."""
_OWN: Final = 0.25
"""Share by which the sides differ, of what both change."""


@dataclass(frozen=True)
class Variation:
    """An action as somebody does it.

    Args:
        tempo: what its period or duration is multiplied with.
    """

    unit: ActionUnit
    courses: Courses
    tempo: float = 1.0


@dataclass(frozen=True, eq=False)
class Pool:
    """The actionlets of some actions, to choose others of the same type from.

    Args:
        written: actions and their extremes.
    """

    written: Sequence[tuple[ActionUnit, Courses]] = ()

    @cached_property
    def pieces(self) -> Mapping[str, tuple[Piece, ...]]:
        """All that move, by the degree of freedom without its side."""
        found: dict[str, list[Piece]] = {}
        for unit, courses in self.written:
            for dof, course in courses.items():
                track = _track(_rows(course, _defaults(unit)), unit.cyclic)
                moving = [piece for piece in track.pieces if piece.travel]
                found.setdefault(_sideless(dof), []).extend(dict.fromkeys(moving))
        return {dof: tuple(pieces) for dof, pieces in found.items()}


def _sideless(dof: str) -> str:
    return dof.removeprefix("left_").removeprefix("right_")


def _defaults(unit: ActionUnit) -> dict[str, float]:
    chosen = {name: parameter.default for name, parameter in unit.parameters.items()}
    return chosen | dict.fromkeys(unit.derived, 0.0)


@dataclass(frozen=True)
class _Changes:
    """What is changed in one degree of freedom, by the number of the extreme in the file.

    Args:
        neighbour: (n,) the number of the extreme towards which it moves.
        towards: (n,) by which share of the way.
        skew: (n,) what is added to the skew.
    """

    neighbour: NDArray[np.intp]
    towards: Floats
    skew: Floats


def varied(
    unit: ActionUnit,
    courses: Courses,
    ranges: Mapping[str, tuple[float, float]],
    pool: Pool,
    seed: int,
    amount: float,
) -> Variation:
    """The action as the performer ``seed`` does it; as written where ``amount`` is 0.

    Args:
        ranges: by degree of freedom, in the file's units.
        pool: the skew of each actionlet goes the way ``amount`` towards that of another of its type in here.
        seed: any whole number; each tells a performer, whoever else there is.
        amount: 0 to 1.
    """
    if amount == 0:
        return Variation(unit, courses)
    defaults = _defaults(unit)
    rows = {dof: _rows(course, defaults) for dof, course in courses.items()}
    cycle = Score({dof: _track(one, unit.cyclic) for dof, one in rows.items()})
    rng = np.random.default_rng(seed % 2**64)
    other = mutate(cycle, rng, _MOST * amount, ranges)
    swapped = substituted(cycle, {dof: pool.pieces.get(_sideless(dof), ()) for dof in cycle.dofs}, rng)
    changes = {
        dof: _changes(one, cycle[dof], other[dof], swapped[dof], amount, unit.cyclic)
        for dof, one in rows.items()
    }
    warp = _Warp.between(cycle, other)

    def moved(phase: Value) -> Value:
        return phase.plus(Value(warp.shift(float(phase.at(defaults)))))

    return Variation(
        replace(
            unit,
            contacts={
                side: tuple((moved(begin), moved(end)) for begin, end in spans)
                for side, spans in unit.contacts.items()
            },
            labels={name: (moved(begin), moved(end)) for name, (begin, end) in unit.labels.items()},
        ),
        {dof: _applied(course, _common(dof, changes), moved) for dof, course in courses.items()},
        other.duration,
    )


def _rows(course: Sequence[Extreme], defaults: Mapping[str, float]) -> Floats:
    """(n, 3) phase, angle and skew of the extremes of one cycle where nobody chooses the parameters."""
    return np.array(
        [[value.at(defaults) for value in (e.phase, e.angle, e.skew)] for e in course], np.float64
    )


def _track(rows: Floats, is_cyclic: bool) -> Track:
    """One cycle, which lasts a second."""
    if is_cyclic:
        rows = np.concatenate([_later(rows, turn) for turn in range(-2, 4)])
    elif len(rows) == 1:
        rows = np.concatenate([rows, _later(rows, 1.0)])
    return Track.through(rows[np.argsort(rows[:, 0], kind="stable")], (0.0, 1.0))


def _later(rows: Floats, phase: float) -> Floats:
    moved = rows.copy()
    moved[:, 0] += phase
    return moved


def _changes(
    rows: Floats, before: Track, after: Track, swapped: Track, amount: float, is_cyclic: bool
) -> _Changes:
    """What mutation did to each extreme of a track, and the way ``amount`` to other velocity functions."""
    angles = rows[:, 1]
    phases = rows[:, 0] % 1.0 if is_cyclic else rows[:, 0]
    places = np.abs(before.times - phases[:, None]).argmin(axis=1)
    moved = after.extremes[places] - before.extremes[places]
    # The piece that ends at the first extreme is the last one of the cycle before.
    ends = np.where(places > 0, places - 1, len(before.pieces) - 1 if is_cyclic else 0)
    old, new, others = (np.array([_skew(track, end) for end in ends]) for track in (before, after, swapped))
    tilts = new - old + amount * (others - old)
    ways = np.abs(angles[:, None] - np.stack([np.roll(angles, 1), np.roll(angles, -1)], axis=1))
    back = ways[:, 0] < ways[:, 1]
    numbers = np.arange(len(rows))
    neighbour = np.where(back, np.roll(numbers, 1), np.roll(numbers, -1))
    way = angles[neighbour] - angles
    share = np.divide(moved, way, out=np.zeros(len(rows)), where=np.abs(way) > 1e-9)
    return _Changes(neighbour, np.clip(share, -0.45, 0.45), tilts)


def _skew(track: Track, place: int) -> float:
    piece = track.pieces[place]
    return piece.skew if isinstance(piece, Actionlet) else 0.5


def _common(dof: str, changes: Mapping[str, _Changes]) -> _Changes:
    """The changes of a degree of freedom; a right limb takes most of them from the left one."""
    own = changes[dof]
    other = changes.get("left_" + dof.removeprefix("right_")) if dof.startswith("right_") else None
    if other is None or not np.array_equal(other.neighbour, own.neighbour):
        return own
    return _Changes(
        own.neighbour,
        (1 - _OWN) * other.towards + _OWN * own.towards,
        (1 - _OWN) * other.skew + _OWN * own.skew,
    )


def _applied(
    course: Sequence[Extreme], changes: _Changes, moved: Callable[[Value], Value]
) -> tuple[Extreme, ...]:
    found = []
    for extreme, neighbour, share, tilt in zip(
        course, changes.neighbour.tolist(), changes.towards.tolist(), changes.skew.tolist(), strict=True
    ):
        angle = extreme.angle.scaled(1 - share).plus(course[neighbour].angle.scaled(share))
        found.append(Extreme(moved(extreme.phase), angle, extreme.skew.plus(Value(tilt))))
    return tuple(found)


@dataclass(frozen=True)
class _Warp:
    """How a mutation moved phases.

    Args:
        at: (n,) phases, rising.
        shifts: (n,) what was added to each.
    """

    at: Floats
    shifts: Floats

    @classmethod
    def between(cls, before: Score, after: Score) -> _Warp:
        """From where pieces of all tracks begin and end."""
        at = np.concatenate([before[dof].times for dof in before.dofs])
        new = np.concatenate([after[dof].times for dof in before.dofs]) / after.duration
        inside = (at >= 0) & (at <= 1)
        at, new = np.append(at[inside], [0.0, 1.0]), np.append(new[inside], [0.0, 1.0])
        at, first = np.unique(at, return_index=True)
        return cls(at, new[first] - at)

    def shift(self, phase: float) -> float:
        """What is added to a phase; the same in every cycle."""
        inside = phase if 0 <= phase <= 1 else phase % 1.0
        return float(np.interp(inside, self.at, self.shifts))
