"""From a motion as its file has it to metres and Y up."""

from __future__ import annotations

import numpy as np

from gmr.errors import DatasetError
from gmr.matching.body import UP_TURNS, turned_upright
from gmr.motion import Motion
from gmr.quaternions import multiply
from gmr.units import UNITS

__all__ = ["guessed_unit", "in_metres_upright", "unit_text"]

_STATURE_PER_LEG = 1 / 0.491
"""Stature over the length of thigh and shin. Source: Winter, "Biomechanics and Motor Control of Human
Movement", segment lengths after Drillis and Contini: 0.245 and 0.246 of the stature."""

_GUESSED = ("m", "cm", "mm", "in", "ft", "cmu")
_USUAL_STATURE = 1.7
_PLAUSIBLE_STATURES = (1.0, 2.4)


def guessed_unit(leg: float) -> tuple[float, float]:
    """Metres per file unit for a body whose legs are ``leg`` file units long, and the stature that this
    gives.

    Raises:
        DatasetError: no known unit makes it a human's leg.
    """
    stature = leg * _STATURE_PER_LEG
    units = [UNITS[name] for name in _GUESSED]
    unit = min(units, key=lambda unit: abs(np.log(max(stature, 1e-300) * unit / _USUAL_STATURE)))
    least, most = _PLAUSIBLE_STATURES
    if not least <= stature * unit <= most:
        raise DatasetError(
            f"a leg of {leg:.4g} file units is a human's in none of {', '.join(_GUESSED)}; "
            "say how many metres a file unit is: unit=..."
        )
    return unit, stature * unit


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
