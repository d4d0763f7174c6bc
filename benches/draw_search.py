"""Measures exact search from 1,000 to 10,000,000 rows, near the data and far from it, and draws the curves.

python benches/draw_search.py docs/images/search_rows.svg [most rows]

Each point is the median over rounds of the mean time of a query in a batch on one thread; SciPy and FAISS
answer fewer queries, up to 1,000,000 rows.
"""

from __future__ import annotations

import gc
import json
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import vl_convert
from numpy.typing import NDArray

from gmr import _core
from gmr.bench.harness import one_core
from gmr.bench.peers import find_peers, label
from gmr.bench.search_inputs import feature_rows, hard_queries, near_queries

COUNTS = (1_000, 10_000, 79_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
MOST_FOR_PEERS = 1_000_000
QUERIES = 2_000

Floats = NDArray[np.float32]


def microseconds(search: Callable[[Floats], object], asked: Floats) -> float:
    """Mean time of a query, the median of five rounds."""
    search(asked)
    rounds = []
    for _ in range(5):
        begun = time.perf_counter()
        search(asked)
        rounds.append(time.perf_counter() - begun)
    return statistics.median(rounds) / len(asked) * 1e6


def searches(features: Floats) -> Iterator[tuple[str, Callable[[Floats], object], int]]:
    """The contestants by name, and how many queries each is asked."""
    begun = time.perf_counter()
    index = _core.Index(features)
    print(f"index of {len(features):,} rows built in {time.perf_counter() - begun:.3f} s")
    yield "gmr", lambda asked: index.search(asked, threads=1), QUERIES
    if len(features) > MOST_FOR_PEERS:
        return
    peers = find_peers("scipy", "faiss")
    few = max(10, min(QUERIES, 20_000_000 // len(features)))
    if "scipy" in peers:
        from scipy.spatial import cKDTree

        tree = cKDTree(features)
        yield label("scipy") + " cKDTree", lambda asked: tree.query(asked, workers=1), few
    if "faiss" in peers:
        peers["faiss"].omp_set_num_threads(1)
        flat = peers["faiss"].IndexFlatL2(features.shape[1])
        flat.add(features)
        yield label("faiss") + " Flat", lambda asked: flat.search(asked, 1), few


def measured(most: int) -> Iterator[dict[str, Any]]:
    for count in (count for count in COUNTS if count <= most):
        rows = feature_rows(count)
        asked = {"near the data": near_queries(rows, QUERIES), "hard": hard_queries(rows, QUERIES)}
        for name, search, few in searches(rows.features):
            for kind, queries in asked.items():
                cost = microseconds(search, queries[:few])
                print(f"{count:>10,} rows, {kind}, {name}: {cost:.1f} us a query", flush=True)
                yield {"rows": count, "queries": kind, "search": name, "cost": cost}
        del rows
        gc.collect()


def chart(values: list[dict[str, Any]]) -> dict[str, Any]:
    """Vega-Lite description of the curves."""
    log = {"type": "log"}
    decades = [10.0**power for power in range(-1, 8)]
    dashes = {"field": "queries", "type": "nominal", "sort": ["near the data", "hard"]}
    return {
        "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
        "width": 520,
        "height": 300,
        "background": "white",
        "data": {"values": values},
        "layer": [
            {"mark": "line", "encoding": {"strokeDash": dashes}},
            {
                "mark": {"type": "point", "filled": True, "opacity": 1},
                "encoding": {"detail": {"field": "queries"}},
            },
        ],
        "encoding": {
            "x": {
                "field": "rows",
                "type": "quantitative",
                "scale": log,
                "title": "rows",
                "axis": {"values": decades, "format": "~s"},
            },
            "y": {
                "field": "cost",
                "type": "quantitative",
                "scale": log,
                "title": "microseconds a query, one thread",
                "axis": {"values": decades, "format": ",~g"},
            },
            "color": {
                "field": "search",
                "type": "nominal",
                "title": None,
                "sort": ["gmr"],
                "scale": {"range": ["#d55e00", "#0072b2", "#999999"]},
                "legend": {"symbolType": "stroke"},
            },
        },
    }


def main() -> None:
    most = int(sys.argv[2]) if len(sys.argv) > 2 else COUNTS[-1]
    with one_core():
        values = list(measured(most))
    Path(sys.argv[1]).write_text(vl_convert.vegalite_to_svg(json.dumps(chart(values))), encoding="utf-8")


if __name__ == "__main__":
    main()
