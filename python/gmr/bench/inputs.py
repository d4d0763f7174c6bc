"""The same inputs for every benchmark, made of the real clips that ship with gmr."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np

import gmr
from gmr.demo import demo_folder

__all__ = ["LARGE_FRAME_COUNT", "cmu_like_bvh", "cmu_like_motion", "data_folder", "unit_quaternions"]

LARGE_FRAME_COUNT = 36_088
"""Frames of the large file that the speed targets speak of: 38 nodes, about 27 MB of text."""


def data_folder(name: str) -> Path | None:
    """A folder below ``GMR_DATA`` with large real files; None where there is none."""
    root = os.environ.get("GMR_DATA")
    folder = Path(root) / name if root else None
    return folder if folder is not None and folder.is_dir() else None


@cache
def cmu_like_bvh(frame_count: int = LARGE_FRAME_COUNT) -> bytes:
    """One BVH file of real CMU rows: those of the shipped clips, one after the other, again and again."""
    files = sorted(demo_folder().glob("*.bvh"))
    header = files[0].read_bytes().partition(b"MOTION")[0]
    rows: list[bytes] = []
    for file in files:
        rows += file.read_bytes().partition(b"Frame Time:")[2].splitlines(keepends=True)[1:]
    repeated = (rows * (frame_count // len(rows) + 1))[:frame_count]
    motion_head = f"MOTION\nFrames: {frame_count}\nFrame Time: .0083333\n".encode()
    return header + motion_head + b"".join(repeated)


@cache
def cmu_like_motion(frame_count: int = LARGE_FRAME_COUNT) -> gmr.Motion:
    """The motion in :func:`cmu_like_bvh`."""
    return gmr.read(cmu_like_bvh(frame_count), format="bvh")


def unit_quaternions(motion: gmr.Motion, dtype: type[np.floating] = np.float32) -> np.ndarray:
    """Local rotations of the motion, ``(F, S, 4)`` xyzw, in one contiguous array of the asked type."""
    return np.ascontiguousarray(motion.rotations, dtype=dtype)
