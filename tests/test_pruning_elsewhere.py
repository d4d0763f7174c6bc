"""Trials on other processes and on a cluster have the bits of those in one process, whoever dies."""

from __future__ import annotations

import pickle
from collections.abc import Iterator, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gmr
from clusters import Cluster, cluster
from gmr.cli.commands import gmr as command
from gmr.cli.common import finished
from gmr.evaluation import Evaluation
from gmr.evaluation.elsewhere import Runs
from gmr.matching.trial import TrialLog, run_trials
from gmr.pruning import Pruning, prune
from gmr.pruning.outcomes import Outcomes
from gmr.pruning.rerun import Again, elsewhere
from locomotion import Arc
from walker import write_walkers

WALKS = {f"{speed:g}_{turn:g}.bvh": Arc(4.0, speed, turn) for speed in (1.0, 2.0) for turn in (0.0, 40.0)}
GRID: dict[str, Any] = {"speeds": (1.0, 2.0), "turn_rates_deg": (-40.0, 0.0, 40.0)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    top = tmp_path_factory.mktemp("takes")
    write_walkers(top, WALKS)
    return top


@pytest.fixture(scope="module")
def found(folder: Path) -> Evaluation:
    return gmr.evaluate(folder, **GRID)


@pytest.fixture(scope="module")
def pruned(found: Evaluation) -> Pruning:
    return prune(found, "20%", until=0.3)


def bits(log: TrialLog) -> dict[str, bytes]:
    values = {field.name: getattr(log, field.name) for field in fields(log)}
    return {name: each.tobytes() for name, each in values.items() if isinstance(each, np.ndarray)}


def assert_same(one: Evaluation, other: Evaluation) -> None:
    assert one.tables() == other.tables()
    assert one.simulation is not None
    assert other.simulation is not None
    for tracking, log in one.simulation.logs.items():
        assert bits(log) == bits(other.simulation.logs[tracking])
        assert log.profiles == other.simulation.logs[tracking].profiles


def assert_alike(one: Pruning, other: Pruning) -> None:
    assert one.importance == other.importance
    assert one.curve.table == other.curve.table
    assert [point.part for point in one.curve.points] == [point.part for point in other.curve.points]


def test_a_pickled_database_gives_the_same_bits(found: Evaluation) -> None:
    simulation = found.simulation
    assert simulation is not None
    database = simulation.database.subset(np.arange(len(simulation.database)) >= 241)
    again = pickle.loads(pickle.dumps(database))
    assert again.clip_names == database.clip_names
    one, other = (run_trials(each, simulation.profiles) for each in (database, again))
    assert bits(one) == bits(other)
    assert (one.row >= 241).all()


def test_processes_give_the_bits_of_one(folder: Path, found: Evaluation) -> None:
    assert_same(found, gmr.evaluate(folder, workers=2, **GRID))


def test_a_cluster_gives_the_same_bits_though_a_worker_is_killed(
    folder: Path, tmp_path: Path, found: Evaluation, pruned: Pruning
) -> None:
    pytest.importorskip("distributed")
    with cluster(tmp_path) as held:
        assert_same(found, gmr.evaluate(folder, cluster=held.address, **GRID))
        assert_alike(pruned, prune(found, "20%", until=0.3, rerun=Killing(held)))
        assert held.workers[0].wait() != 0


class Killing:
    """Runs on a cluster of which a worker is killed after the first result."""

    def __init__(self, held: Cluster) -> None:
        self.held = held

    def __call__(self, asked: Runs, jobs: Sequence[Again]) -> Iterator[tuple[int, Outcomes | None]]:
        for result in elsewhere(cluster=self.held.address)(asked, jobs):
            yield result
            self.held.workers[0].kill()


def test_workers_are_not_counted_for_a_cluster_that_has_its_own(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["evaluate", str(folder), "--workers", "2", "--cluster", "tcp://far:8786", "--no-report"]
    assert finished(command, arguments) == 2
    assert "the cluster at tcp://far:8786 has workers of its own" in capsys.readouterr().err
