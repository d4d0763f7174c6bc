"""An action as its file writes it, as arrays: what all of its performances share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.many_values import Values
from gmr.actionlets.actions.parts import Courses
from gmr.actionlets.actions.units import ActionUnit
from gmr.actionlets.actions.values import Value

__all__ = ["Span", "Written", "defaults"]

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

Span = tuple[int, int]
"""Numbers of the phases where something begins and ends."""


@dataclass(frozen=True, eq=False)
class Written:
    """E extremes, one degree of freedom after the other, and what begins and ends beside them.

    Args:
        dofs: names of the D degrees of freedom.
        first: (D + 1,) number of the first extreme of each; E at the end.
        phases: of the extremes, then of the beginnings and ends.
        angles, skews: of the extremes, in the file's units.
        low, high: (E,) ranges of motion, in the file's units.
        factor: (E,) radians, or metres, in one of those.
        contacts: by side.
        labels: by name.
    """

    dofs: tuple[str, ...]
    first: Ints
    phases: Values
    angles: Values
    skews: Values
    low: Floats
    high: Floats
    factor: Floats
    contacts: Mapping[str, Sequence[Span]]
    labels: Mapping[str, Span]

    @classmethod
    def of(
        cls,
        unit: ActionUnit,
        courses: Courses,
        ranges: Mapping[str, tuple[float, float]],
        factors: Mapping[str, float],
    ) -> Written:
        """The action as arrays; arguments as those of ``SingleAction``."""
        extremes = [extreme for course in courses.values() for extreme in course]
        counts = [len(course) for course in courses.values()]
        phases = [extreme.phase for extreme in extremes]

        def placed(span: tuple[Value, Value]) -> Span:
            phases.extend(span)
            return len(phases) - 2, len(phases) - 1

        contacts = {side: tuple(map(placed, spans)) for side, spans in unit.contacts.items()}
        labels = {name: placed(span) for name, span in unit.labels.items()}
        return cls(
            dofs=tuple(courses),
            first=np.cumsum([0, *counts]),
            phases=Values.of(phases),
            angles=Values.of([extreme.angle for extreme in extremes]),
            skews=Values.of([extreme.skew for extreme in extremes]),
            low=np.repeat([ranges[dof][0] for dof in courses], counts),
            high=np.repeat([ranges[dof][1] for dof in courses], counts),
            factor=np.repeat([factors[dof] for dof in courses], counts),
            contacts=contacts,
            labels=labels,
        )

    def rows(self, unit: ActionUnit) -> Mapping[str, Floats]:
        """By degree of freedom (n, 3) phase, angle and skew where nobody chooses the parameters."""
        given, numbers = defaults(unit), np.arange(len(self.angles))
        found = np.stack(
            [values.at(numbers, given) for values in (self.phases, self.angles, self.skews)], axis=1
        )
        return dict(zip(self.dofs, np.split(found, self.first[1:-1]), strict=True))


def defaults(unit: ActionUnit) -> dict[str, float]:
    """What the parameters are where nobody chooses them."""
    chosen = {name: parameter.default for name, parameter in unit.parameters.items()}
    return chosen | dict.fromkeys(unit.derived, 0.0)
