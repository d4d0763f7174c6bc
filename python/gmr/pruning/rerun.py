"""Runs made again on parts of a database: on threads of this process, or elsewhere with the same bits."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from contextlib import closing
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.cluster import results
from gmr.errors import DatasetError
from gmr.evaluation.elsewhere import Runs
from gmr.matching.trial import Tracking, TrialLog, run_trials
from gmr.pruning.outcomes import Outcomes, joined, outcomes_of

__all__ = ["Again", "Rerun", "elsewhere", "here", "logs_on", "made_again"]


@dataclass(frozen=True, slots=True, eq=False)
class Again:
    """Runs to be made again.

    Attributes:
        left: (N,) the rows that are left.
        runs: (n,) their numbers, ascending.
    """

    left: NDArray[np.bool_]
    runs: NDArray[np.intp]


Rerun: TypeAlias = Callable[[Runs, Sequence[Again]], Iterator[tuple[int, Outcomes | None]]]
"""Makes runs again, several times: the number of each and what became of it, in the order in which they are
done; None where nothing is left that may be jumped to."""


def made_again(asked: Runs, again: Again) -> Outcomes | None:
    """One of them, on this thread."""
    logs = logs_on(asked, again)
    if logs is None:
        return None
    by_tracking = {log.tracking: log for log in logs}
    return joined(
        [
            outcomes_of(by_tracking[tracking], [asked.trials[place] for place in places])
            for tracking, places in places_of(asked, again)
        ]
    )


def places_of(asked: Runs, again: Again) -> Iterator[tuple[Tracking, list[int]]]:
    """The trackings that there are runs of, each with the places of its trials."""
    count = len(asked.trials)
    for number, tracking in enumerate(asked.trackings):
        places = [run - number * count for run in again.runs.tolist() if run // count == number]
        if places:
            yield tracking, places


def logs_on(asked: Runs, again: Again, threads: int = 1) -> list[TrialLog] | None:
    """The logs of some runs on a part of the database, one for each tracking that there are runs of."""
    try:
        part = asked.database.subset(again.left, threads=threads)
    except DatasetError:
        return None
    return [
        run_trials(part, [asked.profiles[place] for place in places], tracking=tracking, threads=threads)
        for tracking, places in places_of(asked, again)
    ]


def here(threads: int = 0) -> Rerun:
    """On threads of this process; 0: as many as there are cores."""
    count = threads or os.cpu_count() or 1

    def run(asked: Runs, jobs: Sequence[Again]) -> Iterator[tuple[int, Outcomes | None]]:
        with ThreadPoolExecutor(count, thread_name_prefix="gmr-prune") as pool:
            waiting = iter(enumerate(jobs))
            running = {pool.submit(made_again, asked, job): number for number, job in _some(waiting, count)}
            try:
                while running:
                    for done in wait(running, return_when=FIRST_COMPLETED).done:
                        number, result = running.pop(done), done.result()
                        running |= {pool.submit(made_again, asked, job): n for n, job in _some(waiting, 1)}
                        yield number, result
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise

    return run


def elsewhere(workers: int | None = None, cluster: str | None = None) -> Rerun:
    """On other processes or on a cluster, with the same bits; see :func:`gmr.cluster.results`."""

    def run(asked: Runs, jobs: Sequence[Again]) -> Iterator[tuple[int, Outcomes | None]]:
        coming = results(made_again, jobs, workers=workers, cluster=cluster, shared=asked)
        with closing(coming) as found:  # type: ignore[type-var]
            yield from found

    return run


def _some(jobs: Iterator[tuple[int, Again]], count: int) -> Iterator[tuple[int, Again]]:
    for _, job in zip(range(count), jobs, strict=False):
        yield job
