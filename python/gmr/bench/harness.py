"""Both sides in one run, turn by turn, so that a ratio holds where absolute times drift."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

__all__ = ["Contest", "Row", "one_core", "run_contest"]

Work = Callable[[], object]


@dataclass(frozen=True, slots=True)
class Contest:
    """One piece of work, done by gmr and by its peers on the same input.

    Args:
        work: what is done, in the words of the table.
        unit: of a rate, such as ``MB/s``; the rate is ``amount`` per second.
        amount: how much of the unit one call does.
        ours: gmr's call.
        peers: the peers' calls, by name.
        targets: the least ratio to reach against a peer, by name.
        absent: peers that are not installed, by name: how to install them.
        peer_amount: how much of the unit one call of a peer does, where a whole ``amount`` would take them
            too long; None for as much as ours.
        all_cores: whether gmr may use all processors (the peers use what they use).
    """

    work: str
    unit: str
    amount: float
    ours: Work
    peers: Mapping[str, Work] = field(default_factory=dict)
    targets: Mapping[str, float] = field(default_factory=dict)
    absent: Mapping[str, str] = field(default_factory=dict)
    peer_amount: float | None = None
    all_cores: bool = False


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: gmr against one peer (or alone, where ``peer`` is empty)."""

    work: str
    unit: str
    ours: float
    ours_low: float
    ours_high: float
    peer: str = ""
    theirs: float | None = None
    ratio: float | None = None
    ratio_low: float | None = None
    ratio_high: float | None = None
    target: float | None = None
    note: str = ""


def run_contest(contest: Contest, *, rounds: int, seconds: float) -> list[Row]:
    """Times the contestants turn by turn and compares them round by round.

    Args:
        contest: what to measure.
        rounds: how many rounds at most.
        seconds: no new round begins once this long has passed (at least three are run, one in a smoke run).

    Returns:
        A row for each peer, present or absent; one row without a peer where there is none.
    """
    calls = {"": contest.ours, **contest.peers}
    repeats = {name: _warm_up(call) for name, call in calls.items()}
    times: dict[str, list[float]] = {name: [] for name in calls}
    begun = time.perf_counter()
    for done in range(rounds):
        if done >= 3 and time.perf_counter() - begun > seconds:
            break
        for name, call in calls.items():
            times[name].append(_time(call, repeats[name]))

    rates = sorted(contest.amount / t for t in times[""])
    ours = (statistics.median(rates), rates[0], rates[-1])
    rows = [_row(contest, ours, peer, times) for peer in contest.peers]
    rows += [
        Row(contest.work, contest.unit, *ours, peer=peer, note=how) for peer, how in contest.absent.items()
    ]
    return rows or [Row(contest.work, contest.unit, *ours)]


def _row(
    contest: Contest, ours: tuple[float, float, float], peer: str, times: Mapping[str, list[float]]
) -> Row:
    amount = contest.amount if contest.peer_amount is None else contest.peer_amount
    share = contest.amount / amount
    ratios = sorted(share * theirs / mine for theirs, mine in zip(times[peer], times[""], strict=True))
    return Row(
        contest.work,
        contest.unit,
        *ours,
        peer=peer,
        theirs=amount / statistics.median(times[peer]),
        ratio=statistics.median(ratios),
        ratio_low=ratios[0],
        ratio_high=ratios[-1],
        target=contest.targets.get(peer),
    )


def _warm_up(call: Work) -> int:
    """Runs the call once and says how often to repeat it so that one timing lasts some milliseconds."""
    call()
    begun = time.perf_counter()
    call()
    return max(1, min(100, int(0.005 / max(time.perf_counter() - begun, 1e-7))))


def _time(call: Work, repeats: int) -> float:
    begun = time.perf_counter()
    for _ in range(repeats):
        call()
    return (time.perf_counter() - begun) / repeats


@contextmanager
def one_core() -> Iterator[None]:
    """Keeps this process on one processor for a while, where the system can (Linux)."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)
