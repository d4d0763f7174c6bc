"""The bones of rule ``centroid`` are those that a real Blender makes of the same files.

Recorded numbers for files that ship; where GMR_DATA and a Blender are at hand, Blender itself on the others.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from bvh_text import read_quietly
from gmr import Motion
from gmr.demo import demo_folder

HERE = Path(__file__).parent
RECORDED = sorted((HERE / "data" / "blender").glob("*.json"))
GMR_DATA = Path(os.environ.get("GMR_DATA", ""))
needs_blender = pytest.mark.skipif(
    "GMR_DATA" not in os.environ or shutil.which("blender") is None,
    reason="needs GMR_DATA and blender on the path",
)

OTHERS = [
    "bvh_exporters/boxing_toes.bvh",  # three children where the joint itself is from its parent
    "bvh_exporters/freebvh.bvh",  # leaves without end sites
    "bvh_exporters/ivizlab_walk.bvh",
    "bvh_exporters/mocapbank.bvh",
    "bvh_exporters/pybvh_bvh_test3.bvh",  # fingers
    "bvh_exporters/rotation_first_root.bvh",
    "bvh_exporters/sinusoidal.bvh",
    "bvh_exporters/swagger.bvh",
    "locomotion/bandai_namco/dataset-1_dash_active_001.bvh",  # position channels on every joint
    "locomotion/bandai_namco/dataset-2_walk-turn-left_normal_001.bvh",
]


def assert_bones_are_blenders(motion: Motion, recorded: dict[str, Any]) -> None:
    joints = [motion.skeleton.index(name) for name in recorded["joints"]]
    # Blender computes in float32, in coordinates that lie up to some heights from the origin, and turns
    # translations into the frame of the root's bone and back.
    atol = 1e-5 * max(1.0, *(float(np.abs(recorded[key]).max()) for key in ("rest_tails", "tails")))
    rest = gmr.bones(motion)
    np.testing.assert_allclose(rest.heads[joints], recorded["rest_heads"], rtol=0, atol=atol)
    np.testing.assert_allclose(rest.tails[joints], recorded["rest_tails"], rtol=0, atol=atol)
    for frame, heads, tails in zip(recorded["frames"], recorded["heads"], recorded["tails"], strict=True):
        if frame >= motion.frame_count:  # Blender also takes rows beyond the declared count
            continue
        bones = gmr.bones(motion, frame=frame)
        np.testing.assert_allclose(bones.heads[joints], heads, rtol=0, atol=atol)
        np.testing.assert_allclose(bones.tails[joints], tails, rtol=0, atol=atol)


def source(recording: Path) -> Path:
    """The file that a recording was made of."""
    name = f"{recording.stem}.bvh"
    homes = (recording.parent, HERE / "data", demo_folder())
    return next(home / name for home in homes if (home / name).exists())


@pytest.mark.parametrize("recording", RECORDED, ids=lambda recording: recording.stem)
def test_bones_are_where_blender_puts_them(recording: Path) -> None:
    recorded = json.loads(recording.read_text(encoding="utf-8"))
    motion = gmr.read(source(recording))
    proper = [n for n, end in zip(motion.skeleton.names, motion.skeleton.ends, strict=True) if end == 0]
    assert sorted(recorded["joints"]) == sorted(proper)
    assert_bones_are_blenders(motion, recorded)


def test_the_recordings_have_each_of_blenders_ways_with_a_tail_on_its_head() -> None:
    recorded = json.loads((HERE / "data" / "blender" / "odd_bones.json").read_text(encoding="utf-8"))
    vectors = np.subtract(recorded["rest_tails"], recorded["rest_heads"])
    of = dict(zip(recorded["joints"], vectors, strict=True))
    for moved in ("leaf_without_end", "leaf_without_channels", "end_on_head", "above_dummy"):
        np.testing.assert_allclose(of[moved], (0, 0.1, 0), atol=1e-5)
    np.testing.assert_allclose(of["opposite_children"], of["chain"], atol=1e-5)
    assert of["other_body"][1] > 1  # a root's: the mean length of all bones


@needs_blender
def test_bones_of_other_programs_files_are_where_blender_puts_them(tmp_path: Path) -> None:
    files = [str(GMR_DATA / name) for name in OTHERS]
    script = str(HERE / "oracles" / "record_blender.py")
    command = ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", script]
    done = subprocess.run(
        [*command, "--", *files, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for name in OTHERS:
        recorded = json.loads((tmp_path / f"{Path(name).stem}.json").read_text(encoding="utf-8"))
        assert_bones_are_blenders(read_quietly((GMR_DATA / name).read_bytes()), recorded)
