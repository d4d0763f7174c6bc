"""An X3D file held against the object model of X3D, which the Web3D Consortium makes from its schema.

The model comes as the package ``x3d`` (X3DPSAIL): which nodes there are, of which kinds, which fields they
have, of which type and access. Its own constructors take nearly anything; here everything is checked, values
by the grammar of their types in ISO/IEC 19776-1.
"""

from __future__ import annotations

import contextlib
import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from functools import cache
from typing import Any

with contextlib.redirect_stdout(io.StringIO()):  # it greets
    import x3d.x3d as model

__all__ = ["faults", "model"]

_NUMBER = r"[+-]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[Ee][+-]?[0-9]+)?"
_WIDTHS = {"Float": 1, "Double": 1, "Time": 1, "Vec2f": 2, "Vec3f": 3, "Color": 3, "Rotation": 4}
_EVENTS = {
    "TimeSensor": {"fraction_changed": ("SFFloat", "outputOnly")},
    "OrientationInterpolator": {
        "set_fraction": ("SFFloat", "inputOnly"),
        "value_changed": ("SFRotation", "outputOnly"),
    },
    "PositionInterpolator": {
        "set_fraction": ("SFFloat", "inputOnly"),
        "value_changed": ("SFVec3f", "outputOnly"),
    },
}
"""Fields that are only events, which the package leaves out (ISO/IEC 19775-1, 8.4.1 and 19.4)."""
_OF_XML = {"DEF", "USE", "containerField"}
_STATEMENTS = {"X3D", "head", "Scene", "component", "meta", "ROUTE"}
_NAME = re.compile(r"[^\s\"'#+,\-.\\\[\]{}\x00-\x1f\x7f0-9][^\s\"'#,.\\\[\]{}\x00-\x1f\x7f]*")


def faults(data: bytes) -> list[str]:
    """What the model has against a file, in words; empty for a valid one."""
    root = ET.fromstring(data)
    found = [*_statement_faults(root)]
    names: dict[str, str] = {}
    for scene in root.iter("Scene"):
        for node in scene:
            if node.tag != "ROUTE":
                found += _node_faults(node, "_X3DChildNode", names)
    for route in root.iter("ROUTE"):
        found += _route_faults(route, names)
    return found


@cache
def _fields(tag: str) -> dict[str, tuple[str, str]]:
    """Type and access by name of the fields of a node."""
    declared = getattr(model, tag).FIELD_DECLARATIONS()
    return {name.rstrip("_"): (_plain(kind), _plain(access)) for name, _, kind, access, _ in declared}


def _plain(value: Any) -> str:
    """The name of a type or an access, which the model has as a function that gives it."""
    return str(value.__name__)


def _statement_faults(root: ET.Element) -> Iterator[str]:
    if root.tag != "X3D" or [child.tag for child in root] != ["head", "Scene"]:
        yield "an X3D element holds a head and a Scene"
    if root.get("profile") not in model.PROFILENAMECHOICES or root.get("version") != "4.0":
        yield f"profile {root.get('profile')!r}, version {root.get('version')!r}"
    children = [child.tag for child in root.find("head") or ()]
    if children != sorted(children, key=["component", "unit", "meta"].index):
        yield f"a head holds components, then units, then metas, not {children}"
    for component in root.iter("component"):
        known = component.get("name") in model.COMPONENTNAMECHOICES
        if not known or not component.get("level", "").isdigit():
            yield f"component {component.attrib}"
    for meta in root.iter("meta"):
        if set(meta.attrib) != {"name", "content"}:
            yield f"meta {meta.attrib}"


def _node_faults(node: ET.Element, wanted: str, names: dict[str, str]) -> Iterator[str]:
    where = f"{node.tag} {node.get('DEF') or node.get('USE') or ''}".strip()
    if not isinstance(getattr(model, node.tag, None), type) or node.tag in _STATEMENTS:
        yield f"there is no node {node.tag}"
        return
    if not issubclass(getattr(model, node.tag), getattr(model, wanted)):
        yield f"{where} is no {wanted.lstrip('_')}"
    used = node.get("USE")
    if used is not None:
        if names.get(used) != node.tag:
            yield f"{where} is used but not defined before as {node.tag}"
        if len(node) or set(node.attrib) - {"USE", "containerField"}:
            yield f"{where} is used, so it has neither fields nor children"
        return
    defined = node.get("DEF")
    if defined is not None:
        if defined in names or not _NAME.fullmatch(defined):
            yield f"{where} is defined twice, or its name is none"
        names[defined] = node.tag
    fields = _fields(node.tag)
    for name, value in node.attrib.items():
        if name in _OF_XML:
            continue
        kind, access = fields.get(name, ("", ""))
        if access not in ("inputOutput", "initializeOnly"):
            yield f"{where} has no field {name} to be set"
        elif not _is(kind, value):
            yield f"{where}: {name}={value[:60]!r} is no {kind}"
    if node.tag == "HAnimHumanoid" and node.get("version") not in model.HANIMVERSIONCHOICES:
        yield f"{where}: version {node.get('version')}"
    yield from _child_faults(node, where, names)


def _child_faults(node: ET.Element, where: str, names: dict[str, str]) -> Iterator[str]:
    fields = _fields(node.tag)
    for child in node:
        own = getattr(model, child.tag, None)
        field = child.get("containerField") or (own.CONTAINERFIELD_DEFAULT() if own else "children")
        kind = fields.get(field, ("", ""))[0]
        if kind not in ("MFNode", "SFNode"):
            yield f"{where} has no field {field} for {child.tag}"
        elif kind == "SFNode" and sum(other.tag == child.tag for other in node) > 1:
            yield f"{where} has several {child.tag} in {field}"
        yield from _node_faults(child, _kind_of_child(field), names)


def _kind_of_child(field: str) -> str:
    return {
        "children": "_X3DChildNode",
        "skeleton": "HAnimJoint",
        "joints": "HAnimJoint",
        "segments": "HAnimSegment",
        "geometry": "_X3DGeometryNode",
        "appearance": "_X3DAppearanceNode",
        "material": "_X3DMaterialNode",
    }[field]


def _is(kind: str, value: str) -> bool:
    """Whether a value is one of its type."""
    if kind == "SFBool":
        return value in ("true", "false")
    if kind in ("SFInt32", "MFInt32"):
        return re.fullmatch(r"\s*([+-]?[0-9]+[\s,]*)" + ("*" if kind[0] == "M" else ""), value) is not None
    if kind == "SFString":
        return True
    if kind == "MFString":
        return re.fullmatch(r'\s*("(?:[^"\\]|\\.)*"\s*,?\s*)*', value) is not None
    width = _WIDTHS[kind[2:]]
    words = value.replace(",", " ").split()
    if kind[0] == "S" and (len(words) != width or "," in value):
        return False
    return len(words) % width == 0 and all(re.fullmatch(_NUMBER, word) for word in words)


def _route_faults(route: ET.Element, names: dict[str, str]) -> Iterator[str]:
    ends = []
    for node, field, accesses, prefix, suffix in (
        ("fromNode", "fromField", ("outputOnly", "inputOutput"), "", "_changed"),
        ("toNode", "toField", ("inputOnly", "inputOutput"), "set_", ""),
    ):
        tag, name = names.get(route.get(node, "")), route.get(field, "")
        fields = {**_fields(tag), **_EVENTS.get(tag, {})} if tag else {}
        bare = name.removeprefix(prefix).removesuffix(suffix)
        kind, access = fields.get(name) or (
            fields[bare] if fields.get(bare, ("", ""))[1] == "inputOutput" else ("", "")
        )
        if access not in accesses:
            yield f"ROUTE {node}={route.get(node)}: no field {name} to go {node[:-4]}"
        ends.append(kind)
    if len(set(ends)) != 1:
        yield f"ROUTE {route.attrib} joins {' and '.join(ends)}"
