"""What a corpus is asked to hold: each take follows from the seed, its action and its index alone."""

from __future__ import annotations

from collections import Counter
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gmr import GmrError
from gmr.actionlets.corpus import Plan, planned
from gmr.actionlets.corpus.choices import Drawn, Each, Fixed, choice, seed_of, share_of
from simple_actions import simple

numbers = st.floats(-1e6, 1e6).map(lambda value: value + 0.0)
names = st.sampled_from(["male", "female", "average"])
choices = (
    st.builds(Fixed, numbers | names)
    | st.lists(numbers, min_size=2, max_size=2, unique=True).map(lambda ends: Drawn(*sorted(ends)))
    | st.lists(numbers, min_size=2, max_size=5, unique=True).map(lambda values: Each(tuple(values)))
)


def plan(actions: str = "sway,nod", variations: int = 20, **asked: Any) -> Plan:
    return planned(simple(), actions.split(","), variations, **asked)


@given(choices)
def test_a_choice_reads_back_as_it_is_written(made: Fixed | Drawn | Each) -> None:
    assert choice(str(made), "speed") == made


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("1.2", Fixed(1.2)),
        ("0.8..1.6", Drawn(0.8, 1.6)),
        ("2..2", Fixed(2.0)),
        ("0.8, 1.2,1.6", Each((0.8, 1.2, 1.6))),
        ("0.8:1.6:0.2", Each((0.8, 1.0, 1.2, 1.4, 1.6))),
        ("male,female", Each(("male", "female"))),
    ],
)
def test_a_choice_is_one_value_a_range_or_several_in_turn(text: str, means: Any) -> None:
    assert choice(text, "it") == means


@pytest.mark.parametrize(
    "text",
    ["", "1,,2", "1,1", "2..1", "1..2..3", "a..b", "nan", "1..inf", "1:2", "1:2:0", "1:2:-1", "0:1e9:1"],
)
def test_what_is_no_choice_is_refused_in_a_sentence(text: str) -> None:
    with pytest.raises(GmrError, match=r"^speed: "):
        choice(text, "speed")


@given(st.integers(0, 2**63), st.text(max_size=8), st.integers(0, 10**9))
def test_shares_and_seeds_lie_where_they_must(seed: int, name: str, index: int) -> None:
    assert 0 <= share_of(seed, name, index) < 1
    assert 0 <= seed_of(seed, name, index) < 2**63
    assert share_of(seed, name, index) != share_of(seed, name, index + 1)


def test_shares_are_spread_evenly_over_the_indices_and_over_the_seeds() -> None:
    for shares in (
        np.array([share_of(1, "sway", index, "depth") for index in range(20_000)]),
        np.array([share_of(seed, "sway", 1, "depth") for seed in range(20_000)]),
    ):
        counts = np.histogram(shares, 20, (0, 1))[0]
        assert ((counts - 1000) ** 2 / 1000).sum() < 50  # chi square, 19 degrees of freedom: 1 in 10,000
        assert abs(np.corrcoef(shares[:-1], shares[1:])[0, 1]) < 0.03


@given(st.integers(0, 2**40), st.integers(1, 50), st.integers(1, 50), st.integers(0, 49))
def test_a_take_does_not_depend_on_how_many_there_are_or_which_others(
    seed: int, few: int, many: int, index: int
) -> None:
    index %= min(few, many)
    alone = plan("nod", few, seed=seed).order(index)
    among = plan("sway,nod", many, seed=seed).order(many + index)
    assert (alone.action, alone.index, alone.seed, alone.settings, alone.parameters) == (
        among.action, among.index, among.seed, among.settings, among.parameters
    )  # fmt: skip
    assert plan("nod", few, seed=seed).file(index) == plan("sway,nod", many, seed=seed).file(many + index)


def test_what_is_drawn_does_not_depend_on_what_else_is() -> None:
    free = plan(settings={"height": "1.5..1.9"}).order(5)
    held = plan(settings={"height": "1.5..1.9", "variation": "0.5"}, parameters={"depth": "6..7"}).order(5)
    assert free.settings["height"] == held.settings["height"]
    assert free.parameters["tempo"] == held.parameters["tempo"]
    assert free.parameters["depth"] != held.parameters["depth"]


def test_parameters_are_drawn_from_their_stated_ranges_where_nobody_says() -> None:
    many = plan("sway,nod", 300)
    for action, low, high in (("sway", 2.0, 10.0), ("nod", 5.0, 30.0)):
        depths = [o.parameters["depth"] for o in map(many.order, range(600)) if o.action == action]
        assert low <= min(depths) < low + 0.1 * (high - low)
        assert high - 0.1 * (high - low) < max(depths) <= high


def test_a_parameter_is_set_for_all_actions_or_for_one() -> None:
    made = plan(parameters={"nod.depth": "7", "tempo": "0.8..0.9", "sway.tempo": "default"})
    orders = list(map(made.order, range(len(made))))
    assert {o.parameters["depth"] for o in orders if o.action == "nod"} == {7.0}
    assert len({o.parameters["depth"] for o in orders if o.action == "sway"}) == 20
    assert {o.parameters["tempo"] for o in orders if o.action == "sway"} == {1.0}
    assert all(0.8 <= o.parameters["tempo"] <= 0.9 for o in orders if o.action == "nod")


def test_lists_give_all_their_combinations_equally_often() -> None:
    made = plan(
        "sway",
        36,
        settings={"sex": "male,female"},
        parameters={"depth": "3,4,5", "tempo": "1,2"},
    )
    seen = Counter(
        (o.settings["sex"], o.parameters["depth"], o.parameters["tempo"]) for o in map(made.order, range(36))
    )
    assert seen == dict.fromkeys(product(("male", "female"), (3.0, 4.0, 5.0), (1.0, 2.0)), 3)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"actions": "swya"}, "Did you mean sway"),
        ({"actions": "sway,sway"}, "'sway' is named twice"),
        ({"actions": "walk,walking"}, "'walk' is named twice, or by two of its names"),
        ({"variations": 0}, "0 variations cannot be"),
        ({"seed": -1}, "a seed of -1"),
        ({"fps": 0.0}, "0 frames a second"),
        ({"fps": float("nan")}, "nan frames a second"),
        ({"fps": 1e9}, "1e+09 frames a second"),
        ({"fps": 1e4, "settings": {"seconds": "1,36000"}}, "360,000,000 frames; 5,000,000 are the most"),
        ({"actions": "nod,sway", "variations": 6_000_000}, "12,000,000 takes; 10,000,000 are the most"),
        ({"format": "amc"}, "use one of gmrb, gmr, bvh, glb"),
        ({"body": "thin"}, "'detailed' and 'paper'"),
        ({"settings": {"seconds": "0"}}, "takes of 0.0 s cannot be"),
        ({"settings": {"seconds": "0..2"}}, "takes of 0.0 s cannot be"),
        ({"settings": {"seconds": "long"}}, "takes of long s cannot be"),
        ({"settings": {"variation": "0..2"}}, "a variation of 2.0 cannot be"),
        ({"settings": {"height": "1.5..9"}}, "9"),
        ({"settings": {"sex": "male,femal"}}, "femal"),
        ({"settings": {"hieght": "1.5"}}, "Did you mean height?"),
        ({"parameters": {"dpeth": "1"}}, "Did you mean depth?"),
        ({"parameters": {"swya.depth": "1"}}, "Did you mean sway?"),
        ({"parameters": {"sway.dpeth": "1"}}, "Did you mean depth?"),
        ({"parameters": {"depth": "4..6"}}, "depth of 'nod' cannot be 4 deg; it goes from 5 to 30 deg"),
        (
            {"parameters": {"sway.depth": "3,11"}},
            "depth of 'sway' cannot be 11 deg; it goes from 2 to 10 deg",
        ),
        ({"parameters": {"depth": "much"}}, "'much' is no number"),
    ],
)
def test_what_cannot_be_is_refused_before_any_work(asked: dict[str, Any], says: str) -> None:
    with pytest.raises(GmrError) as refused:
        plan(**asked)
    assert says in str(refused.value)


def test_plans_differ_in_what_was_asked_for_differently() -> None:
    one = plan(settings={"height": "1.5..1.9"})
    assert one.differences(one.to_json()) == []
    other = plan("sway", 30, settings={"seconds": "2"}, parameters={"depth": "3..4"})
    told = other.differences(one.to_json())
    assert "variations: 20 there, 30 asked for" in told
    assert "actions: sway, nod there, sway asked for" in told
    assert "parameters sway depth: 2..10 there, 3..4 asked for" in told
    assert "seconds: nothing there, 2 asked for" in told
    assert "height: 1.5..1.9 there, nothing asked for" in told
    with pytest.raises(ValueError, match="no plan"):
        one.differences("[]")
