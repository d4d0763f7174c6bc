"""ASF bytes to the skeleton that they describe.

The grammar, line by line, keywords in any case, ``#`` begins a comment::

    file      := (":version" v | ":name" n | units | ":documentation" line* | root | bonedata | hierarchy)*
    units     := ":units" ("mass" number | "length" number | "angle" ("deg" | "rad"))*
    root      := ":root" ("order" value* | "axis" order | "position" x y z | "orientation" x y z)*
    bonedata  := ":bonedata" ("begin" item* "end")*
    hierarchy := ":hierarchy" "begin" (parent child*)* "end"

Other sections are passed over with a warning.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from gmr.acclaim import Acclaim, Bone, Root
from gmr.formats.asf_bone import BoneItems, read_root_item
from gmr.formats.lines import Line, failure, leading_comments, lines_of, numbers_of
from gmr.formats.text import Text, named, shown

__all__ = ["parse_asf"]

_LONGEST_SHARED = 1 << 20
_MOST_SHARED = 64

_LEAST = 1e-9
"""File units of an inch at least, and inches of a file unit."""

_shared: dict[bytes, Acclaim] = {}
"""Skeletons by the bytes of their files: the takes of a session share one."""


def parse_asf(data: bytes, *, name: str | None = None, strict: bool = False) -> Acclaim:
    """The skeleton of an ASF file.

    Args:
        data: the file's bytes: UTF-8, or UTF-16 with a byte order mark.
        name: the file's name, for errors.
        strict: raise where a warning would do: sections and items that gmr does not know, limits without a
            degree of freedom, names that are no UTF-8.

    Raises:
        FormatError: the file cannot be read; the message says where, why, and what to do.
    """
    if known := _shared.get(data):
        return known
    text = Text(data, name=name, strict=strict)
    found = _Reader(text).read()
    if not text.oddities and len(data) <= _LONGEST_SHARED:
        if len(_shared) >= _MOST_SHARED:
            _shared.clear()
        _shared[data] = found
    return found


@dataclass(slots=True)
class _Reader:
    """What was found up to a line."""

    text: Text
    settings: dict[str, Any] = field(default_factory=dict)
    documentation: list[str] = field(default_factory=list)
    root: Root | None = None
    bones: list[Bone] = field(default_factory=list)
    bone: BoneItems | None = None
    joints: dict[str, int] = field(default_factory=lambda: {"root": 0})
    parents: dict[int, int] = field(default_factory=dict)
    places: dict[int, int] = field(default_factory=dict)
    """The byte of the line that told a joint last: its bone, then its parent."""
    in_hierarchy: bool = False
    sections: set[str] = field(default_factory=set)

    def read(self) -> Acclaim:
        notes = leading_comments(self.text)
        section: Callable[[Line], None] = self.before_sections
        for line in lines_of(self.text):
            if line.words[0].startswith(b":"):
                self.check_closed(line)
                section = self.begin_section(line)
            else:
                section(line)
        self.check_whole()
        assert self.root is not None
        return Acclaim(
            root=self.root,
            bones=tuple(self.bones),
            parents=tuple(self.parents[joint] for joint in range(1, len(self.bones) + 1)),
            documentation=tuple(self.documentation),
            notes=notes,
            **self.settings,
        )

    def before_sections(self, line: Line) -> None:
        what = f"the file begins with {shown(line.words[0])}, but an ASF file begins with :version. "
        raise failure(self.text, line, what + "Check that it is an ASF file.", ":version")

    def begin_section(self, line: Line) -> Callable[[Line], None]:
        """What takes the lines of the section that begins here."""
        self.sections.add(line.keyword)
        match line.keyword:
            case ":version" | ":name" as keyword:
                rest = self.text.decoded(b" ".join(line.words[1:]), f"the {keyword[1:]}")
                self.settings[keyword[1:]] = rest
                return self.unexpected
            case ":units":
                return self.read_unit
            case ":documentation":
                return self.read_documentation
            case ":root":
                self.root = Root()
                return self.read_root
            case ":bonedata":
                return self.read_bone
            case ":hierarchy":
                return self.read_hierarchy
        what = f"{shown(line.words[0])} is no section that gmr knows; passed over."
        self.text.odd(what, at=line.at, kind="section")
        return lambda line: None

    def unexpected(self, line: Line) -> None:
        what = f"{shown(line.words[0])} stands before a section. Write :units, :root or another before it."
        raise failure(self.text, line, what)

    def read_documentation(self, line: Line) -> None:
        self.documentation.append(line.whole.decode(errors="replace").rstrip())

    def read_unit(self, line: Line) -> None:
        match line.keyword:
            case "mass" | "length" as item:
                (value,) = numbers_of(self.text, line, f"units, {item}", 1)
                if item == "length" and not _LEAST <= value <= 1 / _LEAST:
                    what = (
                        f"units, length is {shown(line.words[1])}. Write file units per inch, such as 0.45."
                    )
                    raise failure(self.text, line, what)
                self.settings[item] = value
            case "angle":
                angle = line.words[1].lower() if len(line.words) > 1 else b"nothing"
                if not angle.startswith((b"deg", b"rad")):
                    what = f"units, angle is {shown(angle)}. Write deg or rad."
                    raise failure(self.text, line, what, "deg or rad")
                self.settings["radians"] = angle.startswith(b"rad")
            case _:
                what = f"units have {shown(line.words[0])}, which gmr does not know; passed over."
                self.text.odd(what, at=line.at, kind="unit")

    def read_root(self, line: Line) -> None:
        assert self.root is not None
        self.root = read_root_item(self.text, line, self.root)

    def read_bone(self, line: Line) -> None:
        word = line.keyword
        if self.bone is None:
            if word != "begin":
                what = f"{shown(line.words[0])} stands outside a bone. Write begin before it."
                raise failure(self.text, line, what, "begin")
            self.bone = BoneItems(self.text, line)
        elif word == "end":
            self.end_bone(self.bone.finished(line, len(self.bones) + 1), line)
        elif word == "begin":
            what = f"{self.bone.title} has no end before the next begins. Write end there."
            raise failure(self.text, line, what, "end")
        else:
            self.bone.read(line)

    def end_bone(self, bone: Bone, line: Line) -> None:
        if bone.name in self.joints:
            what = "is named root as the root is" if bone.name == "root" else "is there twice"
            raise failure(self.text, line, f"bone {named(bone.name)} {what}. Rename one.")
        assert self.bone is not None
        self.bones.append(bone)
        self.joints[bone.name] = len(self.bones)
        self.places[len(self.bones)] = self.bone.begun.at
        self.bone = None

    def read_hierarchy(self, line: Line) -> None:
        if line.keyword in ("begin", "end") and len(line.words) == 1:
            self.in_hierarchy = line.keyword == "begin"
            return
        if not self.in_hierarchy:
            what = f"{shown(line.words[0])} stands outside the hierarchy's block. Write begin before it."
            raise failure(self.text, line, what, "begin")
        parent, *children = (self.text.decoded(word, "the name") for word in line.words)
        above = self.joint(parent, line)
        for child in children:
            joint = self.joint(child, line)
            if joint == 0:
                raise failure(self.text, line, f"the root hangs on bone {named(parent)}. Remove it there.")
            if joint in self.parents:
                raise failure(self.text, line, f"bone {named(child)} hangs on two others. Remove one.")
            self.parents[joint] = above
            self.places[joint] = line.at

    def joint(self, name: str, line: Line) -> int:
        found = self.joints.get(name)
        if found is None:
            what = f"the hierarchy names {named(name)}, which is no bone of :bonedata. Correct the name."
            raise failure(self.text, line, what)
        return found

    def check_closed(self, line: Line) -> None:
        """Raises where a section begins inside a bone."""
        if self.bone is not None:
            what = f"{self.bone.title} has no end before {shown(line.words[0])}. Write end there."
            raise failure(self.text, line, what, "end")

    def check_whole(self) -> None:
        """Raises unless the file has a root on which every bone hangs."""
        if self.bone is not None:
            what = f"the file ends inside {self.bone.title}. It may be cut off: export it again."
            raise self.text.failure(what, expected="end")
        for section in (":root", ":bonedata", ":hierarchy"):
            if section not in self.sections:
                what = f"has no {section}" if self.sections else "is empty"
                mend = "It may be cut off: export it again."
                raise self.text.failure(f"the file {what}. {mend}", expected=section)
        for joint, bone in enumerate(self.bones, start=1):
            if joint not in self.parents:
                what = f"bone {named(bone.name)} has no place in the :hierarchy. Write it after its parent."
                raise self.text.failure(what, at=self.places[joint])
        if circle := self.off_root():
            what = f"bone {named(self.bones[circle - 1].name)} hangs on itself through others in :hierarchy."
            raise self.text.failure(f"{what} Hang one of them on the root.", at=self.places[circle])

    def off_root(self) -> int:
        """A joint that no path leads to from the root; 0 where there is none."""
        children: list[list[int]] = [[] for _ in range(len(self.bones) + 1)]
        for joint, parent in self.parents.items():
            children[parent].append(joint)
        reached = [0]
        for joint in reached:  # grows while it is walked
            reached += children[joint]
        return min(set(self.parents) - set(reached), default=0)
