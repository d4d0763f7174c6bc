"""A made-up walker as BVH text: it keeps one speed and one turn rate, and swings its legs accordingly."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from locomotion import Arc

HIERARCHY = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation
LEGS
  JOINT Spine
  {
    OFFSET 0 25 0
    CHANNELS 3 Zrotation Xrotation Yrotation
ARMS
    JOINT Head
    {
      OFFSET 0 30 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      End Site
      {
        OFFSET 0 20 0
      }
    }
  }
}
"""


def _chain(names: list[tuple[str, str]], tip: str) -> str:
    """Joints hanging on each other, each a name and an offset, and the End Site of the last."""
    text = f"End Site\n{{\nOFFSET {tip}\n}}\n"
    for name, offset in reversed(names):
        text = f"JOINT {name}\n{{\nOFFSET {offset}\nCHANNELS 3 Zrotation Xrotation Yrotation\n{text}}}\n"
    return text


def _hierarchy() -> str:
    legs = "".join(
        _chain(
            [(f"{side}UpLeg", f"{x} -5 0"), (f"{side}Leg", "0 -42 0"), (f"{side}Foot", "0 -42 0")], "0 -4 14"
        )
        for side, x in (("Left", 9), ("Right", -9))
    )
    arms = "".join(
        _chain([(f"{side}Arm", f"{x} 20 0"), (f"{side}ForeArm", f"{x} 0 0")], f"{x} 0 0")
        for side, x in (("Left", 18), ("Right", -18))
    )
    return HIERARCHY.replace("LEGS", legs).replace("ARMS", arms)


def walker_bvh(arc: Arc, rate: float = 30.0) -> str:
    """The text of a file in centimetres."""
    t = np.arange(round(arc.seconds * rate) + 1) / rate
    turn = np.radians(arc.turn_rate_deg)
    heading, middle = turn * t, turn * t / 2
    way = arc.speed * t * np.sinc(middle / np.pi) * 100 * (-1 if arc.backwards else 1)
    phase = 2 * np.pi * (0.7 + 0.3 * arc.speed) * t
    swing = np.minimum(12 + 12 * arc.speed, 40)
    rows = np.zeros((len(t), 42))
    rows[:, 0] = way * np.sin(middle)
    rows[:, 1] = 93 + 1.5 * np.cos(2 * phase)
    rows[:, 2] = way * np.cos(middle)
    rows[:, 3] = np.degrees(heading)
    for first, sign in ((6, 1), (15, -1)):
        rows[:, first + 1] = -sign * swing * np.sin(phase)
        rows[:, first + 4] = 5 + swing * (1 + sign * np.cos(phase)) / 2
    for first, sign in ((27, -1), (33, 1)):
        rows[:, first + 1] = -sign * swing * np.sin(phase)
    lines = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in rows)
    return f"{_hierarchy()}MOTION\nFrames: {len(t)}\nFrame Time: {1 / rate:.7f}\n{lines}\n"


def write_walkers(folder: Path, clips: Mapping[str, Arc]) -> None:
    """One file a clip."""
    for name, arc in clips.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(walker_bvh(arc))
