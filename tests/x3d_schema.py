"""What the XML schema of X3D 4.0 asks of the elements that gmr writes, in a table of our own.

The Web3D Consortium's x3d-4.0.xsd says which children an element may have and in which order, which
attributes it must have, and how their values are spelt. Told here are the children and the attributes that
gmr writes; another one is a fault. ``x3d_model`` holds the same files against the object model, which knows
nodes, fields and routes, but neither names, ranges nor order.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

__all__ = ["faults"]

Check = Callable[[str], bool]

_XSI = "{http://www.w3.org/2001/XMLSchema-instance}noNamespaceSchemaLocation"
_NUMBER = re.compile(r"[+-]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([Ee][+-]?[0-9]+)?")
_TOKEN = re.compile(r"[A-Za-z0-9._:\-\u00b7\u00c0-\ud7ff\uf900-\ufffd]+")
"""NMTOKEN, without letters that are younger than XML."""
_ID = re.compile(r"(?![0-9.:\-\u00b7])[A-Za-z0-9._\-\u00b7\u00c0-\ud7ff\uf900-\ufffd]+")
_TRIM = " \t\n\r"


def _matches(pattern: re.Pattern[str]) -> Check:
    return lambda value: pattern.fullmatch(value.strip(_TRIM)) is not None


def _one_of(*values: str) -> Check:
    return lambda value: value.strip(_TRIM) in values


def _number(least: float = -float("inf"), most: float = float("inf"), *, above: bool = False) -> Check:
    """A number from ``least``, or only above it, to ``most``."""
    return lambda value: (
        _NUMBER.fullmatch(value.strip(_TRIM)) is not None
        and least <= float(value) <= most
        and not (above and float(value) == least)
    )


def _integer(least: int, most: int) -> Check:
    return lambda value: (
        re.fullmatch(r"[+-]?[0-9]+", value.strip(_TRIM)) is not None and least <= int(value) <= most
    )


def _numbers(width: int, least: float = -float("inf"), most: float = float("inf")) -> Check:
    """So many numbers, with blanks between them."""
    return lambda value: len(value.split()) == width and all(map(_number(least, most), value.split()))


def _rows(width: int, least: float = -float("inf"), most: float = float("inf")) -> Check:
    """Any count of rows of so many numbers; a comma may follow a row."""
    number = _NUMBER.pattern.replace("(", "(?:")
    row = rf"(?:{number}\s+){{{width - 1}}}{number}"
    rows = re.compile(rf"\s*(?:{row}(?:\s*,\s*|\s+|$))*")
    bounded = np.isfinite([least, most]).any()

    def check(value: str) -> bool:
        words = value.replace(",", " ").split() if bounded else []
        return rows.fullmatch(value) is not None and all(least <= float(word) <= most for word in words)

    return check


_TEXT: Check = lambda value: True  # noqa: E731
_BOOL, _NAME = _one_of("true", "false"), _matches(_TOKEN)
_SIZE, _SHARE = _number(0, above=True), _number(0, 1)
_PLACE, _TURN, _COLOUR = _numbers(3), _numbers(4), _numbers(3, 0, 1)
_NODE = {"DEF": _matches(_ID), "USE": _matches(_ID)}


@dataclass(frozen=True)
class Rule:
    """Of an element.

    Args:
        children: pattern of the names of its children, a blank after each.
        fields: how its attributes are spelt.
        required: attributes that it must have.
    """

    children: str = ""
    fields: dict[str, Check] = field(default_factory=dict)
    required: tuple[str, ...] = ()


def _statement(children: str = "", required: tuple[str, ...] = (), **fields: Check) -> Rule:
    return Rule(children, fields, required)


def _node(children: str = "", **fields: Check) -> Rule:
    return Rule(children, {**_NODE, **fields})


_FORMS = "(Box|Cylinder|Sphere) "
_CHILDREN = (
    "((WorldInfo|NavigationInfo|Background|DirectionalLight|Viewpoint|Transform|Shape|HAnimHumanoid|HAnimJoint"
    "|HAnimSegment|TimeSensor|PositionInterpolator|OrientationInterpolator|ROUTE) )*"
)
_PARTS = "((HAnimJoint|HAnimSegment) )*"
_ROUTE = {"fromNode": _matches(_ID), "fromField": _NAME, "toNode": _matches(_ID), "toField": _NAME}
_IN_GROUP = _one_of("children", "proxy", "rootNode", "shape", "skin")
_PROFILES = "Core Interchange CADInterchange Interactive Immersive MedicalInterchange MPEG4Interactive Full"

RULES = {
    "X3D": Rule(
        "(head )?Scene ",
        {"profile": _one_of(*_PROFILES.split()), "version": _one_of("4.0"), _XSI: _TEXT},
        ("profile", "version"),
    ),
    "head": _statement("(component )*(unit )*(meta )*"),
    "component": _statement("", ("name", "level"), name=_one_of("HAnim"), level=_integer(1, 5)),
    "meta": _statement("", ("name", "content"), name=_TEXT, content=_TEXT),
    "Scene": _statement(_CHILDREN),
    "ROUTE": Rule("", _ROUTE, tuple(_ROUTE)),
    "WorldInfo": _node(title=_TEXT),
    "NavigationInfo": _node(type=_TEXT),
    "Background": _node(skyColor=_rows(3, 0, 1)),
    "DirectionalLight": Rule("", {**_NODE, "direction": _PLACE, "intensity": _number(0), "global": _BOOL}),
    "Viewpoint": _node(
        "(NavigationInfo )?",
        description=_TEXT,
        position=_PLACE,
        orientation=_TURN,
        fieldOfView=lambda value: _number(0, above=True)(value) and float(value) < 3.1416,
    ),
    "Transform": _node(_CHILDREN, translation=_PLACE, rotation=_TURN, containerField=_IN_GROUP),
    "Shape": _node(f"(Appearance )?({_FORMS})?|{_FORMS}Appearance ", containerField=_IN_GROUP),
    "Appearance": _node("(Material )*"),
    "Material": _node(diffuseColor=_COLOUR, specularColor=_COLOUR),
    "Box": _node(size=_PLACE),
    "Sphere": _node(radius=_SIZE),
    "Cylinder": _node(radius=_SIZE, height=_SIZE, top=_BOOL, bottom=_BOOL),
    "HAnimHumanoid": _node(
        _PARTS,
        name=_NAME,
        version=_one_of("2.0"),
        loa=_integer(-1, 4),
        skeletalConfiguration=_TEXT,
    ),
    "HAnimJoint": _node(
        _PARTS,
        name=_NAME,
        containerField=_one_of("children", "joints", "skeleton"),
        description=_TEXT,
        center=_PLACE,
        rotation=_TURN,
        translation=_PLACE,
    ),
    "HAnimSegment": _node(_CHILDREN, name=_NAME, containerField=_one_of("children", "segments")),
    "TimeSensor": _node(cycleInterval=_number(0), loop=_BOOL),
    "PositionInterpolator": _node(key=_rows(1), keyValue=_rows(3)),
    "OrientationInterpolator": _node(key=_rows(1), keyValue=_rows(4)),
}


def faults(data: bytes) -> list[str]:
    """What the rules have against a file, in words; empty for a valid one."""
    root = ET.fromstring(data)
    found = [] if root.tag == "X3D" else [f"{root.tag} is no X3D"]
    for element in root.iter():
        found += _element_faults(element)
    defined = [name for element in root.iter() if (name := element.get("DEF")) is not None]
    found += [f"DEF {name} is there twice" for name in {*defined} if defined.count(name) > 1]
    for element in root.iter():
        for use in ("USE", "fromNode", "toNode"):
            if element.get(use, defined[0] if defined else None) not in defined:
                found.append(f"{use} {element.get(use)} is defined nowhere")
    return found


def _element_faults(element: ET.Element) -> Iterator[str]:
    where = f"{element.tag} {element.get('DEF', '')}".strip()
    rule = RULES.get(element.tag)
    if rule is None:
        yield f"{where} is no element that gmr writes"
        return
    children = "".join(f"{child.tag} " for child in element)
    if not re.fullmatch(rule.children, children):
        yield f"{where} holds {children}"
    if (element.text or "").strip() or any((child.tail or "").strip() for child in element):
        yield f"{where} holds text"
    yield from (f"{where} lacks {name}" for name in rule.required if element.get(name) is None)
    for name, value in element.attrib.items():
        check = rule.fields.get(name)
        if check is None:
            yield f"{where} has an attribute {name}"
        elif not check(value):
            yield f"{where}: {name}={value[:60]!r} is spelt otherwise"
