"""GMR text to a motion; every number is the nearest float64. The format: docs/gmr-format.md."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.channels import ChannelLayout
from gmr.formats.gmr_blocks import read_blocks
from gmr.formats.gmr_columns import Columns, PoseColumns, columns_of_rows, moving_joints, pose_of_columns
from gmr.formats.gmr_content import off_length
from gmr.formats.gmr_joints import Joints
from gmr.formats.gmr_trees import TreesError
from gmr.formats.numerals import number, why_no_number
from gmr.formats.rows import place_of_row, read_rows
from gmr.formats.text import Text, shown
from gmr.formats.timing import read_timing
from gmr.frames import Pose, Rows
from gmr.motion import Motion
from gmr.skeleton import Skeleton

__all__ = ["read_gmr_text"]

VERSION = 1


def read_gmr_text(data: bytes, *, name: str | None = None, strict: bool = False) -> Motion:
    """Motion of a GMR text file.

    Args:
        data: the file's bytes: UTF-8, or UTF-16 with a byte order mark.
        name: the file's name, for errors and for the motion.
        strict: raise where a warning would do: more or fewer rows than declared, a last row that is cut off,
            a frame time of zero, quaternions that are not of length 1.

    Raises:
        FormatError: the file cannot be read; the message says where, why, and what to do.
    """
    text = Text(data, name=name, strict=strict)
    header = _read_header(text)
    joints = Joints.of(text, read_blocks(text))
    skeleton, layout = joints.skeleton(header.post)
    reading = _reading(joints, header, skeleton, layout)
    if not text.peek():
        raise text.failure(
            "the file ends before MOTION. It may be cut off: write it again.", expected="MOTION"
        )
    timing, columns = read_timing(text), sum(map(len, joints.channels))
    rows = read_rows(text, columns, joints.channel, timing)
    if isinstance(reading, Columns):
        assert layout is not None
        source: Rows | Pose = Rows(read_only(_ordered(rows, reading)), layout)
    else:
        source = reading.pose(rows, layout)
        if off := off_length(source):
            at = place_of_row(text, columns, off.frame)
            text.odd(f"{off}; read as they are. Divide them by their lengths.", at=at)
    return Motion(skeleton, timing.frame_time, source, header.unit, name)


def _reading(
    joints: Joints, header: _Header, skeleton: Skeleton, layout: ChannelLayout | None
) -> Columns | PoseColumns:
    """How to read a frame: as a row of the post-rotation file where the columns are its, else as a pose."""
    moving = moving_joints(skeleton, joints.channels)
    if header.translated is not None and sorted(header.translated) != moving:
        what = (
            "TRANSLATED must list all roots and all joints with position channels, each once, and no others"
        )
        raise joints.text.failure(f"{what}. Correct the list.", at=header.at)
    may_be_rows = layout is not None and skeleton.home is None and header.translated is None
    if may_be_rows and layout is not None and header.adds_offset == layout.adds_offset:
        columns = columns_of_rows(skeleton, layout, joints.order)
        if _lower(columns.names) == _lower(joints.channels):
            return columns
    try:
        translated = moving if header.translated is None else header.translated
        return pose_of_columns(skeleton, joints.channels, joints.order, translated, header.adds_offset)
    except TreesError as error:
        raise joints.failure(error) from None


def _lower(channels: Sequence[tuple[str, ...]]) -> list[list[str]]:
    return [[name.lower() for name in names] for names in channels]


def _ordered(rows: NDArray[np.float64], columns: Columns) -> NDArray[np.float64]:
    """The rows with their columns in the order of the post-rotation file."""
    if np.array_equal(columns.sources, np.arange(rows.shape[1])):
        return rows
    ordered = np.empty_like(rows)
    ordered[:, columns.sources] = rows
    return ordered


class _Header(NamedTuple):
    """What stands before the first ROOT."""

    at: int
    unit: float | None
    post: bool | None
    """Whether the positions of the post-rotation file add to the offset; None: there was no such file."""
    adds_offset: bool
    translated: list[int] | None


def _read_header(text: Text) -> _Header:
    at = text.at
    word = text.take()
    if word.upper() != b"GMR":
        what = f"begins with {shown(word)}" if word else "is empty"
        what = f"the file {what}, but a GMR file begins with GMR and a version. Check that it is one."
        raise text.failure(what, at=text.at - len(word), expected="GMR 1")
    version = text.take()
    if not version.isdigit() or version.lstrip(b"0") != str(VERSION).encode():
        said = shown(version) if version else "nothing"
        what = f"GMR is followed by {said}, but this gmr reads version {VERSION}. Install a newer gmr."
        raise text.failure(what, at=text.at - len(version), expected=str(VERSION))
    found: dict[bytes, object] = {}
    while text.peek().upper() != b"ROOT":
        start = text.peek_at()
        keyword = text.take().upper()
        if keyword in found:
            raise text.failure(f"there are two {keyword.decode()}s. Remove one.", at=start)
        match keyword:
            case b"UNIT":
                found[keyword] = _unit(text)
            case b"POST" | b"POSITIONS":
                found[keyword] = _adds_offset(text, keyword)
            case b"TRANSLATED":
                found[keyword] = _joint_numbers(text)
            case _:
                said = shown(keyword) if keyword else "the end of the file"
                what = (
                    f"{said} stands in the header. Write UNIT, POST, POSITIONS, TRANSLATED or a ROOT joint."
                )
                raise text.failure(what, at=start, expected="ROOT", column=True)
    return _Header(
        at,
        found.get(b"UNIT"),  # type: ignore[arg-type]
        found.get(b"POST"),  # type: ignore[arg-type]
        bool(found.get(b"POSITIONS", False)),
        found.get(b"TRANSLATED"),  # type: ignore[arg-type]
    )


def _unit(text: Text) -> float:
    word = text.take()
    value = number(word)
    if value is None or value <= 0:
        why = why_no_number(word) if value is None else "a unit is longer than 0. Leave UNIT out if unknown."
        raise text.failure(f"UNIT: {why}", at=text.at - len(word), expected="metres", column=True)
    return value


def _adds_offset(text: Text, keyword: bytes) -> bool:
    word = text.take()
    if word.lower() not in (b"replace", b"add"):
        what = f"{keyword.decode()} is followed by {shown(word)}. Write replace or add."
        raise text.failure(what, at=text.at - len(word), expected="replace or add", column=True)
    return word.lower() == b"add"


def _joint_numbers(text: Text) -> list[int]:
    start = text.at
    words: list[bytes] = []
    while (word := text.peek()).isdigit() and len(word) <= 9:
        words.append(text.take())
    found = [int(word) for word in words]
    if not found or found[0] != len(found) - 1:
        what = "TRANSLATED is no list. Write how many joints, then the number of each."
        raise text.failure(what, at=start, expected="a count and numbers of joints")
    return found[1:]
