"""Blending against the vertices of a real Blender, recorded by tests/oracles/record_blender_skinning.py."""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.skinning import Method

DATA = Path(__file__).parent / "data"
LARGE = Path(os.environ.get("GMR_DATA", "/nowhere")) / "gltf"
FILES = [DATA / "rigged_simple.gltf", LARGE / "cesium_man.gltf", LARGE / "fox.glb"]


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
@pytest.mark.parametrize(("method", "recorded"), [("lbs", "linear"), ("dqbs", "volume")])
def test_vertices_are_blenders_to_a_millionth_of_the_extent(
    file: Path, method: Method, recorded: str
) -> None:
    if not file.exists():
        pytest.skip("needs GMR_DATA")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        character = gmr.read_character(file)
    record = json.loads((DATA / "blender" / "skin" / f"{file.stem}.json").read_text(encoding="utf-8"))
    found = character.skin(record["poses"], method, hemisphere="running")[:, :: record["step"]]
    blenders = np.array(record[recorded])
    extent = np.ptp(found.reshape(-1, 3), axis=0).max()
    assert np.abs(found - blenders).max() < 1e-6 * extent
    # Poses this extreme tell the two methods apart.
    assert np.abs(np.array(record["linear"]) - np.array(record["volume"])).max() > 1e-3 * extent
