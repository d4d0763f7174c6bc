"""A performance: an action with all that was left open decided, as one score with its contacts and path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actions.timeline import Profile
from gmr.actionlets.score import Score
from gmr.actionlets.travel.plan import Travel

__all__ = ["Performance"]


@dataclass(frozen=True)
class Performance:
    """What a body is to do, before it is known which body and how it travels.

    Args:
        action: the name of the action.
        score: the tracks of all degrees of freedom that move, radians (metres for the root's lengths).
        contacts: by "left" and "right", (n, 2) seconds between which that foot is on the ground, in order,
            apart from each other; the first may begin before 0 and the last end after the score.
        speed: (n, 2) seconds and metres a second along the path, straight between the points.
        turn_rate: (n, 2) seconds and radians a second, positive to the left.
        travel: "path": speed and turn rate are asked; "feet": the planted feet carry the root;
            or (seconds, one of these) from then on.
        phases: (label, begin, end) in seconds, by their beginning.
        parameters: what was chosen.
        seed, variation: what it differs by from the action as written.
    """

    action: str
    score: Score
    contacts: Mapping[str, NDArray[np.float64]]
    speed: NDArray[np.float64]
    turn_rate: NDArray[np.float64]
    travel: Travel
    phases: tuple[tuple[str, float, float], ...]
    parameters: Mapping[str, Profile]
    seed: int = 0
    variation: float = 0.0

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return self.score.duration
