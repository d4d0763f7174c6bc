"""The lengths of a measured skeleton.

Legs, arms, the widths of hips and shoulders and the length of the trunk are measured, in the middle of the
frames and of both sides; where the joints of the spine, the neck and the foot are differs from one way of
capturing to the next, so these keep the published proportions to the stature that the legs tell.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.anatomy import Anatomy, anatomy
from gmr.actionlets.dofs import SIDES, body_data
from gmr.actionlets.proportions import Lengths, lengths_of
from gmr.motion import Motion
from gmr.skeleton import Skeleton

__all__ = ["leg_of", "lengths_like"]

Floats = NDArray[np.float64]

_NARROWEST = 0.3
"""Share of the published width below which two joints do not lie on either side of a body."""


def lengths_like(measured: Motion | Skeleton, sex: str) -> tuple[float, Lengths]:
    """Stature and lengths of a measured body; see :meth:`gmr.actionlets.Body.like`."""
    body = anatomy(_resting(measured) if isinstance(measured, Skeleton) else measured)
    at = body_data("proportions.toml")["heights"]
    thigh, shank = _length(body, "hip", "knee"), _length(body, "knee", "ankle")
    assert thigh is not None
    assert shank is not None
    height = (thigh + shank) / (at["hip"] - at["ankle"])
    plain = lengths_of(height, sex)
    hips = (body.place("left_hip") + body.place("right_hip")) / 2
    found = {
        "thigh": thigh,
        "shank": shank,
        "upper_arm": _length(body, "shoulder", "elbow"),
        "forearm": _length(body, "elbow", "wrist"),
        "hip": _half(body, "hip", plain.hip),
        "shoulder": _half(body, "shoulder", plain.shoulder),
    }
    lengths = replace(plain, **{name: value for name, value in found.items() if value is not None})
    if "left_shoulder" in body.joints and "right_shoulder" in body.joints:
        shoulders = (body.place("left_shoulder") + body.place("right_shoulder")) / 2
        ratio = _middle(shoulders - hips) / (plain.pelvis + plain.trunk - plain.shoulder_drop)
        trunk = ratio * (plain.trunk - plain.shoulder_drop) + plain.shoulder_drop
        lengths = replace(lengths, pelvis=ratio * plain.pelvis, trunk=trunk)
    return height, lengths


def leg_of(body: Anatomy) -> float:
    """Length of a leg from hip to ankle, metres."""
    return sum(_length(body, *ends) or 0.0 for ends in (("hip", "knee"), ("knee", "ankle")))


def _resting(skeleton: Skeleton) -> Motion:
    """One frame of a skeleton in metres, in which nothing is turned."""
    still = np.zeros((1, skeleton.slot_count, 4))
    still[..., 3] = 1
    return Motion.from_pose(skeleton, still, skeleton.offsets[list(skeleton.roots)][None], 1.0, unit=1.0)


def _length(body: Anatomy, one: str, other: str) -> float | None:
    """Between two joints of the limbs, the mean of both sides; None where one is not known."""
    ends = [(f"{side}_{one}", f"{side}_{other}") for side in SIDES]
    known = [_middle(body.place(b) - body.place(a)) for a, b in ends if {a, b} <= body.joints.keys()]
    return float(np.mean(known)) if known else None


def _half(body: Anatomy, joint: str, published: float) -> float | None:
    """Half the width between two joints; None where they are not known, or are where collar bones meet."""
    if not {f"{side}_{joint}" for side in SIDES} <= body.joints.keys():
        return None
    half = _middle(body.place(f"left_{joint}") - body.place(f"right_{joint}")) / 2
    return half if half >= _NARROWEST * published else None


def _middle(ways: Floats) -> float:
    return float(np.median(np.linalg.norm(ways, axis=-1)))
