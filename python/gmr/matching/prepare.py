"""From a motion as its file has it to metres and Y up."""

from __future__ import annotations

import numpy as np

from gmr.body.measures import UP_TURNS, turned_from_upright, turned_upright
from gmr.channels import ChannelLayout
from gmr.motion import Motion
from gmr.quaternions import conjugate, multiply
from gmr.units import UNITS

__all__ = ["in_metres_upright", "turned", "unit_text"]


def unit_text(unit: float) -> str:
    """A unit in words: ``"1 unit = 0.01 m (cm)"``."""
    name = next((name for name, metres in UNITS.items() if np.isclose(metres, unit, rtol=1e-6)), None)
    known = {"cmu": "CMU's 0.45 inch scale", "in": "inch", "ft": "foot"}
    return f"1 unit = {unit:.6g} m" + (f" ({known.get(name, name)})" if name else "")


def in_metres_upright(motion: Motion, unit: float, up: str) -> Motion:
    """The motion in metres with +Y up, for a file of ``unit`` metres a unit and the axis ``up`` above."""
    metres = motion.with_unit(unit).to_unit("m")
    return metres if up == "+Y" else turned(metres, up)


def turned(motion: Motion, up: str, to: str = "+Y", *, layout: ChannelLayout | None = None) -> Motion:
    """The motion with its world turned so that what points along the axis ``up`` points along ``to``.

    Args:
        motion: at home.
        up, to: keys of :data:`gmr.body.measures.UP_TURNS`.
        layout: channels to write it with in a post-rotation file; the standard ones where left out.
    """
    skeleton = motion.skeleton
    topology = skeleton.topology
    turning = np.unique(skeleton.slots[skeleton.slots >= 0])
    under_world = turning[np.asarray(topology.slot_parents)[turning] < 0]
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    turn = multiply(conjugate(np.array(UP_TURNS[to])), np.array(UP_TURNS[up]))
    rotations[:, under_world] = multiply(turn, rotations[:, under_world])
    roots = np.isin(motion.translated, skeleton.roots)
    translations[:, roots] = turned_from_upright(turned_upright(translations[:, roots], up), to)
    return Motion.from_pose(
        skeleton,
        rotations,
        translations,
        motion.frame_time,
        translated=motion.translated,
        layout=layout,
        unit=motion.unit,
        name=motion.name,
    )
