"""From a motion as its file has it to metres and Y up."""

from __future__ import annotations

import numpy as np

from gmr.body.measures import UP_TURNS, turned_upright
from gmr.motion import Motion
from gmr.quaternions import multiply
from gmr.units import UNITS

__all__ = ["in_metres_upright", "unit_text"]


def unit_text(unit: float) -> str:
    """A unit in words: ``"1 unit = 0.01 m (cm)"``."""
    name = next((name for name, metres in UNITS.items() if np.isclose(metres, unit, rtol=1e-6)), None)
    known = {"cmu": "CMU's 0.45 inch scale", "in": "inch", "ft": "foot"}
    return f"1 unit = {unit:.6g} m" + (f" ({known.get(name, name)})" if name else "")


def in_metres_upright(motion: Motion, unit: float, up: str) -> Motion:
    """The motion in metres with +Y up, for a file of ``unit`` metres a unit and the axis ``up`` above."""
    metres = motion.with_unit(unit).to_unit("m")
    return metres if up == "+Y" else _turned(metres, up)


def _turned(motion: Motion, up: str) -> Motion:
    """The motion with its world turned so that the axis ``up`` becomes +Y."""
    skeleton = motion.skeleton
    topology = skeleton.topology
    turning = np.unique(skeleton.slots[skeleton.slots >= 0])
    under_world = turning[np.asarray(topology.slot_parents)[turning] < 0]
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[:, under_world] = multiply(np.array(UP_TURNS[up]), rotations[:, under_world])
    roots = np.isin(motion.translated, skeleton.roots)
    translations[:, roots] = turned_upright(translations[:, roots], up)
    return Motion.from_pose(
        skeleton,
        rotations,
        translations,
        motion.frame_time,
        translated=motion.translated,
        unit=motion.unit,
        name=motion.name,
    )
