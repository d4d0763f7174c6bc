"""Going sideways, backwards and diagonally, and facing ahead all the while."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Final

from gmr.evaluation.scenario import RUN_UP, Segment, Trial

__all__ = ["Strafe", "way_in_words"]


@dataclass(frozen=True, slots=True)
class Strafe:
    """A straight line in another direction than the one faced, one speed and direction a trial.

    Attributes:
        speeds: metres per second.
        drifts_deg: directions, degrees from where the character faces, positive to the left.
        record: seconds recorded.
        name: in tables and sentences.
    """

    speeds: tuple[float, ...] = (1.0, 2.0)
    drifts_deg: tuple[float, ...] = (45.0, 90.0, 135.0, 180.0, -135.0, -90.0, -45.0)
    record: float = 10.0
    name: str = "strafe"

    def trials(self) -> tuple[Trial, ...]:
        """One for every speed and direction; it goes that way before it is recorded, too."""
        return tuple(
            Trial.along(
                self.name,
                f"{speed:g} m/s {way_in_words(drift)}",
                (Segment(RUN_UP, speed, 0.0, drift), Segment(self.record, speed, 0.0, drift)),
            )
            for speed, drift in product(self.speeds, self.drifts_deg)
        )


_WAYS: Final = {
    0.0: "ahead",
    45.0: "ahead and to the left",
    90.0: "to the left",
    135.0: "back and to the left",
    180.0: "backwards",
    -135.0: "back and to the right",
    -90.0: "to the right",
    -45.0: "ahead and to the right",
}


def way_in_words(drift_deg: float) -> str:
    """A direction as seen by whoever goes there: "to the left", or its angle where it has no name."""
    side = "left" if drift_deg > 0 else "right"
    return _WAYS.get(float(drift_deg), f"{abs(drift_deg):g} degrees to the {side}")
