"""Files as programs really write them; they are not free to ship, so this runs where GMR_DATA has them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from bvh_text import read_quietly
from gmr import FormatWarning
from gmr.formats.bvh import read_bvh, write_bvh

FOLDER = Path(os.environ.get("GMR_DATA", "")) / "bvh_exporters"
needs_files = pytest.mark.skipif(
    "GMR_DATA" not in os.environ or not FOLDER.is_dir(), reason="GMR_DATA names no folder with bvh_exporters"
)

FILES = {
    "boxing_toes": (3069, 26),
    "freebvh": (69, 70),
    "full_precision_frame_time": (3, 3),
    "ivizlab_walk": (1064, 30),
    "mocapbank": (455, 24),
    "pybvh_bvh_test1": (75, 29),
    "pybvh_bvh_test2": (61, 28),
    "pybvh_bvh_test3": (100, 73),
    "rotation_first_root": (4, 6),
    "sinusoidal": (120, 5),
    "swagger": (581, 27),
}


@needs_files
@pytest.mark.parametrize("name", FILES)
def test_every_exporters_file_is_read_value_by_value_and_comes_back(name: str) -> None:
    data = (FOLDER / f"{name}.bvh").read_bytes()
    motion = read_quietly(data)
    assert (motion.frame_count, motion.skeleton.joint_count) == FILES[name]
    lines = data.decode().split("Frame Time:")[1].splitlines()[1:]
    expected = [[float(token) for token in line.split()] for line in lines if line.strip()]
    assert motion.rows.tolist() == expected[: motion.frame_count]
    again = read_bvh(write_bvh(motion))
    assert again == motion
    assert again.rows.tobytes() == motion.rows.tobytes()


@needs_files
def test_no_file_in_the_folder_is_left_out() -> None:
    assert sorted(FILES) == sorted(path.stem for path in FOLDER.glob("*.bvh"))


@needs_files
def test_a_row_beyond_the_declared_count_is_said() -> None:
    with pytest.warns(FormatWarning, match="3,069 frames are declared, but 3,070 rows are there"):
        read_bvh((FOLDER / "boxing_toes.bvh").read_bytes())


@needs_files
def test_rotations_before_positions_move_the_root_by_its_own_columns() -> None:
    motion = read_bvh((FOLDER / "rotation_first_root.bvh").read_bytes())
    np.testing.assert_array_equal(motion.positions(dtype=np.float64)[0, 0], [10, 50, -20])
