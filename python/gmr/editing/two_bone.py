"""Two bones that reach for a point: where the middle joint goes, in closed form.

The triangle of the two bones and the way to the target is found by the law of cosines; the limb is turned to
the target by the shortest turn and bent in the plane in which it was bent. All frames are solved at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.quaternions import IDENTITY, about, multiply, rotated

__all__ = ["TwoBone", "two_bone"]

Floats = NDArray[np.float64]

_STRAIGHT = 0.01
"""Sine of the bend below which the plane of a nearly straight limb is taken over by its hinge."""


@dataclass(frozen=True, eq=False, slots=True)
class TwoBone:
    """The solved limb."""

    upper: Floats
    """(..., 4) xyzw: turn of the upper bone in the world, after the rotation that it has."""
    lower: Floats
    """(..., 4) xyzw: turn of the lower bone in the world."""
    middle: Floats
    """(..., 3) the new middle joint."""
    end: Floats
    """(..., 3) the new end."""
    missed: Floats
    """(...,) distance from the new end to the target: 0 to rounding where it can be reached."""


def two_bone(top: Floats, middle: Floats, end: Floats, target: Floats, hinge: Floats) -> TwoBone:
    """Turns of two bones that bring the end of a limb to a target, or as near as their lengths allow.

    With ``l1`` and ``l2`` the lengths and ``d`` the distance from the top to the target, held between
    ``|l1 - l2|`` and ``l1 + l2``, the middle joint is ``x = (l1^2 - l2^2 + d^2) / 2d`` along the way to the
    target and ``h`` beside it, where ``h d / 2`` is the triangle's area by Heron's formula. Where the target
    is the end, nothing turns.

    Args:
        top: (..., 3) where the limb begins, any unit.
        middle: (..., 3) knee or elbow.
        end: (..., 3) ankle or wrist.
        target: (..., 3) where the end is wanted.
        hinge: (..., 3) direction in the world about which the limb bends: ``upper x lower`` points along it.
            Only a limb that is straight to a degree is bent about it; of length 0 where nothing is known.
    """
    upper, lower = middle - top, end - middle
    l1, l2 = _length(upper), _length(lower)
    wanted = _length(target - top)
    d = np.clip(wanted, np.abs(l1 - l2), l1 + l2)
    old = _unit(end - top, _unit(upper, np.array([0.0, 1.0, 0.0])))
    new = _unit(target - top, old)
    normal = _normal(upper, lower, old, hinge)
    turned = rotated(_shortest(old, new, normal), normal)

    # Heron's formula and the foot of the height as products: exact for a limb that is straight or folded.
    sum_, difference = l1 + l2, l1 - l2
    product = (sum_ + d) * (sum_ - d) * (d + difference) * (d - difference)
    safe = np.where(d > 0, d, 1.0)
    along = np.where(d > 0, difference / safe * sum_ / 2 + d / 2, 0.0)
    beside = np.where(d > 0, np.sqrt(np.maximum(product, 0)) / (2 * safe), l1)
    to_middle = along[..., None] * new + beside[..., None] * np.cross(new, turned)
    to_end = d[..., None] * new

    is_there = (target == end).all(axis=-1, keepdims=True)
    turn_upper = np.where(is_there, IDENTITY, _turn(upper, normal, to_middle, turned))
    turn_lower = np.where(is_there, IDENTITY, _turn(lower, normal, to_end - to_middle, turned))
    found = top + rotated(turn_upper, upper)
    reached = found + rotated(turn_lower, lower)
    return TwoBone(turn_upper, turn_lower, found, reached, _length(target - reached))


def _normal(upper: Floats, lower: Floats, way: Floats, hinge: Floats) -> Floats:
    """(..., 3) unit normal of the plane in which the limb is bent, at right angles to the way to its end."""
    sizes = _length(upper) * _length(lower)
    bend = np.cross(upper, lower) / np.where(sizes > 0, sizes, 1.0)[..., None]
    doubt = np.maximum(_STRAIGHT - _length(bend), 0)[..., None]
    mixed = bend + doubt * _unit(hinge, np.zeros(3))
    mixed = mixed - (mixed * way).sum(axis=-1, keepdims=True) * way
    return _unit(mixed, _beside(way))


def _beside(way: Floats) -> Floats:
    """(..., 3) some unit vector at right angles to each unit vector."""
    axis = np.eye(3)[np.abs(way).argmin(axis=-1)]
    return _unit(np.cross(way, axis), axis)


def _turn(bone: Floats, normal: Floats, new_bone: Floats, new_normal: Floats) -> Floats:
    """(..., 4) rotation that takes a bone to its new direction and the plane's normal along with it."""
    old = _unit(bone, _beside(normal))
    new = _unit(new_bone, old)
    straight = _shortest(old, new, normal)
    carried = rotated(straight, normal)
    sine = (np.cross(carried, new_normal) * new).sum(axis=-1)
    cosine = (carried * new_normal).sum(axis=-1)
    return multiply(about(new, np.arctan2(sine, cosine)), straight)


def _shortest(old: Floats, new: Floats, about: Floats) -> Floats:
    """(..., 4) the shortest rotation between unit vectors; a half turn goes about ``about``."""
    quaternion = np.concatenate([np.cross(old, new), 1 + (old * new).sum(axis=-1, keepdims=True)], axis=-1)
    half_turn = np.concatenate([about, np.zeros((*about.shape[:-1], 1))], axis=-1)
    size = _length(quaternion)[..., None]
    return np.where(size > 1e-12, quaternion / np.where(size > 1e-12, size, 1.0), half_turn)


def _length(vectors: Floats) -> Floats:
    return np.asarray(np.linalg.norm(vectors, axis=-1), np.float64)


def _unit(vectors: Floats, otherwise: Floats) -> Floats:
    """(..., 3) unit vectors; ``otherwise`` where the length is 0."""
    size = _length(vectors)[..., None]
    found: Floats = np.where(size > 0, vectors / np.where(size > 0, size, 1.0), otherwise)
    return found
