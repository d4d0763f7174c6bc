"""Which clips take away most of what trials cost, for each second of them: one after the other.

What a trial costs is what it lacks of holding; see :mod:`gmr.completion.shortfall`. Candidates are ranked by
a cheap bound: had the searches of the failing trials asked for the speed and turn rate alone, and found the
candidate's frames too, how much less would they have cost? The best few of each round are then tried: all
trials are run again with each, and the one that takes away most cost per second is chosen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.completion.candidates import Candidate
from gmr.completion.queries import Queries, queries_of
from gmr.completion.shortfall import shortfalls
from gmr.completion.tempo import Rows, rows_of
from gmr.matching.database import Database
from gmr.matching.naming import recording_of
from gmr.matching.trial import Profile, Tracking, TrialLog, run_trials

__all__ = ["Choice", "Contest", "bound", "choose", "on_plan", "shortlisted"]

Name = TypeVar("Name")

_QUERIES: Final = 400
"""Searches that the bound looks at."""

_TRIED: Final = 8
_TRIED_OF_ONE: Final = 2
"""Candidates with which the trials are run again in each round, and how many of one clip in each order."""

_LISTED: Final = 32
_LISTED_OF_ONE: Final = 4
"""Candidates that get as far as that."""

_LEAST: Final = 0.01
"""Share of the cost that a clip must take away to be worth having."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A clip that was chosen.

    Attributes:
        name: of the clip.
        candidate: what it is.
        seconds: how long it is.
        bound: squared distance that a search of the failing trials could save by it, on average.
        cost_before, cost_after: what all trials lack of holding, added up, without it and with it.
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
        """Cost taken away per second of the recording: to play it faster is no gain in itself."""
        return (self.cost_before - self.cost_after) / (self.seconds * self.candidate.factor)


@dataclass(frozen=True, slots=True, eq=False)
class Contest:
    """The dataset and its candidates in one database, and the trials that decide.

    Attributes:
        database: scaled as the dataset by itself.
        candidates: by the names of their clips.
        profiles, tracking: the T trials.
        threads: how many to use.
    """

    database: Database
    candidates: Mapping[str, Candidate]
    profiles: tuple[Profile, ...]
    tracking: Tracking
    threads: int

    def run(self, names: Sequence[str]) -> TrialLog:
        """All trials on the dataset and some of the candidates."""
        part = self._with(names)
        return run_trials(part, self.profiles, tracking=self.tracking, threads=self.threads)

    def asked(self, log: TrialLog, trials: NDArray[np.intp], names: Sequence[str]) -> Queries:
        """What some trials of a log ask for by speed and turn rate alone, and what that costs with some
        candidates."""
        return on_plan(self._with(names), log, trials, self.threads)

    def _with(self, names: Sequence[str]) -> Database:
        taken = np.array(
            [recording_of(clip) not in self.candidates or recording_of(clip) in names for clip in self._clips]
        )
        return self.database.subset(taken[self.database.clips], threads=self.threads)

    def shows(self, log: TrialLog, name: str) -> bool:
        """Whether a trial shows a frame of a clip."""
        clips = [number for number, clip in enumerate(self._clips) if recording_of(clip) == name]
        return bool(np.isin(self.database.clips[log.row[log.row >= 0]], clips).any())

    def rows(self, name: str) -> Rows:
        """The frames of a candidate, with those of its mirrored copy where the dataset has such."""
        clips = [number for number, clip in enumerate(self._clips) if recording_of(clip) == name]
        return joined([rows_of(self.database, clip) for clip in clips])

    @property
    def _clips(self) -> tuple[str, ...]:
        return self.database.clip_names


def choose(
    contest: Contest, *, at_most: float | None = None, progress: Callable[[int, int], object]
) -> tuple[tuple[Choice, ...], int]:
    """Choose one clip after the other until none helps.

    A clip helps when all trials together lack at least 1% less with it, and no fewer of them hold. Clips that
    later ones have made idle are left out at the end: a frame that is never shown has won no search, so that
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
    lack = shortfalls(log)
    before = held = int((lack == 0).sum())
    room = np.inf if at_most is None else at_most
    found: list[Choice] = []
    while left:
        taken = [choice.name for choice in found]
        progress(len(found), len(contest.candidates))
        asked = contest.asked(log, np.flatnonzero(lack), taken)
        best: tuple[Choice, TrialLog] | None = None
        cost = float(lack.sum())
        fitting = {name: rows for name, rows in left.items() if rows.seconds <= room}
        ranked = _promising(fitting, contest.candidates, asked, contest.threads, _TRIED, _TRIED_OF_ONE)
        for name, saved in ranked.items():
            again = contest.run([*taken, name])
            lacks = shortfalls(again)
            after, holds = float(lacks.sum()), int((lacks == 0).sum())
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
        lack, held, room = shortfalls(log), choice.held, room - choice.seconds
        del left[choice.name]
    return tuple(choice for choice in found if contest.shows(log, choice.name)), before


def shortlisted(rows: Mapping[Candidate, Rows], asked: Queries, threads: int) -> list[Candidate]:
    """The candidates worth trying, few of one clip."""
    who = {candidate: candidate for candidate in rows}
    return list(_promising(rows, who, asked, threads, _LISTED, _LISTED_OF_ONE))


def on_plan(database: Database, log: TrialLog, trials: NDArray[np.intp], threads: int) -> Queries:
    """Searches of some trials as if they were on their way: asked for the speed and turn rate alone, and what
    that costs.

    A character that strays asks for ever wilder ways back, to which no clip is the answer.
    """
    asked = queries_of(database, log, trials, "velocity").some(_QUERIES)
    cost, _ = database.search(asked.features, threads=threads)
    return Queries(asked.features, cost[:, 0].astype(np.float64))


def bound(rows: Rows, asked: Queries, threads: int = 1) -> float:
    """What the searches could have cost less, on average, had they found these frames too."""
    if len(rows.features) == 0 or len(asked.cost) == 0:
        return 0.0
    cost, _ = _core.Index(rows.features).search(asked.features, 1, threads=threads)
    return float(np.maximum(asked.cost - cost[:, 0], 0.0).mean())


def joined(parts: Sequence[Rows]) -> Rows:
    """The frames of a clip and of its mirrored copy: recorded once."""
    return Rows(np.concatenate([part.features for part in parts]), parts[0].seconds)


def _promising(
    rows: Mapping[Name, Rows],
    who: Mapping[Name, Candidate],
    asked: Queries,
    threads: int,
    most: int,
    of_one: int,
) -> dict[Name, float]:
    """Those that could save most, per second recorded and in all by turns, and what: a short clip may save
    much for its length, and yet too little to help."""
    saved = {name: bound(part, asked, threads) for name, part in rows.items()}
    useful = [name for name, gain in saved.items() if gain > 0]
    per_second = sorted(useful, key=lambda name: -saved[name] / (rows[name].seconds * who[name].factor))
    in_all = sorted(useful, key=lambda name: -saved[name])
    chosen: dict[Name, float] = {}
    for order in (per_second, in_all):
        of_clip: Counter[str] = Counter()
        room = len(chosen) + most // 2
        for name in order:
            if len(chosen) < room and name not in chosen and of_clip[who[name].source] < of_one:
                of_clip[who[name].source] += 1
                chosen[name] = saved[name]
    return chosen
