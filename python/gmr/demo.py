"""The real clips that ship with gmr: walks and runs of the CMU Graphics Lab Motion Capture Database."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

__all__ = ["CREDIT", "demo_folder"]

CREDIT = (
    "Clips: CMU Graphics Lab Motion Capture Database (mocap.cs.cmu.edu), free for all uses, "
    "created with funding from NSF EIA-0196217; BVH conversion by cgspeed."
)
"""Whom the shipped clips come from."""


def demo_folder() -> Path:
    """Folder of the shipped BVH files (subjects 02, 07, 08 and 09; 120 frames per second)."""
    return Path(str(files("gmr"))) / "data" / "demo"
