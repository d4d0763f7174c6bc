"""A real Blender's vertices of a character, for tests and for the script that records them."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

__all__ = ["blenders_vertices"]

SCRIPT = Path(__file__).parent / "oracles" / "skin_blender.py"


def blenders_vertices(
    file: Path, fps: int, frames: Sequence[int], method: str, folder: Path
) -> list[list[list[list[float]]]]:
    """By frame and mesh, in the axes of the file; ``method`` is ``linear`` or ``volume``."""
    out = folder / "vertices.json"
    # Blender's glTF importer needs NumPy, which Debian's Blender lacks.
    packages = Path(np.__file__).parent.parent
    options = ["--background", "--factory-startup", "--python-exit-code", "1"]
    command = ["blender", *options, "--python", SCRIPT, "--", file, out, fps, packages, method, *frames]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300, check=False)
    if "numpy" in done.stdout + done.stderr and not out.exists():
        pytest.skip("Blender's Python is another than the one that has NumPy here")
    assert done.returncode == 0, done.stderr
    found: dict[str, list[list[list[float]]]] = json.loads(out.read_text())
    return [found[str(frame)] for frame in frames]
