"""A motion to BVH bytes: names, hierarchy, channels and offsets as they were read, every value bit-exact."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.channels import ChannelLayout
from gmr.errors import FormatError
from gmr.motion import Motion
from gmr.skeleton import End, Skeleton

__all__ = ["bvh_chunks", "write_bvh"]

_CHUNK_VALUES = 1 << 18
_DEEPEST_INDENT = 32
"""Deeper blocks are indented no further: a chain of joints would make the file grow with its square."""


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
    order = _file_order(skeleton)
    _check_names(motion, order)
    _check_values(motion, layout, rows)
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


def _file_order(skeleton: Skeleton) -> list[int]:
    """Joints as the file nests them: each before its children, siblings as they are listed."""
    order: list[int] = []
    waiting = list(reversed(skeleton.roots))
    while waiting:
        joint = waiting.pop()
        order.append(joint)
        waiting.extend(reversed(skeleton.children[joint]))
    return order


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
    site, tip = int(End.SITE), int(End.TIP)
    lines = ["HIERARCHY"]
    open_joints: list[int] = []

    def close_to(joint: int) -> None:
        while open_joints and open_joints[-1] != joint:
            open_joints.pop()
            lines.append(_indent(len(open_joints)) + "}")

    for joint in order:
        if ends[joint] == tip:
            continue
        close_to(parents[joint])
        tabs = _indent(len(open_joints))
        keyword = "End Site" if ends[joint] == site else "JOINT" if parents[joint] >= 0 else "ROOT"
        name = "" if ends[joint] == site else skeleton.names[joint]
        lines += [f"{tabs}{keyword} {name}".rstrip(" "), f"{tabs}{{", f"{tabs}\tOFFSET {offsets[joint]}"]
        if ends[joint] != site:
            channels = layout.names[joint]
            lines.append(" ".join([f"{tabs}\tCHANNELS {len(channels)}", *channels]))
        open_joints.append(joint)
    close_to(-1)
    return ("\n".join(lines) + "\n").encode()


def _indent(depth: int) -> str:
    return "\t" * min(depth, _DEEPEST_INDENT)


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


def _check_values(motion: Motion, layout: ChannelLayout, rows: NDArray[np.float64]) -> None:
    """Raises for a value that is no decimal number."""
    names, offsets = motion.skeleton.names, motion.skeleton.offsets
    for joint in np.flatnonzero(~np.isfinite(offsets).all(axis=1)).tolist():
        what = f"the offset of joint '{names[joint]}' is {offsets[joint].tolist()}, which BVH cannot say"
        raise FormatError(f"{what}. Correct it.", file=motion.name)
    if np.isfinite(rows).all():
        return
    frame, column = np.argwhere(~np.isfinite(rows))[0].tolist()
    joint = int(np.searchsorted(layout.starts, column, side="right")) - 1
    channel = layout.names[joint][column - int(layout.starts[joint])]
    what = (
        f"joint '{names[joint]}', {channel} is {rows[frame, column]} in frame {frame}, which BVH cannot say"
    )
    raise FormatError(f"{what}. Fill the gap, or cut the frame out.", file=motion.name)
