"""Units put together: which extremes each degree of freedom of an action goes through.

A unit is written once. Used for the right side it is mirrored: what it says of the left it does on the right,
what bends or turns the trunk to the left turns it to the right, and parameters with a side change their sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from gmr.actionlets.actions.anatomy import Anatomy
from gmr.actionlets.actions.tables import nearest
from gmr.actionlets.actions.units import ActionUnit, Change, Extreme, Part, Unit
from gmr.actionlets.actions.values import Value
from gmr.errors import FormatError

__all__ = ["Courses", "action_courses", "check_unit", "mirrored_contacts"]

Courses: TypeAlias = dict[str, tuple[Extreme, ...]]
"""By degree of freedom, the extremes of one cycle."""

_TO_A_SIDE: Final = ("lateral", "rotation", "sway", "obliquity")
"""Motions of the trunk and the root that are the other way round in a mirror."""


_DEEPEST: Final = 100
_MOST_EXTREMES: Final = 10_000


@dataclass(frozen=True, slots=True)
class _Assembly:
    units: Mapping[str, Unit]
    anatomy: Anatomy
    sided: frozenset[str]
    file: str
    place: str
    user: Callable[[str], FormatError] | None = None

    def fault(self, sentence: str) -> FormatError:
        return FormatError(f"[{self.place}] {sentence}", file=self.file)

    def inside(self, unit: Unit) -> _Assembly:
        return replace(self, file=unit.file, place=f"{unit.kind}.{unit.name}", user=self.user or self.fault)


def action_courses(action: ActionUnit, units: Mapping[str, Unit], anatomy: Anatomy) -> Courses:
    """The extremes of an action by degree of freedom, all checked.

    Raises:
        FormatError: names that do not exist or go in a circle, a limb that is not connected, two units that
            move the same, an angle outside its range of motion, a parameter that the action has not.
    """
    sided = action.sided
    at = _Assembly(units, anatomy, sided, action.file, f"action.{action.name}")
    courses = _joined(at, ((part, _of_part(part, "", at, ())) for part in action.parts))
    for dof, change in action.changes.items():
        anatomy.check_dof(dof, at.fault)
        courses[dof] = _changed(courses.get(dof), change, dof, at)
    if action.mirrored:
        courses = _in_the_mirror(courses, sided)
    if not courses:
        raise at.fault("moves nothing; give it units, or dofs with their extremes")
    for dof, course in courses.items():
        anatomy.check_range(dof, course, at.fault)
        numbers = (number for e in course for number in (e.phase, e.angle, e.skew))
        _check_parameters(numbers, action, f"moves {dof}", at)
    _check_timing(action, at)
    return courses


def check_unit(unit: Unit, units: Mapping[str, Unit], anatomy: Anatomy) -> None:
    """Checks a unit by itself, whether or not an action uses it.

    Raises:
        FormatError: as for :func:`action_courses`.
    """
    at = _Assembly(units, anatomy, frozenset(), unit.file, f"{unit.kind}.{unit.name}")
    for dof, course in _of_part(Part(unit.name, "left"), "", at, ()).items():
        anatomy.check_range(dof, course, at.fault)


def _of_part(part: Part, side: str, at: _Assembly, chain: tuple[str, ...]) -> Courses:
    """The courses of a part in a unit that is itself used for ``side``."""
    if part.unit in chain:
        raise at.fault(f"goes in a circle of names: {' -> '.join((*chain, part.unit))}")
    if len(chain) > _DEEPEST:
        raise at.fault(f"has units in units more than {_DEEPEST} deep; put fewer into each other")
    unit = at.units.get(part.unit)
    if unit is None:
        raise at.fault(
            f"uses '{part.unit}', which no joint, limb or group is called. {nearest(part.unit, at.units)}"
        )
    flipped = part.side == "right"
    own = part.side or side
    courses = _of_unit(unit, own, at.inside(unit), (*chain, part.unit))
    if flipped:
        courses = _in_the_mirror(courses, at.sided)
    if (count := part.rate * max(map(len, courses.values()), default=0)) > _MOST_EXTREMES:
        raise at.fault(
            f"has '{part.unit}' {part.rate} times in a period, with {count:,} extremes of one degree of "
            f"freedom; {_MOST_EXTREMES:,} are the most"
        )
    return {dof: _synchronised(_spread(course, part.scale), part) for dof, course in courses.items()}


def _of_unit(unit: Unit, side: str, at: _Assembly, chain: tuple[str, ...]) -> Courses:
    """The courses of a unit as it is written: for the left, where it has no side."""
    if unit.kind == "joint":
        joint = at.anatomy.joint(unit.joint, bool(side), chain[0], at.fault, at.user or at.fault)
        return {at.anatomy.dof(joint, motion, at.fault): course for motion, course in unit.motions.items()}
    courses = _joined(at, ((part, _of_part(part, side and "left", at, chain)) for part in unit.parts))
    if unit.kind == "limb":
        for part in unit.parts:
            if part.unit in at.units and at.units[part.unit].kind != "joint":
                raise at.fault(
                    f"is a limb, made of joint actions; '{part.unit}' is a {at.units[part.unit].kind}"
                )
        at.anatomy.check_connected(courses, at.fault)
    return courses


def _joined(at: _Assembly, parts: Iterable[tuple[Part, Courses]]) -> Courses:
    courses: Courses = {}
    homes: dict[str, str] = {}
    for part, found in parts:
        for dof, course in found.items():
            if dof in courses:
                raise at.fault(f"has '{homes[dof]}' and '{part.unit}', and both move {dof}; take one of them")
            courses[dof], homes[dof] = course, part.unit
    return courses


def mirrored_contacts(action: ActionUnit) -> ActionUnit:
    """The action with the contacts and the labels of its sides exchanged, where it is mirrored."""
    if not action.mirrored:
        return action

    def other(span: tuple[Value, Value]) -> tuple[Value, Value]:
        return span[0].mirrored(action.sided), span[1].mirrored(action.sided)

    return replace(
        action,
        contacts={_other(side): tuple(map(other, spans)) for side, spans in action.contacts.items()},
        labels={_other(name): other(span) for name, span in action.labels.items()},
    )


def _in_the_mirror(courses: Courses, sided: frozenset[str]) -> Courses:
    return {_other(dof): _mirrored(dof, course, sided) for dof, course in courses.items()}


def _other(name: str) -> str:
    for one, other in (("left", "right"), ("right", "left")):
        if name.startswith(one):
            return other + name.removeprefix(one)
    return name


def _mirrored(dof: str, course: Sequence[Extreme], sided: frozenset[str]) -> tuple[Extreme, ...]:
    central = not dof.startswith(("left_", "right_"))
    sign = -1.0 if central and dof.partition(".")[2] in _TO_A_SIDE else 1.0
    return tuple(
        Extreme(e.phase.mirrored(sided), e.angle.mirrored(sided).scaled(sign), e.skew.mirrored(sided))
        for e in course
    )


def _spread(course: tuple[Extreme, ...], scale: float) -> tuple[Extreme, ...]:
    """The course with ``scale`` times its distance from its middle."""
    if scale == 1:
        return course
    middle = Value(0.0)
    for extreme in course:
        middle = middle.plus(extreme.angle.scaled((1 - scale) / len(course)))
    return tuple(replace(e, angle=e.angle.scaled(scale).plus(middle)) for e in course)


def _synchronised(course: tuple[Extreme, ...], part: Part) -> tuple[Extreme, ...]:
    """``q(t) = p(rate t + phase)``: an extreme at phase x of p comes where ``rate t + phase = x + k``."""
    if part.phase == 0 and part.rate == 1:
        return course
    return tuple(
        replace(e, phase=e.phase.plus(Value(turn - part.phase)).scaled(1 / part.rate))
        for turn in range(part.rate)
        for e in course
    )


def _changed(
    course: tuple[Extreme, ...] | None, change: Change, dof: str, at: _Assembly
) -> tuple[Extreme, ...]:
    if change.extremes:
        return change.extremes
    if course is None:
        raise at.fault(f"changes {dof}, which no unit of it moves; give it extremes: [[0, 10], [0.5, 40]]")
    spread = _synchronised(_spread(course, change.scale), Part("", phase=change.phase))
    return tuple(replace(e, angle=e.angle.plus(change.add)) for e in spread)


def _check_timing(action: ActionUnit, at: _Assembly) -> None:
    """Checks the parameters of all that an action says beside its degrees of freedom."""
    _check_parameters([action.span], action, "lasts as long as it does", at)
    for side, spans in action.contacts.items():
        numbers = [number for span in spans for number in span]
        _check_parameters(numbers, action, f"has contacts of the {side} foot", at)
    for label, span in action.labels.items():
        _check_parameters(span, action, f"has the phase '{label}'", at)
    for name in action.courses.keys() - action.parameters.keys():
        raise at.fault(
            f"has the course of a parameter '{name}', which it does not have. "
            f"{nearest(name, action.parameters)}"
        )


def _check_parameters(numbers: Iterable[Value], action: ActionUnit, does: str, at: _Assembly) -> None:
    known = {*action.parameters, *action.derived}
    for name in sorted(frozenset[str]().union(*(number.parameters for number in numbers)) - known):
        raise at.fault(f"{does} by the parameter '{name}', which it does not have. {nearest(name, known)}")
