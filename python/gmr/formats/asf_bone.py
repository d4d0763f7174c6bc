"""The items of a bone and of the root of an ASF file."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from typing import Any, Final

from gmr.acclaim import UNLIMITED, Bone, Limits, Root
from gmr.formats.lines import Line, failure, numbers_of
from gmr.formats.numerals import number
from gmr.formats.text import Text, named, shown

__all__ = ["BoneItems", "axis_order", "read_root_item", "why_no_name"]

_TURNS: Final = ("rx", "ry", "rz")
_MOVES: Final = ("tx", "ty", "tz")
_UNIT_WITHIN: Final = 1e-3
"""How far from 1 the length of a direction may be for being printed in few digits."""
_LIMIT = re.compile(r"\(\s*([^\s(),]+)[\s,]+([^\s(),]+)\s*\)")
_INFINITE: Final = {"-inf": -float("inf"), "inf": float("inf"), "+inf": float("inf")}
_NOTES: Final = ("bodymass", "cofmass")
_MOST_SHOWN = 60
_RESERVED: Final = frozenset(("begin", "end"))
_CONTROL = re.compile(rb"[\x00-\x1f\x7f]")


@dataclass(slots=True)
class BoneItems:
    """What stands between ``begin`` and ``end`` of a bone, as far as it was read."""

    text: Text
    begun: Line
    items: dict[str, Any] = field(default_factory=dict)
    limits: list[str] = field(default_factory=list)
    limits_line: Line | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def title(self) -> str:
        """The bone as errors call it."""
        return f"bone {named(self.items['name'])}" if "name" in self.items else "a bone without a name"

    def read(self, line: Line) -> None:
        """Takes in one line."""
        word = line.keyword
        if word in self.items or (word == "limits" and self.limits):
            raise failure(self.text, line, f"{self.title} has {word} twice. Remove one.")
        match word:
            case "id":
                self.items["id"] = self.text.decoded(b" ".join(line.words[1:]), "the id")
            case "name":
                self.items["name"] = self.name(line)
            case "direction":
                self.items["direction"] = tuple(numbers_of(self.text, line, f"{self.title}, direction", 3))
            case "length":
                (self.items["length"],) = numbers_of(self.text, line, f"{self.title}, length", 1)
            case "axis":
                self.items["axis"] = tuple(numbers_of(self.text, line, f"{self.title}, axis", 3))
                self.items["axis_order"] = axis_order(self.text, line, line.words[4:], self.title)
            case "dof":
                self.items["dof"] = self.dofs(line)
            case "limits":
                self.limits_line = line
                self.limits.append(" ".join(part.decode(errors="replace") for part in line.words[1:]))
            case _ if word.startswith("(") and self.limits_line is not None:
                self.limits.append(" ".join(part.decode(errors="replace") for part in line.words))
            case _ if word in _NOTES:
                self.notes.append(" ".join(part.decode(errors="replace") for part in line.words))
            case _:
                what = f"{self.title} has {shown(line.words[0])}, which gmr does not know; passed over."
                self.text.odd(what, at=line.at, kind="item")

    def name(self, line: Line) -> str:
        """The name, which is one word."""
        if len(line.words) != 2:
            what = "has a name of several words" if line.words[2:] else "has no name after 'name'"
            raise failure(self.text, line, f"a bone {what}. Write one word.")
        found = self.text.decoded(line.words[1], "the name")
        if why := why_no_name(found):
            raise failure(self.text, line, f"a bone is named {named(found)}, but {why}. Rename it.")
        return found

    def dofs(self, line: Line) -> tuple[str, ...]:
        """The degrees of freedom, of which gmr reads rotations."""
        found = [word.lower().decode(errors="replace") for word in line.words[1:]]
        for dof in found:
            if dof in (*_MOVES, "l"):
                what = (
                    f"{self.title} has the degree of freedom {dof}: gmr reads bones that turn (rx, ry, rz), "
                    "and a root that moves. Export with bones of constant length."
                )
                raise failure(self.text, line, what, "rx, ry, rz")
            if dof not in _TURNS:
                what = f"{self.title} has a degree of freedom {named(dof)}. There are rx, ry and rz."
                raise failure(self.text, line, what, "rx, ry, rz")
        if len(set(found)) < len(found):
            raise failure(self.text, line, f"{self.title} has a degree of freedom twice. Remove one.")
        return tuple(found)

    def finished(self, line: Line, place: int) -> Bone:
        """The bone that ends with this line, the one numbered ``place`` where it does not say otherwise."""
        for item in ("name", "direction", "length"):
            if item not in self.items:
                raise failure(self.text, line, f"{self.title} has no {item}. Write it before its end.", item)
        self.check_direction(line)
        dofs = self.items.get("dof", ())
        return Bone(
            name=self.items["name"],
            direction=self.items["direction"],
            length=self.items["length"],
            axis=self.items.get("axis", (0.0, 0.0, 0.0)),
            axis_order=self.items.get("axis_order", "XYZ"),
            dofs=dofs,
            limits=self.pairs(len(dofs)),
            number=self.items.get("id", str(place)),
            notes=tuple(self.notes),
        )

    def check_direction(self, line: Line) -> None:
        """Warns of a direction that makes the bone longer or shorter than its length says."""
        size, length = math.hypot(*self.items["direction"]), self.items["length"]
        if length and abs(size - 1) > _UNIT_WITHIN:
            what = f"{self.title} has a direction of length {size:.6g}, not 1"
            long = f"with the length {length:.6g} it is {size * length:.6g} long"
            self.text.odd(f"{what}: {long}. Write a direction of length 1.", at=line.at, kind="direction")

    def pairs(self, count: int) -> tuple[Limits, ...]:
        """The limits, a pair for each of ``count`` degrees of freedom."""
        if self.limits_line is None:
            return (UNLIMITED,) * count
        told = " ".join(self.limits)
        found = _LIMIT.findall(told)
        if _LIMIT.sub("", told).strip(" ,"):
            shorter = named(told[:_MOST_SHOWN])
            what = f"{self.title} has the limits {shorter}. Write a pair in parentheses for each: (-10 170)."
            raise failure(self.text, self.limits_line, what, "(least greatest)")
        pairs = tuple((self.limit(low), self.limit(high)) for low, high in found)
        if not count:
            what = f"{self.title} has limits but no dof; they are left out."
            self.text.odd(what, at=self.limits_line.at, kind="limits")
            return ()
        if len(pairs) != count:
            what = f"{self.title} has {len(pairs)} limits for {count} degrees of freedom. Write one for each."
            raise failure(self.text, self.limits_line, what)
        return pairs

    def limit(self, word: str) -> float:
        """A number, or an infinity."""
        value = _INFINITE.get(word.lower(), number(word.encode()))
        if value is None:
            assert self.limits_line is not None
            what = f"{self.title}, limits: {named(word)} is not a number. Write a decimal number, or inf."
            raise failure(self.text, self.limits_line, what)
        return value


def why_no_name(name: str) -> str | None:
    """Why this cannot be a bone's name in an ASF, as part of a sentence; None where it can."""
    if name.lower() in _RESERVED:
        return "that word means something else in an ASF file"
    raw = name.encode(errors="replace")
    is_plain = raw.decode() == name and raw.split() == [raw] and not _CONTROL.search(raw)
    if not is_plain or b"#" in raw or raw.startswith(b":"):
        return "a bone's name is one word without control characters or '#', and does not begin with ':'"
    return None


def read_root_item(text: Text, line: Line, root: Root) -> Root:
    """The root with one more line taken in."""
    match line.keyword:
        case "order":
            return replace(root, order=_root_order(text, line))
        case "axis":
            return replace(root, axis_order=axis_order(text, line, line.words[1:], "the root"))
        case "position" | "orientation" as item:
            x, y, z = numbers_of(text, line, f"the root's {item}", 3)
            return (
                replace(root, position=(x, y, z))
                if item == "position"
                else replace(root, orientation=(x, y, z))
            )
    what = f"the root has {shown(line.words[0])}, which gmr does not know; passed over."
    text.odd(what, at=line.at, kind="root item")
    return root


def _root_order(text: Text, line: Line) -> tuple[str, ...]:
    found = tuple(word.upper().decode(errors="replace") for word in line.words[1:])
    unknown = [word for word in found if word.lower() not in (*_TURNS, *_MOVES)]
    if unknown or len(set(found)) < len(found) or not found:
        wrong = f"has {named(unknown[0])}" if unknown else "is empty" if not found else "has a value twice"
        what = f"the root's order {wrong}. Write TX TY TZ RX RY RZ, each once, as the frames list them."
        raise failure(text, line, what, "TX TY TZ RX RY RZ")
    return found


def axis_order(text: Text, line: Line, words: list[bytes], title: str) -> str:
    """The order of three axes, such as XYZ, which may be left out."""
    found = b"".join(words).upper().decode(errors="replace")
    if not found:
        return "XYZ"
    if len(found) != 3 or set(found) - set("XYZ") or found[0] == found[1] or found[1] == found[2]:
        what = f"{title} has the axis order {named(found)}. Write three axes, such as XYZ."
        raise failure(text, line, what, "XYZ")
    return found
