"""A track while it is being fitted: instants of rest, angles there, skews between them, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.actionlet import Actionlet, on_the_way
from gmr.actionlets.bell import share
from gmr.actionlets.track import Track

__all__ = ["Outline"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Outline:
    """N pieces one after the other.

    Attributes:
        times: (N + 1,) seconds, rising.
        angles: (N + 1,) radians.
        skews: (N,).
    """

    times: Floats
    angles: Floats
    skews: Floats

    def at(self, t: Floats) -> Floats:
        """Radians at seconds within ``times``."""
        i = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.skews) - 1)
        u = np.clip((t - self.times[i]) / (self.times[i + 1] - self.times[i]), 0, 1)
        return on_the_way(self.angles[i], self.angles[i + 1], share(u, self.skews[i]))

    def track(self) -> Track:
        """As a track that begins at 0."""
        pieces = zip(
            self.angles[:-1].tolist(), self.angles[1:].tolist(), np.diff(self.times).tolist(),
            self.skews.tolist(), strict=True,
        )  # fmt: skip
        return Track(
            tuple(
                Actionlet.silence(start, seconds) if start == end else Actionlet(start, end, seconds, skew)
                for start, end, seconds, skew in pieces
            )
        )
