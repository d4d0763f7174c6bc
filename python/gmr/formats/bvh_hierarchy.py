"""The HIERARCHY of a BVH file: joints, offsets and channels.

The grammar, keywords in any case, tokens parted by any blanks and line ends::

    hierarchy := "HIERARCHY" ("ROOT" joint)+
    joint     := name "{" ("OFFSET" x y z | "CHANNELS" count channel* | "JOINT" joint | end)* "}"
    end       := "End" name "{" "OFFSET" x y z "}"

A name is what stands before the brace or the line's end, blanks in it included, and may be missing. The
reader keeps its own stack, so that nesting has no limit but memory.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

from gmr.channels import POSITIONS, ROTATIONS
from gmr.formats.numerals import number, why_no_number
from gmr.formats.text import Text, named, shown
from gmr.skeleton import End

__all__ = ["Hierarchy", "read_hierarchy"]

Vector = tuple[float, float, float]


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
                    self.read_end_site(block)
                case b"}":
                    self.close(blocks.pop())
                case _:
                    raise self.unexpected(block, word)

    def open_joint(self, parent: int) -> _Block:
        start = self.text.at
        name = self.text.decoded(self.text.take_phrase(), "the name")
        if any(c < " " or c == "\x7f" for c in name):
            what = f"the name {named(name)} holds control characters. Rename the joint, or export again."
            raise self.text.failure(what, at=start)
        self.take_brace(f"joint {named(name)}")
        return _Block(self.found.add(name, parent), start)

    def take_brace(self, owner: str) -> None:
        at = self.text.at
        if self.text.take() != b"{":
            raise self.text.failure(f"{owner} has no block. Write '{{' after its name.", at=at, expected="{")

    def read_offset(self, block: _Block) -> None:
        if block.has_offset:
            raise self.text.failure(f"{self.joint(block)} has two OFFSETs. Remove one.")
        block.has_offset = True
        self.found.offsets[block.joint] = self.take_vector(self.joint(block))

    def take_vector(self, owner: str) -> Vector:
        return self.take_number(owner, 0), self.take_number(owner, 1), self.take_number(owner, 2)

    def take_number(self, owner: str, have: int) -> float:
        word = self.text.peek()
        value = number(word)
        if value is None and word.upper() in _WORDS:
            what = f"{owner}: OFFSET has {have} number{'s' * (have != 1)}. Write three: x, y and z."
            raise self.text.failure(what, expected="three numbers")
        self.text.take()
        if value is None:
            what = f"{owner}, OFFSET: {why_no_number(word)}"
            raise self.text.failure(what, at=self.text.at - len(word), expected="a number", column=True)
        return value

    def read_channels(self, block: _Block) -> None:
        owner, at = self.joint(block), self.text.at
        if block.has_channels:
            raise self.text.failure(f"{owner} has two CHANNELS. Write all its channels in one.")
        if block.has_children:
            raise self.text.failure(f"{owner} has CHANNELS after its children. Move CHANNELS before them.")
        block.has_channels = True
        count = self.text.take()
        if not count.isdigit() or len(count) > 9:
            what = f"{owner}: CHANNELS is followed by {shown(count)}. Write how many channels there are."
            raise self.text.failure(what, at=at, expected="a whole number")
        names = []
        while self.text.peek().lower() in _CHANNELS:
            names.append(self.text.take().decode())
        self.check_channels(owner, int(count), names, at)
        self.found.channels[block.joint] = tuple(names)

    def check_channels(self, owner: str, count: int, names: list[str], at: int) -> None:
        after = self.text.peek()
        if after.lower().endswith((b"rotation", b"position", b"scale")):
            what = f"{owner} has a channel {shown(after)}. There are {', '.join(_CHANNELS.values())}."
            raise self.text.failure(what, at=at)
        if count != len(names):
            missing = abs(count - len(names))
            ones = "one" if missing == 1 else "ones"
            mend = f"Write the missing {ones}" if len(names) < count else f"Remove the {ones} too many"
            raise self.text.failure(
                f"{owner} declares {count} channel{'s' * (count != 1)} but CHANNELS lists {len(names)} "
                f"({' '.join(names[:8]) or 'none'}{' ...' * (len(names) > 8)}). {mend}, or change the count.",
                at=at,
            )
        known = [name.lower() for name in names]
        places = [name for name in known if name.encode() in _PLACES]
        turns = [name for name in known if name.encode() not in _PLACES]
        if len(set(places)) < len(places):
            raise self.text.failure(f"{owner} has a position twice ({' '.join(names)}). Remove one.", at=at)
        if len(turns) > 3 or any(one == next_ for one, next_ in pairwise(turns)):
            what = f"{owner} has rotations that are no Euler angles ({' '.join(names[:8])})."
            raise self.text.failure(f"{what} Write at most three, no two alike in succession.", at=at)

    def read_end_site(self, block: _Block) -> None:
        start, parent = self.text.at, self.found.names[block.joint]
        self.text.take_phrase()
        owner = f"the End Site of joint {named(parent)}"
        self.take_brace(owner)
        end = self.found.add(f"{parent}_end", block.joint, End.SITE)
        if self.text.take().upper() != b"OFFSET":
            raise self.text.failure(f"{owner} has no OFFSET. Write one there.", at=start, expected="OFFSET")
        self.found.offsets[end] = self.take_vector(owner)
        if self.text.take() != b"}":
            raise self.text.failure(f"{owner} holds more than an OFFSET. Write '}}' after it.", expected="}")

    def close(self, block: _Block) -> None:
        if not block.has_offset:
            what = f"{self.joint(block)} has no OFFSET. Write one, OFFSET 0 0 0 if it is where its parent is."
            raise self.text.failure(what, expected="OFFSET")
        turns = any(name.lower().endswith("rotation") for name in self.found.channels[block.joint])
        if turns and not block.has_children:
            self.found.add(f"{self.found.names[block.joint]}_end", block.joint, End.TIP)

    def unexpected(self, block: _Block, word: bytes) -> Exception:
        owner = f"{self.joint(block)}, which begins at line {self.text.line_of(block.start)}"
        match word.upper():
            case b"":
                what = f"the file ends inside {owner}. It may be cut off: export it again."
            case b"MOTION" | b"ROOT":
                what = f"{word.decode()} stands inside {owner}. Write the closing brace '}}' that is missing."
            case b"{":
                what = f"there is a second '{{' in {owner}. Remove it."
            case _:
                what = (
                    f"{shown(word)} stands inside {owner}. Write OFFSET, CHANNELS, JOINT, End Site or '}}'."
                )
        expected = "OFFSET, CHANNELS, JOINT, End Site or }"
        return self.text.failure(what, at=self.text.at - len(word), expected=expected, column=True)

    def joint(self, block: _Block) -> str:
        return f"joint {named(self.found.names[block.joint])}"


_WORDS = frozenset((b"", b"{", b"}", b"OFFSET", b"CHANNELS", b"JOINT", b"END", b"ROOT", b"MOTION"))
_CHANNELS = {
    f"{axis}{kind}".lower().encode(): f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ"
}
_PLACES = frozenset(name.encode() for name in POSITIONS)
assert frozenset(_CHANNELS) == _PLACES | frozenset(name.encode() for name in ROTATIONS)
