"""Operations on scores, made to work on single tracks too."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from gmr.actionlets.actionlet import Actionlet
from gmr.actionlets.score import Score
from gmr.actionlets.track import Track

__all__ = ["Played", "on_scores", "paired"]

Played = TypeVar("Played", Track, Score)
"""A track or a score; what comes back is of the same kind."""

_ALONE = "the track"


def on_scores(change: Callable[..., Score], *given: Played) -> Played:
    """``change`` made to scores; tracks are scores of one track for as long."""
    scores = [one if isinstance(one, Score) else Score({_ALONE: one}) for one in given]
    found = change(*scores)
    return found if isinstance(given[0], Score) else found[_ALONE]


def paired(one: Score, other: Score) -> tuple[dict[str, Track], dict[str, Track]]:
    """The tracks of both for all degrees of freedom of either; those that one does not name rest at 0."""
    names = [*one.dofs, *(dof for dof in other.dofs if dof not in one.tracks)]
    return (
        {name: one.tracks.get(name) or _rest(one) for name in names},
        {name: other.tracks.get(name) or _rest(other) for name in names},
    )


def _rest(score: Score) -> Track:
    return Track((Actionlet.silence(0.0, score.duration),))
