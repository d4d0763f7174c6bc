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

__all__ = ["build", "calls", "growth", "hard", "hard_among_many", "near", "near_among_many", "weighted"]

Floats = NDArray[np.float32]
Search = Callable[[Floats], tuple[Floats, NDArray[np.int64]]]

LARGE_ROW_COUNT = 79_000
"""Rows that the speed targets speak of."""

MANY_ROWS = 1_000_000
"""Rows of the larger case."""

TARGETS = {"scipy": 15.0, "faiss": 60.0}
TARGETS_AMONG_MANY = {"scipy": 80.0, "faiss": 300.0}


def near(frame_count: int) -> Iterator[Contest]:
    """Searches 79,000 rows for queries as a controller makes them."""
    yield _contest(feature_rows(_row_count(frame_count)), "near", near_queries, TARGETS)


def hard(frame_count: int) -> Iterator[Contest]:
    """Searches 79,000 rows for what no body does."""
    yield _contest(feature_rows(_row_count(frame_count)), "hard", hard_queries, {})


def near_among_many(frame_count: int) -> Iterator[Contest]:
    """Searches 1,000,000 rows for queries as a controller makes them."""
    yield _contest(feature_rows(_many(frame_count)), "near", near_queries, TARGETS_AMONG_MANY)


def hard_among_many(frame_count: int) -> Iterator[Contest]:
    """Searches 1,000,000 rows for what no body does."""
    yield _contest(feature_rows(_many(frame_count)), "hard", hard_queries, {})


def weighted(frame_count: int) -> Iterator[Contest]:
    """The same queries with weights of their own, beside those without: what weights cost."""
    rows = feature_rows(_row_count(frame_count))
    index = _core.Index(rows.features)
    for kind, make in (("near", near_queries), ("hard", hard_queries)):
        asked = make(rows, 4_000)
        weights = np.random.default_rng(4).uniform(0.5, 1.5, asked.shape).astype(np.float32)
        yield Contest(
            work=f"search of {len(rows.features):,} rows ({rows.source}), {kind}, with weights",
            unit="k queries/s",
            amount=len(asked) / 1e3,
            ours=lambda asked=asked, weights=weights: index.search(asked, threads=1, weights=weights),  # type: ignore[misc]
            peers={"gmr, without weights": lambda asked=asked: index.search(asked, threads=1)},  # type: ignore[misc]
        )


def growth(frame_count: int) -> Iterator[Contest]:
    """Searches 1,000 to 1,000,000 rows: cost should grow far slower than the rows."""
    most = _many(frame_count)
    for count in (1_000, 10_000, 100_000, 1_000_000):
        if count > most:
            break
        rows = feature_rows(count)
        yield _contest(rows, "near", near_queries, {})
        yield _contest(rows, "hard", hard_queries, {})
    yield _contest(dense_rows(most), "near", near_queries, {})


def calls(frame_count: int) -> Iterator[Contest]:
    """One query a call from Python, as an interactive program asks; the slowest calls are told too."""
    for count in (_row_count(frame_count), _many(frame_count)):
        rows = feature_rows(count)
        searches, absent = _searches(rows.features)
        ours = searches.pop("")
        for kind, make in (("near", near_queries), ("hard", hard_queries)):
            asked = make(rows, 2_000)
            single = [asked[i : i + 1] for i in range(len(asked))]
            p50, p99 = np.percentile([_seconds(ours, query) for query in single for _ in range(2)], [50, 99])
            yield Contest(
                work=f"search of {count:,} rows, {kind}, one query a call: "
                f"p50 {p50 * 1e6:.1f}, p99 {p99 * 1e6:.1f} us",
                unit="k queries/s",
                amount=len(single) / 1e3,
                ours=_each(ours, single),
                peers={name: _each(search, single[:30]) for name, search in searches.items()},
                peer_amount=0.03,
                absent=absent,
            )


def build(frame_count: int) -> Iterator[Contest]:
    """Builds the index."""
    peers = find_peers("scipy")
    for count in (_row_count(frame_count), _many(frame_count)):
        rows = feature_rows(count).features
        yield Contest(
            work=f"index of {len(rows):,} rows, built",
            unit="M rows/s",
            amount=len(rows) / 1e6,
            ours=lambda rows=rows: _core.Index(rows, threads=1),  # type: ignore[misc]
            peers={label("scipy"): lambda rows=rows: _tree(rows)} if "scipy" in peers else {},  # type: ignore[misc]
            absent=peers.absent,
        )


def _each(search: Search, asked: list[Floats]) -> Callable[[], object]:
    return lambda: [search(query) for query in asked]


def _many(frame_count: int) -> int:
    return min(28 * frame_count, MANY_ROWS)


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
    peers = find_peers("hnswlib")
    if "hnswlib" in peers:
        graph = _graph(peers["hnswlib"], rows.features)
        recall = (graph(theirs)[0] <= ours(theirs)[0] * (1 + 1e-3) + 1e-3).mean()
        searches[f"{label('hnswlib')}, approximate, recall {recall:.3f}"] = graph
    absent |= peers.absent
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


def _graph(hnswlib: Any, features: Floats) -> Search:
    """An approximate search on one thread, as the library's own documentation sets it up."""
    index = hnswlib.Index(space="l2", dim=features.shape[1])
    index.init_index(max_elements=len(features), ef_construction=100, M=16, random_seed=1)
    index.set_num_threads(1)
    index.add_items(features)
    index.set_ef(64)

    def search(asked: Floats) -> tuple[Floats, NDArray[np.int64]]:
        frames, costs = index.knn_query(asked, k=1)
        return costs, frames

    return search


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
