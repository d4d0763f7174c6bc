"""What frames at one rate have in common, be they poses of a skeleton or places of markers."""

from __future__ import annotations

import math
from abc import abstractmethod

from gmr.errors import GmrError

__all__ = ["Clip", "check_frame_time"]


class Clip:
    """One continuous recording: frames, one after the other in equal time."""

    frame_time: float

    @property
    @abstractmethod
    def frame_count(self) -> int:
        """F."""

    def __len__(self) -> int:
        return self.frame_count

    @property
    def fps(self) -> float:
        """Frames a second; infinite where the frame time is 0."""
        return 1 / self.frame_time if self.frame_time else math.inf

    @property
    def duration(self) -> float:
        """Seconds, each frame lasting one frame time."""
        return self.frame_count * self.frame_time


def check_frame_time(seconds: float) -> None:
    """Raises GmrError unless a frame can last so long."""
    if not (math.isfinite(seconds) and seconds >= 0):
        raise GmrError(f"a frame cannot last {seconds} seconds; give 0 or more")
