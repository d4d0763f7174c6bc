"""A motion to BVH bytes: names, hierarchy, channels and offsets as they were read, every value bit-exact."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.channels import ChannelLayout
from gmr.errors import FormatError
from gmr.formats.finite import check_offsets, check_rows
from gmr.formats.nesting import file_order, nested_lines
from gmr.motion import Motion
from gmr.skeleton import End, Skeleton

__all__ = ["bvh_chunks", "write_bvh"]

_CHUNK_VALUES = 1 << 18


def write_bvh(motion: Motion) -> bytes:
    """The motion as a BVH file; see :func:`bvh_chunks`."""
    return b"".join(bvh_chunks(motion))


def bvh_chunks(motion: Motion) -> Iterator[bytes]:
    """The motion as a BVH file, piece by piece, so that a long one needs no memory for the whole.

    Rows that were read are written as they are, in the shortest decimals that read back bit-identical; a pose
    is written in the Euler angles of the motion's layout, with those of its dropped dummies that it takes to
    let siblings turn independently. Zero-length tips that reading added are left out.
    All is checked before the first piece comes out.

    Raises:
        FormatError: a name or a value that BVH has no way to write; joint and frame are named.
        SkeletonError: siblings turn independently, which rows of channels cannot say.
    """
    motion = motion.to_post_rotation()
    skeleton, rows = motion.skeleton, motion.rows
    layout = motion.layout or ChannelLayout.standard(skeleton, motion.translated)
    order = file_order(skeleton)
    _check_names(motion, order)
    check_offsets(motion, skeleton, "BVH")
    check_rows(motion, layout, rows, "BVH")
    rows = _in_file_order(layout, order, rows)
    return _chunks(skeleton, layout, order, rows, motion.frame_time)


def _chunks(
    skeleton: Skeleton,
    layout: ChannelLayout,
    order: list[int],
    rows: NDArray[np.float64],
    frame_time: float,
) -> Iterator[bytes]:
    yield _hierarchy(skeleton, layout, order)
    seconds = _core.format_rows(np.array([[frame_time]])).decode()
    yield f"MOTION\nFrames: {len(rows)}\nFrame Time: {seconds}".encode()
    step = max(1, _CHUNK_VALUES // max(1, layout.column_count))
    for start in range(0, len(rows), step):
        yield _core.format_rows(rows[start : start + step])


def _in_file_order(layout: ChannelLayout, order: list[int], rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rows with their columns in the order in which the file lists their joints."""
    starts = layout.starts
    columns = np.concatenate([np.arange(0), *(np.arange(starts[j], starts[j + 1]) for j in order)])
    if np.array_equal(columns, np.arange(rows.shape[1])):
        return np.ascontiguousarray(rows)
    return np.ascontiguousarray(rows[:, columns])


def _hierarchy(skeleton: Skeleton, layout: ChannelLayout, order: list[int]) -> bytes:
    offsets = _core.format_rows(skeleton.offsets).decode().splitlines()
    parents, ends = skeleton.parents.tolist(), skeleton.ends.tolist()

    def block(joint: int) -> tuple[str, list[str]]:
        if ends[joint] == End.SITE:
            return "End Site", [f"OFFSET {offsets[joint]}"]
        keyword, channels = "JOINT" if parents[joint] >= 0 else "ROOT", layout.names[joint]
        listed = " ".join([f"CHANNELS {len(channels)}", *channels])
        return f"{keyword} {skeleton.names[joint]}".rstrip(" "), [f"OFFSET {offsets[joint]}", listed]

    written = [joint for joint in order if ends[joint] != End.TIP]
    return "\n".join(["HIERARCHY", *nested_lines(written, parents, block), ""]).encode()


def _check_names(motion: Motion, order: list[int]) -> None:
    """Raises for a name that would not read back."""
    for joint in order:
        name = motion.skeleton.names[joint]
        raw = name.encode(errors="replace")
        if raw.decode() != name or raw != raw.strip() or any(c in "{}\x7f" or c < " " for c in name):
            what = (
                f"the name {name!r} of joint {joint} cannot stand in a BVH file: braces, control characters "
            )
            raise FormatError(what + "and blanks at its ends do not read back. Rename it.", file=motion.name)
