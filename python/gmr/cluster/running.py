"""The results of many jobs, as they come."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar, cast

from gmr.errors import GmrError
from gmr.threads import thread_count

__all__ = ["LOCAL", "Plain", "results", "worker_count"]

Job = TypeVar("Job")
Result = TypeVar("Result")

LOCAL: Final = "local"
"""The name of a Dask cluster that is started on this machine and goes with the command."""


def results(
    work: Callable[[Job], Result] | Callable[[Any, Job], Result],
    jobs: Sequence[Job],
    *,
    workers: int | None = None,
    cluster: str | None = None,
    shared: Any = None,
) -> Iterator[tuple[int, Result]]:
    """Each job's number and result, in the order in which they are done, every job once.

    Few jobs are on their way at a time, so that memory does not grow with their number. Closing the iterator
    (:func:`contextlib.closing`) ends what it has started.

    Args:
        work: a function of a module, or a :func:`functools.partial` of one; it may run twice for a job whose
            worker died, so it must do no harm by that.
        jobs: plain data, pickled.
        workers: processes on this machine, 1: none but this one; None or 0: a process for each core. With
            the local cluster: its workers.
        cluster: None: processes; "local": a Dask cluster of this machine's; else the address of a scheduler,
            such as ``tcp://10.0.0.1:8786``.
        shared: what all jobs need, pickled: sent once to each worker, not with each job. Where it is not
            None, ``work`` is called with it and the job.

    Raises:
        MissingExtraError: a cluster is asked for and distributed is not installed (the extra ``cluster``).
        GmrError: what ``work`` raises of that kind, in the same words; or the cluster cannot be reached, or
            workers die again and again over the same jobs.
        ValueError: there cannot be so many workers; or workers are counted for a cluster that has its own.
    """
    count = worker_count(workers, cluster)
    if cluster is not None:
        from gmr.cluster.on_dask import on_dask

        return on_dask(Plain(work), jobs, cluster, count, shared)
    if min(count, len(jobs)) <= 1:
        given = () if shared is None else (shared,)
        alone = cast(Callable[..., Result], work)
        return ((number, alone(*given, job)) for number, job in enumerate(jobs))
    from gmr.cluster.on_processes import on_processes

    return on_processes(Plain(work), jobs, min(count, len(jobs)), shared)


def worker_count(workers: int | None, cluster: str | None = None) -> int:
    """How many workers there will be; 0: the cluster at an address has its own.

    Raises:
        ValueError: there cannot be so many; or workers are counted for a cluster that has its own.
        TypeError: it is no whole number.
    """
    if cluster not in (None, LOCAL):
        if workers:
            raise ValueError(f"the cluster at {cluster} has workers of its own; leave their number out")
        return 0
    return thread_count(workers) or _cores()


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@dataclass(frozen=True)
class Plain(Generic[Result]):
    """Work whose errors can be sent: of gmr's, which hold more than their words, only the words."""

    work: Callable[..., Result]

    def __call__(self, *given: Any) -> Result:
        """The result of one job: the last, after what all of them share."""
        try:
            return self.work(*given)
        except GmrError as error:
            raise GmrError(str(error)) from None
