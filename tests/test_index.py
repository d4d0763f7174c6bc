"""The index finds exactly what looking at every frame finds: index, cost, ties, tags, exclusion, limits."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from gmr import _core

Floats = NDArray[np.float32]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Case:
    """A database and what is asked of it."""

    features: Floats
    candidates: NDArray[np.bool_]
    tags: NDArray[np.uint32]
    queries: Floats
    asked: NDArray[np.uint32]
    exclude: NDArray[np.uint32]
    max_cost: float
    k: int

    def search(self, threads: int) -> tuple[Floats, Ints]:
        index = _core.Index(self.features, self.candidates, self.tags)
        return index.search(self.queries, self.k, self.asked, self.exclude, self.max_cost, threads)


def make_case(kind: str, frame_count: int, dims: int, query_count: int, k: int, seed: int) -> Case:
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(frame_count, dims))
    if kind == "walk":
        rows = np.cumsum(rows, axis=0)
    elif kind == "whole":
        rows = np.round(rows)
    else:
        rows *= 10.0 ** rng.integers(-12, 12, size=(1, dims))
        rows[rng.random(frame_count) < 0.3] = rows[:1]
    features = rows.astype(np.float32)
    queries = np.zeros((query_count, dims), np.float32)
    if frame_count:
        queries = features[rng.integers(0, frame_count, query_count)]
        moved = rng.random(query_count) < 0.7
        queries[moved] += rng.normal(size=(int(moved.sum()), dims)).astype(np.float32)
    first = rng.integers(0, max(frame_count, 1), query_count)
    costs = squared_distances(features, queries[:1]).ravel()
    return Case(
        features,
        rng.random(frame_count) < 0.9,
        rng.integers(0, 8, frame_count).astype(np.uint32),
        queries,
        rng.choice([0, 0, 1, 2, 5], query_count).astype(np.uint32),
        np.stack([first, first + rng.integers(0, 41, query_count)], axis=1).astype(np.uint32),
        float(np.median(costs)) if len(costs) and rng.random() < 0.3 else np.inf,
        k,
    )


def squared_distances(features: Floats, queries: Floats) -> Floats:
    """Costs (Q, N): float32, the dimensions in order, each step rounded by itself."""
    costs = np.zeros((len(queries), len(features)), np.float32)
    for dimension in range(features.shape[1]):
        difference = queries[:, None, dimension] - features[None, :, dimension]
        costs += difference * difference
    return costs


def look_at_every_frame(case: Case) -> tuple[Floats, Ints]:
    """What the index must find: the k lowest (cost, frame) of the frames that are admitted."""
    costs = squared_distances(case.features, case.queries)
    frames = np.arange(len(case.features))
    admitted = case.candidates & (case.tags & case.asked[:, None] == case.asked[:, None])
    admitted &= (frames < case.exclude[:, :1]) | (frames >= case.exclude[:, 1:])
    admitted &= costs < np.float32(case.max_cost)
    found_costs = np.full((len(case.queries), case.k), np.inf, np.float32)
    found_frames = np.full((len(case.queries), case.k), -1, np.int64)
    for query, row in enumerate(costs):
        order = np.lexsort((frames, row))
        best = order[admitted[query][order]][: case.k]
        found_costs[query, : len(best)] = row[best]
        found_frames[query, : len(best)] = best
    return found_costs, found_frames


@given(
    kind=st.sampled_from(["walk", "whole", "skewed"]),
    frame_count=st.integers(0, 400),
    dims=st.integers(1, 80),
    k=st.integers(0, 9),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=120)
def test_the_index_finds_what_looking_at_every_frame_finds(
    kind: str, frame_count: int, dims: int, k: int, seed: int
) -> None:
    case = make_case(kind, frame_count, dims, query_count=50, k=k, seed=seed)
    costs, frames = look_at_every_frame(case)
    for threads in (1, 2):
        found_costs, found_frames = case.search(threads)
        np.testing.assert_array_equal(found_frames, frames)
        np.testing.assert_array_equal(found_costs.view(np.uint32), costs.view(np.uint32))


def test_ten_thousand_queries_of_many_frames_agree_with_brute_force_and_with_scipy() -> None:
    case = make_case("walk", 6000, 27, 10_000, 1, seed=5)
    everything = Case(
        case.features,
        np.ones(6000, np.bool_),
        case.tags,
        case.queries,
        np.zeros(10_000, np.uint32),
        np.zeros((10_000, 2), np.uint32),
        np.inf,
        1,
    )
    costs, frames = everything.search(threads=2)
    for block in range(0, 10_000, 500):
        expected = squared_distances(case.features, case.queries[block : block + 500])
        np.testing.assert_array_equal(frames[block : block + 500, 0], expected.argmin(axis=1))
        np.testing.assert_array_equal(costs[block : block + 500, 0], expected.min(axis=1))
    distances, _ = cKDTree(case.features.astype(np.float64)).query(case.queries.astype(np.float64))
    np.testing.assert_allclose(np.sqrt(costs[:, 0].astype(np.float64)), distances, rtol=1e-5, atol=1e-5)


@given(kind=st.sampled_from(["walk", "whole", "skewed"]), seed=st.integers(0, 2**32 - 1))
def test_costs_are_those_of_float64_but_for_rounding(kind: str, seed: int) -> None:
    case = make_case(kind, 300, 27, 40, 1, seed)
    index = _core.Index(case.features)
    costs, frames = index.search(case.queries)
    exact = ((case.queries[:, None].astype(np.float64) - case.features.astype(np.float64)) ** 2).sum(axis=2)
    rounding = 30 * float(np.finfo(np.float32).eps)
    found = np.take_along_axis(exact, frames, axis=1)
    np.testing.assert_allclose(costs, found, rtol=rounding, atol=1e-37)
    assert np.all(found[:, 0] <= exact.min(axis=1) * (1 + 2 * rounding) + 1e-37)


PROGRAM = """
import hashlib
from test_index import make_case
for kind in ("walk", "whole", "skewed"):
    for frame_count, dims in ((3000, 27), (700, 3), (200, 130)):
        costs, frames = make_case(kind, frame_count, dims, 300, 3, seed=frame_count).search(threads=1)
        print(hashlib.sha256(costs.tobytes() + frames.tobytes()).hexdigest())
"""


def test_every_instruction_set_gives_the_same_bits() -> None:
    def answers(isa: str) -> str:
        environment = {**os.environ, "GMR_ISA": isa, "PYTHONPATH": str(Path(__file__).parent)}
        command = [sys.executable, "-c", PROGRAM]
        return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout

    found = {isa: answers(isa) for isa in _core.instruction_sets()}
    assert len(found["scalar"].split()) == 9
    assert len(set(found.values())) == 1, found


def test_one_frame_and_no_frame() -> None:
    query = np.zeros((2, 3), np.float32)
    costs, frames = _core.Index(np.ones((1, 3), np.float32)).search(query, k=2)
    np.testing.assert_array_equal(frames, [[0, -1]] * 2)
    np.testing.assert_array_equal(costs, [[3.0, np.inf]] * 2)
    costs, frames = _core.Index(np.ones((0, 3), np.float32)).search(query)
    np.testing.assert_array_equal(frames, [[-1]] * 2)
    no_queries = _core.Index(np.ones((1, 3), np.float32)).search(query[:0], k=2)
    assert [found.shape for found in no_queries] == [(0, 2), (0, 2)]


def test_what_is_no_candidate_may_be_nan_and_is_never_found() -> None:
    features = np.zeros((4, 2), np.float32)
    features[1] = np.nan
    index = _core.Index(features, np.array([False, False, True, True]))
    assert (index.frame_count, index.candidate_count, index.dims) == (4, 2, 2)
    assert index.search(np.zeros((1, 2), np.float32), k=4)[1].tolist() == [[2, 3, -1, -1]]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda x: _core.Index(np.where(np.eye(4) > 0, np.nan, x).astype(np.float32)),
            "feature 0 of frame 0 is NaN",
        ),
        (lambda x: _core.Index(x[:, ::2]), "C-contiguous"),
        (lambda x: _core.Index(x[:, :0]), "0 dimensions"),
        (lambda x: _core.Index(x, np.ones(3, np.bool_)), "candidates holds 3 elements where 4 are needed"),
        (lambda x: _core.Index(x, None, np.ones(3, np.uint32)), "tags holds 3"),
        (lambda x: _core.Index(x).search(x[:, :3].copy()), "queries are of 3 numbers; this index is of 4"),
        (lambda x: _core.Index(x).search(x / np.float32(0)), "of query 0 is"),
        (lambda x: _core.Index(x).search(x, max_cost=np.nan), "NaN"),
        (lambda x: _core.Index(x).search(x, tags=np.zeros(3, np.uint32)), "tags holds 3 elements where 4"),
        (lambda x: _core.Index(x).search(x, exclude=np.zeros((3, 2), np.uint32)), "exclude holds 3"),
        (lambda x: _core.Index(x).search(x, exclude=np.zeros((4, 3), np.uint32)), "exclude has 3 columns"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*encountered in divide:RuntimeWarning")
def test_what_does_not_fit_is_refused_in_words(call: object, message: str) -> None:
    assert callable(call)
    with pytest.raises(ValueError, match=message):
        call(np.arange(16, dtype=np.float32).reshape(4, 4))


def test_more_hits_than_memory_holds_are_refused() -> None:
    with pytest.raises(MemoryError, match="ask for fewer"):
        _core.Index(np.ones((1, 1), np.float32)).search(np.ones((2, 1), np.float32), k=2**60)
