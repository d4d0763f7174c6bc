"""Bodies of other sizes: the same gait at another pace.

Gaits of bodies with legs of other lengths ``l`` are alike where their Froude numbers ``v^2 / g l`` are:
lengths then go with ``l``, times with ``sqrt(l / g)``, speeds with ``sqrt(g l)``.
Source: R. McN. Alexander and A. S. Jayes, "A dynamic similarity hypothesis for the gaits of quadrupedal
mammals", J. Zool. 201 (1983) 135; for people A. L. Hof, "Scaling gait data to body size", Gait and Posture 4
(1996) 222.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.actions.units import ActionUnit
from gmr.actionlets.body import Body

__all__ = ["SPEED", "WRITTEN", "Pace", "leg_ratio", "pace", "stepping"]

SPEED = "speed"

_ROUND = 0.1
"""Metres from the body's middle to its feet, which go round it when it turns on the spot."""


class Pace(NamedTuple):
    """How a body of another size performs what is written for the reference body."""

    period: float
    """What the period is multiplied with."""
    speed: float
    """What a speed in m/s is multiplied with, before curves of the file are looked up at it."""


WRITTEN = Pace(1.0, 1.0)
"""The reference body's."""


def pace(unit: ActionUnit, size: float) -> Pace:
    """The pace of an action for legs that are ``size`` times as long as those of the reference body.

    A period that follows the speed goes with ``sqrt(l)``; one that something else tells (a march's beat, the
    time of a jump) stays. In both cases a step is as long, by the leg, as it is written for the speed that is
    looked up: ``v T / l`` is kept.
    """
    period = math.sqrt(size) if unit.cyclic and SPEED in unit.span.parameters else 1.0
    return Pace(period, period / size)


def stepping(parameters: Mapping[str, ArrayLike]) -> NDArray[np.float64]:
    """Metres a second with which feet step that go along a path and round the body: a body that turns on the
    spot does not leave them where they are."""
    turn_rate = np.radians(parameters.get("turn_rate", 0.0))
    return np.asarray(np.hypot(parameters[SPEED], _ROUND * turn_rate), np.float64)


def leg_ratio(body: Body | None) -> float:
    """Length of a body's legs by that of the reference body, a man of 1.75 m; 1 for None."""
    return 1.0 if body is None else body.leg_length / _reference_leg()


@cache
def _reference_leg() -> float:
    return Body.of().leg_length
