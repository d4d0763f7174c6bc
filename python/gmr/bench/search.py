"""Exact nearest-neighbour search in the features of real clips, against SciPy's and FAISS's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr import _core
from gmr.bench.harness import Contest
from gmr.bench.inputs import data_folder
from gmr.bench.peers import Peers, find_peers, label
from gmr.demo import demo_folder

__all__ = ["near_manifold", "off_manifold"]

Floats = NDArray[np.float32]

ROW_COUNT: Final = 79_000
QUERY_COUNT: Final = 1_000


def near_manifold(frame_count: int) -> Iterator[Contest]:
    """Queries as a controller makes them: the pose of a row, a future of a row close by, a little noise."""
    yield from _contests(frame_count, "near the manifold", reach=10, noise=0.05)


def off_manifold(frame_count: int) -> Iterator[Contest]:
    """Hard queries: the pose of one row with the future of any other."""
    yield from _contests(frame_count, "hard", reach=None, noise=0.0)


def _contests(frame_count: int, kind: str, *, reach: int | None, noise: float) -> Iterator[Contest]:
    row_count = min(ROW_COUNT, 4 * frame_count)
    features, is_trajectory = _features(row_count)
    queries = _queries(features, is_trajectory, reach, noise)
    index = _core.Index(features)
    peers = find_peers("scipy", "faiss")
    theirs: dict[str, Callable[[], object]] = {}
    if "scipy" in peers:
        theirs[label("scipy")] = _scipy_call(features, queries, index)
    if "faiss" in peers:
        theirs[label("faiss")] = _faiss_call(peers, features, queries)
    targets = {} if reach is None else {label("scipy"): 15.0, label("faiss"): 60.0}
    yield Contest(
        f"search of {len(features):,} rows of {features.shape[1]}, {kind}",
        "k queries/s",
        len(queries) / 1e3,
        lambda: index.search(queries, 1, threads=1),
        theirs,
        targets,
        peers.absent,
    )


@cache
def _features(row_count: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Scaled features of real clips and their mirror images, at the frame rate that gives so many rows."""
    motions = gmr.read_folder(data_folder("locomotion") or demo_folder())
    usual = gmr.matching.Database.build(motions, mirror=True)
    rate = min(1000.0, max(60.0, 60.0 * 1.02 * row_count / len(usual)))
    database = gmr.matching.Database.build(motions, mirror=True, rate=rate)
    return np.ascontiguousarray(database.features[:row_count]), database.is_trajectory


def _queries(features: Floats, is_trajectory: NDArray[np.bool_], reach: int | None, noise: float) -> Floats:
    """(Q, D): the pose of one row and the future of another, at most ``reach`` rows away (None: anywhere)."""
    random = np.random.default_rng(1)
    count = len(features)
    poses = random.integers(0, count, QUERY_COUNT)
    if reach is None:
        futures = random.integers(0, count, QUERY_COUNT)
    else:
        futures = np.clip(poses + random.integers(-reach, reach + 1, QUERY_COUNT), 0, count - 1)
    queries = np.where(is_trajectory, features[futures], features[poses])
    return np.ascontiguousarray(queries + noise * random.standard_normal(queries.shape), np.float32)


def _scipy_call(features: Floats, queries: Floats, index: _core.Index) -> Callable[[], object]:
    """SciPy's k-d tree, all queries in one call on one thread."""
    from scipy.spatial import cKDTree

    tree = cKDTree(features)
    distances, _ = tree.query(queries, workers=1)
    np.testing.assert_allclose(index.search(queries, 1)[0][:, 0], distances**2, rtol=1e-4, atol=1e-5)
    return lambda: tree.query(queries, workers=1)


def _faiss_call(peers: Peers, features: Floats, queries: Floats) -> Callable[[], object]:
    """FAISS's flat index, one thread and one query a call: a character's next query needs the last answer."""
    faiss: Any = peers["faiss"]
    faiss.omp_set_num_threads(1)
    flat = faiss.IndexFlatL2(features.shape[1])
    flat.add(features)
    return lambda: [flat.search(queries[i : i + 1], 1) for i in range(len(queries))]
