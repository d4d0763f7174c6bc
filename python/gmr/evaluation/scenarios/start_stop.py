"""Standing, walking and standing again."""

from __future__ import annotations

from dataclasses import dataclass

from gmr.evaluation.scenario import RUN_UP, Segment, Trial

__all__ = ["StartStop"]


@dataclass(frozen=True, slots=True)
class StartStop:
    """Straight ahead in starts and stops, at one speed a trial; the speed changes at once, as in switching.

    Attributes:
        speeds: walked at, metres per second.
        walk: seconds of walking each time.
        stand: seconds of standing each time.
        times: how often it starts.
        name: in tables and sentences.
    """

    speeds: tuple[float, ...] = (1.0, 1.5, 2.0, 2.5, 3.0)
    walk: float = 5.0
    stand: float = 3.0
    times: int = 4
    name: str = "start-stop"

    def trials(self) -> tuple[Trial, ...]:
        """One a speed; it stands before it is recorded too."""
        return tuple(self._trial(speed) for speed in self.speeds)

    def _trial(self, speed: float) -> Trial:
        once = (Segment(self.walk, speed, 0.0), Segment(self.stand, 0.0, 0.0))
        return Trial.along(self.name, f"{speed:g} m/s", (Segment(RUN_UP, 0.0, 0.0), *once * self.times))
