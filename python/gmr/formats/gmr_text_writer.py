"""A motion to a GMR text file; every number reads back bit-identical. The format: docs/gmr-format.md."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.formats.gmr_blocks import LONGEST_LENT
from gmr.formats.gmr_columns import Columns, columns_of_pose, columns_of_rows
from gmr.formats.gmr_content import check, kept, side_by_side
from gmr.formats.gmr_names import spelled_name, spelled_reference
from gmr.formats.gmr_trees import Trees, trees_of
from gmr.formats.nesting import file_order, nested_lines
from gmr.frames import Rows
from gmr.motion import Motion
from gmr.skeleton import End

__all__ = ["gmr_chunks", "write_gmr"]

_CHUNK_VALUES = 1 << 18
_KINDS = {End.JOINT: "Joint", End.SITE: "Site", End.TIP: "Tip"}


def write_gmr(motion: Motion) -> bytes:
    """The motion as a GMR text file; see :func:`gmr_chunks`."""
    return b"".join(gmr_chunks(motion))


def gmr_chunks(motion: Motion) -> Iterator[bytes]:
    """The motion as a GMR text file, piece by piece, so that a long one needs no memory for the whole.

    What is kept and what is not: :mod:`gmr.formats.gmr_content`. All is checked before the first piece comes
    out.

    Raises:
        FormatError: a number is not finite, or there is no joint; joint, channel and frame are named.
    """
    motion = kept(motion)
    check(motion)
    order = file_order(motion.skeleton)
    source = motion.source
    if isinstance(source, Rows):
        columns = columns_of_rows(motion.skeleton, source.layout, order)
    else:
        columns = columns_of_pose(motion.skeleton, motion.pose, order)
    return _chunks(motion, order, columns)


def _chunks(motion: Motion, order: list[int], columns: Columns) -> Iterator[bytes]:
    lines = [*_header(motion), *_blocks(motion, order, columns.names), ""]
    yield "\n".join(lines).encode()
    yield f"MOTION\nFrames: {motion.frame_count}\nFrame Time: {_numbers([motion.frame_time])}\n".encode()
    step = max(1, _CHUNK_VALUES // max(1, len(columns.sources)))
    width = sum(math.prod(array.shape[1:]) for array in motion.source.numbers)
    in_order = np.array_equal(columns.sources, np.arange(width))
    for start in range(0, motion.frame_count, step):
        values = _values(motion, slice(start, start + step))
        yield _core.format_rows(values if in_order else values.take(columns.sources, axis=1))


def _header(motion: Motion) -> Iterator[str]:
    layout, translated = motion.layout, motion.translated.tolist()
    yield "GMR 1"
    if motion.unit is not None:
        yield f"UNIT {_numbers([motion.unit])}"
    if layout is not None:
        yield f"POST {'add' if layout.adds_offset else 'replace'}"
        if layout.adds_offset and isinstance(motion.source, Rows):
            yield "POSITIONS add"
    if translated != sorted(translated):
        yield " ".join(["TRANSLATED", str(len(translated)), *map(str, translated)])


def _blocks(motion: Motion, order: list[int], channels: Sequence[tuple[str, ...]]) -> Iterator[str]:
    skeleton, layout = motion.skeleton, motion.layout
    trees = trees_of(skeleton)
    offsets = _core.format_rows(trees.offsets).decode().splitlines()
    parents, turns = trees.parents.tolist(), trees.turns.tolist()
    names, ends = skeleton.names, skeleton.ends.tolist()
    unique = frozenset(name for name, count in Counter(names).items() if count == 1)
    is_numbered = order != list(range(len(order)))

    def head(joint: int) -> tuple[str, list[str]]:
        """The line above the brace, and what the block says of the kind of joint."""
        name, parent, kind = spelled_name(names[joint]), parents[joint], End(ends[joint])
        if kind == End.JOINT or parent < 0 or skeleton.children[joint]:
            keyword = "JOINT" if parent >= 0 else "ROOT"
            return f"{keyword} {name}", [] if kind == End.JOINT else [f"KIND {_KINDS[kind]}"]
        is_usual = len(names[parent]) <= LONGEST_LENT and names[joint] == f"{names[parent]}_end"
        return f"End {_KINDS[kind]}" + f" {name}" * (not is_usual), []

    def block(joint: int) -> tuple[str, list[str]]:
        heading, lines = head(joint)
        if is_numbered:
            lines.append(f"NUMBER {joint}")
        lines.append(f"OFFSET {offsets[joint]}")
        lines += _link(trees, joint, names, unique)
        if turns[joint] >= 0:
            lines.append(f"TURN {turns[joint]}")
        for keyword, listed in (
            ("CHANNELS", channels[joint]),
            ("POST", layout.names[joint] if layout else ()),
        ):
            if listed:
                lines.append(" ".join([keyword, str(len(listed)), *listed]))
        return heading, lines

    return nested_lines(order, parents, block)


def _link(trees: Trees, joint: int, names: Sequence[str], unique: frozenset[str]) -> list[str]:
    """What the top of a tree says of the bone above it at home."""
    if joint not in trees.tops:
        return []
    above, offset = trees.tops[joint]
    head = "TOP" if above < 0 else f"LINK {spelled_reference(above, names, unique)}"
    return [f"{head} {_numbers(offset)}"]


def _numbers(values: Sequence[float]) -> str:
    return _core.format_rows(np.array([values])).decode().rstrip("\n")


def _values(motion: Motion, frames: slice) -> NDArray[np.float64]:
    """The numbers of some frames: the rows, or translations and rotations side by side."""
    if isinstance(motion.source, Rows):
        return np.ascontiguousarray(motion.source.values[frames])
    parts = [array[frames] for array in (motion.translations, motion.rotations)]
    return np.concatenate([side_by_side(part) for part in parts], axis=1)
