"""Searches with weights, tags, limits and exclusions find what brute force finds; costs tell their parts."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from gmr import _core
from gmr.errors import DatasetError
from gmr.matching import LOCOMOTION, Database
from walkers import walker

DATABASE = Database.build(
    [walker(3.0, 1.2, 0.4, name="curve"), walker(2.0, 2.5, -0.2, swing=0.8, name="run")],
    tags={"curve": 1, "run": 3},
)

TIED = Database.build(
    [
        walker(2.0, 2.5, -0.2, swing=0.8, name="run"),
        walker(3.0, 1.2, 0.4, name="curve"),
        walker(2.0, 0.0, swing=0.0, name="still"),
        walker(3.0, 1.2, 0.4, name="curve once more"),
        walker(2.0, 2.5, -0.2, swing=0.8, name="run once more"),
    ],
    tags={"curve": 1, "still": 1, "curve once more": 3, "run once more": 2},
)
"""Two motions are there twice, with other tags, and one is the same in all its frames."""

Floats = NDArray[np.float32]


def costs_of(query: Floats, weights: Floats, features: Floats = DATABASE.features) -> Floats:
    """(N,) what each row costs: dimension after dimension, each step rounded to float32."""
    costs = np.zeros(len(features), np.float32)
    for number, weight in enumerate(weights):
        difference = query[number] - features[:, number]
        costs += weight * (difference * difference)
    return costs


def found_by_hand(
    costs: Floats, k: int, tags: int, exclude: tuple[int, int], limit: float, database: Database = DATABASE
) -> NDArray[np.int64]:
    """(k,) the cheapest rows that are admitted, of equals the lowest, then -1."""
    rows = np.arange(len(costs))
    admitted = database.candidates & ((database.tags & tags) == tags) & (costs < np.float32(limit))
    admitted &= (rows < exclude[0]) | (rows >= exclude[1])
    best = np.flatnonzero(admitted)[np.argsort(costs[admitted], kind="stable")][:k]
    return np.concatenate([best, np.full(k - len(best), -1)])


def weights_of(rng: np.random.Generator, kind: str) -> Floats:
    if kind == "none":
        return np.ones(27, np.float32)
    if kind == "whole":
        return rng.integers(0, 3, 27).astype(np.float32)
    return (rng.random(27) * 10.0 ** rng.integers(-3, 3, 27)).astype(np.float32)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["none", "whole", "wide"]),
    st.sampled_from([0, 1, 2]),
    st.integers(1, 5),
    st.sampled_from([np.inf, 20.0, 0.0]),
)
def test_a_search_finds_what_brute_force_finds(seed: int, kind: str, tags: int, k: int, limit: float) -> None:
    rng = np.random.default_rng(seed)
    query = DATABASE.features[rng.integers(len(DATABASE))] + rng.normal(0, 0.3, 27).astype(np.float32)
    weights = weights_of(rng, kind)
    start = int(rng.integers(len(DATABASE)))
    asked = None if kind == "none" else weights
    costs, rows = DATABASE.search(
        query, k, tags=tags, weights=asked, exclude=[[start, start + 40]], max_cost=limit
    )
    by_hand = costs_of(query, weights)
    expected = found_by_hand(by_hand, k, tags, (start, start + 40), limit)
    np.testing.assert_array_equal(rows[0], expected)
    np.testing.assert_array_equal(costs[0], np.where(expected < 0, np.inf, by_hand[expected]))


def test_rows_are_there_twice_and_many_times() -> None:
    """What the searches among equals stand on."""
    assert len(TIED.clip_names) == 5
    rows = TIED.features[TIED.candidates]
    _, how_often = np.unique(rows, axis=0, return_counts=True)
    assert set(how_often.tolist()) == {2, 61}
    assert how_often.sum() == len(rows)


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(["none", "whole", "wide", "few"]),
    st.sampled_from([0, 1, 2, 3]),
    st.integers(1, 9),
    st.booleans(),
)
def test_of_rows_that_cost_the_same_the_lowest_is_found(
    seed: int, kind: str, tags: int, k: int, limited: bool
) -> None:
    rng = np.random.default_rng(seed)
    away = rng.normal(0, 0.3, 27).astype(np.float32) * np.float32(rng.random() < 0.7)
    query = TIED.features[rng.integers(len(TIED))] + away
    if kind == "few":
        weights = np.zeros(27, np.float32)
        weights[rng.integers(27, size=2)] = 1.0
    else:
        weights = weights_of(rng, kind)
    by_hand = costs_of(query, weights, TIED.features)
    # A limit that many rows cost to the bit: none of them is below it.
    limit = float(rng.choice(by_hand[TIED.candidates])) if limited else np.inf
    start = int(rng.integers(len(TIED)))
    exclude = (start, start + int(rng.integers(120)))
    costs, rows = TIED.search(
        query,
        k,
        tags=tags,
        weights=None if kind == "none" else weights,
        exclude=[list(exclude)],
        max_cost=limit,
    )
    expected = found_by_hand(by_hand, k, tags, exclude, limit, TIED)
    np.testing.assert_array_equal(rows[0], expected)
    np.testing.assert_array_equal(costs[0], np.where(expected < 0, np.inf, by_hand[expected]))


@given(
    st.integers(0, 2**32 - 1), st.integers(1, 400), st.integers(1, 40), st.integers(1, 9), st.integers(1, 3)
)
def test_of_quantised_rows_that_cost_the_same_the_lowest_is_found(
    seed: int, row_count: int, dims: int, k: int, steps: int
) -> None:
    """Whole features, weights and queries: there are more rows than costs."""
    rng = np.random.default_rng(seed)
    rows = rng.integers(-steps, steps + 1, (row_count, dims)).astype(np.float32)
    rows[rng.random(row_count) < 0.3] = rows[0]
    tags = rng.integers(0, 4, row_count).astype(np.uint32)
    queries = rng.integers(-steps, steps + 1, (8, dims)).astype(np.float32)
    weights = rng.integers(0, 3, (8, dims)).astype(np.float32)
    asked = rng.integers(0, 4, 8).astype(np.uint32)
    found_costs, found = _core.Index(rows, None, tags).search(queries, k, asked, weights=weights)
    for number in range(8):
        costs = costs_of(queries[number], weights[number], rows)
        admitted = np.flatnonzero((tags & asked[number]) == asked[number])
        best = admitted[np.lexsort((admitted, costs[admitted]))][:k]
        none = k - len(best)
        assert found[number].tolist() == [*best.tolist(), *[-1] * none]
        assert found_costs[number].tolist() == [*costs[best].tolist(), *[np.inf] * none]


def test_each_query_may_have_weights_and_tags_of_its_own() -> None:
    queries = DATABASE.features[[3, 50, 190]] + np.float32(0.2)
    weights = np.random.default_rng(0).random((3, 27)).astype(np.float32)
    together = DATABASE.search(queries, 2, weights=weights, tags=[1, 0, 2])
    for number, tags in enumerate([1, 0, 2]):
        alone = DATABASE.search(queries[number], 2, weights=weights[number], tags=tags)
        np.testing.assert_array_equal(alone[0][0], together[0][number])
        np.testing.assert_array_equal(alone[1][0], together[1][number])


def test_a_cost_is_the_sum_of_its_groups() -> None:
    queries = DATABASE.features[[3, 50]] + np.float32(0.2)
    weights = LOCOMOTION.spread({"hips velocity": 3.0, "trajectory facing": 0.0})
    costs, rows = DATABASE.search(queries, 3, weights=weights)
    parts = DATABASE.costs_by_group(queries, rows, weights=weights)
    assert list(parts) == [group.name for group in LOCOMOTION.groups]
    assert (parts["trajectory facing"] == 0).all()
    np.testing.assert_allclose(np.sum(list(parts.values()), axis=0), costs, rtol=1e-5)
    hips = LOCOMOTION.slices()["hips velocity"]
    apart = DATABASE.features[rows][..., hips] - queries[:, None, hips]
    np.testing.assert_allclose(parts["hips velocity"], 3 * (apart**2).sum(axis=-1), rtol=1e-5)
    assert np.isnan(DATABASE.costs_by_group(queries[0], [[-1]])["hips velocity"]).all()


def test_what_cannot_be_asked_is_refused_in_words() -> None:
    query = DATABASE.features[0]
    with pytest.raises(ValueError, match=r"weight 2 of query 0 is -1; give a finite number, 0 or more"):
        DATABASE.search(query, weights=np.where(np.arange(27) == 2, -1, 1))
    with pytest.raises(ValueError, match="weights are of 3 numbers; this index is of 27"):
        DATABASE.search(query, weights=[1, 2, 3])
    with pytest.raises(ValueError, match="tags holds 2 elements where 1 are needed"):
        DATABASE.search(query, tags=[1, 2])
    with pytest.raises(ValueError, match="there is no row 5000"):
        DATABASE.costs_by_group(query, [[5000]])
    with pytest.raises(DatasetError, match="no feature group is called 'hip velocity'"):
        LOCOMOTION.spread({"hip velocity": 2})
