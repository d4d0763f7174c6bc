"""Searches with weights, tags, limits and exclusions find what brute force finds; costs tell their parts."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from gmr.errors import DatasetError
from gmr.matching import LOCOMOTION, Database
from walkers import walker

DATABASE = Database.build(
    [walker(3.0, 1.2, 0.4, name="curve"), walker(2.0, 2.5, -0.2, swing=0.8, name="run")],
    tags={"curve": 1, "run": 3},
)

Floats = NDArray[np.float32]


def costs_of(query: Floats, weights: Floats) -> Floats:
    """(N,) what each row costs: dimension after dimension, each step rounded to float32."""
    costs = np.zeros(len(DATABASE), np.float32)
    for number, weight in enumerate(weights):
        difference = query[number] - DATABASE.features[:, number]
        costs += weight * (difference * difference)
    return costs


def found_by_hand(
    costs: Floats, k: int, tags: int, exclude: tuple[int, int], limit: float
) -> NDArray[np.int64]:
    rows = np.arange(len(costs))
    admitted = DATABASE.candidates & ((DATABASE.tags & tags) == tags) & (costs < np.float32(limit))
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
