"""Bodies that now follow a path and now are carried by their feet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.travel.path import level
from gmr.editing.easing import smooth_step

__all__ = ["carried_by_turns"]

Floats = NDArray[np.float64]

_CHANGE = 0.2
"""Seconds within which the one takes the pelvis over from the other."""


def carried_by_turns(
    kinds: Sequence[tuple[float, str]],
    times: Floats,
    by_path: tuple[Floats, Floats],
    by_feet: tuple[Floats, Floats],
) -> tuple[Floats, Floats]:
    """Root and heading that go from frame to frame as the path does, or as the planted feet do.

    Args:
        kinds: (seconds, "path" or "feet") from then on, in time.
        times: (F,) seconds of the frames.
        by_path: (F, 2) x and z of the pelvis and (F,) headings that speed and turn rate lead to.
        by_feet: the same, of a body that its feet carry.
    """
    share = _share(kinds, (times[1:] + times[:-1]) / 2)
    heading = np.zeros(len(times))
    turns = [np.diff(course) for _, course in (by_path, by_feet)]
    heading[1:] = np.cumsum(turns[0] + share * (turns[1] - turns[0]))
    heading += by_path[1][0]
    ways = [level(np.diff(place, axis=0), -course[:-1]) for place, course in (by_path, by_feet)]
    steps = level(ways[0] + share[:, None] * (ways[1] - ways[0]), heading[:-1])
    ground = np.zeros((len(times), 2))
    ground[1:] = np.cumsum(steps, axis=0)
    return ground + by_path[0][0], heading


def _share(kinds: Sequence[tuple[float, str]], times: Floats) -> Floats:
    """(n,) how far the feet carry the body, 0 to 1."""
    share = np.full(len(times), float(kinds[0][1] == "feet"))
    for seconds, kind in kinds[1:]:
        here = smooth_step((times - seconds) / _CHANGE + 0.5)
        share += here * ((kind == "feet") - share)
    return share
