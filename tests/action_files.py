"""Small library files for tests."""

from __future__ import annotations

from pathlib import Path

from gmr.actionlets import Library, library

SWING = """
format = 1

[joint.swing_hip]
joint = "hip"
flexion = [
  [0.1, { speed = [[0, 0], [1, -20], [2, -25]] }],
  [0.6, { speed = [[0, 0], [1, 30], [2, 40]] }, 0.4],
]

[joint.swing_knee]
joint = "knee"
flexion = [[0.0, 5], [0.3, 50, 0.6]]

[limb.swing_leg]
units = ["swing_hip", "swing_knee"]

[joint.swing_waist]
joint = "waist"
rotation = [[0.0, 8], [0.5, { base = -8, drift = [[-10, -5], [10, 5]] }]]

[action.swing]
about = "Legs that swing"
units = [
  { unit = "swing_leg", side = "left" },
  { unit = "swing_leg", side = "right", phase = 0.5 },
  "swing_waist",
]
period = { speed = [[0, 2.0], [2, 1.0]] }
contacts = { left = [[0.0, 0.6]], right = [[0.5, 1.1]] }
travel = "path"
phases = { first = [0.0, 0.5], second = [0.5, 1.0] }

[action.swing.parameters]
speed = { low = 0, high = 2, default = 1, unit = "m/s" }
drift = { low = -10, high = 10, default = 0, unit = "deg/s", sided = true }

[joint.nod_neck]
joint = "neck"
flexion = [[0, 0], [0.5, 30], [1, 0]]

[action.nod_once]
units = ["nod_neck"]
duration = 1.5
contacts = { left = [[0, 1]], right = [[0, 1]] }
"""


def library_of(text: str, folder: Path) -> Library:
    """The shipped actions and those of a text."""
    file = folder / "mine.toml"
    file.write_text(text)
    return library(file)


def swinging(folder: Path) -> Library:
    """The shipped actions, 'swing' and 'nod_once'."""
    return library_of(SWING, folder)
