"""Degrees of freedom of the body: what each is called, which way it turns, how far, and its paper's number.

World: X is the body's left, Y up, Z forward; all is zero in the anatomical standing posture with the arms at
the sides and the palms to the thighs. The turns of a joint follow each other in the order flexion, then
abduction (sideways), then rotation about the bone, each carried along by those before: ``R = R_f R_a R_r``.
In this order the flexion is about the axis of the proximal segment and the rotation about the bone itself,
with which the clinical angles of the knee are defined as well (Grood and Suntay, J. Biomech. Eng. 105 (1983)
136). The forearm turns before the hand does, so the wrist begins with its pronation.
Source: Zheng et al., "Human Motion Simulation and Action Corpus", for the numbers; the ranges are cited in
``gmr/data/body/dofs.toml``.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

__all__ = ["DETAILED", "PAPER", "SIDES", "Dof", "body_data"]

SIDES = ("left", "right")

Axis = tuple[float, float, float]

_AXES: Mapping[str, Axis] = {
    "+X": (1.0, 0.0, 0.0),
    "-X": (-1.0, 0.0, 0.0),
    "+Y": (0.0, 1.0, 0.0),
    "-Y": (0.0, -1.0, 0.0),
    "+Z": (0.0, 0.0, 1.0),
    "-Z": (0.0, 0.0, -1.0),
}
_MIDDLE = ("neck", "waist")


@dataclass(frozen=True, slots=True)
class Dof:
    """A degree of freedom.

    Args:
        name: ``"left_hip.flexion"``.
        joint: the joint that it turns, ``"left_hip"``; the pelvis for those of the root.
        motion: which of its movements, ``"flexion"``.
        axis: unit vector, in the frame of the joint after its turns before: the positive direction turns
            right-handed about it; for a translation of the root the direction itself.
        low: lowest value, radians (or metres).
        high: highest value.
        index: the paper's number of it, y0 to y21; None: the paper has it not.
        is_length: a translation, in metres.
        source: of the range.
    """

    name: str
    joint: str
    motion: str
    axis: Axis
    low: float
    high: float
    index: int | None = None
    is_length: bool = False
    source: str = ""

    @property
    def low_deg(self) -> float:
        """Lowest value in degrees (metres for a translation)."""
        return self.low if self.is_length else math.degrees(self.low)

    @property
    def high_deg(self) -> float:
        """Highest value in degrees (metres for a translation)."""
        return self.high if self.is_length else math.degrees(self.high)


@cache
def body_data(file: str) -> Mapping[str, Any]:
    """Content of a file of ``gmr/data/body``."""
    text = resources.files("gmr").joinpath("data", "body", file).read_text(encoding="utf-8")
    return tomllib.loads(text)


def _joint_dofs() -> Iterator[Dof]:
    for joint, motions in body_data("dofs.toml").items():
        if joint == "format":
            continue
        for motion, entry in motions.items():
            low, high = (math.radians(value) for value in entry["range"])
            numbers = entry.get("y")
            if joint in _MIDDLE:
                axis = _AXES[entry["axis"]]
                yield Dof(
                    f"{joint}.{motion}", joint, motion, axis, low, high, numbers, source=entry["source"]
                )
                continue
            for k, side in enumerate(SIDES):
                name, axis = f"{side}_{joint}", _AXES[entry["axis"][k]]
                index = None if numbers is None else numbers[k]
                yield Dof(f"{name}.{motion}", name, motion, axis, low, high, index, source=entry["source"])


def _root_dofs() -> Iterator[Dof]:
    for motion, axis in (("sway", "+X"), ("heave", "+Y"), ("surge", "+Z")):
        yield Dof(f"root.{motion}", "pelvis", motion, _AXES[axis], -math.inf, math.inf, is_length=True)
    for motion, axis in (("tilt", "+X"), ("obliquity", "+Z"), ("rotation", "+Y")):
        yield Dof(f"root.{motion}", "pelvis", motion, _AXES[axis], -math.inf, math.inf)


def _ordered() -> tuple[tuple[Dof, ...], tuple[Dof, ...]]:
    """Those of the paper by its numbers; the rest side by side, and the root."""
    found = tuple(_joint_dofs())
    paper = sorted((dof for dof in found if dof.index is not None), key=lambda dof: dof.index or 0)
    rest = sorted((dof for dof in found if dof.index is None), key=lambda dof: _limb(dof.joint))
    return tuple(paper), (*rest, *_root_dofs())


def _limb(joint: str) -> tuple[bool, bool]:
    return joint.endswith("ankle"), joint.startswith("right")


PAPER, _MORE = _ordered()
"""The 22 degrees of freedom of the paper, in the order of its numbers."""

DETAILED = (*PAPER, *_MORE)
"""All 40: the paper's, wrists, ankles and the root."""
