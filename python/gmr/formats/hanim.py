"""The joints of a humanoid as H-Anim names, nests and places them.

Source: ISO/IEC 19774-1:2019 "Humanoid animation (H-Anim) architecture", 4.9.6 (hierarchies and segments of
the levels of articulation) and Annex A (centres of joints in the default pose: standing, facing +Z, arms at
the sides, metres, the origin on the ground between the feet).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

__all__ = ["FINGERS", "LIMBS", "LOA_1", "NECK", "SPINE", "Articulation", "articulations"]

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Articulation:
    """A joint of H-Anim.

    Args:
        name: as ``l_hip``.
        parent: the name of the joint above it; "" for the root.
        segment: what H-Anim calls the part of the body that it turns.
        centre: metres, in the default pose of H-Anim's own body; None where gmr needs none.
    """

    name: str
    parent: str
    segment: str
    centre: Vector | None = None


_HEIGHTS: Mapping[str, Vector] = {
    "vl5": (0.0028, 1.0568, -0.0776), "vl4": (0.0035, 1.0925, -0.0787), "vl3": (0.0041, 1.1276, -0.0796),
    "vl2": (0.0045, 1.1546, -0.0800), "vl1": (0.0048, 1.1912, -0.0805), "vt12": (0.0051, 1.2278, -0.0808),
    "vt11": (0.0053, 1.2679, -0.0810), "vt10": (0.0056, 1.2848, -0.0822), "vt9": (0.0057, 1.3126, -0.0838),
    "vt8": (0.0057, 1.3382, -0.0845), "vt7": (0.0058, 1.3625, -0.0833), "vt6": (0.0059, 1.3866, -0.0800),
    "vt5": (0.0060, 1.4102, -0.0745), "vt4": (0.0061, 1.4320, -0.0675), "vt3": (0.0062, 1.4583, -0.0570),
    "vt2": (0.0063, 1.4761, -0.0484), "vt1": (0.0065, 1.4951, -0.0387), "vc7": (0.0066, 1.5132, -0.0301),
    "vc6": (0.0066, 1.5357, -0.0143), "vc5": (0.0066, 1.5520, -0.0082), "vc4": (0.0066, 1.5662, -0.0084),
    "vc3": (0.0066, 1.5800, -0.0103), "vc2": (0.0066, 1.5928, -0.0103), "vc1": (0.0066, 1.6144, -0.0034),
}  # fmt: skip
"""Vertebrae from below upwards."""

SPINE = tuple(name for name in _HEIGHTS if not name.startswith("vc"))
"""Joints of the back, from below upwards."""
NECK = tuple(name for name in _HEIGHTS if name.startswith("vc"))
"""Joints of the neck, from below upwards."""

_SIDED = (
    Articulation("hip", "sacroiliac", "thigh", (0.0961, 0.9124, -0.0001)),
    Articulation("knee", "hip", "calf", (0.1040, 0.4867, 0.0308)),
    Articulation("talocrural", "knee", "talus", (0.1101, 0.0656, -0.0736)),
    Articulation(
        "metatarsophalangeal_2", "talocrural", "tarsal_proximal_phalanx_2", (0.1086, 0.0001, 0.0368)
    ),
    Articulation("sternoclavicular", "vt1", "clavicle", (0.0820, 1.4488, -0.0353)),
    Articulation("shoulder", "sternoclavicular", "upperarm", (0.2029, 1.4376, -0.0387)),
    Articulation("elbow", "shoulder", "forearm", (0.2014, 1.1357, -0.0682)),
    Articulation("radiocarpal", "elbow", "carpal", (0.1984, 0.8663, -0.0583)),
)
"""Of the left side, without its letter; those of the right side are mirrored."""

LIMBS: Mapping[str, str] = {
    "up_leg": "hip",
    "leg": "knee",
    "foot": "talocrural",
    "toe": "metatarsophalangeal_2",
    "clavicle": "sternoclavicular",
    "arm": "shoulder",
    "forearm": "elbow",
    "hand": "radiocarpal",
}
"""Joint of each part of a side (:mod:`gmr.skinning.driving.parts`), without the letter of the side."""

_THUMB = (
    ("carpometacarpal_1", "metacarpal_1"),
    ("metacarpophalangeal_1", "carpal_proximal_phalanx_1"),
    ("carpal_interphalangeal_1", "carpal_distal_phalanx_1"),
)


def _finger(number: int) -> tuple[tuple[str, str], ...]:
    return (
        (f"metacarpophalangeal_{number}", f"carpal_proximal_phalanx_{number}"),
        (f"carpal_proximal_interphalangeal_{number}", f"carpal_middle_phalanx_{number}"),
        (f"carpal_distal_interphalangeal_{number}", f"carpal_distal_phalanx_{number}"),
    )


_FINGERS = {
    "thumb": _THUMB,
    "index": _finger(2),
    "middle": _finger(3),
    "ring": _finger(4),
    "pinky": _finger(5),
}

FINGERS: Mapping[str, tuple[str, ...]] = {
    part: tuple(name for name, _ in chain) for part, chain in _FINGERS.items()
}
"""Joints of each finger, from the hand outwards, without the letter of the side."""

LOA_1 = frozenset(
    ["humanoid_root", "sacroiliac", "vl5", "skullbase"]
    + [f"{letter}_{joint.name}" for letter in "lr" for joint in _SIDED if joint.name != "sternoclavicular"]
)
"""The joints that every humanoid of the first level of articulation has."""


@cache
def articulations() -> Mapping[str, Articulation]:
    """All joints that gmr knows of H-Anim, by name, none before its parent."""
    return {joint.name: joint for joint in _all()}


def _all() -> Iterator[Articulation]:
    yield Articulation("humanoid_root", "", "sacrum", (0.0, 0.8240, 0.0277))
    yield Articulation("sacroiliac", "humanoid_root", "pelvis", (0.0, 0.9149, 0.0016))
    above = "humanoid_root"
    for name, centre in _HEIGHTS.items():
        yield Articulation(name, above, name[1:], centre)
        above = name
    yield Articulation("skullbase", above, "skull", (0.0044, 1.6209, 0.0236))
    for letter, side in (("l", 1.0), ("r", -1.0)):
        for joint in _SIDED:
            assert joint.centre is not None
            x, y, z = joint.centre
            above = joint.parent if joint.parent in ("sacroiliac", "vt1") else f"{letter}_{joint.parent}"
            yield Articulation(f"{letter}_{joint.name}", above, f"{letter}_{joint.segment}", (side * x, y, z))
        for chain in _FINGERS.values():
            above = f"{letter}_radiocarpal"
            for name, segment in chain:
                yield Articulation(f"{letter}_{name}", above, f"{letter}_{segment}")
                above = f"{letter}_{name}"
