"""BVH bytes to a motion: the hierarchy, the timing, and the rows of numbers, which the core reads."""

from __future__ import annotations

from typing import Literal

from gmr.formats.bvh_shape import Shape, read_shape
from gmr.formats.rows import read_rows
from gmr.formats.text import Text, named
from gmr.formats.timing import read_timing
from gmr.motion import Motion

__all__ = ["read_bvh"]


def read_bvh(
    data: bytes,
    *,
    name: str | None = None,
    positions: Literal["replace", "add"] = "replace",
    strict: bool = False,
) -> Motion:
    """Motion of a BVH file; its rows of numbers are kept as read, bit-exact.

    Args:
        data: the file's bytes: UTF-8, or UTF-16 with a byte order mark.
        name: the file's name, for errors and for the motion.
        positions: position channels "replace" a joint's OFFSET, as Blender reads them, or "add" to it, as
            three.js does.
        strict: raise where a warning would do: more or fewer rows than declared, a last row that is cut off,
            no MOTION, a frame time of zero, names that are no UTF-8.

    Returns:
        A motion with every joint of the file. A leaf that turns but has no End Site is given a zero-length
        tip, so that its rotation is kept. Files with the same hierarchy share skeleton and layout.

    Raises:
        FormatError: the file cannot be read; the message says where, why, and what to do.
        ValueError: ``positions`` is neither "replace" nor "add".
    """
    if positions not in ("replace", "add"):
        raise ValueError(f"positions={positions!r} is not known; use 'replace' or 'add'")
    text = Text(bytes(data), name=name, strict=strict)
    shape = read_shape(text, adds_offset=positions == "add")
    timing = read_timing(text)
    rows = read_rows(text, shape.layout.column_count, lambda column: _channel(shape, column), timing)
    return Motion.from_rows(shape.skeleton, shape.layout, rows, timing.frame_time, name=name)


def _channel(shape: Shape, column: int) -> str:
    """The joint and channel that a column belongs to."""
    joint, channel = shape.layout.channel(column)
    return f"joint {named(shape.skeleton.names[joint])}, {channel}"
