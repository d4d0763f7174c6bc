"""The text of a relation read and checked: what is wrong is said with its place, before any marker is seen.

``docs/markers.md`` describes the text.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, Final

from gmr.errors import FormatError, GmrError
from gmr.listing import quoted
from gmr.markers.anatomy import RULES, Rule
from gmr.markers.relation import Direction, Part, Relation

__all__ = ["read_relation"]

_AXES: Final = ("left", "up", "forward")
_PART_KEYS: Final = frozenset({"joint", "parent", "markers", "loose", "centre", "at", "tip", *_AXES})
_SHOWN: Final = 8


def read_relation(data: bytes, file: str) -> Relation:
    """The relation in the bytes of a TOML file.

    Raises:
        FormatError: names the entry at fault, what was expected, and how to mend it.
    """
    try:
        text = tomllib.loads(data.decode("utf-8-sig"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise FormatError(
            f"this is no TOML: {error}. See the relations that ship with gmr.", file=file
        ) from error
    try:
        return _relation(text, file)
    except _FaultError as fault:
        raise FormatError(str(fault), file=file) from None


class _FaultError(GmrError):
    """What is wrong with a relation, still without its file."""


def _relation(text: Mapping[str, Any], file: str) -> Relation:
    entries = text.get("parts")
    if not isinstance(entries, dict) or not entries:
        raise _FaultError("it has no parts. Write a table [parts.pelvis] and one for each other part.")
    _check_keys("the file", text, {"name", "about", "aliases", "parts"})
    parts = [_part(name, entry) for name, entry in entries.items()]
    ordered = _parents_first(parts)
    _check_joints(parts)
    for part in parts:
        _check_points(part, parts)
    aliases = text.get("aliases", {})
    labels = {label for part in parts for label in (*part.markers, *part.loose)}
    for other, label in aliases.items() if isinstance(aliases, dict) else [("", aliases)]:
        if label not in labels:
            raise _FaultError(f"[aliases] {other} = {label!r} names no marker of a part")
    return Relation(
        str(text.get("name", Path(file).stem)), str(text.get("about", "")), ordered, aliases, file
    )


def _part(name: str, entry: Any) -> Part:
    where = f"[parts.{name}]"
    if not isinstance(entry, dict):
        raise _FaultError(f"{where} must be a table with joint, parent and markers")
    _check_keys(where, entry, _PART_KEYS)
    if not isinstance(entry.get("joint"), str):
        raise _FaultError(
            f"{where} has no joint. Write the name of the joint at its upper end: joint = 'LeftLeg'."
        )
    axes = [axis for axis in entry if axis in _AXES]
    if len(axes) != 2:
        raise _FaultError(
            f"{where} gives {len(axes)} directions. Write two of left, up and forward, the more certain "
            "first: up = { from = ['LeftLeg'], to = ['LeftUpLeg'] }."
        )
    parent = entry.get("parent")
    if parent is not None and not isinstance(parent, str):
        raise _FaultError(f"{where} has a parent that is no name of a part")
    directions = [_direction(f"{where} {axis}", _AXES.index(axis), entry[axis]) for axis in axes]
    return Part(
        name=name,
        joint=entry["joint"],
        parent=parent,
        markers=_names(f"{where} markers", entry.get("markers", [])),
        loose=_names(f"{where} loose", entry.get("loose", [])),
        directions=(directions[0], directions[1]),
        centre=_rule(f"{where} centre", entry["centre"]) if "centre" in entry else None,
        at=_names(f"{where} at", entry.get("at", [])),
        tip=_names(f"{where} tip", entry.get("tip", [])),
    )


def _direction(where: str, axis: int, entry: Any) -> Direction:
    if not isinstance(entry, dict) or set(entry) != {"from", "to"}:
        raise _FaultError(f"{where} must say from where to where: {{ from = ['R_IAS'], to = ['L_IAS'] }}")
    return Direction(axis, _names(f"{where} from", entry["from"]), _names(f"{where} to", entry["to"]))


def _rule(where: str, entry: Any) -> Rule:
    """The rule with its values, each of the type that its field has."""
    known = quoted(tuple(RULES), len(RULES))
    if not isinstance(entry, dict) or entry.get("rule") not in RULES:
        raise _FaultError(f"{where} must name a rule: {{ rule = 'midpoint', of = [...] }}; there are {known}")
    kind = RULES[entry["rule"]]
    known_fields = {field.name: field for field in fields(kind)}
    values = {key: value for key, value in entry.items() if key != "rule"}
    _check_keys(where, values, known_fields)
    made: dict[str, Any] = {}
    for key, value in values.items():
        default = known_fields[key].default
        if isinstance(default, float) or default is MISSING:
            made[key] = _length(f"{where} {key}", value)
        elif isinstance(default, str):
            if not isinstance(value, str):
                raise _FaultError(f"{where} {key} must be one name, in quotes")
            made[key] = value
        elif key == "by":
            if not isinstance(value, list) or len(value) != 3:
                raise _FaultError(f"{where} by must be three lengths in metres: left, up, forward")
            made[key] = tuple(_length(f"{where} by", step, signed=True) for step in value)
        else:
            made[key] = _names(f"{where} {key}", value)
    rule = kind(**made)
    lacking = [
        key for key, field in known_fields.items()
        if key not in made and field.default in ("", ()) and key not in ("leg",)
    ]  # fmt: skip
    if lacking:
        raise _FaultError(f"{where} lacks {quoted(lacking, _SHOWN)}")
    for key in ("asis", "across"):
        if len(made.get(key, (0, 0))) != 2:
            raise _FaultError(f"{where} {key} must name two markers: the left one, then the right one")
    if made.get("side", "left") not in ("left", "right"):
        raise _FaultError(f"{where} side must be 'left' or 'right'")
    return rule


def _length(where: str, value: Any, *, signed: bool = False) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 10:
        raise _FaultError(f"{where} must be a length in metres, such as 0.008")
    if not signed and not value > 0:
        raise _FaultError(f"{where} must be more than 0 metres")
    return float(value)


def _names(where: str, entry: Any) -> tuple[str, ...]:
    entry = [entry] if isinstance(entry, str) else entry
    if not isinstance(entry, list) or not all(isinstance(name, str) and name for name in entry):
        raise _FaultError(f"{where} must be a list of names, each in quotes")
    if len(set(entry)) < len(entry):
        raise _FaultError(f"{where} names a point twice")
    return tuple(entry)


def _check_keys(where: str, entry: Mapping[str, Any], known: Iterable[str]) -> None:
    unknown = [key for key in entry if key not in known]
    if unknown:
        raise _FaultError(
            f"{where} has an unknown entry '{unknown[0]}'; there are {quoted(sorted(known), 12)}"
        )


def _parents_first(parts: list[Part]) -> tuple[Part, ...]:
    """The parts so ordered that none comes before its parent, depth first, siblings as written."""
    names = {part.name for part in parts}
    for part in parts:
        if part.parent is not None and part.parent not in names:
            raise _FaultError(f"[parts.{part.name}] hangs on '{part.parent}', which is no part")
    ordered: list[Part] = []
    waiting = [part for part in reversed(parts) if part.parent is None]
    while waiting:
        part = waiting.pop()
        ordered.append(part)
        waiting += [child for child in reversed(parts) if child.parent == part.name]
    if len(ordered) < len(parts):
        lost = next(part.name for part in parts if part not in ordered)
        raise _FaultError(
            f"[parts.{lost}] hangs on itself through its parents. One part must have no parent."
        )
    return tuple(ordered)


def _check_joints(parts: list[Part]) -> None:
    owners: dict[str, str] = {}
    for part in parts:
        if part.joint in owners:
            raise _FaultError(
                f"[parts.{part.name}] and [parts.{owners[part.joint]}] have the same joint '{part.joint}'"
            )
        owners[part.joint] = part.name
    on: dict[str, str] = {}
    for part in parts:
        for label in (*part.markers, *part.loose):
            if label in owners:
                raise _FaultError(f"'{label}' is a marker and a joint. Give the joint another name.")
            if label in on:
                raise _FaultError(
                    f"the marker '{label}' is on '{on[label]}' and on '{part.name}'; it can be on one part"
                )
            on[label] = part.name


def _check_points(part: Part, parts: list[Part]) -> None:
    """Every point that a part speaks of must be a marker or a joint in it."""
    where = f"[parts.{part.name}]"
    parent = next((other for other in parts if other.name == part.parent), None)
    inside = _points_of(part, parts)
    spoken = [name for way in part.directions for name in (*way.start, *way.end)]
    for name in (*spoken, *part.at, *part.tip):
        if name not in inside:
            raise _FaultError(
                f"{where} speaks of '{name}', which is neither a marker nor a joint of this part"
            )
    if part.centre is None:
        return
    if parent is None:
        raise _FaultError(
            f"{where} has no parent, so that it has no joint centre; say where its joint is put with at"
        )
    above = _points_of(parent, parts)
    for name in part.centre.names:
        if name not in above:
            raise _FaultError(
                f"{where} centre speaks of '{name}', which is neither a marker nor a joint of "
                f"'{parent.name}', the part above"
            )
    by_joints = {name for way in parent.directions for name in (*way.start, *way.end)} - {
        *parent.markers,
        *parent.loose,
    }
    if part.centre.needs_axes and by_joints - {parent.joint}:
        raise _FaultError(
            f"{where} centre needs the axes of '{parent.name}', whose directions speak of "
            f"{quoted(sorted(by_joints - {parent.joint}), 3)}; give that part's directions by markers"
        )


def _points_of(part: Part, parts: list[Part]) -> set[str]:
    joints = {other.joint for other in parts if other.parent == part.name}
    return {*part.markers, *part.loose, part.joint, *joints}
