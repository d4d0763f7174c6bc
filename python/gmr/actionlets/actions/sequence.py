"""Actions one after the other, under one name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from gmr.actionlets.actions.action import Action, SingleAction
from gmr.actionlets.actions.plan import Plan, in_turn
from gmr.actionlets.actions.reading import Origin
from gmr.actionlets.actions.tables import nearest
from gmr.actionlets.actions.timeline import Profile, chosen_parameters
from gmr.actionlets.actions.units import Step
from gmr.errors import ActionletError, FormatError

__all__ = ["SequenceAction", "sequence_of"]

_JOIN: Final = 0.25
"""Seconds of a transition where a file does not say."""
_LONGEST_JOIN: Final = 60.0
_PHASES: Final = 100
"""Phases of a cycle that are looked at for a change-over."""


@dataclass(frozen=True)
class SequenceAction(Action):
    """Actions in turn; where one that goes on follows another, it goes on with the same step.

    Args:
        parameters: none: its file chooses those of its actions.
        steps: each action, for how long (None: as it is by itself), with which parameters.
        join: seconds that each transition lasts at least.
    """

    steps: tuple[tuple[Action, float | None, Mapping[str, Profile]], ...]
    join: float

    def plan(
        self,
        chosen: Mapping[str, Profile],
        seconds: float | None,
        seed: int,
        variation: float,
        begins: float | None = None,
        size: float = 1.0,
    ) -> Plan:
        """What is to be done when; time beyond that of its actions goes to the last of them."""
        plans: list[Plan] = []
        owed = 0.0
        for number, (action, lasts, parameters) in enumerate(self.steps):
            shorter = None if lasts is None else max(lasts - owed, lasts / 2)
            plan = action.plan(parameters, shorter, seed, variation, begins, size)
            owed = 0.0
            if number + 1 < len(self.steps):
                after, _, others = self.steps[number + 1]
                owed = _until_alike(action, parameters, after, others, plan, size)
                if owed:
                    plan = action.plan(parameters, plan.seconds + owed, seed, variation, begins, size)
            plans.append(plan)
            begins = plan.phase
        total = sum(plan.seconds for plan in plans)
        if seconds is not None:
            if seconds < total - 1e-9:
                raise ActionletError(
                    f"'{self.name}' takes {total:.3g} s; give that many seconds or more, or none"
                )
            action, _, parameters = self.steps[-1]
            begins = plans[-2].phase if len(plans) > 1 else None
            lasts = plans[-1].seconds + seconds - total
            plans[-1] = action.plan(parameters, lasts, seed, variation, begins, size)
        whole = in_turn(plans, self.join)
        names = [action.name for action, _, _ in self.steps]
        return replace(whole, labels=_named(names, plans) + whole.labels)


def _until_alike(
    one: Action,
    chosen: Mapping[str, Profile],
    other: Action,
    others: Mapping[str, Profile],
    plan: Plan,
    size: float,
) -> float:
    """Seconds by which to go on with ``one`` until the feet do the same in both, longest before and after.

    0 where not both go on, or their parameters change.
    """
    if not (isinstance(one, SingleAction) and isinstance(other, SingleAction)):
        return 0.0
    if plan.phase is None or not other.unit.cyclic:
        return 0.0
    phases = np.arange(_PHASES) / _PHASES
    stand = [action.standing(values, phases, size) for action, values in ((one, chosen), (other, others))]
    differ = np.flatnonzero((stand[0] != stand[1]).any(axis=0))
    if not len(differ):
        return 0.0
    away = np.abs(phases[:, None] - phases[differ])
    away = np.minimum(away, 1 - away).min(axis=1)
    best = phases[away >= 0.9 * away.max()]
    cycles = ((best - plan.phase) % 1.0).min()
    return float(cycles) * one.period(chosen, size)


def _named(names: list[str], plans: list[Plan]) -> tuple[tuple[str, float, float], ...]:
    begin, rows = 0.0, []
    for name, plan in zip(names, plans, strict=True):
        rows.append((name, begin, begin + plan.seconds))
        begin += plan.seconds
    return tuple(rows)


def sequence_of(origin: Origin, steps: tuple[Step, ...], actions: Mapping[str, Action]) -> SequenceAction:
    """The sequence that a file writes.

    Args:
        actions: those that it may use, by name.

    Raises:
        FormatError: an action that does not exist, or a parameter that it does not take.
    """
    table = origin.table
    found = []
    for number, step in enumerate(steps):
        if step.action not in actions:
            raise table.fault(
                f"actions[{number}]", step.action, f"the name of an action. {nearest(step.action, actions)}"
            )
        action = actions[step.action]
        try:
            chosen = chosen_parameters(action.name, action.parameters, step.parameters)
        except ActionletError as error:
            raise FormatError(f"[{table.place}] actions[{number}]: {error}", file=table.file) from error
        found.append((action, step.seconds, chosen))
    join = table.number("join", _JOIN)
    if not 0 < join <= _LONGEST_JOIN:
        raise table.fault("join", join, f"more than 0 s, and {_LONGEST_JOIN:g} at most")
    return SequenceAction(
        origin.name,
        table.text("about", ""),
        table.texts("words"),
        table.texts("aliases"),
        {},
        tuple(found),
        join,
    )
