"""A walk of CMU's on a skeleton of fifteen parts, wearing the IOR set: markers whose truth is known."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr.demo import demo_folder
from gmr.markers import Markers, wear
from gmr.quaternions import conjugate, multiply
from gmr.skeleton import End, Skeleton
from gmr.tpose import without_leading_tpose
from gmr.units import UNITS

Array = NDArray[np.float64]

PARTS: dict[str, tuple[str, str | None, tuple[str, ...]]] = {
    "Hips": ("Hips", None, ()),
    "Spine": ("Spine", "Hips", ()),
    "Head": ("Head", "Spine", ("Spine", "Spine1", "Neck1")),
    "LeftArm": ("LeftArm", "Spine", ("Spine", "Spine1", "LeftArm")),
    "LeftForeArm": ("LeftForeArm", "LeftArm", ("LeftForeArm",)),
    "LeftHand": ("LeftHand", "LeftForeArm", ("LeftHand",)),
    "RightArm": ("RightArm", "Spine", ("Spine", "Spine1", "RightArm")),
    "RightForeArm": ("RightForeArm", "RightArm", ("RightForeArm",)),
    "RightHand": ("RightHand", "RightForeArm", ("RightHand",)),
    "LeftUpLeg": ("LeftUpLeg", "Hips", ("LeftUpLeg",)),
    "LeftLeg": ("LeftLeg", "LeftUpLeg", ("LeftLeg",)),
    "LeftFoot": ("LeftFoot", "LeftLeg", ("LeftFoot",)),
    "RightUpLeg": ("RightUpLeg", "Hips", ("RightUpLeg",)),
    "RightLeg": ("RightLeg", "RightUpLeg", ("RightLeg",)),
    "RightFoot": ("RightFoot", "RightLeg", ("RightFoot",)),
}
"""Joint -> the joint of CMU's that turns it, its parent, and the bones of CMU's whose sum is its offset."""


@lru_cache(maxsize=4)
def walk(clip: str = "07_01") -> gmr.Motion:
    """A walk in metres in which every two parts share a true joint centre."""
    recorded = without_leading_tpose(gmr.read(demo_folder() / f"{clip}.bvh"))
    recorded = recorded.with_unit(UNITS["cmu"]).to_unit("m")
    skeleton = recorded.skeleton
    names = list(PARTS)
    world = recorded.joint_rotations(dtype=np.float64)
    turns = [world[:, skeleton.index(turning)] for turning, _, _ in PARTS.values()]
    parents = [names.index(parent) if parent else -1 for _, parent, _ in PARTS.values()]
    offsets = [
        sum((skeleton.offsets[skeleton.index(bone)] for bone in bones), np.zeros(3))
        for _, _, bones in PARTS.values()
    ]
    local = [
        turns[k] if parent < 0 else multiply(conjugate(turns[parent]), turns[k])
        for k, parent in enumerate(parents)
    ]
    hips = recorded.positions(dtype=np.float64, joints=["Hips"])
    leaves = [joint for joint in range(len(names)) if joint not in parents]
    made = Skeleton.post_rotation(
        [*names, *(f"{names[leaf]}_end" for leaf in leaves)],
        [*parents, *leaves],
        [*offsets, *(np.array([0.0, 0.1, 0.0]) for _ in leaves)],
        ends=[End.JOINT] * len(names) + [End.SITE] * len(leaves),
    )
    return gmr.Motion.from_pose(made, np.stack(local, axis=1), hips, recorded.frame_time, unit=1.0, name=clip)


def hanging_axes(toward: Array) -> Array:
    """Columns left, up, forward of a limb in its joint's frame, which hangs along ``toward``."""
    up = -toward / np.linalg.norm(toward)
    forward = np.array([0.0, 0.0, 1.0])
    forward = forward - (forward @ up) * up
    forward /= np.linalg.norm(forward)
    return np.stack([np.cross(up, forward), up, forward], axis=1)


LIMB_MARKERS: dict[str, dict[str, tuple[float, float, float]]] = {
    "UpLeg": {"FTC": (0.09, -0.02, 0.0), "WAND1": (0.12, -0.2, 0.03)},
    "Leg": {"FAX": (0.05, -0.04, -0.03), "TTC": (0.0, -0.06, 0.05), "WAND2": (0.11, -0.2, 0.0)},
    "Arm": {"WAND3": (0.09, -0.15, 0.02)},
    "ForeArm": {"WAND4": (0.08, -0.12, 0.02)},
    "Hand": {"HM2": (0.035, -0.08, 0.0), "HM5": (-0.035, -0.075, 0.005)},
    "Foot": {
        "FCC": (0.0, -0.06, -0.07), "FM1": (-0.03, -0.05, 0.13),
        "FM2": (0.01, -0.045, 0.14), "FM5": (0.05, -0.06, 0.11),
    },
}  # fmt: skip
"""Markers of the left limbs, in metres left, up and forward of the joint; the right ones are mirrored."""

ENDS = {
    "UpLeg": ("Leg", 0.05, "FLE", "FME"),
    "Leg": ("Foot", 0.035, "FAL", "TAM"),
    "Arm": ("ForeArm", 0.04, "HLE", "HME"),
    "ForeArm": ("Hand", 0.03, "RSP", "UHE"),
}
"""Part -> the joint at its lower end, and the markers outside and inside of it, so many metres away."""


def places() -> dict[str, tuple[str, Array]]:
    """Label -> joint and place: the IOR set on the skeleton of :func:`walk`."""
    skeleton = walk().skeleton
    found: dict[str, tuple[str, Array]] = {
        "SNJ": ("Spine", np.array([0.0, 0.30, 0.06])), "SXS": ("Spine", np.array([0.0, 0.16, 0.1])),
        "CV7": ("Spine", np.array([0.0, 0.37, -0.07])), "TV8": ("Spine", np.array([0.0, 0.19, -0.11])),
    }  # fmt: skip
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        letter, mirror = side[0], np.array([sign, 1.0, 1.0])
        found[f"{letter}_IAS"] = "Hips", mirror * [0.12, -0.02, 0.11]
        found[f"{letter}_IPS"] = "Hips", mirror * [0.05, 0.0, -0.08]
        found[f"{letter}_SAJ"] = "Spine", mirror * [0.18, 0.36, 0.0]
        found[f"{letter}_HDF"] = "Head", mirror * [0.07, 0.19, 0.09]
        found[f"{letter}_HDB"] = "Head", mirror * [0.065, 0.18, -0.09]
        for limb, markers in LIMB_MARKERS.items():
            joint = f"{side}{limb}"
            lower = skeleton.index(f"{side}{ENDS[limb][0]}") if limb in ENDS else None
            toward = np.array([0.0, -1.0, 0.0]) if lower is None else skeleton.offsets[lower]
            if limb == "Hand":
                toward = np.array([sign, 0.0, 0.0])
            axes = hanging_axes(toward)
            for label, place in markers.items():
                found[f"{letter}_{label}"] = joint, axes @ (mirror * place)
            if lower is not None:
                _, half, outside, inside = ENDS[limb]
                for label, way in ((outside, sign), (inside, -sign)):
                    found[f"{letter}_{label}"] = joint, skeleton.offsets[lower] + way * half * axes[:, 0]
    return found


@lru_cache(maxsize=4)
def worn(clip: str = "07_01") -> Markers:
    """The walk's markers, without any fault."""
    return wear(walk(clip), {label: (joint, tuple(place)) for label, (joint, place) in places().items()})


def noisy(markers: Markers, millimetres: float, seed: int = 0) -> Markers:
    """The recording with normal noise of so many millimetres on each coordinate."""
    noise = np.random.default_rng(seed).normal(scale=millimetres / 1000, size=markers.positions.shape)
    return replace(markers, positions=markers.positions + noise)


def hidden(markers: Markers, label: str, first: int, length: int) -> Markers:
    """The recording with a gap."""
    positions = markers.positions.copy()
    positions[first : first + length, markers.index(label)] = np.nan
    return replace(markers, positions=positions)


def exchanged(markers: Markers, one: str, other: str, first: int, length: int) -> Markers:
    """The recording with two labels exchanged in some frames."""
    positions = markers.positions.copy()
    pair = [markers.index(one), markers.index(other)]
    positions[first : first + length, pair] = positions[first : first + length, pair[::-1]]
    return replace(markers, positions=positions)
