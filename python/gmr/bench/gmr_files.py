"""GMR's own files: opening a large one, which is mapped and not read."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import cmu_like_motion
from gmr.frames import Pose

__all__ = ["open_large"]

_REPEATED = 27
"""Times that the large motion is repeated: of 36,088 frames that makes a file of 1 GB."""


def open_large(frame_count: int) -> Iterator[Contest]:
    """Opens a file of 1 GB as a motion; beside it NumPy opens the array of its rotations alone."""
    motion = cmu_like_motion(frame_count)
    rotations, translations = (
        np.tile(array, (_REPEATED, 1, 1)) for array in (motion.rotations, motion.translations)
    )
    long = replace(motion, source=Pose(rotations, motion.translated, translations))
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder) / "long.gmrb", Path(folder) / "long.npy"
        gmr.write(long, ours)
        np.save(theirs, rotations)
        if not np.array_equal(gmr.read(ours)[-9:].rotations, np.load(theirs, mmap_mode="r")[-9:]):
            raise AssertionError("what gmr wrote does not read back bit-identical")
        yield Contest(
            work=f"open a .gmrb of {ours.stat().st_size / 1e9:.2g} GB",
            unit="files/s",
            amount=1,
            ours=lambda: gmr.read(ours),
            peers={f"NumPy {np.__version__} load, mapped": lambda: np.load(theirs, mmap_mode="r")},
        )
