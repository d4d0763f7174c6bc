"""One time line for several motions, each with frames of its own length."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gmr.view.figure import Figure

__all__ = ["Timeline"]

_SLACK = 1e-6
"""Share of a frame by which a frame may begin early: times are sums of rounded numbers."""


@dataclass(frozen=True)
class Timeline:
    """Ticks that are ``step`` seconds apart, from 0 until the longest motion has ended."""

    step: float
    tick_count: int

    @classmethod
    def of(cls, figures: Sequence[Figure], fps: float | None = None) -> Timeline:
        """The time line of these figures: a tick for each frame of the fastest, or ``fps`` ticks a second
        where that is less."""
        step = min(figure.frame_time for figure in figures)
        if fps is not None:
            step = max(step, 1 / fps)
        lasts = max(figure.frame_count * figure.frame_time for figure in figures)
        return cls(step, max(1, math.ceil(lasts / step - _SLACK)))

    @property
    def seconds(self) -> float:
        """How long it lasts, the last tick as long as any."""
        return self.step * self.tick_count

    def frame(self, figure: Figure, tick: int) -> int:
        """The frame of a figure that is shown at a tick: the one that has begun last; the last one after its
        end."""
        begun = math.floor(tick * self.step / figure.frame_time + _SLACK)
        return min(max(begun, 0), figure.frame_count - 1)

    def tick(self, seconds: float) -> int:
        """The tick at a time, within the time line."""
        return min(max(math.floor(seconds / self.step + _SLACK), 0), self.tick_count - 1)
