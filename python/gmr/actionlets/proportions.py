"""How long and how heavy the segments of a body are: published shares of its stature and of its mass.

Sources: ``gmr/data/body/proportions.toml``, which cites each figure.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.dofs import SIDES, body_data
from gmr.errors import ActionletError
from gmr.skeleton import End, Skeleton

__all__ = [
    "Foot",
    "Lengths",
    "Segment",
    "Sizes",
    "lengths_of",
    "segments_of",
    "sizes",
    "skeleton_of",
    "stature_of",
]

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]

_DEFAULT = 1.75
_SEXES = ("male", "female", "average")
_TREE = (
    ("pelvis", ""),
    ("waist", "pelvis"),
    ("neck", "waist"),
    ("neck_end", "neck"),
    *(
        (f"{side}_{joint}", f"{side}_{above}" if sided else above)
        for side in SIDES
        for joint, above, sided in (
            ("shoulder", "waist", False),
            ("elbow", "shoulder", True),
            ("wrist", "elbow", True),
            ("wrist_end", "wrist", True),
        )
    ),
    *(
        (f"{side}_{joint}", f"{side}_{above}" if sided else above)
        for side in SIDES
        for joint, above, sided in (
            ("hip", "pelvis", False),
            ("knee", "hip", True),
            ("ankle", "knee", True),
            ("ankle_end", "ankle", True),
        )
    ),
)
"""Each joint and its parent, depth first."""


@dataclass(frozen=True, slots=True)
class Foot:
    """Where a foot meets the ground, in the frame of its ankle: at rest X is the left, Y up, Z forward.

    Args:
        ankle_height: of the ankle above the sole, metres.
        heel: the back end of the sole.
        ball: the sole below the joints of the toes, about which the heel rises.
        toe: the tip of the toes.
    """

    ankle_height: float
    heel: Vector
    ball: Vector
    toe: Vector


@dataclass(frozen=True, slots=True)
class Segment:
    """What a joint turns, without what hangs below the next joint.

    Args:
        joint: that turns it, ``"left_hip"`` for the left thigh.
        mass: share of the body's mass; all together are 1.
        centre: (3,) centre of mass in the frame of the joint, metres.
    """

    joint: str
    mass: float
    centre: Vector


@dataclass(frozen=True, slots=True)
class Lengths:
    """The lengths of a body, metres, left and right alike.

    Args:
        hip: of a hip joint from the midline.
        pelvis: from pelvis to waist.
        trunk: from waist to the base of the neck.
        head: from there to the top of the head.
        shoulder: of a shoulder joint from the midline.
        shoulder_drop: of the shoulder joints below the base of the neck.
    """

    hip: float
    pelvis: float
    trunk: float
    head: float
    shoulder: float
    shoulder_drop: float
    upper_arm: float
    forearm: float
    hand: float
    thigh: float
    shank: float
    ankle_height: float
    heel: float
    ball: float
    toe: float

    @property
    def foot(self) -> Foot:
        """The foot that these lengths make."""
        down = -self.ankle_height
        return Foot(self.ankle_height, (0.0, down, -self.heel), (0.0, down, self.ball), (0.0, down, self.toe))


@dataclass(frozen=True, slots=True)
class Sizes:
    """A body in numbers."""

    height: float
    percentile: float
    lengths: Lengths
    skeleton: Skeleton
    foot: Foot
    segments: tuple[Segment, ...]


def sizes(height: float | None, sex: str, percentile: float | None) -> Sizes:
    """The sizes of a body of a stature, or of a percentile of it; see :meth:`gmr.actionlets.Body.of`."""
    stature = stature_of(sex)
    if percentile is not None:
        if height is not None:
            raise ActionletError(
                f"height={height} and percentile={percentile}: give one of them, for the other follows"
            )
        if not 0 < percentile < 100:
            raise ActionletError(f"percentile={percentile}: give more than 0 and less than 100")
        height = stature.inv_cdf(percentile / 100)
    height = _DEFAULT if height is None else float(height)
    found = lengths_of(height, sex)
    return Sizes(
        height,
        100 * stature.cdf(height),
        found,
        skeleton_of(found),
        found.foot,
        segments_of(found, sex),
    )


def lengths_of(height: float, sex: str) -> Lengths:
    """The lengths of a body of a stature in metres.

    Raises:
        ActionletError: it is no adult's stature.
    """
    low, high = body_data("proportions.toml")["limits"]["height"]
    if not (math.isfinite(height) and low <= height <= high):
        raise ActionletError(
            f"height={height:g} m: the proportions are those of adults; give {low} to {high} metres, or take "
            "a measured skeleton, Body.like(motion)"
        )
    return _lengths(height, sex)


def stature_of(sex: str) -> NormalDist:
    """Distribution of the stature, metres.

    Raises:
        ActionletError: an unknown sex.
    """
    if sex not in _SEXES:
        raise ActionletError(f"sex={sex!r}: give one of {', '.join(_SEXES)}")
    mean, spread = _mixed(sex, lambda entry: np.array(entry["stature"]))
    return NormalDist(float(mean), float(spread))


def _lengths(height: float, sex: str) -> Lengths:
    data = body_data("proportions.toml")
    at, long, delp = data["heights"], data["lengths"], data["delp"]
    biacromial = float(_mixed(sex, lambda entry: np.array(entry["biacromial"] / entry["stature"][0])))
    head = float(_mixed(sex, lambda entry: np.array(entry["head"])))
    trunk = 1 - head - at["hip"]
    pelvis = trunk * float(_mixed(sex, lambda entry: np.array(entry["pelvis"])))
    heel, ball, hip = (delp[key] / delp["height"] for key in ("heel", "ball", "hip"))
    shares = Lengths(
        hip=hip,
        pelvis=pelvis,
        trunk=trunk - pelvis,
        head=head,
        shoulder=biacromial / 2,
        shoulder_drop=1 - head - at["shoulder"],
        upper_arm=long["upper_arm"],
        forearm=long["forearm"],
        hand=long["hand"],
        thigh=at["hip"] - at["knee"],
        shank=at["knee"] - at["ankle"],
        ankle_height=at["ankle"],
        heel=heel,
        ball=ball,
        toe=long["foot"] - heel,
    )
    return Lengths(*(height * getattr(shares, name) for name in Lengths.__slots__))


def skeleton_of(lengths: Lengths) -> Skeleton:
    """The skeleton of a body, in the anatomical standing posture: arms down, feet forward."""
    offsets: list[Vector] = []
    for name, _ in _TREE:
        side, _, part = name.partition("_")
        aside = {"left": 1.0, "right": -1.0}.get(side, 0.0)
        offsets.append(_offset(name if not aside else part, aside, lengths))
    names = [name for name, _ in _TREE]
    parents = [names.index(above) if above else -1 for _, above in _TREE]
    ends = [int(End.SITE) if name.endswith("_end") else int(End.JOINT) for name in names]
    return Skeleton.post_rotation(names, parents, offsets, ends=ends)


def _offset(part: str, aside: float, lengths: Lengths) -> Vector:
    """Vector from the joint above to a joint at rest."""
    return {
        "pelvis": (0.0, 0.0, 0.0),
        "waist": (0.0, lengths.pelvis, 0.0),
        "neck": (0.0, lengths.trunk, 0.0),
        "neck_end": (0.0, lengths.head, 0.0),
        "shoulder": (aside * lengths.shoulder, lengths.trunk - lengths.shoulder_drop, 0.0),
        "elbow": (0.0, -lengths.upper_arm, 0.0),
        "wrist": (0.0, -lengths.forearm, 0.0),
        "wrist_end": (0.0, -lengths.hand, 0.0),
        "hip": (aside * lengths.hip, 0.0, 0.0),
        "knee": (0.0, -lengths.thigh, 0.0),
        "ankle": (0.0, -lengths.shank, 0.0),
        "ankle_end": (0.0, -lengths.ankle_height, lengths.toe),
    }[part]


def segments_of(lengths: Lengths, sex: str) -> tuple[Segment, ...]:
    """Masses and centres of mass; that of a foot is half way between the heights of ankle and sole."""
    ways: Mapping[str, tuple[float, float, float]] = {
        "pelvis": (0.0, lengths.pelvis, 0.0),
        "waist": (0.0, lengths.trunk, 0.0),
        "neck": (0.0, lengths.head, 0.0),
        "shoulder": (0.0, -lengths.upper_arm, 0.0),
        "elbow": (0.0, -lengths.forearm, 0.0),
        "wrist": (0.0, -lengths.hand, 0.0),
        "hip": (0.0, -lengths.thigh, 0.0),
        "knee": (0.0, -lengths.shank, 0.0),
    }
    found = []
    for part in (*ways, "ankle"):
        mass, share = _mixed(sex, lambda entry, part=part: np.array(entry["segments"][part]))
        if part == "ankle":
            length = lengths.heel + lengths.toe
            centre = (0.0, -lengths.ankle_height / 2, float(share) * length - lengths.heel)
        else:
            x, y, z = ways[part]
            centre = (float(share) * x, float(share) * y, float(share) * z)
        sided = (part,) if part in ("pelvis", "waist", "neck") else tuple(f"{side}_{part}" for side in SIDES)
        found += [Segment(joint, float(mass), centre) for joint in sided]
    total = sum(segment.mass for segment in found)
    return tuple(Segment(one.joint, one.mass / total, one.centre) for one in found)


def _mixed(sex: str, value: Any) -> Floats:
    """A figure of the men, of the women, or the mean of both."""
    data = body_data("proportions.toml")
    kinds = ("male", "female") if sex == "average" else (sex,)
    return np.asarray(np.mean([value(data[kind]) for kind in kinds], axis=0), np.float64)
