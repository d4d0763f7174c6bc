"""Motions by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from gmr.errors import DatasetError
from gmr.motion import Motion

__all__ = ["MIRRORED", "image_of", "named", "recording_of"]

MIRRORED: Final = " (mirrored)"
"""What the name of a mirrored copy ends with."""


def image_of(name: str) -> str:
    """What the mirrored copy of a clip is called."""
    return name + MIRRORED


def recording_of(clip: str) -> str:
    """The name of the recording behind a clip: that of a mirrored copy without its mark."""
    return clip.removesuffix(MIRRORED)


def named(motions: Iterable[Motion] | Mapping[str, Motion]) -> dict[str, Motion]:
    """Motions by name; those without one are called "motion 1", ..., and a name that repeats gets a
    number."""
    if isinstance(motions, Mapping):
        return {name: _a_motion(name, motion) for name, motion in motions.items()}
    if isinstance(motions, Motion):
        raise DatasetError("a database is built of several motions: put this one into a list, [motion]")
    found: dict[str, Motion] = {}
    for number, motion in enumerate(motions, start=1):
        name = base = getattr(motion, "name", None) or f"motion {number}"
        again = 1
        while name in found:
            again += 1
            name = f"{base} ({again})"
        found[name] = _a_motion(name, motion)
    return found


def _a_motion(name: str, given: object) -> Motion:
    if not isinstance(given, Motion):
        raise TypeError(f"{name}: a motion is needed here, not {given!r:.60}; read files with gmr.read")
    return given
