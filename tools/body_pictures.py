"""Draws the body's degrees of freedom, and a captured walk beside what is read from it.

python tools/body_pictures.py docs/images
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gmr
from gmr import Motion
from gmr.actionlets import Body, film_strip, posing, read
from gmr.demo import demo_folder

UPPER = (
    ("neck.flexion", 40),
    ("waist.flexion", 55),
    ("waist.lateral", 30),
    ("waist.rotation", 40),
    ("right_shoulder.flexion", 100),
    ("right_shoulder.abduction", 80),
    ("right_shoulder.rotation", 45),
    ("right_elbow.flexion", 100),
    ("right_wrist.flexion", 60),
)
LOWER = (
    ("right_hip.flexion", 80),
    ("right_hip.abduction", 40),
    ("right_hip.rotation", 40),
    ("right_knee.flexion", 90),
    ("right_ankle.flexion", 30),
    ("right_ankle.inversion", 30),
    ("root.tilt", 30),
    ("root.obliquity", 15),
    ("root.rotation", 45),
)
"""Degrees of freedom and the degrees to show of each."""


def main(folder: Path) -> None:
    for shown, file in ((UPPER, "body_upper.svg"), (LOWER, "body_lower.svg")):
        labels = [f"{name.removeprefix('right_')} {degrees}°" for name, degrees in shown]
        film_strip(one_by_one(shown), folder / file, len(shown), "three-quarter", labels=labels, plan=False)
    walk = gmr.read(demo_folder() / "07_01.bvh")
    again = read(Body.like(walk), walk).motion()
    film_strip([walk, again], folder / "body_read.svg", 9, titles=["captured", "read and posed again"])


def one_by_one(shown: tuple[tuple[str, int], ...]) -> Motion:
    """A frame for each degree of freedom."""
    body = Body.of()
    angles = np.zeros((len(shown), body.dof_count))
    for frame, (name, degrees) in enumerate(shown):
        angles[frame, body.column(name)] = np.radians(degrees)
        if name == "right_shoulder.rotation":  # a bent elbow shows it
            angles[frame, body.column("right_elbow.flexion")] = np.radians(90)
    return posing.motion(body, angles)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
