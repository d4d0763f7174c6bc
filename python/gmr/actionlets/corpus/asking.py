"""A plan is made of what a person asks for, and refused before any work where it cannot be done."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, Final

from gmr.actionlets.actions.tables import nearest
from gmr.actionlets.actions.taking import check_frames
from gmr.actionlets.corpus.choices import Choice, Drawn, Fixed, choice
from gmr.actionlets.corpus.making import versions
from gmr.actionlets.corpus.plan import Plan
from gmr.errors import GmrError
from gmr.listing import listed

if TYPE_CHECKING:
    from gmr.actionlets.actions.library import Library
    from gmr.actionlets.actions.units import Parameter

__all__ = ["FORMATS", "planned"]

FORMATS: Final = ("gmrb", "gmr", "bvh", "glb")
"""What a corpus can be written as: one file a take."""

_SETTINGS: Final = {
    "seconds": None,
    "variation": "0..1",
    "height": None,
    "percentile": None,
    "sex": "average",
}
"""What takes have besides their action's parameters, and what is meant where nobody says."""

_BODY: Final = ("height", "percentile", "sex")

_MOST: Final = 10_000_000
"""Takes."""


def planned(
    library: Library,
    actions: Iterable[str],
    variations: int,
    *,
    seed: int = 0,
    fps: float = 120.0,
    format: str = "gmrb",
    body: str = "detailed",
    settings: Mapping[str, str] | None = None,
    parameters: Mapping[str, str] | None = None,
    contents: Mapping[str, bytes] | None = None,
) -> Plan:
    """The plan of a corpus.

    Args:
        library: its actions.
        actions: names or aliases, each once.
        variations: how many takes of each.
        seed: of all that is drawn.
        fps: frames a second.
        format: of the motion files: "gmrb", "gmr", "bvh" or "glb".
        body: "detailed" or "paper".
        settings: choices, written as :mod:`gmr.actionlets.corpus.choices` says, of "seconds", "variation"
            (0 to 1 where left out), "height" (metres) or "percentile", and "sex".
        parameters: choices by the name of a parameter, or action.parameter for that action alone; "default"
            is what the library says. What is left out is drawn from the whole range that the library states.
        contents: the files of the library, by name.

    Raises:
        GmrError: an unknown action, parameter or setting (the nearest is offered), or a value that cannot be.
    """
    names = _actions(library, actions)
    if not 1 <= variations <= _MOST:
        raise GmrError(f"{variations:,} variations cannot be; ask for 1 to {_MOST:,} of each action")
    if len(names) * variations > _MOST:
        raise GmrError(
            f"{variations:,} variations of {len(names)} actions are {len(names) * variations:,} takes; "
            f"{_MOST:,} are the most in a corpus"
        )
    check_frames(listed(names, 3), 0.0, fps)
    if seed < 0:
        raise GmrError(f"a seed of {seed} cannot be; give a whole number from 0")
    if format not in FORMATS:
        raise GmrError(f"a corpus cannot be written as '{format}'; use one of {', '.join(FORMATS)}")
    return Plan(
        actions=names,
        variations=variations,
        seed=seed,
        fps=float(fps),
        format=f".{format}",
        body=body,
        settings=_settings(settings or {}, body, names, fps),
        parameters=_parameters({name: library[name].parameters for name in names}, parameters or {}),
        library={name: hashlib.sha256(text).hexdigest() for name, text in _named(contents or {})},
        made_with=versions(),
    )


def _named(contents: Mapping[str, bytes]) -> Iterator[tuple[str, bytes]]:
    """Contents by the name of the file, wherever it lies; by its path where two have one name."""
    names = [PurePath(path).name for path in contents]
    for path, name in zip(contents, names, strict=True):
        yield (name if names.count(name) == 1 else path), contents[path]


def _actions(library: Library, actions: Iterable[str]) -> tuple[str, ...]:
    names = tuple(library[name].name for name in actions)
    if not names:
        raise GmrError(f"no action is named; there are {listed(list(library), 30)}")
    for name in names:
        if names.count(name) > 1:
            raise GmrError(f"the action '{name}' is named twice, or by two of its names; name it once")
    return names


def _settings(given: Mapping[str, str], body: str, actions: Iterable[str], fps: float) -> dict[str, Choice]:
    if unknown := [name for name in given if name not in _SETTINGS]:
        raise GmrError(f"no setting is called '{unknown[0]}'. {nearest(unknown[0], _SETTINGS)}")
    texts = {name: given.get(name, default) for name, default in _SETTINGS.items()}
    found = {name: choice(text, name) for name, text in texts.items() if text is not None}
    for value in found["seconds"].values if "seconds" in found else ():
        if isinstance(value, str) or not value > 0:
            raise GmrError(f"takes of {value} s cannot be; give more than 0 seconds")
        check_frames(listed(list(actions), 3), value, fps)
    for value in found["variation"].values:
        if isinstance(value, str) or not 0 <= value <= 1:
            raise GmrError(f"a variation of {value} cannot be; give 0 (as written) to 1")
    _check_bodies({name: found[name] for name in _BODY if name in found}, body)
    return found


def _check_bodies(choices: Mapping[str, Choice], kind: str) -> None:
    """Raises what the body itself says of values that it cannot have."""
    from gmr.actionlets.body import Body

    if kind not in ("detailed", "paper"):
        raise GmrError(f"no body is called '{kind}'; there are 'detailed' and 'paper'")
    for values in product(*(own.values for own in choices.values())):
        settings: dict[str, Any] = dict(zip(choices, values, strict=True))
        Body.of(detailed=kind == "detailed", **settings)


def _parameters(
    actions: Mapping[str, Mapping[str, Parameter]], given: Mapping[str, str]
) -> dict[str, dict[str, Choice]]:
    """By action, a choice for each of its parameters."""
    for name in given:
        _check_known(name, actions)
    return {
        action: {
            name: _parameter(action, parameter, given.get(f"{action}.{name}", given.get(name)))
            for name, parameter in own.items()
        }
        for action, own in actions.items()
    }


def _check_known(name: str, actions: Mapping[str, Mapping[str, Parameter]]) -> None:
    every = {own for parameters in actions.values() for own in parameters}
    action, dot, own = name.rpartition(".")
    if dot and action not in actions:
        raise GmrError(f"'{name}': no action '{action}' was asked for. {nearest(action, actions)}")
    known = set(actions[action]) if dot else every
    if own not in known:
        whose = f"the action '{action}' has" if dot else f"{listed(list(actions), 5)}: there is"
        raise GmrError(f"{whose} no parameter '{own}'. {nearest(own, sorted(known))}")


def _parameter(action: str, parameter: Parameter, text: str | None) -> Choice:
    if text is None:
        return (
            Drawn(parameter.low, parameter.high) if parameter.low < parameter.high else Fixed(parameter.low)
        )
    if text == "default":
        return Fixed(parameter.default)
    what = f"{parameter.name} of '{action}'"
    found = choice(text, what)
    unit = f" {parameter.unit}" if parameter.unit else ""
    for value in found.values:
        if isinstance(value, str):
            raise GmrError(f"{what}: '{value}' is no number")
        if not parameter.low <= value <= parameter.high or math.isnan(value):
            goes = f"it goes from {parameter.low:g} to {parameter.high:g}{unit}"
            raise GmrError(
                f"{what} cannot be {value:g}{unit}; {goes}."
                f" Where another action goes further, write {action}.{parameter.name}=... for this one"
            )
    return found
