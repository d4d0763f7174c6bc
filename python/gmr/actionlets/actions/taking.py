"""A performance done by a body: the motion, and what is known of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from gmr.actionlets.actions.performance import Performance
from gmr.actionlets.body import Body
from gmr.actionlets.posing import motion as posed
from gmr.actionlets.travel import Carried, Report, carried
from gmr.motion import Motion

__all__ = ["Take", "taken"]


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
        ActionletError: ``fps`` is no rate above 0.
    """
    who = body or _man()
    found = carried(who, performance.score.sample(fps, who.names), performance, fps)
    motion = posed(who, found.angles, found.root, found.heading, fps, name=performance.action)
    return Take(motion, performance, found)


@cache
def _man() -> Body:
    return Body.of()
