"""How much each clip matters: every trial that shows it is run again without it.

A trial that never shows a clip is the same without it, bit
by bit, so only the others are run.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gmr.evaluation.elsewhere import Runs
from gmr.pruning.outcomes import Outcomes, needed_rows
from gmr.pruning.part import recordings_of, whole
from gmr.pruning.rerun import Again, Rerun
from gmr.table import Table

__all__ = ["importance_table"]

Progress = Callable[[int, int], object]


def importance_table(asked: Runs, outcomes: Outcomes, rerun: Rerun, progress: Progress) -> Table:
    """What it costs to leave out each recording, alone.

    Args:
        asked: what the runs are made of.
        outcomes: what became of them with all recordings.
        rerun: makes them again.
        progress: called with the number of recordings done and of all.

    Returns:
        One row a recording, the one that matters most first: ``clip``, its ``seconds``, ``runs`` that need
        it, ``offset_change`` of the score's offset in metres, ``held_change`` of the number of runs that do
        what they are asked, and ``loss``, the two together (see :meth:`gmr.pruning.Score.worse_than`); NaN
        where nothing would be left to play.
    """
    database = asked.database
    needed = needed_rows(database, outcomes)
    recordings = recordings_of(database)
    everything = whole(database)
    jobs = []
    for recording in recordings:
        left = everything.without(recording.name, (0, recording.frames)).rows(database)
        jobs.append(Again(left, np.flatnonzero((needed & ~left).any(axis=1))))
    before = outcomes.score
    offset, held, loss = (np.full(len(jobs), np.nan) for _ in range(3))
    run_again = [number for number, job in enumerate(jobs) if len(job.runs)]
    untouched = np.setdiff1d(np.arange(len(jobs)), run_again)
    offset[untouched] = held[untouched] = loss[untouched] = 0.0
    done = len(untouched)
    progress(done, len(jobs))
    for place, found in rerun(asked, [jobs[number] for number in run_again]):
        number, done = run_again[place], done + 1
        if found is not None:
            after = outcomes.put(jobs[number].runs, found).score
            offset[number], held[number] = after.offset - before.offset, after.held - before.held
            loss[number] = after.worse_than(before)
        progress(done, len(jobs))
    order = np.lexsort((np.arange(len(jobs)), -np.where(np.isnan(loss), np.inf, loss)))
    table = Table(
        {
            "clip": np.array([recording.name for recording in recordings], object),
            "seconds": np.array([(recording.frames - 1) / database.rate for recording in recordings]),
            "runs": np.array([len(job.runs) for job in jobs], np.int64),
            "offset_change": offset,
            "held_change": held,
            "loss": loss,
        }
    )
    return table.take(order)
