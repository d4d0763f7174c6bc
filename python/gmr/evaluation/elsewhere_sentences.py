"""Clips that hold nothing the grid asks for, in words: what they do is computed, not guessed from names.

Among walks and runs there may lie a dance, a game or steps backwards. Their seconds count as material, and
pieces of them are played where nothing nearer is about; whoever reads the verdict is to know.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.evaluation.clip_sentences import MOST_NAMES, below_their_common_folder, originals
from gmr.evaluation.regions import FORWARD_SHARE, Grid
from gmr.evaluation.words import STANDS, count, duration, percent, some_of
from gmr.table import Table

__all__ = ["elsewhere_sentences"]

MOSTLY: Final = 0.5
"""A clip that goes forward for this share of its time, at any speed, is locomotion, if not of the grid."""

ALONE: Final = 0.01
"""Share of the time of all trials from which on such a clip is named with its share."""


def elsewhere_sentences(grid: Grid, coverage: Table, clips: Table) -> Iterator[str]:
    """Say which clips mostly stand, turn on the spot, or go sideways or backwards, and how much is played.

    A clip counts, with its mirrored copy, when less of it than a cell of the grid must have goes forward
    within the grid's speeds and turn rates, and less than half of it forward at any speed.
    """
    own = originals(clips)
    names, which = np.unique(own, return_inverse=True)
    others = _hold_nothing(grid, coverage, dict(zip(clips["clip"].tolist(), which.tolist(), strict=True)))
    if not others.any() or others.all():
        return
    seconds = np.bincount(which, np.where(clips["mirrored"], 0.0, clips["seconds"]), len(names))
    share = np.bincount(which, clips["played_share"], len(names)).astype(np.float64)
    told = below_their_common_folder(names.tolist())
    longest = [int(place) for place in np.argsort(-seconds, kind="stable") if others[place]]
    lasting = float(seconds[others].sum())
    part = percent(lasting / float(seconds.sum()))
    one = len(longest) == 1
    do, who = (
        ("stands, turns on the spot or goes", "it") if one else ("stand, turn on the spot or go", "each")
    )
    yield (
        f"{count(len(longest), 'clip')} of {len(names)} ({duration(lasting)}, {part} of the material) mostly "
        f"{do} sideways or backwards ({_where(told, longest)}): {who} goes forward for less than half of its "
        f"time, and for less than {duration(grid.limits.covered)} at the speeds and turn rates of the grid. "
        f"{_played(told, share, others)}; clips that go forward for longer are not counted here, whatever "
        "else they hold."
    )


def _hold_nothing(grid: Grid, coverage: Table, place: dict[str, int]) -> NDArray[np.bool_]:
    """(C,) which clips hold nothing that the grid asks for; ``place`` is the number of a name."""
    speeds, turns = grid.borders
    speed, turn, weight = coverage["speed"], coverage["turn_rate_deg"], coverage["weight"]
    forward = (speed >= STANDS) & (coverage["forward_speed"] >= FORWARD_SHARE * speed)
    asked = forward & (speed >= speeds[0]) & (speed <= speeds[-1]) & (turn >= turns[0]) & (turn <= turns[-1])
    clip = np.array([place[name] for name in coverage["clip"].tolist()], np.int64)

    def seconds(windows: NDArray[np.bool_]) -> NDArray[np.float64]:
        return np.bincount(clip[windows], weight[windows], max(place.values()) + 1).astype(np.float64)

    every = seconds(np.ones(len(coverage), bool))
    lacks = seconds(asked) < grid.limits.covered
    return np.asarray((every > 0) & lacks & (seconds(forward) < MOSTLY * every))


def _where(names: Sequence[str], chosen: Sequence[int]) -> str:
    """Some of their names; of several folders how many lie in each, that with most of them first."""
    folders = [name.rpartition("/")[0] for name in names]
    found, every = Counter(folders[place] for place in chosen), Counter(folders)
    if len(every) == 1 or len(chosen) <= MOST_NAMES:
        return some_of([names[place] for place in chosen], MOST_NAMES)
    parts = [
        f"{number} of {every[folder]} in {folder or 'the folder'}" for folder, number in found.most_common()
    ]
    return some_of(parts, 2 * MOST_NAMES)


def _played(names: Sequence[str], share: NDArray[np.float64], others: NDArray[np.bool_]) -> str:
    """How much of the time they are shown all the same, and of many the most played one."""
    total, most, many = (
        float(share[others].sum()),
        int(np.argmax(np.where(others, share, -1.0))),
        others.sum(),
    )
    who = "It is" if many == 1 else f"These {many} are"
    if total == 0:
        return f"{who} never shown"
    tell_most = many > MOST_NAMES and share[most] >= ALONE
    alone = f", {names[most]} alone for {percent(float(share[most]))}" if tell_most else ""
    return f"{who} shown for {percent(total)} of the time{alone}"
