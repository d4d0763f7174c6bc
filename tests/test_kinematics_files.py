"""World positions of real files: the same bits on every instruction set, and those of pybvh."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr import _core

BITS = """
import hashlib, sys
sys.path.insert(0, {tests!r})
import numpy as np, gmr
from kinematics_oracle import random_case
from test_kinematics import run
motion = gmr.read({file!r})
arrays = [motion.positions(dtype=t) for t in ("float32", "float64")]
arrays += [motion.bone_rotations(), *run(random_case(4, 25, 77, root_count=2), np.float32)]
print(hashlib.sha256(b"".join(a.tobytes() for a in arrays)).hexdigest())
"""


def test_every_instruction_set_gives_the_same_bits_for_a_real_file(walk_path: Path) -> None:
    code = BITS.format(tests=str(Path(__file__).parent), file=str(walk_path))
    found = {
        isa: subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"GMR_ISA": isa},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for isa in _core.instruction_sets()
    }
    assert len(set(found.values())) == 1, found


def test_positions_of_a_real_file_are_pybvhs(walk_path: Path) -> None:
    pybvh = pytest.importorskip("pybvh")
    theirs = pybvh.read_bvh_file(str(walk_path)).node_positions()
    motion = gmr.read(walk_path)
    height = np.ptp(theirs[..., 1])
    assert np.abs(motion.positions(dtype=np.float64) - theirs).max() < 1e-9 * height
    assert np.abs(motion.positions() - theirs).max() < 2e-6 * height
