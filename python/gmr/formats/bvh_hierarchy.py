"""The HIERARCHY of a BVH file: joints, offsets and channels.

The grammar, keywords in any case, tokens parted by any blanks and line ends::

    hierarchy := "HIERARCHY" ("ROOT" joint)+
    joint     := name "{" ("OFFSET" x y z | "CHANNELS" count channel* | "JOINT" joint | end)* "}"
    end       := "End" name "{" "OFFSET" x y z "}"

A name is what stands before the brace or the line's end, blanks in it included, and may be missing. The
reader keeps its own stack, so that nesting has no limit but memory.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from gmr.formats.block_errors import no_offset, unexpected_in_block
from gmr.formats.channel_lists import read_channels
from gmr.formats.text import Text, named, shown
from gmr.formats.vectors import Vector, take_vector
from gmr.skeleton import End

__all__ = ["Hierarchy", "read_hierarchy"]


@dataclass(slots=True)
class Hierarchy:
    """J joints in file order, End Sites and tips included."""

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    offsets: list[Vector] = field(default_factory=list)
    channels: list[tuple[str, ...]] = field(default_factory=list)
    ends: list[End] = field(default_factory=list)

    def add(self, name: str, parent: int, end: End = End.JOINT) -> int:
        """Index of a new joint; its offset and channels are still to be set."""
        self.names.append(name)
        self.parents.append(parent)
        self.offsets.append((0.0, 0.0, 0.0))
        self.channels.append(())
        self.ends.append(end)
        return len(self.names) - 1


@dataclass(slots=True)
class _Block:
    """A joint whose closing brace is still to come."""

    joint: int
    start: int
    """The byte after its keyword."""
    has_offset: bool = False
    has_channels: bool = False
    has_children: bool = False


def read_hierarchy(text: Text) -> Hierarchy:
    """Reads from HIERARCHY to the brace that closes the last root, and leaves ``text`` there.

    Raises:
        FormatError: the text is no hierarchy; line, joint and remedy are named.
    """
    word = text.take()
    if word.upper() != b"HIERARCHY":
        what = f"begins with {shown(word)}" if word else "is empty"
        raise text.failure(
            f"the file {what}, but a BVH file begins with HIERARCHY. Check that it is a BVH file.",
            at=text.at - len(word),
            expected="HIERARCHY",
        )
    reader = _Reader(text, Hierarchy())
    while text.peek().upper() == b"ROOT":
        text.take()
        reader.read_tree()
    if not reader.found.names:
        what = shown(text.take()) if text.peek() else "the end of the file"
        raise text.failure(f"HIERARCHY is followed by {what}. Write a ROOT joint there.", expected="ROOT")
    return reader.found


@dataclass(slots=True)
class _Reader:
    text: Text
    found: Hierarchy

    def read_tree(self) -> None:
        """Reads a root after its keyword, and all that hangs on it."""
        blocks = [self.open_joint(-1)]
        while blocks:
            block = blocks[-1]
            word = self.text.take()
            match word.upper():
                case b"OFFSET":
                    self.read_offset(block)
                case b"CHANNELS":
                    self.read_channels(block)
                case b"JOINT":
                    block.has_children = True
                    blocks.append(self.open_joint(block.joint))
                case b"END":
                    block.has_children = True
                    self.read_end_site(block.joint)
                case b"}":
                    self.close(blocks.pop())
                case _:
                    title = self.title(block.joint)
                    raise unexpected_in_block(self.text, word, title, block.start, _ITEMS)

    def open_joint(self, parent: int) -> _Block:
        start = self.text.at
        raw = self.text.take_phrase()
        if _CONTROL.search(raw):
            what = f"the name {shown(raw)} holds control characters. Rename the joint, or export again."
            raise self.text.failure(what, at=start)
        joint = self.found.add(self.text.decoded(raw, "the name"), parent)
        self.take_brace(joint, start)
        return _Block(joint, start)

    def take_brace(self, joint: int, start: int) -> None:
        if self.text.take() != b"{":
            what = f"{self.title(joint)} has no block. Write '{{' after its name."
            raise self.text.failure(what, at=start, expected="{")

    def read_offset(self, block: _Block) -> None:
        if block.has_offset:
            raise self.text.failure(f"{self.title(block.joint)} has two OFFSETs. Remove one.")
        block.has_offset = True
        self.found.offsets[block.joint] = self.take_vector(block.joint)

    def take_vector(self, joint: int) -> Vector:
        return take_vector(self.text, "OFFSET", lambda: self.title(joint), _KEYWORDS)

    def read_channels(self, block: _Block) -> None:
        at = self.text.at
        if block.has_channels:
            what = f"{self.title(block.joint)} has two CHANNELS. Write all its channels in one."
            raise self.text.failure(what)
        if block.has_children:
            what = f"{self.title(block.joint)} has CHANNELS after its children. Move CHANNELS before them."
            raise self.text.failure(what)
        block.has_channels = True
        try:
            self.found.channels[block.joint] = read_channels(self.text)
        except ValueError as error:
            raise self.text.failure(f"{self.title(block.joint)} {error}", at=at) from None

    def read_end_site(self, parent: int) -> None:
        start = self.text.at
        self.text.take_phrase()
        end = self.found.add(f"{self.found.names[parent]}_end", parent, End.SITE)
        self.take_brace(end, start)
        if self.text.take().upper() != b"OFFSET":
            what = f"{self.title(end)} has no OFFSET. Write one there."
            raise self.text.failure(what, at=start, expected="OFFSET")
        self.found.offsets[end] = self.take_vector(end)
        if self.text.take() != b"}":
            what = f"{self.title(end)} holds more than an OFFSET. Write '}}' after it."
            raise self.text.failure(what, expected="}")

    def close(self, block: _Block) -> None:
        if not block.has_offset:
            raise no_offset(self.text, self.title(block.joint))
        if block.has_children:
            return
        if any(name.lower().endswith("rotation") for name in self.found.channels[block.joint]):
            self.found.add(f"{self.found.names[block.joint]}_end", block.joint, End.TIP)

    def title(self, joint: int) -> str:
        """A joint as errors call it."""
        if self.found.ends[joint] == End.SITE:
            return f"the End Site of joint {named(self.found.names[self.found.parents[joint]])}"
        return f"joint {named(self.found.names[joint])}"


_ITEMS = "OFFSET, CHANNELS, JOINT, End Site or }"
_CONTROL = re.compile(rb"[\x00-\x1f\x7f]")
_KEYWORDS = frozenset((b"OFFSET", b"CHANNELS", b"JOINT", b"END", b"ROOT", b"MOTION"))
