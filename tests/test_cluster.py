"""Jobs on processes and on a Dask cluster: every job once, whoever dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from functools import partial
from pathlib import Path

import pytest

import jobs
from clusters import cluster
from gmr import GmrError
from gmr.cluster import results, worker_count

NUMBERS = list(range(12))
SQUARES = [(number, number * number) for number in NUMBERS]


@pytest.mark.parametrize("workers", [1, 2])
def test_every_job_is_done_once_whatever_the_workers(workers: int) -> None:
    assert sorted(results(jobs.square, NUMBERS, workers=workers)) == SQUARES
    assert list(results(jobs.square, [], workers=workers)) == []


def test_jobs_are_shared_among_processes() -> None:
    assert len({process for _, process in results(jobs.process_of, NUMBERS, workers=2)}) == 2


def test_a_job_whose_process_is_killed_is_done_by_another(tmp_path: Path) -> None:
    work = partial(jobs.die_once, str(tmp_path))
    assert sorted(results(work, NUMBERS, workers=2)) == SQUARES
    assert (tmp_path / "died").exists()


@pytest.mark.parametrize("workers", [1, 2])
def test_what_jobs_share_is_given_to_each_and_sent_once(workers: int) -> None:
    found = sorted(results(jobs.scaled, NUMBERS, workers=workers, shared=jobs.Shared(3)))
    assert [result for _, (result, _) in found] == [3 * number for number in NUMBERS]
    assert {unpacked for _, (_, unpacked) in found} == {workers - 1}


def test_what_jobs_share_is_there_after_a_process_was_killed(tmp_path: Path) -> None:
    found = sorted(results(jobs.die_once_scaled, NUMBERS, workers=2, shared=(str(tmp_path), 5)))
    assert found == [(number, 5 * number * number) for number in NUMBERS]
    assert (tmp_path / "died").exists()


def test_a_job_that_kills_every_process_is_given_up() -> None:
    with pytest.raises(GmrError, match="have died 3 times over the same work"):
        list(results(jobs.die_always, NUMBERS, workers=2))


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_comes_back_in_its_own_words(workers: int) -> None:
    with pytest.raises(GmrError, match=r"^three\.bvh:3: no third$"):
        list(results(jobs.refuse_three, NUMBERS, workers=workers))


def test_closing_ends_the_work(tmp_path: Path) -> None:
    many = list(range(1000))
    with closing(results(partial(jobs.count, str(tmp_path)), many, workers=2)) as found:  # type: ignore[type-var]
        next(found)
    done = len(list(tmp_path.iterdir()))
    assert 0 < done < 100
    time.sleep(0.1)
    assert len(list(tmp_path.iterdir())) == done


def test_processes_end_with_the_command_that_is_killed(tmp_path: Path) -> None:
    program = (
        "import jobs; from functools import partial; from gmr.cluster import results\n"
        f"work = partial(jobs.count, {str(tmp_path)!r})\n"
        "if __name__ == '__main__':\n"
        "    for found in results(work, range(10000), workers=2): print(found, flush=True)"
    )
    paths = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": paths}
    ) as command:
        assert command.stdout is not None
        command.stdout.readline()
        os.kill(command.pid, signal.SIGKILL)
        command.stdout.read()  # ends when nobody is left who might write
    done = len(list(tmp_path.iterdir()))
    time.sleep(0.2)
    assert 0 < done == len(list(tmp_path.iterdir()))


BEGINNING = (
    "import jobs; from gmr.cluster import results\n"
    "if __name__ == '__main__':\n"
    "    shared = jobs.Shared(3, bytes(40_000_000))  # far more than a pipe holds\n"
    "    print(sorted(results(jobs.scaled_slowly, range({count}), workers=2, shared=shared)))"
)
ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")


@ON_LINUX
@pytest.mark.parametrize("seconds", [0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.9])
@pytest.mark.parametrize("which", [0, 1])
def test_a_process_that_is_killed_while_it_starts_costs_nothing(which: int, seconds: float) -> None:
    with begun(BEGINNING.format(count=40)) as command:
        process = workers_of(command, which + 1)[which]
        time.sleep(seconds)
        with suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
        out, err = command.communicate(timeout=60)
    assert (command.returncode, err) == (0, "")
    assert out == f"{[(number, 3 * number) for number in range(40)]}\n"


@ON_LINUX
@pytest.mark.parametrize("seconds", [0, 0.1, 0.3, 0.6])
def test_an_interrupt_ends_the_command_while_processes_start(seconds: float) -> None:
    with begun(BEGINNING.format(count=4000)) as command:
        workers_of(command, 1)
        time.sleep(seconds)
        command.send_signal(signal.SIGINT)
        out, err = command.communicate(timeout=60)  # ends when no worker is left either
    assert (out, command.returncode) == ("", -signal.SIGINT)
    assert err.count("Traceback") == 1
    assert err.endswith("KeyboardInterrupt\n")


@ON_LINUX
def test_processes_that_all_die_while_they_start_are_given_up() -> None:
    with begun(BEGINNING.format(count=4000)) as command:
        until = time.monotonic() + 60
        while command.poll() is None and time.monotonic() < until:
            for process in children(command.pid):
                with suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
        _, err = command.communicate(timeout=10)
    assert "worker processes have died 3 times over the same work" in err


@contextmanager
def begun(program: str) -> Iterator[subprocess.Popen[str]]:
    """The program; it and its workers are gone in the end, even where they hang."""
    paths = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    with subprocess.Popen(
        [sys.executable, "-c", program],
        text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=os.environ | {"PYTHONPATH": paths},
    ) as command:  # fmt: skip
        try:
            yield command
        finally:
            if command.poll() is None:
                for process in children(command.pid):
                    os.kill(process, signal.SIGKILL)
                command.kill()


def workers_of(command: subprocess.Popen[str], count: int) -> list[int]:
    """As soon as the command has so many worker processes."""
    until = time.monotonic() + 30
    while time.monotonic() < until:
        if len(found := children(command.pid)) >= count:
            return found
        time.sleep(0.002)
    raise AssertionError("the workers did not start")


def children(process: int) -> list[int]:
    """Worker processes of a process, in the order in which they were started."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
            if int(fields[1]) == process and b"spawn_main" in (folder / "cmdline").read_bytes():
                found.append((int(fields[19]), int(folder.name)))
    return [number for _, number in sorted(found)]


def test_a_program_ends_that_asks_for_no_more_results() -> None:
    program = (
        "import jobs; from gmr.cluster import results\n"
        "if __name__ == '__main__':\n"
        "    found = results(jobs.process_of, range(1000), workers=2)\n"
        "    next(found)"
    )
    with begun(program) as command:
        assert command.communicate(timeout=60) == ("", "")
    assert command.returncode == 0


def test_what_cannot_be_sent_back_is_said() -> None:
    with pytest.raises(Exception, match="lambda"):
        list(results(jobs.unsendable, NUMBERS, workers=2))


def test_an_error_that_cannot_be_sent_back_comes_in_words() -> None:
    with pytest.raises(RuntimeError, match="UnsendableError: no third"):
        list(results(jobs.refuse_unsendably, NUMBERS, workers=2))


def test_large_jobs_and_results_go_both_ways() -> None:
    many = [bytes([number]) * 5_000_000 for number in NUMBERS]
    assert sorted(results(jobs.turned, many, workers=2)) == [(n, many[n][::-1]) for n in NUMBERS]


def test_workers_are_counted_where_they_are_chosen() -> None:
    assert worker_count(3) == 3
    assert worker_count(None) == worker_count(0) == len(os.sched_getaffinity(0))
    assert worker_count(None, "tcp://far:8786") == 0
    with pytest.raises(ValueError, match="has workers of its own"):
        worker_count(2, "tcp://far:8786")
    with pytest.raises(ValueError, match="cannot be -1"):
        worker_count(-1)


def test_a_cluster_does_every_job_once_though_a_worker_is_killed(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    marks = tmp_path / "marks"
    marks.mkdir()
    many = list(range(150))
    shared = (str(marks), 7, bytes(9_000_000))  # sent in pieces; it outlives the worker that put it together
    with cluster(tmp_path) as held:
        found = []
        for result in results(jobs.count_scaled, many, cluster=held.address, shared=shared):
            found.append(result)
            if len(found) == 40:
                held.workers[0].kill()
        assert sorted(found) == [(number, 7 * number * number) for number in many]
        with pytest.raises(GmrError, match=r"^three\.bvh:3: no third$"):
            list(results(jobs.refuse_three, NUMBERS, cluster=held.address))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense", "http://127.0.0.1:1"])
def test_an_address_where_no_scheduler_answers_is_said(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("gmr.cluster.on_dask._ANSWER", 1)
    with pytest.raises(GmrError, match=f"no Dask scheduler answers at '{address}'.*'local'"):
        list(results(jobs.square, NUMBERS, cluster=address))


def test_a_cluster_without_workers_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("gmr.cluster.on_dask._PATIENCE", 0.5)
    with cluster(tmp_path, workers=0) as held, pytest.raises(GmrError, match=r"no worker for 0\.5 s"):
        list(results(jobs.square, NUMBERS, cluster=held.address))


def test_without_the_package_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(GmrError, match=r"gmr-motion\[cluster\]"):
        list(results(jobs.square, NUMBERS, cluster="local"))
