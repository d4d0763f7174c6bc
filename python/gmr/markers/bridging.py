"""Short stretches without a pose bridged by slerp; long ones left, and named.

A stretch at the edge of the recording has nothing on its other side and is never bridged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gmr.markers.gaps import runs
from gmr.quaternions import multiply

__all__ = ["Stretch", "bridge_rotations", "bridge_vectors", "stretches"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Stretch:
    """Frames in which a part could not be fitted.

    Args:
        first: the first of them.
        length: how many.
        became: "bridged": interpolated from the frames around it; "unknown": NaN.
    """

    first: int
    length: int
    became: Literal["bridged", "unknown"]


def stretches(known: NDArray[np.bool_], longest: float) -> tuple[Stretch, ...]:
    """The runs of frames that are not known; those of at most ``longest`` frames are to be bridged."""
    frames = len(known)
    found = []
    for first, length in runs(~known):
        inside = first > 0 and first + length < frames
        found.append(Stretch(first, length, "bridged" if inside and length <= longest else "unknown"))
    return tuple(found)


def bridge_rotations(rotations: Array, over: tuple[Stretch, ...]) -> Array:
    """(F, 4) unit quaternions, NaN where not known, with those stretches slerped that are to be bridged.

    Successive quaternions are on one side, so that their numbers do not jump where the rotation does not.
    """
    found = rotations.copy()
    for stretch in over:
        if stretch.became != "bridged":
            continue
        before, after = found[stretch.first - 1], found[stretch.first + stretch.length]
        steps = np.arange(1, stretch.length + 1) / (stretch.length + 1)
        found[stretch.first : stretch.first + stretch.length] = _slerp(before, after, steps)
    return _continuous(found)


def bridge_vectors(vectors: Array, over: tuple[Stretch, ...]) -> Array:
    """(F, 3) vectors, with those stretches interpolated linearly that are to be bridged."""
    found = vectors.copy()
    for stretch in over:
        if stretch.became != "bridged":
            continue
        before, after = found[stretch.first - 1], found[stretch.first + stretch.length]
        steps = np.arange(1, stretch.length + 1)[:, None] / (stretch.length + 1)
        found[stretch.first : stretch.first + stretch.length] = before + steps * (after - before)
    return found


def _slerp(before: Array, after: Array, steps: Array) -> Array:
    """(n, 4) on the shorter way from one rotation to another."""
    turn = multiply(before * np.array([-1.0, -1.0, -1.0, 1.0]), after)
    turn = turn if turn[3] >= 0 else -turn
    sine = float(np.linalg.norm(turn[:3]))
    if sine < 1e-12:
        return np.repeat(before[None], len(steps), axis=0)
    angles = np.arctan2(sine, turn[3]) * steps
    parts = np.concatenate([np.sin(angles)[:, None] * turn[:3] / sine, np.cos(angles)[:, None]], axis=1)
    return multiply(before[None], parts)


def _continuous(rotations: Array) -> Array:
    """The same rotations, each quaternion on the side of the last one known."""
    known = np.flatnonzero(np.isfinite(rotations).all(axis=1))
    held = rotations[known]
    turned = (held[1:] * held[:-1]).sum(axis=1) < 0
    signs = np.concatenate([[1.0], np.where(np.cumsum(turned) % 2, -1.0, 1.0)])[: len(held)]
    found = rotations.copy()
    found[known] = held * signs[:, None]
    return found
