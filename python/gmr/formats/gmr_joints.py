"""The joints of a GMR text file, by their numbers: from blocks to a skeleton."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gmr.channels import ChannelLayout
from gmr.errors import FormatError, SkeletonError
from gmr.formats.gmr_blocks import Block, Link
from gmr.formats.gmr_trees import Bones, Top, Trees, TreesError, bones_at_home, skeleton_of
from gmr.formats.text import Text, named
from gmr.skeleton import Skeleton

__all__ = ["Joints"]


@dataclass(frozen=True)
class Joints:
    """J blocks.

    Args:
        text: where they stand, for errors.
        blocks: (J,) by the joints' numbers.
        order: (J,) the joints' numbers in the order of the file.
        parents: (J,) the joint in whose block each stands, -1 for a root.
    """

    text: Text
    blocks: Sequence[Block]
    order: Sequence[int]
    parents: NDArray[np.int32]

    @classmethod
    def of(cls, text: Text, blocks: Sequence[Block]) -> Joints:
        """The joints of blocks in the order of the file.

        Raises:
            FormatError: NUMBERs are not those of the joints.
        """
        order = _numbers(text, blocks)
        held: list[Block] = [blocks[0]] * len(blocks)
        parents = np.empty(len(blocks), np.int32)
        for number, block in zip(order, blocks, strict=True):
            held[number] = block
            parents[number] = order[block.parent] if block.parent >= 0 else -1
        return cls(text, held, order, parents)

    @cached_property
    def names(self) -> list[str]:
        """(J,)"""
        return [block.name for block in self.blocks]

    @cached_property
    def channels(self) -> list[tuple[str, ...]]:
        """(J,) the channels of each joint."""
        return [block.channels for block in self.blocks]

    def channel(self, column: int) -> str:
        """What a column is, for errors."""
        for joint in self.order:
            if column < len(self.channels[joint]):
                return f"joint {named(self.names[joint])}, {self.channels[joint][column]}"
            column -= len(self.channels[joint])
        raise IndexError("no joint has this column")

    def skeleton(self, adds_offset: bool | None) -> tuple[Skeleton, ChannelLayout | None]:
        """The skeleton, and the channels of the post-rotation file that it came from.

        Args:
            adds_offset: of that file; None: there was none.

        Raises:
            FormatError: the blocks make no skeleton, or the channels are not those of one.
        """
        try:
            trees = Trees(self.parents, self._offsets, self._turns, self._tops())
            bones = bones_at_home(trees, self.names)
            layout = self._layout(bones, adds_offset)
            ends = np.array([block.kind for block in self.blocks], np.uint8)
            count = 0 if layout is None else len(layout.slot_joints)
            skeleton = skeleton_of(trees, bones, self.names, ends, count)
        except TreesError as error:
            raise self.failure(error) from None
        except SkeletonError as error:
            raise self.text.failure(str(error)) from None
        if layout is not None and not layout.fits(skeleton.home or skeleton):
            what = "the TURNs are not those of the joints with POST: the bones below a joint that has POST or"
            what += (
                " children have its number, counted in the order of the joints. Leave out POST, or mend them."
            )
            raise self.text.failure(what, at=self.blocks[self.order[0]].start)
        return skeleton, layout

    def failure(self, error: TreesError) -> FormatError:
        """The error about a joint, with its line."""
        block = self.blocks[error.joint]
        return self.text.failure(f"{block.title} {error}", at=block.start)

    @property
    def _offsets(self) -> NDArray[np.float64]:
        return np.array([block.offset for block in self.blocks], np.float64)

    @property
    def _turns(self) -> NDArray[np.int32]:
        """(J,) checked: an array of slots is as long as the highest."""
        for joint, block in enumerate(self.blocks):
            if block.turn >= len(self.blocks):
                what = f"has TURN {block.turn}, but {len(self.blocks)} joints have no more than as many turns"
                raise TreesError(joint, f"{what}. Number them from 0.")
        return np.array([block.turn for block in self.blocks], np.int32)

    def _tops(self) -> dict[int, Top]:
        return {
            joint: Top(self._above(joint, block.link), block.link.offset)
            for joint, block in enumerate(self.blocks)
            if block.link is not None
        }

    def _above(self, joint: int, link: Link) -> int:
        """The joint that a soft link names."""
        if link.above is None:
            return -1
        if isinstance(link.above, int):
            found = [link.above] if link.above < len(self.blocks) else []
        else:
            found = self._by_name.get(link.above, [])
        if len(found) == 1:
            return found[0]
        said = f"#{link.above}" if isinstance(link.above, int) else named(link.above)
        count = f"{len(found)} joints have that name" if found else "there is no such joint"
        mend = "Write '#' and the number of one" if found else "Write the name of one, or '#' and its number"
        raise TreesError(joint, f"hangs at home on {said}, but {count}. {mend}.")

    @cached_property
    def _by_name(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for joint, name in enumerate(self.names):
            found.setdefault(name, []).append(joint)
        return found

    def _layout(self, bones: Bones, adds_offset: bool | None) -> ChannelLayout | None:
        if adds_offset is not None:
            channels = tuple(block.post for block in self.blocks)
            return ChannelLayout(channels, tuple(bones.parents.tolist()), adds_offset)
        for joint, block in enumerate(self.blocks):
            if block.post:
                raise TreesError(joint, "has POST, but the header has none. Write POST replace there.")
        return None


def _numbers(text: Text, blocks: Sequence[Block]) -> list[int]:
    """The number of each block's joint: its NUMBER, or its place where none has one."""
    found: list[int] = []
    taken: dict[int, Block] = {}
    numbered = blocks[0].number is not None
    for place, block in enumerate(blocks):
        if (block.number is not None) != numbered:
            what = f"has {'no' if numbered else 'a'} NUMBER, unlike {blocks[0].title}"
            raise text.failure(f"{block.title} {what}. Number all joints, or none.", at=block.start)
        number = place if block.number is None else block.number
        if number >= len(blocks):
            what = f"has NUMBER {number}, but there are {len(blocks)} joints. Number them from 0."
            raise text.failure(f"{block.title} {what}", at=block.start)
        if number in taken:
            what = f"has the same NUMBER {number} as {taken[number].title}. Give each its own."
            raise text.failure(f"{block.title} {what}", at=block.start)
        taken[number] = block
        found.append(number)
    return found
