"""Library files, read: TOML to units, with errors that name file, table, key, value and what was expected.

``docs/actions.md`` describes the files.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from gmr.actionlets.actions.tables import Table, nearest
from gmr.actionlets.actions.units import (
    LEAN,
    MOST_SECONDS,
    SIDES,
    ActionUnit,
    Change,
    Parameter,
    Part,
    Step,
    Unit,
)
from gmr.errors import FormatError

__all__ = ["FORMAT", "MAX_BYTES", "Content", "Origin", "read_files"]

FORMAT: Final = 1
_KINDS: Final = ("joint", "limb", "group", "action", "sequence")
_SPACES: Final = {"joint": "unit", "limb": "unit", "group": "unit", "action": "action", "sequence": "action"}
_PARTS_KEYS: Final = ("unit", "side", "phase", "rate", "scale")
_ACTION_KEYS: Final = (
    "about", "words", "aliases", "parameters", "period", "duration", "begins", "seconds", "units", "dofs",
    "contacts", "travel", "phases", "course", "mirrored", "from",
)  # fmt: skip
_TAKEN: Final = ("seconds", "fps", "seed", "body", "variation", LEAN)
"""What is asked beside the parameters, and what follows from them."""
MAX_BYTES: Final = 16 * 2**20
"""Of a library file."""
_LONGEST: Final = 100
_NAME: Final = re.compile(rf"\w[\w-]{{0,{_LONGEST - 1}}}")
_DEEPEST: Final = 100
"""Tables that one may take ``from`` another, in a row."""
_MOST_STEPS: Final = 1000
_SPANS: Final = (0.01, 3600.0)
"""Seconds of a period or a duration."""


@dataclass(frozen=True, slots=True)
class Origin:
    """A table as it stands in its file, before ``from`` is followed."""

    kind: str
    name: str
    table: Table


@dataclass(frozen=True, slots=True)
class Content:
    """All that some files define."""

    units: Mapping[str, Unit] = field(default_factory=dict)
    actions: Mapping[str, ActionUnit] = field(default_factory=dict)
    sequences: Mapping[str, tuple[Origin, tuple[Step, ...]]] = field(default_factory=dict)


def read_files(files: Mapping[str, bytes]) -> Content:
    """The content of library files, each of which may use the names of all.

    Args:
        files: by name as the user knows it, the bytes.

    Raises:
        FormatError: says which file, table and key, what is there, and what was expected.
    """
    found: dict[tuple[str, str], Origin] = {}
    for file, data in files.items():
        for origin in _tables(data, file):
            key = (_SPACES[origin.kind], origin.name)
            if key in found:
                raise FormatError(
                    f"[{origin.table.place}] has a name that {found[key].table.file} gives to "
                    f"[{found[key].table.place}]; give it another",
                    file=file,
                )
            found[key] = origin
    whole = [_followed(origin, found, ()) for origin in found.values()]
    return Content(
        units={origin.name: _unit(origin) for origin in whole if _SPACES[origin.kind] == "unit"},
        actions={origin.name: _action(origin) for origin in whole if origin.kind == "action"},
        sequences={
            origin.name: (origin, _steps(origin.table)) for origin in whole if origin.kind == "sequence"
        },
    )


@lru_cache(maxsize=32)
def _tables(data: bytes, file: str) -> tuple[Origin, ...]:
    if len(data) > MAX_BYTES:
        raise FormatError("so much is no library of actions; 16 MB are the most", file=file)
    try:
        text = tomllib.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:  # ValueError: no UTF-8, no TOML, too many digits
        raise FormatError(f"this is no TOML: {error}. See docs/actions.md.", file=file) from error
    top = Table(file, Path(file).name, text)
    top.check_keys(("format", "name", "about", "credit", *_KINDS))
    if text.get("format") != FORMAT or isinstance(text.get("format"), bool):
        raise top.fault("format", text.get("format"), f"format = {FORMAT}, the version that this gmr reads")
    return tuple(
        Origin(kind, _checked_name(top, kind, name), Table(file, f"{kind}.{name}", table.held))
        for kind in _KINDS
        for name, table in top.table(kind).tables().items()
    )


def _checked_name(top: Table, kind: str, name: str) -> str:
    """A name that can be typed, listed between commas, and be that of a folder of takes."""
    if not _NAME.fullmatch(name):
        raise top.fault(
            kind, name, f"a name of letters, digits, _ and -, as in [{kind}.my_{kind}]; {_LONGEST} at most"
        )
    return name


def _followed(origin: Origin, found: Mapping[tuple[str, str], Origin], seen: tuple[str, ...]) -> Origin:
    """The table with what it takes ``from`` another of its kind below its own keys."""
    table = origin.table
    if "from" not in table.held:
        return origin
    name = table.text("from")
    chain = (*seen, origin.name)
    if name in chain:
        raise table.fault("from", name, f"no circle of names; here {' -> '.join((*chain, name))}")
    if len(chain) > _DEEPEST:
        raise table.fault("from", name, f"at most {_DEEPEST} names that take from each other in a row")
    source = found.get((_SPACES[origin.kind], name))
    if source is None or source.kind != origin.kind:
        known = [other.name for other in found.values() if other.kind == origin.kind]
        raise table.fault("from", name, f"the name of another {origin.kind}. {nearest(name, known)}")
    below = dict(_followed(source, found, chain).table.held)
    for own in ("aliases", "about", "words"):
        below.pop(own, None)
    if {"period", "duration"} & set(table.held):
        below.pop("period", None)
        below.pop("duration", None)
    held = _over(below, {key: value for key, value in table.held.items() if key != "from"})
    return Origin(origin.kind, origin.name, Table(table.file, table.place, held))


def _over(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Tables joined key by key; a value that is above hides the one below."""
    joined = dict(below)
    for key, value in above.items():
        under = joined.get(key)
        deeper = isinstance(value, dict) and isinstance(under, dict) and key != "base"
        joined[key] = _over(under, value) if deeper else value  # type: ignore[arg-type]
    return joined


def _unit(origin: Origin) -> Unit:
    table = origin.table
    if origin.kind == "joint":
        motions = [key for key in table.held if key not in ("joint", "about")]
        if not motions:
            raise FormatError(
                f"[{table.place}] moves nothing; write flexion = [[0, 10], [0.5, 40]]", file=table.file
            )
        return Unit(
            "joint", origin.name, table.file, table.text("joint"),
            motions={motion: table.extremes(motion) for motion in motions},
        )  # fmt: skip
    table.check_keys(("units", "about"))
    parts = _parts(table)
    if not parts or (origin.kind == "limb" and len(parts) < 2):
        least = "two joint actions or more" if origin.kind == "limb" else "one unit or more"
        raise table.fault("units", table.held.get("units"), least)
    return Unit(origin.kind, origin.name, table.file, parts=parts)


def _parts(table: Table) -> tuple[Part, ...]:
    rows = table.held.get("units", [])
    if not isinstance(rows, list):
        raise table.fault(
            "units", rows, "a list of units, each a name or { unit = ..., side = ..., phase = ... }"
        )
    return tuple(_part(table, f"units[{number}]", row) for number, row in enumerate(rows))


def _part(table: Table, key: str, row: Any) -> Part:
    if isinstance(row, str):
        return Part(row)
    if not isinstance(row, dict):
        raise table.fault(key, row, "a name or { unit = ..., side = ..., phase = ... }")
    entry = Table(table.file, f"{table.place}] [{key}", row)
    entry.check_keys(_PARTS_KEYS)
    rate = entry.number("rate", 1)
    if rate != int(rate) or not 1 <= rate <= 100:
        raise entry.fault("rate", row["rate"], "a whole number of times in a period, 1 to 100")
    side = entry.choice("side", SIDES) if "side" in row else ""
    return Part(entry.text("unit"), side, entry.number("phase", 0), int(rate), entry.number("scale", 1))


def _action(origin: Origin) -> ActionUnit:
    table = origin.table
    table.check_keys(_ACTION_KEYS)
    spans = [key for key in ("period", "duration") if key in table.held]
    if len(spans) != 1:
        raise FormatError(
            f"[{table.place}] has {' and '.join(spans) or 'neither period nor duration'}; write one of them: "
            "period = 1.1 for what goes on, duration = 2.0 for what is done once",
            file=table.file,
        )
    span = table.value(spans[0])
    shortest, longest = _SPANS
    if not (span.lowest >= shortest and span.highest <= longest):
        raise table.fault(
            spans[0], table.held[spans[0]],
            f"more than 0 s, whatever the parameters: {shortest:g} to {longest:g}",
        )  # fmt: skip
    contacts = table.table("contacts")
    contacts.check_keys(SIDES)
    labels = table.table("phases")
    return ActionUnit(
        name=origin.name,
        file=table.file,
        about=table.text("about", ""),
        words=table.texts("words"),
        aliases=table.texts("aliases"),
        parameters={
            name: _parameter(name, entry) for name, entry in table.table("parameters").tables().items()
        },
        cyclic=spans[0] == "period",
        span=span,
        begins=table.number("begins", 0),
        seconds=_seconds(table),
        parts=_parts(table),
        changes={dof: _change(table.table("dofs"), dof) for dof in table.table("dofs").held},
        contacts={side: contacts.spans(side) for side in SIDES},
        travel=table.choice("travel", ("path", "feet"), "feet"),
        labels={name: labels.span(name, span_) for name, span_ in labels.held.items()},
        courses={name: _course(table.table("course"), name) for name in table.table("course").held},
        mirrored=table.flag("mirrored"),
    )


def _seconds(table: Table) -> float | None:
    """How long, where the table says."""
    if "seconds" not in table.held:
        return None
    seconds = table.number("seconds")
    if not 0 < seconds <= MOST_SECONDS:
        raise table.fault("seconds", seconds, f"more than 0 s, and {MOST_SECONDS:,.0f} at most")
    return seconds


def _parameter(name: str, table: Table) -> Parameter:
    table.check_keys(("low", "high", "default", "unit", "about", "sided"))
    if name in _TAKEN or not name.isidentifier():
        raise FormatError(
            f"[{table.place}] a parameter cannot be called '{name}'; call it by one word, and not "
            f"{', '.join(_TAKEN)}",
            file=table.file,
        )
    low, high, default = (table.number(key) for key in ("low", "high", "default"))
    if not low <= default <= high:
        raise table.fault("default", default, f"a number from low = {low:g} to high = {high:g}")
    return Parameter(
        name, low, high, default, table.text("unit", ""), table.text("about", ""), table.flag("sided")
    )


def _change(table: Table, dof: str) -> Change:
    held = table.held[dof]
    if not isinstance(held, dict) or not {"scale", "add", "phase"} & set(held):
        return Change(extremes=table.extremes(dof))
    entry = table.table(dof)
    entry.check_keys(("scale", "add", "phase"))
    return Change(scale=entry.number("scale", 1), add=entry.value("add", 0), phase=entry.number("phase", 0))


def _course(table: Table, parameter: str) -> tuple[tuple[float, float], ...]:
    points = table.pairs(parameter)
    early = [seconds for seconds, _ in points if seconds >= 0]
    late = [seconds for seconds, _ in points if seconds < 0]
    if (
        not points
        or early + late != [seconds for seconds, _ in points]
        or not (_rises(early) and _rises(late))
    ):
        raise table.fault(
            parameter, table.held[parameter],
            "rows of [seconds, factor] in order: rising from the beginning, then, below 0, rising to the end",
        )  # fmt: skip
    return points


def _rises(numbers: list[float]) -> bool:
    return all(before < after for before, after in pairwise(numbers))


def _steps(table: Table) -> tuple[Step, ...]:
    table.check_keys(("about", "words", "aliases", "actions", "join"))
    rows = table.held.get("actions")
    if not isinstance(rows, list) or not rows:
        raise table.fault(
            "actions", rows, "a list of actions, each a name or { action = ..., seconds = ... }"
        )
    if len(rows) > _MOST_STEPS:
        raise table.fault("actions", rows, f"{_MOST_STEPS:,} actions at most; there are {len(rows):,}")
    steps = tuple(_step(table, f"actions[{number}]", row) for number, row in enumerate(rows))
    if (lasts := sum(step.seconds or 0.0 for step in steps)) > MOST_SECONDS:
        raise table.fault("actions", rows, f"{MOST_SECONDS:,.0f} s together at most; there are {lasts:,.0f}")
    return steps


def _step(table: Table, key: str, row: Any) -> Step:
    if isinstance(row, str):
        return Step(row, None, {})
    if not isinstance(row, dict):
        raise table.fault(key, row, "a name or { action = ..., seconds = ... }")
    entry = Table(table.file, f"{table.place}] [{key}", row)
    chosen = {name: entry.number(name) for name in row if name not in ("action", "seconds")}
    return Step(entry.text("action"), _seconds(entry), chosen)
