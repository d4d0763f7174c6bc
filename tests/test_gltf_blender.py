"""A real Blender puts the vertices of what gmr writes where gmr's reading of it says."""

from __future__ import annotations

import os
import shutil
import warnings
from pathlib import Path

import numpy as np
import pytest

import gmr
from blender_skinning import blenders_vertices
from gmr import FormatWarning
from lbs_oracle import blended

GMR_DATA = Path(os.environ.get("GMR_DATA", "/nowhere")) / "gltf"
RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"
FILES = [RIGGED, *(GMR_DATA / name for name in ("cesium_man.gltf", "fox.glb"))]
FRAMES = (0, 7, 16)

needs_blender = pytest.mark.skipif(shutil.which("blender") is None, reason="needs blender on the path")


@needs_blender
@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_blender_moves_what_is_written_as_gmr_reads_it(file: Path, tmp_path: Path) -> None:
    if not file.exists():
        pytest.skip("needs GMR_DATA")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FormatWarning)
        character = gmr.read_character(file)
    poses = character.animation(fps=24)
    gmr.write_character(character, tmp_path / "moving.glb", poses, 1 / 24)
    merged = character.merged
    found = blenders_vertices(tmp_path / "moving.glb", 24, FRAMES, "linear", tmp_path)
    for frame, meshes in zip(FRAMES, found, strict=True):
        transforms = poses[frame] @ merged.inverse_binds[0]
        ours = blended(merged.vertices, merged.joints, merged.weights, transforms[None])[0]
        extent = np.ptp(ours, axis=0).max()
        assert np.allclose(meshes[0], ours, rtol=0, atol=2e-6 * extent)
