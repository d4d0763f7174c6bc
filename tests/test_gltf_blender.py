"""A real Blender puts the vertices of what gmr writes where gmr's reading of it says."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr import FormatWarning
from lbs_oracle import blended

GMR_DATA = Path(os.environ.get("GMR_DATA", "/nowhere")) / "gltf"
RIGGED = Path(__file__).parent / "data" / "rigged_simple.gltf"
FILES = [RIGGED, *(GMR_DATA / name for name in ("cesium_man.gltf", "fox.glb"))]
SCRIPT = Path(__file__).parent / "oracles" / "skin_blender.py"
FRAMES = (0, 7, 16)

needs_blender = pytest.mark.skipif(shutil.which("blender") is None, reason="needs blender on the path")


def blenders_vertices(file: Path, fps: int, tmp_path: Path) -> dict[str, list[list[list[float]]]]:
    """What Blender makes of a file, by frame and mesh."""
    out = tmp_path / "vertices.json"
    packages = Path(np.__file__).parent.parent
    command = [
        "blender",
        "--background",
        "--factory-startup",
        "--python-exit-code",
        "1",
        "--python",
        SCRIPT,
        "--",
    ]
    command += [file, out, fps, packages, *FRAMES]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300, check=False)
    if "numpy" in done.stdout + done.stderr and not out.exists():
        pytest.skip("Blender's Python is another than the one that has NumPy here")
    assert done.returncode == 0, done.stderr
    found: dict[str, list[list[list[float]]]] = json.loads(out.read_text())
    return found


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
    for frame, meshes in blenders_vertices(tmp_path / "moving.glb", 24, tmp_path).items():
        transforms = poses[int(frame)] @ merged.inverse_binds[0]
        ours = blended(merged.vertices, merged.joints, merged.weights, transforms[None])[0]
        extent = np.ptp(ours, axis=0).max()
        assert np.allclose(meshes[0], ours, rtol=0, atol=2e-6 * extent)
