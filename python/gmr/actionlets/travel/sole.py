"""The sole: how a foot that rolls from heel to toe without slipping carries the ankle along.

The foot is rigid. While the toes point up it turns about its heel, while they point down about the tip of the
toes, and when it is flat it rests.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.editing.easing import smooth_step

__all__ = ["Sole", "pitch_of", "yaw_of"]

Floats = NDArray[np.float64]

_FLAT = np.radians(3.0)
_FREE = np.radians(14.0)
"""Radians of nominal pitch up to which a foot on the ground is flat, and from which it keeps its pitch."""

_RISES = 0.8
"""Share of its nominal pitch by which a heel rises about the tip of the toes."""


@dataclass(frozen=True, eq=False, slots=True)
class Sole:
    """Heel and toe of a foot and how far its heel rises."""

    heel: Floats
    """(3,) from the ankle at rest, metres."""
    toe: Floats
    """(3,) the same, as low as the heel."""
    rises: float = _RISES
    """Share of its nominal pitch by which the heel rises about the tip of the toes."""

    def settled(self, pitch: Floats) -> Floats:
        """(F,) pitch of the foot on the ground from its nominal pitch.

        It is flat to 3 degrees and free from 14 on, C2 between, so that a foot comes to rest on its sole and
        rises from it without a jolt. The nominal foot of people rises about its ball, this one, whose toes do
        not bend, about their tip: it rises by a fifth less, so that the ankle is not much higher. A rigid
        ankle has no choice.
        """
        free = smooth_step((np.abs(pitch) - _FLAT) / (_FREE - _FLAT))
        found: Floats = pitch * np.where(pitch < 0, self.rises, 1.0) * free
        return found

    def contact(self, pitch: Floats) -> tuple[Floats, Floats]:
        """Where the sole touches the ground.

        Args:
            pitch: (F,) radians, toes up.

        Returns:
            (F, 3) the point of the sole, from the ankle, in the foot's frame, and (F, 2) where on the ground
            that is, x and z from the place under the ankle of the flat foot, before its yaw.
        """
        front = pitch < 0
        point = np.where(front[:, None], self.toe, self.heel)
        return point, point[:, ::2]


def pitch_of(foot: Floats) -> Floats:
    """(F,) radians that the toes point up, of (F, 3, 3) feet; beyond a quarter where the sole looks up.

    Where the toes point ahead is told by the foot's yaw, so that a foot that is also rolled passes upright
    without a jump.
    """
    yaw = yaw_of(foot)
    level = foot[:, 0, 2] * np.sin(yaw) + foot[:, 2, 2] * np.cos(yaw)
    return np.asarray(np.arctan2(foot[:, 1, 2], level), np.float64)


def yaw_of(foot: Floats) -> Floats:
    """(F,) radians that the foot points to the left of its frame's forward: its twist about the vertical.

    Of ``R_y(yaw) R_x(pitch)`` that is the yaw however the foot is pitched. Where its toes point it is not:
    they point back once a foot that leaves the ground is past upright.
    Source: swing and twist; the twist's ``tan`` of half the angle is ``q_y / q_w``.
    """
    return np.asarray(np.arctan2(foot[:, 0, 2] - foot[:, 2, 0], foot[:, 0, 0] + foot[:, 2, 2]), np.float64)
