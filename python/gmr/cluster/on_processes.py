"""Jobs on processes of this machine."""

from __future__ import annotations

import atexit
import multiprocessing
import os
import pickle
import signal
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection, wait
from typing import Any, Final, Generic, NoReturn, TypeVar

from gmr.cluster.interrupts import interrupts_held
from gmr.errors import GmrError

__all__ = ["on_processes"]

Job = TypeVar("Job")
Result = TypeVar("Result")

_MOST_DEATHS: Final = 3
"""Times that processes may die while they have a job, before it is held to be the cause."""


def on_processes(
    work: Callable[..., Result], jobs: Sequence[Job], workers: int, shared: Any = None
) -> Iterator[tuple[int, Result]]:
    """See :func:`gmr.cluster.results`."""
    team = _Team[Job, Result](work if shared is None else partial(work, shared), jobs, workers)
    # A program may end before it has asked for all results; it waits for its processes, and they for jobs.
    atexit.register(team.end)
    try:
        found: list[tuple[int, Result]] = []
        while found or team.has_jobs():
            team.give()  # first, so that no process waits until a result is dealt with
            yield from found
            found = team.hear()
    finally:
        team.end()
        atexit.unregister(team.end)


class _Team(Generic[Job, Result]):
    """Processes, each with one job at a time, and the jobs that wait for one.

    :class:`concurrent.futures.ProcessPoolExecutor` hangs when a process is killed while others are started:
    its own thread takes the pool down while this one adds to it. Here one thread does all, and no two
    processes share a pipe or a lock, so that one that is killed breaks nothing but its own link.
    """

    def __init__(self, work: Callable[[Job], Result], jobs: Sequence[Job], most: int) -> None:
        self._packed = pickle.dumps(work, pickle.HIGHEST_PROTOCOL)
        self._jobs = jobs
        self._most = most
        self._waiting = deque(range(len(jobs)))
        self._deaths = [0] * len(jobs)
        self._workers: list[_Worker] = []

    def has_jobs(self) -> bool:
        """Whether there are jobs whose result is not there."""
        return bool(self._waiting) or self._is_at_work()

    def give(self) -> None:
        """A job to each process that has none, after starting those that are missing."""
        idle = [worker for worker in self._workers if worker.job is None]
        for _ in range(min(len(self._waiting) - len(idle), self._most - len(self._workers))):
            with interrupts_held():
                self._workers.append(_Worker())
            idle.append(self._workers[-1])
        for worker in idle[: len(self._waiting)]:
            worker.job = self._waiting.popleft()
            packed = pickle.dumps(self._jobs[worker.job], pickle.HIGHEST_PROTOCOL)
            try:
                if not worker.has_work:
                    worker.link.send_bytes(self._packed)
                    worker.has_work = True
                worker.link.send_bytes(packed)
            except OSError:
                self._lose(worker)

    def hear(self) -> list[tuple[int, Result]]:
        """The results that are there, as soon as there are some or a process has died; none if all idle."""
        found: list[tuple[int, Result]] = []
        if not self._is_at_work():
            return found
        ready = wait([worker.link for worker in self._workers])
        for worker in [worker for worker in self._workers if worker.link in ready]:
            try:
                packed = worker.link.recv_bytes()
            except (EOFError, OSError):
                self._lose(worker)
                continue
            assert worker.job is not None
            number, worker.job = worker.job, None
            is_done, answer = pickle.loads(packed)
            if not is_done:
                error, where = answer
                raise error from RuntimeError(f"in a worker process\n{where}")
            found.append((number, answer))
        return found

    def end(self) -> None:
        """No process is left when this returns; what they are at they finish."""
        for worker in self._workers:
            worker.link.close()
        for worker in self._workers:
            worker.process.join()

    def _is_at_work(self) -> bool:
        return any(worker.job is not None for worker in self._workers)

    def _lose(self, worker: _Worker) -> None:
        """Leave a dead process behind; its job waits for another.

        Raises:
            GmrError: processes die again and again over that job.
        """
        self._workers.remove(worker)
        worker.link.close()
        worker.process.kill()
        worker.process.join()
        if worker.job is None:
            return
        self._waiting.appendleft(worker.job)
        self._deaths[worker.job] += 1
        if self._deaths[worker.job] >= _MOST_DEATHS:
            raise GmrError(
                f"worker processes have died {_MOST_DEATHS} times over the same work, killed or out of "
                "memory; ask for fewer workers, or less at a time"
            )


class _Worker:
    """A process.

    Attributes:
        link: where it takes the work, then jobs, and gives a result for each; broken when it dies.
        job: the number of the job that it has.
        has_work: whether it was given the work.
    """

    def __init__(self) -> None:
        # Forking a process that has threads, as the core and NumPy start them, may copy a lock that is held.
        spawned = multiprocessing.get_context("spawn")
        self.link, theirs = spawned.Pipe()
        # Only what fits a pipe's buffer: if the process is killed before it has read the rest, nothing tells.
        self.process = spawned.Process(target=_serve, args=(theirs,))
        self.process.start()
        theirs.close()  # it has the only one, else its death would not be seen
        self.job: int | None = None
        self.has_work = False


def _serve(link: Connection) -> None:
    """What a worker does: an interrupt is the command's to answer, and whose command is gone goes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    threading.Thread(target=_end_with_the_command, daemon=True).start()
    with suppress(EOFError, OSError):  # the command needs no more
        work = _unpacked(link.recv_bytes())
        while True:
            link.send_bytes(_answer(work, link.recv_bytes()))


def _unpacked(packed: bytes) -> Callable[[Any], Any]:
    """The work; where it is not to be had, one that says why, for any job."""
    try:
        return pickle.loads(packed)  # type: ignore[no-any-return]
    except Exception as error:
        return partial(_refuse, error)


def _refuse(error: Exception, job: object) -> NoReturn:
    raise error


def _answer(work: Callable[[Any], Any], job: bytes) -> bytes:
    """Whether a job could be done, and its result, or what was raised, and where."""
    try:
        return pickle.dumps((True, work(pickle.loads(job))), pickle.HIGHEST_PROTOCOL)
    except BaseException as error:  # a panic of the core is no Exception
        where = traceback.format_exc()
        try:
            packed = pickle.dumps((False, (error, where)), pickle.HIGHEST_PROTOCOL)
            pickle.loads(packed)  # some can be packed but not unpacked
        except Exception:
            instead = RuntimeError(where.splitlines()[-1])
            return pickle.dumps((False, (instead, where)), pickle.HIGHEST_PROTOCOL)
        return packed


def _end_with_the_command() -> None:
    command = multiprocessing.parent_process()
    assert command is not None
    command.join()
    os._exit(1)
