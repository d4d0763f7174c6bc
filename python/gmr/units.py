"""Units of length: what a file counts in, and what it is wanted in."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gmr.arrays import read_only
from gmr.dof_rows import DofRows
from gmr.errors import GmrError
from gmr.frames import Pose, Rows

if TYPE_CHECKING:
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton

__all__ = ["UNITS", "metres_per_unit", "to_unit"]

UNITS = {
    "m": 1.0,
    "dm": 0.1,
    "cm": 0.01,
    "mm": 0.001,
    "in": 0.0254,
    "ft": 0.3048,
    "cmu": 0.0254 / 0.45,
}
"""Metres per unit; "cmu" is what the CMU mocap database counts in (ASF length 0.45: inches / 0.45)."""

_SMALLEST, _LARGEST = 1e-9, 1e9
"""Metres per unit beyond which no body can be meant, and the numbers of a file might overflow."""


def metres_per_unit(unit: float | str) -> float:
    """Metres per unit of "m", "cm", "mm", "in", "ft", "dm" or "cmu", or of a number of metres.

    Raises:
        GmrError: the unit is none of these, or not from 1e-9 to 1e9.
    """
    if isinstance(unit, str):
        if unit.lower() in UNITS:
            return UNITS[unit.lower()]
        try:
            unit = float(unit)
        except ValueError:
            known = ", ".join(UNITS)
            raise GmrError(f"there is no unit '{unit}'; use one of {known}, or metres per unit") from None
    if not _SMALLEST <= unit <= _LARGEST:
        raise GmrError(f"a unit cannot be {unit:g} metres; give from {_SMALLEST:g} to {_LARGEST:g}")
    return float(unit)


def to_unit(motion: Motion, unit: float | str) -> Motion:
    """The same motion measured in another unit: offsets and translations are scaled, angles stay.

    Raises:
        GmrError: the motion does not say in what unit it is.
    """
    wanted = metres_per_unit(unit)
    if motion.unit is None:
        raise GmrError(
            f"{motion.name or 'this motion'} does not say in what unit it is, so it cannot be converted; "
            "declare it first: motion.with_unit('cm')"
        )
    if wanted == motion.unit:
        return motion
    return replace(_scaled(motion, motion.unit / wanted), unit=wanted)


def _scaled(motion: Motion, factor: float) -> Motion:
    """The motion with every length multiplied by ``factor``."""
    source = motion.source
    if isinstance(source, DofRows):
        frames = _scaled_dofs(source, factor)
        return replace(motion, skeleton=frames.acclaim.skeleton, source=frames)
    if isinstance(source, Rows):
        changed: Rows | Pose = _scaled_rows(source, factor)
    else:
        rows = _scaled_rows(source.rows, factor) if isinstance(source.rows, Rows) else None
        acclaim = None if source.acclaim is None else source.acclaim.scaled(factor)
        changed = replace(
            source, translations=read_only(source.translations * factor), rows=rows, acclaim=acclaim
        )
    dropped = motion.dropped
    if dropped is not None:
        dropped = dropped.on(
            lambda skeleton: _scaled_offsets(skeleton, factor), lambda rows: _scaled_rows(rows, factor)
        )
    return replace(motion, skeleton=_scaled_offsets(motion.skeleton, factor), source=changed, dropped=dropped)


def _scaled_dofs(rows: DofRows, factor: float) -> DofRows:
    lengths = np.where(rows.acclaim.turns, 1.0, factor)
    return replace(rows, values=read_only(rows.values * lengths), acclaim=rows.acclaim.scaled(factor))


def _scaled_rows(rows: Rows, factor: float) -> Rows:
    lengths = np.where(rows.layout.column_turns, 1.0, factor)
    return replace(rows, values=read_only(rows.values * lengths))


@lru_cache(maxsize=16)  # the files of a folder mostly share one skeleton
def _scaled_offsets(skeleton: Skeleton, factor: float) -> Skeleton:
    home = None if skeleton.home is None else _scaled_offsets(skeleton.home, factor)
    return replace(skeleton, offsets=read_only(skeleton.offsets * factor), home=home)
