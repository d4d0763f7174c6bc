"""Exact nearest neighbours of motion-matching queries: index, peers, and how the cost grows with the rows."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.bench.harness import Contest
from gmr.bench.inputs import LARGE_FRAME_COUNT
from gmr.bench.peers import find_peers, label
from gmr.bench.search_inputs import (
    FeatureRows,
    dense_rows,
    feature_rows,
    hard_queries,
    near_queries,
)

__all__ = ["build", "calls", "growth", "hard", "near"]

Floats = NDArray[np.float32]
Search = Callable[[Floats], tuple[Floats, NDArray[np.int64]]]

LARGE_ROW_COUNT = 79_000
"""Rows that the speed targets speak of."""

TARGETS = {"scipy": 15.0, "faiss": 60.0}


def near(frame_count: int) -> Iterator[Contest]:
    """Searches 79,000 rows for queries as a controller makes them."""
    yield _contest(feature_rows(_row_count(frame_count)), "near", near_queries, TARGETS)


def hard(frame_count: int) -> Iterator[Contest]:
    """Searches 79,000 rows for what no body does."""
    yield _contest(feature_rows(_row_count(frame_count)), "hard", hard_queries, {})


def growth(frame_count: int) -> Iterator[Contest]:
    """Searches 1,000 to 1,000,000 rows: cost should grow far slower than the rows."""
    most = min(1_000_000, 28 * frame_count)
    for count in (1_000, 10_000, 100_000, 1_000_000):
        if count > most:
            break
        rows = feature_rows(count)
        yield _contest(rows, "near", near_queries, {})
        yield _contest(rows, "hard", hard_queries, {})
    yield _contest(dense_rows(most), "near", near_queries, {})


def calls(frame_count: int) -> Iterator[Contest]:
    """One query a call from Python, as an interactive program asks; the slowest calls are told too."""
    rows = feature_rows(_row_count(frame_count))
    searches, absent = _searches(rows.features)
    asked = near_queries(rows, 2_000)
    single = [asked[i : i + 1] for i in range(len(asked))]
    ours = searches.pop("")
    p50, p99 = np.percentile([_seconds(ours, query) for query in single for _ in range(2)], [50, 99])

    def call_each(search: Search, asked: list[Floats]) -> Callable[[], object]:
        return lambda: [search(query) for query in asked]

    yield Contest(
        work=f"search, one query a call: p50 {p50 * 1e6:.1f}, p99 {p99 * 1e6:.1f} us",
        unit="k queries/s",
        amount=len(single) / 1e3,
        ours=call_each(ours, single),
        peers={name: call_each(search, single[:100]) for name, search in searches.items()},
        peer_amount=0.1,
        absent=absent,
    )


def build(frame_count: int) -> Iterator[Contest]:
    """Builds the index."""
    peers = find_peers("scipy")
    for count in (_row_count(frame_count), 28 * frame_count):
        rows = feature_rows(min(count, 1_000_000)).features
        yield Contest(
            work=f"index of {len(rows):,} rows, built",
            unit="M rows/s",
            amount=len(rows) / 1e6,
            ours=lambda rows=rows: _core.Index(rows),  # type: ignore[misc]
            peers={label("scipy"): lambda rows=rows: _tree(rows)} if "scipy" in peers else {},  # type: ignore[misc]
            absent=peers.absent,
        )


def _row_count(frame_count: int) -> int:
    return LARGE_ROW_COUNT if frame_count >= LARGE_FRAME_COUNT else 2 * frame_count


def _contest(
    rows: FeatureRows, kind: str, make: Callable[[FeatureRows, int], Floats], targets: dict[str, float]
) -> Contest:
    """A batch of queries on one thread: more than caches hold for gmr, fewer for peers that take long."""
    count = len(rows.features)
    asked = make(rows, 4_000)
    theirs = asked[: 100 if count > 200_000 else 1_000]
    searches, absent = _searches(rows.features)
    _check_same_answers(searches, theirs)
    ours = searches.pop("")
    return Contest(
        work=f"search of {count:,} rows ({rows.source}), {kind}",
        unit="k queries/s",
        amount=len(asked) / 1e3,
        ours=lambda: ours(asked),
        peers={name: lambda search=search: search(theirs) for name, search in searches.items()},  # type: ignore[misc]
        peer_amount=len(theirs) / 1e3,
        targets={label(name): ratio for name, ratio in targets.items()},
        absent=absent,
    )


def _searches(features: Floats) -> tuple[dict[str, Search], dict[str, str]]:
    """gmr's search (named "") and the peers', each on one thread; and the peers that are missing."""
    peers = find_peers("scipy", "faiss")
    index = _core.Index(features)
    found: dict[str, Search] = {"": lambda asked: index.search(asked, threads=1)}
    if "scipy" in peers:
        tree = _tree(features)
        found[label("scipy")] = lambda asked: _squared(*tree.query(asked, workers=1))
    if "faiss" in peers:
        faiss = peers["faiss"]
        faiss.omp_set_num_threads(1)
        flat = faiss.IndexFlatL2(features.shape[1])
        flat.add(features)
        found[label("faiss")] = lambda asked: flat.search(asked, 1)
    found["numpy"] = lambda asked: _numpy_search(features, asked)
    return found, peers.absent


def _tree(features: Floats) -> Any:
    from scipy.spatial import cKDTree

    return cKDTree(features)


def _squared(distances: NDArray[np.float64], frames: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    return np.square(distances).astype(np.float32), frames


def _numpy_search(features: Floats, asked: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Each query against every row, as one writes it in NumPy."""
    costs = np.empty(len(asked), np.float32)
    frames = np.empty(len(asked), np.int64)
    for i, query in enumerate(asked):
        difference = features - query
        all_costs = np.einsum("nd,nd->n", difference, difference)
        frames[i] = all_costs.argmin()
        costs[i] = all_costs[frames[i]]
    return costs, frames


def _check_same_answers(searches: dict[str, Search], asked: Floats) -> None:
    ours = searches[""](asked)[0].ravel()
    for name, search in searches.items():
        # FAISS expands the square, which cancels: its costs near zero keep few digits.
        np.testing.assert_allclose(np.ravel(search(asked)[0]), ours, rtol=1e-3, atol=1e-3, err_msg=name)


def _seconds(search: Search, query: Floats) -> float:
    begun = time.perf_counter()
    search(query)
    return time.perf_counter() - begun
