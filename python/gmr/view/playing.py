"""Where a time line is, and how it moves on."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gmr.view.timeline import Timeline

__all__ = ["Player"]


class Player:
    """A place on a time line that moves with the clock while it plays; it begins playing, and loops."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._seconds, self._speed, self._loops = 0.0, 1.0, True
        self.tick = 0
        """Where it is."""
        self.is_playing = timeline.tick_count > 1
        """Whether it moves with the clock."""

    def advance(self, elapsed: float) -> bool:
        """Lets time pass, in seconds; tells whether there is something new to draw."""
        if not self.is_playing:
            return False
        before, self._seconds = self.tick, self._seconds + elapsed * self._speed
        if self._seconds >= self._timeline.seconds:
            if self._loops:
                self._seconds %= self._timeline.seconds
            else:
                self.is_playing = False
        self.tick = self._timeline.tick(self._seconds)
        return self.tick != before or not self.is_playing

    def toggle(self) -> None:
        """Plays or pauses; at the end of the time line it plays from the start."""
        if not self.is_playing and not self._loops and self.tick == self._timeline.tick_count - 1:
            self._go_to(0)
        self.is_playing = not self.is_playing and self._timeline.tick_count > 1

    def go(self, tick: int) -> None:
        """Pauses at a tick; past either end it goes on at the other."""
        self.is_playing = False
        self._go_to(tick % self._timeline.tick_count)

    def run_at(self, speed: float) -> None:
        """How many seconds pass in one."""
        self._speed = speed

    def loop(self, loops: bool) -> None:
        """Whether it starts again at the end."""
        self._loops = loops

    def _go_to(self, tick: int) -> None:
        self.tick = tick
        self._seconds = tick * self._timeline.step
