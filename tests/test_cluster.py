"""Jobs on processes and on a Dask cluster: every job once, whoever dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import closing
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
