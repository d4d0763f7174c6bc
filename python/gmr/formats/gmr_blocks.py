"""The blocks of a GMR text file: its joints as they are nested, not yet as they hang together at home.

The grammar, keywords in any case, tokens parted by any blanks and line ends::

    trees   := ("ROOT" name block)+
    block   := "{" item* "}"
    item    := "OFFSET" x y z | "NUMBER" n | "TURN" n | "KIND" kind
             | "LINK" reference x y z | "TOP" x y z
             | "CHANNELS" count channel* | "POST" count channel*
             | "JOINT" name block | "End" kind [name] leaf
    leaf    := "{" item* "}"  without JOINT and End
    kind    := "Joint" | "Site" | "Tip"

The reader keeps its own stack, so that nesting has no limit but memory. Source: docs/gmr-format.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from gmr.formats.block_errors import no_offset, unexpected_in_block
from gmr.formats.channel_lists import GMR, POST, read_channels
from gmr.formats.gmr_names import Reference, take_name, take_reference
from gmr.formats.text import Text, named, shown
from gmr.formats.vectors import Vector, take_vector
from gmr.skeleton import End

__all__ = ["LONGEST_LENT", "Block", "Link", "read_blocks"]


LONGEST_LENT = 1000
"""Characters of a name that an end without a name takes from its joint at most; ends are many, and short."""


class Link(NamedTuple):
    """What a tree's top says of the bone above it at home."""

    above: Reference | None
    """The joint that it hangs on at home; None: it is a root there."""
    offset: Vector
    at: int
    """The byte after its keyword."""


@dataclass(slots=True)
class Block:
    """A joint of the file."""

    name: str
    parent: int
    """The block that it stands in, -1 for a root."""
    kind: End
    start: int
    """The byte after its keyword."""
    offset: Vector = (0.0, 0.0, 0.0)
    number: int | None = None
    turn: int = -1
    link: Link | None = None
    channels: tuple[str, ...] = ()
    post: tuple[str, ...] = ()
    is_leaf: bool = False
    """It may hold no further block."""
    items: set[bytes] = field(default_factory=set)
    """The keywords that it has."""

    @property
    def title(self) -> str:
        """The joint as errors call it."""
        return f"joint {named(self.name)}"


def read_blocks(text: Text) -> list[Block]:
    """Reads from the first ROOT to the brace that closes the last, and leaves ``text`` there.

    Raises:
        FormatError: these are no blocks of joints; line, joint and remedy are named.
    """
    reader = _Reader(text, [])
    while text.peek().upper() == b"ROOT":
        text.take()
        reader.read_tree()
    if not reader.found:
        what = shown(text.take()) if text.peek() else "the end of the file"
        raise text.failure(f"the header is followed by {what}. Write a ROOT joint there.", expected="ROOT")
    return reader.found


@dataclass(slots=True)
class _Reader:
    text: Text
    found: list[Block]

    def read_tree(self) -> None:
        """Reads a root after its keyword, and all that hangs on it."""
        open_blocks = [self.open_joint(-1)]
        while open_blocks:
            here = open_blocks[-1]
            word = self.text.take()
            keyword = word.upper()
            if keyword in (b"JOINT", b"END"):
                self.check_inner(self.found[here], word)
                open_blocks.append(self.open_joint(here) if keyword == b"JOINT" else self.open_end(here))
            elif keyword == b"}":
                self.close(self.found[open_blocks.pop()])
            elif keyword in _ITEMS:
                self.read_item(self.found[here], keyword)
            else:
                block = self.found[here]
                raise unexpected_in_block(self.text, word, block.title, block.start, _WORDS)

    def open_joint(self, parent: int) -> int:
        start = self.text.at
        return self.open(Block(take_name(self.text), parent, End.JOINT, start))

    def open_end(self, parent: int) -> int:
        start = self.text.at
        kind = self.take_kind("End")
        if self.text.peek() != b"{":
            return self.open(Block(take_name(self.text), parent, kind, start, is_leaf=True))
        above = self.found[parent]
        if len(above.name) > LONGEST_LENT:
            what = f"an end of {above.title} has no name, and its joint's is too long to lend"
            raise self.text.failure(f"{what}. Write a name after End {kind.name.title()}.", at=start)
        return self.open(Block(f"{above.name}_end", parent, kind, start, is_leaf=True))

    def check_inner(self, block: Block, word: bytes) -> None:
        if block.is_leaf:
            what = f"{shown(word)} stands inside the End of {block.title}"
            mend = f"Write JOINT and KIND {block.kind.name.title()} in the place of End"
            raise self.text.failure(f"{what}. {mend}.", at=self.text.at - len(word), column=True)

    def open(self, block: Block) -> int:
        if self.text.take() != b"{":
            what = f"{block.title} has no block. Write '{{' after its name."
            raise self.text.failure(what, at=block.start, expected="{")
        self.found.append(block)
        return len(self.found) - 1

    def read_item(self, block: Block, keyword: bytes) -> None:
        at = self.text.at
        if keyword in block.items:
            raise self.text.failure(f"{block.title} has two {keyword.decode()}s. Remove one.", at=at)
        block.items.add(keyword)
        match keyword:
            case b"OFFSET":
                block.offset = self.take_vector(block, "OFFSET")
            case b"NUMBER":
                block.number = self.take_count(block, "NUMBER", "the joint's place among all, from 0")
            case b"TURN":
                block.turn = self.take_count(block, "TURN", "the number of its bone's world rotation, from 0")
            case b"KIND":
                block.kind = self.take_kind("KIND")
            case b"LINK":
                block.link = Link(take_reference(self.text), self.take_vector(block, "LINK"), at)
            case b"TOP":
                block.link = Link(None, self.take_vector(block, "TOP"), at)
            case b"CHANNELS":
                block.channels = self.take(block, lambda text: read_channels(text, GMR))
            case _:
                block.post = self.take(block, lambda text: read_channels(text, POST))
        if {b"LINK", b"TOP"} <= block.items:
            what = f"{block.title} has a LINK and a TOP. Remove TOP where it hangs on a joint at home."
            raise self.text.failure(what, at=at)

    def take_vector(self, block: Block, keyword: str) -> Vector:
        return take_vector(self.text, keyword, lambda: block.title, _KEYWORDS)

    def take_count(self, block: Block, keyword: str, meaning: str) -> int:
        word = self.text.take()
        if word.isdigit() and len(word) <= 9:
            return int(word)
        said = shown(word) if word else "the end of the file"
        what = f"{block.title} has {keyword} followed by {said}. Write {meaning}, a whole number."
        raise self.text.failure(what, at=self.text.at - len(word), expected="a whole number", column=True)

    def take_kind(self, keyword: str) -> End:
        word = self.text.take()
        kind = _KINDS.get(word.upper())
        if kind is None or (keyword == "End" and kind == End.JOINT):
            what = f"{keyword} is followed by {shown(word)}. Write Site, or Tip (an end that a reader added)."
            raise self.text.failure(what, at=self.text.at - len(word), expected="Site or Tip", column=True)
        return kind

    def take(self, block: Block, read: Callable[[Text], tuple[str, ...]]) -> tuple[str, ...]:
        at = self.text.at
        try:
            return read(self.text)
        except ValueError as error:
            raise self.text.failure(f"{block.title} {error}", at=at) from None

    def close(self, block: Block) -> None:
        if b"OFFSET" not in block.items:
            raise no_offset(self.text, block.title)


_ITEMS = frozenset((b"OFFSET", b"NUMBER", b"TURN", b"KIND", b"LINK", b"TOP", b"CHANNELS", b"POST"))
_WORDS = f"{b', '.join(sorted(_ITEMS)).decode()}, JOINT, End or }}"
_KEYWORDS = _ITEMS | {b"JOINT", b"END", b"ROOT", b"MOTION"}
_KINDS = {b"JOINT": End.JOINT, b"SITE": End.SITE, b"TIP": End.TIP}
