"""Jobs on a Dask cluster."""

from __future__ import annotations

import logging
import pickle
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Final, TypeVar

from gmr.cluster.interrupts import interrupts_held
from gmr.cluster.running import LOCAL
from gmr.cluster.shared import WithShared, joined
from gmr.errors import GmrError, MissingExtraError

__all__ = ["on_dask"]

Job = TypeVar("Job")
Result = TypeVar("Result")

_AHEAD: Final = 2
"""Jobs on their way for each thread of the workers."""

_LOOK: Final = 2.0
"""Seconds without a result after which the workers are counted."""

_PATIENCE: Final = 60.0
"""Seconds that a cluster may be without workers."""

_PIECE: Final = 4_000_000
"""Bytes that are sent to a scheduler at a time."""

_ANSWER: Final = 15
"""Seconds in which a scheduler has to answer."""


def on_dask(
    work: Callable[..., Result], jobs: Sequence[Job], cluster: str, workers: int, shared: Any = None
) -> Iterator[tuple[int, Result]]:
    """See :func:`gmr.cluster.results`; ``workers`` are those of the local cluster."""
    try:
        import distributed
    except ImportError as error:
        raise MissingExtraError("distributed", "cluster", "Work on a cluster") from error
    with _client(distributed, cluster, workers) as client:
        try:
            yield from _results(distributed, client, work, jobs, shared)
        except distributed.KilledWorker as error:
            raise GmrError(
                f"workers of the cluster died again and again over the same work: {error}"
            ) from None
        except _gone(distributed) as error:
            raise GmrError(f"the connection to the cluster at {cluster} is lost: {error}") from None


def _results(
    distributed: Any, client: Any, work: Callable[..., Result], jobs: Sequence[Job], shared: Any
) -> Iterator[tuple[int, Result]]:
    waiting = deque(range(len(jobs)))
    running: dict[Any, int] = {}
    run = uuid.uuid4().hex
    threads = _threads(client)
    sent = () if shared is None else (_sent(client, shared, run),)
    alone = work if shared is None else WithShared(work, run)
    while waiting or running:
        while waiting and len(running) < _AHEAD * threads:
            number = waiting.popleft()
            running[client.submit(alone, jobs[number], *sent, key=f"gmr-{run}-{number}", pure=False)] = number
        try:
            with client.as_current():
                ended = distributed.wait(list(running), timeout=_LOOK, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            threads = _threads(client)
            continue
        done = list(ended)
        for future, result in zip(done, client.gather(done), strict=True):
            yield running.pop(future), result


def _sent(client: Any, shared: Any, run: str) -> Any:
    """What all jobs share, on the cluster: in pieces that the scheduler holds, so that it can be put together
    again when the worker that had it is gone."""
    packed = pickle.dumps(shared, pickle.HIGHEST_PROTOCOL)
    pieces = [
        client.submit(bytes, packed[start : start + _PIECE], key=f"gmr-{run}-piece-{start}", pure=False)
        for start in range(0, len(packed), _PIECE)
    ]
    return client.submit(joined, *pieces, key=f"gmr-{run}-shared", pure=False)


def _threads(client: Any) -> int:
    """Threads of all workers, as soon as there is one."""
    until = time.monotonic() + _PATIENCE
    while not (threads := sum(client.nthreads().values())):
        if time.monotonic() > until:
            raise GmrError(
                f"the cluster has had no worker for {_PATIENCE:g} s; start some (dask worker ADDRESS), "
                "where gmr-motion is installed too"
            )
        time.sleep(0.1)
    return int(threads)


@contextmanager
def _client(distributed: Any, cluster: str, workers: int) -> Iterator[Any]:
    """A connection; the local cluster begins and ends with it."""
    if cluster == LOCAL:
        with interrupts_held():
            own = distributed.LocalCluster(
                n_workers=workers, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
            )
        with own, distributed.Client(own, set_as_default=False) as client:
            yield client
        return
    try:
        client = distributed.Client(cluster, timeout=_ANSWER, set_as_default=False)
    except (OSError, ValueError) as error:
        raise GmrError(
            f"no Dask scheduler answers at '{cluster}': {error}; give its address, such as "
            f"tcp://10.0.0.1:8786, or '{LOCAL}' for a cluster on this machine"
        ) from None
    with client:
        yield client


def _gone(distributed: Any) -> tuple[type[BaseException], ...]:
    """What is raised where the scheduler is no more."""
    from concurrent.futures import CancelledError

    return CancelledError, distributed.comm.CommClosedError
