"""A performance done by a body: the motion, and what is known of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

from gmr.actionlets.actions.performance import Performance
from gmr.actionlets.body import Body
from gmr.actionlets.posing import motion as posed
from gmr.actionlets.travel import Carried, Report, carried
from gmr.actionlets.upright import sampled
from gmr.errors import ActionletError
from gmr.motion import Motion

__all__ = ["Take", "check_frames", "taken"]

_MOST_FPS: Final = 10_000.0
_MOST_FRAMES: Final = 5_000_000
"""Ten hours at 120 frames a second, and some."""


@dataclass(frozen=True, eq=False)
class Take:
    """A synthesised motion and its labels.

    Args:
        motion: of the body, metres.
        performance: what was to be done; its contacts, phases, parameters and seed are the labels.
        carried: the body's angles, root and heading, of which the motion is made.
    """

    motion: Motion
    performance: Performance
    carried: Carried

    @property
    def report(self) -> Report:
        """How it travelled, beside what was asked, and what it had to give up."""
        return self.carried.report


def taken(performance: Performance, body: Body | None = None, fps: float = 120.0) -> Take:
    """The performance, done by a body; a man of 1.75 m where it is None.

    Raises:
        ActionletError: ``fps`` is no rate above 0 and up to 10,000, or the frames are too many.
    """
    check_frames(performance.action, performance.seconds, fps)
    who = body or _man()
    found = carried(who, sampled(who, performance.score, fps), performance, fps)
    motion = posed(who, found.angles, found.root, found.heading, fps, name=performance.action)
    return Take(motion, performance, found)


@cache
def _man() -> Body:
    return Body.of()


def check_frames(action: str, seconds: float, fps: float) -> None:
    """Refuses what is no rate, or too many frames.

    Raises:
        ActionletError: ``fps`` is not above 0 and up to 10,000, or there would be more than 5,000,000 frames.
    """
    if not 0 < fps <= _MOST_FPS:
        raise ActionletError(
            f"{fps:g} frames a second cannot be; give more than 0 and at most {_MOST_FPS:,.0f}"
        )
    if (frames := seconds * fps) > _MOST_FRAMES:
        raise ActionletError(
            f"{seconds:g} s of '{action}' at {fps:g} frames a second are {frames:,.0f} frames; "
            f"{_MOST_FRAMES:,} are the most: give fewer of them, or less time"
        )
