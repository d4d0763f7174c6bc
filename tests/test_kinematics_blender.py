"""Joint positions agree with those that a real Blender computes from the same files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import gmr

FOLDER = Path(__file__).parent / "data" / "blender"
FILES = sorted(FOLDER.glob("*.bvh"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_positions_are_where_blender_puts_them(file: Path) -> None:
    recorded = json.loads(file.with_suffix(".json").read_text(encoding="utf-8"))
    motion = gmr.read(file)
    joints = [motion.skeleton.index(name) for name in recorded["joints"]]
    ours = motion.positions(dtype=np.float64)[recorded["frames"]][:, joints]
    theirs = np.array(recorded["heads"])

    height = np.ptp(theirs[..., 1], axis=1).max()
    # Blender computes in float32, in world coordinates that lie up to some heights from the origin.
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=5e-6 * max(height, np.abs(theirs).max()))


def test_there_are_five_files() -> None:
    assert len(FILES) == 5
