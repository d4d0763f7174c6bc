"""Jobs on processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Final, TypeVar

from gmr.cluster.interrupts import interrupts_held
from gmr.cluster.shared import WithShared, hold
from gmr.errors import GmrError

__all__ = ["on_processes"]

Job = TypeVar("Job")
Result = TypeVar("Result")

_AHEAD: Final = 2
"""Jobs on their way for each process, so that none waits for its next."""

_MOST_DEATHS: Final = 3
"""Times that processes may die while a job is on its way, before it is held to be the cause."""


def on_processes(
    work: Callable[..., Result], jobs: Sequence[Job], workers: int, shared: Any = None
) -> Iterator[tuple[int, Result]]:
    """See :func:`gmr.cluster.results`."""
    waiting = deque(range(len(jobs)))
    deaths = [0] * len(jobs)
    packed = None if shared is None else pickle.dumps(shared, pickle.HIGHEST_PROTOCOL)
    alone = work if shared is None else WithShared(work)
    while waiting:
        running: dict[Future[Result], int] = {}
        pool = _pool(workers, packed)
        try:
            while waiting or running:
                while waiting and len(running) < _AHEAD * workers:
                    with interrupts_held():  # a process is started by it
                        running[pool.submit(alone, jobs[waiting[0]])] = waiting[0]
                    waiting.popleft()
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    result = future.result()
                    yield running.pop(future), result
        except BrokenProcessPool:
            waiting.extendleft(sorted(running.values(), reverse=True))
            for number in running.values():
                deaths[number] += 1
            if max(deaths) >= _MOST_DEATHS:
                raise GmrError(
                    f"worker processes have died {_MOST_DEATHS} times over the same work, killed or out of "
                    "memory; ask for fewer workers, or less at a time"
                ) from None
        finally:
            pool.shutdown(cancel_futures=True)


def _pool(workers: int, shared: bytes | None) -> ProcessPoolExecutor:
    # Forking a process that has threads, as the core and NumPy start them, may copy a lock that is held.
    spawned = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(workers, mp_context=spawned, initializer=_begin, initargs=(shared,))


def _begin(shared: bytes | None) -> None:
    """What a worker does first: an interrupt is the command's to answer, and whose command is gone goes."""
    if shared is not None:
        hold("", shared)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    threading.Thread(target=_end_with_the_command, daemon=True).start()


def _end_with_the_command() -> None:
    command = multiprocessing.parent_process()
    assert command is not None
    command.join()
    os._exit(1)
