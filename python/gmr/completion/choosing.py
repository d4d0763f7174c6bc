"""Which clips take away most of what failing trials cost, for each second of them: one after the other.

Candidates are ranked by a cheap bound: had the searches of the failing trials found the candidate's frames
too, how much less they would have cost. The best few of each round are then tried: all trials are run
again with each, and the one that takes away most cost per second of clip is chosen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.completion.candidates import Candidate
from gmr.completion.queries import Queries, queries_of
from gmr.completion.tempo import Rows, rows_of
from gmr.matching.database import Database
from gmr.matching.trial import Profile, Tracking, TrialLog, run_trials
from gmr.pruning.outcomes import outcomes_of

__all__ = ["Choice", "Contest", "bound", "choose", "search_costs", "shortlisted"]

Name = TypeVar("Name")

_QUERIES: Final = 400
"""Searches that the bound looks at."""

_TRIED: Final = 6
"""Candidates with which the trials are run again in each round."""

_LISTED: Final = 24
"""Candidates that get as far as being tried, and of one clip at most:"""
_OF_ONE_CLIP: Final = 2

_LEAST: Final = 0.02
"""Share of the cost that a clip must take away to be worth having."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A clip that was chosen.

    Attributes:
        name: of the clip.
        candidate: what it is.
        seconds: how long it is.
        bound: what the searches of the failing trials could save by it, in the same measure.
        cost_before, cost_after: what the searches of the trials that failed at first cost without it and with
            it, as a share of what they cost at first: the mean over these trials.
        held: how many trials hold with it.
        tried: with how many candidates the trials were run in its round.
    """

    name: str
    candidate: Candidate
    seconds: float
    bound: float
    cost_before: float
    cost_after: float
    held: int
    tried: int

    @property
    def gain(self) -> float:
        """Cost taken away per second of clip."""
        return (self.cost_before - self.cost_after) / self.seconds


@dataclass(frozen=True, slots=True, eq=False)
class Contest:
    """The dataset and its candidates in one database, and the trials that decide.

    Attributes:
        database: scaled as the dataset by itself.
        candidates: by the names of their clips.
        profiles, tracking: the T trials.
        failing: which of them failed at first.
        threads: how many to use.
    """

    database: Database
    candidates: Mapping[str, Candidate]
    profiles: tuple[Profile, ...]
    tracking: Tracking
    failing: NDArray[np.intp]
    threads: int

    def run(self, names: Sequence[str]) -> TrialLog:
        """All trials on the dataset and some of the candidates."""
        taken = np.array(
            [_recording(clip) not in self.candidates or _recording(clip) in names for clip in self._clips]
        )
        part = self.database.subset(taken[self.database.clips])
        return run_trials(part, self.profiles, tracking=self.tracking, threads=self.threads)

    def shows(self, log: TrialLog, name: str) -> bool:
        """Whether a trial shows a frame of a clip."""
        clips = [number for number, clip in enumerate(self._clips) if _recording(clip) == name]
        return bool(np.isin(self.database.clips[log.row[log.row >= 0]], clips).any())

    def rows(self, name: str) -> Rows:
        """The frames of a candidate, with those of its mirrored copy where the dataset has such."""
        clips = [number for number, clip in enumerate(self._clips) if _recording(clip) == name]
        return joined([rows_of(self.database, clip) for clip in clips])

    @property
    def _clips(self) -> tuple[str, ...]:
        return self.database.clip_names


def choose(
    contest: Contest, *, at_most: float | None = None, progress: Callable[[int, int], object]
) -> tuple[tuple[Choice, ...], int]:
    """Choose one clip after the other until none helps.

    Each trial that failed at first counts alike: by what its searches cost, as a share of what they cost at
    first. A clip helps when that falls by at least 2% on average, and no fewer trials hold. Clips that later
    ones have made idle are left out at the end: a frame that is never shown has won no search, so that
    without it every trial is the same.

    Args:
        contest: what there is to choose from.
        at_most: seconds that the chosen clips may last together.
        progress: called with how many clips were chosen, and of how many there are.

    Returns:
        The choices, and how many trials held before, with the candidates left aside.
    """
    left = {name: contest.rows(name) for name in contest.candidates}
    log = contest.run(())
    before = held = int(outcomes_of(log).held.sum())
    first = search_costs(log, contest.failing)
    cost = 1.0
    room = np.inf if at_most is None else at_most
    found: list[Choice] = []
    while left:
        progress(len(found), len(contest.candidates))
        fails = ~outcomes_of(log).held[contest.failing]
        asked = queries_of(contest.database, log, contest.failing[fails], first[fails]).some(_QUERIES)
        best: tuple[Choice, TrialLog] | None = None
        fitting = {name: rows for name, rows in left.items() if rows.seconds <= room}
        ranked = _ranked(fitting, asked, contest.threads)[:_TRIED]
        for name, saved in ranked:
            again = contest.run([*(choice.name for choice in found), name])
            after = float((search_costs(again, contest.failing) / first).mean())
            holds = int(outcomes_of(again).held.sum())
            tried = Choice(
                name, contest.candidates[name], left[name].seconds, saved, cost, after, holds, len(ranked)
            )
            helps = after <= (1 - _LEAST) * cost and holds >= held
            if helps and (best is None or tried.gain > best[0].gain):
                best = tried, again
        if best is None:
            break
        choice, log = best
        found.append(choice)
        cost, held, room = choice.cost_after, choice.held, room - choice.seconds
        del left[choice.name]
    return tuple(choice for choice in found if contest.shows(log, choice.name)), before


def shortlisted(rows: Mapping[Candidate, Rows], asked: Queries, threads: int) -> list[Candidate]:
    """The candidates worth trying: best bound per second first, few of one clip."""
    chosen: list[Candidate] = []
    of_clip: dict[str, int] = {}
    for candidate, _ in _ranked(rows, asked.some(_QUERIES), threads):
        of_clip[candidate.source] = of_clip.get(candidate.source, 0) + 1
        if of_clip[candidate.source] <= _OF_ONE_CLIP:
            chosen.append(candidate)
    return chosen[:_LISTED]


def bound(rows: Rows, asked: Queries, threads: int = 1) -> float:
    """What the searches could have cost less, on average, had they found these frames too."""
    if len(rows.features) == 0 or len(asked.cost) == 0:
        return 0.0
    cost, _ = _core.Index(rows.features).search(asked.features, 1, threads=threads)
    return float((np.maximum(asked.cost - cost[:, 0], 0.0) / asked.unit).mean())


def search_costs(log: TrialLog, trials: NDArray[np.intp]) -> NDArray[np.float64]:
    """(K,) mean cost of the searches in the recorded part of each of some trials."""
    cost = log.cost_pose[trials].astype(np.float64) + log.cost_trajectory[trials]
    recorded = np.arange(cost.shape[1]) >= log.recorded_from[trials][:, None]
    return np.asarray(np.nanmean(np.where(recorded, cost, np.nan), axis=1))


def joined(parts: Sequence[Rows]) -> Rows:
    """The frames of a clip and of its mirrored copy: recorded once."""
    return Rows(np.concatenate([part.features for part in parts]), parts[0].seconds)


def _ranked(rows: Mapping[Name, Rows], asked: Queries, threads: int) -> list[tuple[Name, float]]:
    """Those that could save anything, most per second first, and how much."""
    saved = {name: bound(part, asked, threads) for name, part in rows.items()}
    useful = [(name, gain) for name, gain in saved.items() if gain > 0]
    return sorted(useful, key=lambda item: -item[1] / rows[item[0]].seconds)


def _recording(clip: str) -> str:
    return clip.removesuffix(" (mirrored)")
