"""Another performer of an action: one cycle of it, mutated, tells how every cycle is changed.

Extremes of a degree of freedom move by shares of the way to their neighbours, so that the change is in
proportion whatever the parameters are. Phases are warped alike in all degrees of freedom, in contacts and in
labels: what was synchronised stays so, and the contacts follow. What a right limb does half a period after
the left one it goes on doing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.parts import Courses
from gmr.actionlets.actions.units import ActionUnit
from gmr.actionlets.actions.written import Written, defaults
from gmr.actionlets.choices import Choices
from gmr.actionlets.mutable import Mutable
from gmr.actionlets.score import Score
from gmr.actionlets.track import Piece, Track

__all__ = ["Pool", "Variable", "Variation"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_MOST: Final = 0.6
"""Amount of the mutation that a variation of 1 asks for: beyond it steps stumble."""
_OWN: Final = 0.25
"""Share by which the sides differ, of what both change."""
_STRIDE: Final = 0.3
"""Share of its change that hip flexion takes where a speed is asked, for a stride carries it."""
_CADENCE: Final = 0.4
"""Share of its change that the tempo takes there: at one speed a slower step is a longer one."""
_SHARE: Final = 0.45
"""Of the way to its neighbour that an extreme moves at most."""


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
            given = defaults(unit)
            for dof, course in courses.items():
                rows = [[float(value.at(given)) for value in (e.phase, e.angle, e.skew)] for e in course]
                track = _track(np.array(rows), unit.cyclic)
                moving = [piece for piece in track.pieces if piece.travel]
                found.setdefault(_sideless(dof), []).extend(dict.fromkeys(moving))
        return {dof: tuple(pieces) for dof, pieces in found.items()}


@dataclass(frozen=True, eq=False)
class Variation:
    """How somebody does an action: what is changed in its E extremes and S phases.

    Args:
        tempo: what its period or duration is multiplied with.
        shift: (S,) what is added to each phase.
        neighbour: (E,) the number of the extreme towards which each moves.
        towards: (E,) by which share of the way.
        tilt: (E,) what is added to the skew.
    """

    tempo: float
    shift: Floats
    neighbour: Ints
    towards: Floats
    tilt: Floats


@dataclass(frozen=True, eq=False)
class Variable:
    """What variations of an action start from: one cycle of it, where nobody chooses the parameters.

    Args:
        cycle: as a score of one second.
        choices: pieces of other actions of the same types as those of the cycle.
        place: (E,) for each extreme of the action, which of the cycle it is.
        end: (E,) the piece that ends there.
        neighbour: (E,) of the two extremes beside it the one that is nearer, but not as high.
        way: (E,) how far it is there.
        free: (E,) share of its change that each extreme takes.
        cadence: share of its change that the tempo takes.
        partner: (E,) the extreme of the left limb from which it takes most of its changes; itself for others.
        warped: (N,) phases at which the times of the cycle's extremes are told.
        phases: (S,) the action's, within the cycle.
    """

    cycle: Mutable
    choices: Choices
    place: Ints
    end: Ints
    neighbour: Ints
    way: Floats
    free: Floats
    cadence: float
    partner: Ints
    warped: Floats
    phases: Floats

    @classmethod
    def of(
        cls, unit: ActionUnit, written: Written, ranges: Mapping[str, tuple[float, float]], pool: Pool
    ) -> Variable:
        """Of an action.

        Args:
            ranges: by degree of freedom, in the file's units.
            pool: where velocity functions of other actionlets come from.
        """
        rows = written.rows(unit)
        score = Score({dof: _track(one, unit.cyclic) for dof, one in rows.items()})
        cycle = Mutable.of(score, ranges)
        others = {dof: pool.pieces.get(_sideless(dof), ()) for dof in written.dofs}
        neighbour = np.concatenate([_neighbours(one[:, 1]) for one in rows.values()])
        neighbour += np.repeat(written.first[:-1], np.diff(written.first))
        place, end = _places(rows, score, unit.cyclic)
        angles = np.concatenate([one[:, 1] for one in rows.values()])
        inside = cycle.times[(cycle.times >= 0) & (cycle.times <= 1)]
        phases = written.phases.at(np.arange(len(written.phases)), defaults(unit))
        strides = "speed" in unit.parameters and unit.travel == "path"
        free = {dof: _STRIDE if strides and _sideless(dof) == "hip.flexion" else 1.0 for dof in rows}
        return cls(
            cycle=cycle,
            choices=Choices.of(score, others),
            place=place,
            end=end,
            neighbour=neighbour,
            way=angles[neighbour] - angles,
            free=np.concatenate([np.full(len(one), free[dof]) for dof, one in rows.items()]),
            cadence=_CADENCE if strides else 1.0,
            partner=_partners(written, neighbour),
            warped=np.unique([*inside, 0.0, 1.0]),
            phases=np.where((phases >= 0) & (phases <= 1), phases, phases % 1.0),
        )

    def varied(self, seed: int, amount: float) -> Variation:
        """The action as the performer ``seed`` does it.

        Args:
            seed: any whole number; each tells a performer, whoever else there is.
            amount: 0 (as written) to 1. Skews go that way towards those of other actionlets of their type.
        """
        if amount == 0:
            none = np.zeros(len(self.way))
            return Variation(1.0, np.zeros(len(self.phases)), self.neighbour, none, none)
        rng = np.random.default_rng(seed % 2**64)
        mutant = self.cycle.changed(rng, _MOST * amount)
        old, new = self.cycle.skews[self.end], mutant.skews[self.end]
        tilt = new - old + amount * (self._swapped(rng)[self.end] - old)
        moved = mutant.extremes[self.place] - self.cycle.extremes[self.place]
        towards = np.divide(moved, self.way, out=np.zeros(len(moved)), where=np.abs(self.way) > 1e-9)
        towards = np.clip(towards, -_SHARE, _SHARE)
        return Variation(
            mutant.tempo**self.cadence,
            self.cadence * np.interp(self.phases, self.warped, mutant.pace.warped(self.warped) - self.warped),
            self.neighbour,
            self.free * ((1 - _OWN) * towards[self.partner] + _OWN * towards),
            self.free * ((1 - _OWN) * tilt[self.partner] + _OWN * tilt),
        )

    def _swapped(self, rng: np.random.Generator) -> Floats:
        """(P,) skews of the cycle's pieces with the velocity functions of others."""
        drawn = self.choices.drawn(rng)
        found = self.cycle.skews.copy()
        found[drawn >= 0] = self.choices.skews[drawn[drawn >= 0]]
        return found


def _sideless(dof: str) -> str:
    return dof.removeprefix("left_").removeprefix("right_")


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


def _neighbours(angles: Floats) -> Ints:
    """(n,) the number of the nearer of the two extremes beside each; of two as near, the one after it."""
    numbers = np.arange(len(angles))
    before, after = np.roll(numbers, 1), np.roll(numbers, -1)
    return np.where(np.abs(angles - angles[before]) < np.abs(angles - angles[after]), before, after)


def _places(rows: Mapping[str, Floats], cycle: Score, is_cyclic: bool) -> tuple[Ints, Ints]:
    """For each extreme of an action, which extreme of the cycle it is, and which piece ends there."""
    places, ends, pieces = [], [], 0
    for number, (dof, one) in enumerate(rows.items()):
        track = cycle[dof]
        phases = one[:, 0] % 1.0 if is_cyclic else one[:, 0]
        place = np.abs(track.times - phases[:, None]).argmin(axis=1)
        # The piece that ends at the first extreme is the last one of the cycle before.
        end = np.where(place > 0, place - 1, len(track.pieces) - 1 if is_cyclic else 0)
        places.append(place + pieces + number)
        ends.append(end + pieces)
        pieces += len(track.pieces)
    return np.concatenate(places), np.concatenate(ends)


def _partners(written: Written, neighbour: Ints) -> Ints:
    """(E,) the extreme of the left limb for one of the right that moves the same way; itself for others."""
    found = np.arange(len(neighbour))
    spans = dict(zip(written.dofs, zip(written.first[:-1], written.first[1:], strict=True), strict=True))
    for dof, (first, last) in spans.items():
        start, end = spans.get("left_" + dof.removeprefix("right_"), (0, 0))
        if dof.startswith("right_") and np.array_equal(
            neighbour[first:last] - first, neighbour[start:end] - start
        ):
            found[first:last] = np.arange(start, end)
    return found
