"""A motion written as a .glb: its joints are where they were."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gmr import FormatError, GmrError, Motion
from gmr.formats.gltf import glb_of_motion
from strategies import motions, poses


def assert_in_place(written: Motion, motion: Motion) -> None:
    """All joints of ``motion`` are where they were, in metres, to float32."""
    assert motion.unit is not None
    columns = [written.skeleton.names.index(name) for name in motion.skeleton.names]
    found = written.positions(dtype=np.float64)[:, columns]
    wanted = motion.positions(dtype=np.float64) * motion.unit
    reach = np.abs(motion.skeleton.offsets).sum() * motion.unit + np.abs(wanted).max() + 1e-3
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-5 * reach)


@given(motions(min_frames=2) | poses(min_frames=2), st.sampled_from([1.0, 0.01]))
def test_every_joint_comes_back_in_its_place(motion: Motion, unit: float) -> None:
    motion = motion.with_unit(unit)
    written = gmr.read(b"".join(glb_of_motion(motion)), format="glb")
    assert written.frame_count == motion.frame_count
    assert written.frame_time == pytest.approx(motion.frame_time, rel=1e-5)
    assert_in_place(written, motion)


def test_a_real_walk_is_written_by_its_suffix_and_read_again(walk_path: Path, tmp_path: Path) -> None:
    walk = gmr.read(walk_path).with_unit("cm")
    gmr.write(walk, tmp_path / "walk.glb")
    again = gmr.read(tmp_path / "walk.glb")
    assert_in_place(again, walk)
    assert gmr.read_character(tmp_path / "walk.glb").joint_names == walk.skeleton.names


def test_what_gltf_cannot_say_is_refused(walk_path: Path, tmp_path: Path) -> None:
    walk = gmr.read(walk_path)
    with pytest.raises(GmrError, match=r"metres.*with_unit"):
        gmr.write(walk, tmp_path / "walk.glb")
    with pytest.raises(FormatError, match="without frames"):
        gmr.write(replace(walk[:0], unit=1.0), tmp_path / "walk.glb")
    assert list(tmp_path.iterdir()) == []
