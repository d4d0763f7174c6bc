"""The laws of joining, pasting, timing and mutation: nothing jumps, durations add up, periods are kept."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import gmr
from gmr.actionlets import (
    Actionlet,
    Measured,
    Score,
    Track,
    concatenate,
    insert,
    is_periodic,
    mutate,
    repeated,
    stretched,
    substituted,
    synchronise,
    variation,
)
from scores import assert_smooth, durations, measured, scores, shares, tracks

joins = st.sampled_from(["insert", "blend"])
periodic_tracks = st.builds(
    lambda track, share: synchronise(track, phase=share * track.duration), tracks(periodic=True), shares
)


def meets(one: Track, other: Track) -> bool:
    return abs(one.end - other.start) <= 1e-9 * max(1, abs(one.end))


@given(tracks(), tracks(), joins, durations)
def test_concatenation_is_smooth_and_durations_add_up(
    first: Track, second: Track, join: str, seconds: float
) -> None:
    found = concatenate(first, second, join, seconds)  # type: ignore[arg-type]
    assert_smooth(found)
    inserted = seconds if join == "insert" and not meets(first, second) else 0.0
    assert found.duration == pytest.approx(first.duration + second.duration + inserted)


@given(tracks(), tracks(), durations)
def test_an_inserted_transition_leaves_both_as_they_are(first: Track, second: Track, seconds: float) -> None:
    found = concatenate(first, second, "insert", seconds)
    t, u = np.linspace(0, first.duration, 40), np.linspace(0, second.duration, 40)
    np.testing.assert_allclose(found.angle(t), first.angle(t), atol=1e-6)
    np.testing.assert_allclose(found.angle(found.duration - second.duration + u), second.angle(u), atol=1e-6)


@given(tracks(), tracks(), durations)
def test_a_blend_meets_midway_and_leaves_what_is_far_from_the_seam(
    first: Track, second: Track, seconds: float
) -> None:
    found = concatenate(first, second, "blend", seconds)
    middle = (first.end + second.start) / 2
    assert float(found.angle(first.duration)) == pytest.approx(middle, abs=1e-6)
    for place, time in enumerate(first.times[:-1]):
        if time <= first.duration - seconds:
            assert found.extremes[place] == pytest.approx(first.extremes[place], abs=1e-9)
    for place, time in enumerate(second.times[1:], 1):
        if time >= seconds:
            assert found.extremes[len(first.pieces) + place] == pytest.approx(
                second.extremes[place], abs=1e-9
            )


@given(tracks(), tracks())
def test_tracks_that_meet_just_follow_each_other(first: Track, second: Track) -> None:
    shift = first.end - second.start
    there = Track(tuple(p.between(p.start + shift, p.end + shift) for p in second.pieces))
    for join in ("insert", "blend"):
        assert concatenate(first, there, join).pieces == (*first.pieces, *there.pieces)


@given(scores(whole=False), shares, joins)
def test_a_score_cut_in_two_is_whole_again(score: Score, share: float, join: str) -> None:
    time = (0.05 + 0.9 * share) * score.duration
    found = concatenate(
        score.excerpt(0, time),
        score.excerpt(time, score.duration),
        join,  # type: ignore[arg-type]
    )
    assert found.duration == pytest.approx(score.duration)
    assert found.piece_count <= score.piece_count + 2 * len(score.dofs)  # a silence may stay cut
    times = np.linspace(0, score.duration, 60)
    np.testing.assert_allclose(found.angles(times), score.angles(times), atol=1e-6)


@given(scores(whole=False), scores(whole=False), joins, durations)
def test_scores_cut_anywhere_are_joined_without_a_jump(
    first: Score, second: Score, join: str, seconds: float
) -> None:
    found = concatenate(first, second.renamed({"dof 0": "another"}), join, seconds)  # type: ignore[arg-type]
    assert set(found.dofs) == {*first.dofs, "another", *(set(second.dofs) - {"dof 0"})}
    for track in found.tracks.values():
        assert_smooth(track)
    if join == "insert" or all(track.is_whole for track in first.tracks.values()):
        times = np.linspace(0, first.duration, 30)
        if join == "insert":
            np.testing.assert_allclose(found.angles(times, first.dofs), first.angles(times), atol=1e-6)


@given(tracks(max_pieces=3), tracks(), shares, shares, shares)
def test_insertion_is_smooth_and_lengthens_by_the_cut(
    target: Track, source: Track, one: float, other: float, where: float
) -> None:
    begin, end = sorted((one * source.duration, other * source.duration))
    assume(end - begin > 1e-3)
    found = insert(target, source, (begin, end), where * target.duration)
    assert_smooth(found)
    assert found.duration == pytest.approx(target.duration + end - begin)
    np.testing.assert_allclose(found.velocity([0.0, found.duration]), 0, atol=1e-6)
    turns = int(((source.times > begin) & (source.times < end)).sum())
    assert len(found.pieces) == len(target.pieces) + turns


def test_insertion_is_that_of_the_paper_s_tables() -> None:
    source = Track((Actionlet(0.0, 0.9, 0.5, 0.3), Actionlet(0.9, 0.1, 0.7, 0.6)))
    target = Track((Actionlet(0.2, 0.4, 0.3), Actionlet(0.4, 1.0, 0.8, 0.4), Actionlet(1.0, 0.0, 0.6)))
    t_s2, begin, end, at = 0.5, 0.2, 0.9, 0.6
    t_t1, t_t2 = 0.3, 1.1
    found = insert(target, source, (begin, end), at)
    times = [0.0, t_t1, at + (t_s2 - begin), t_t2 + (end - begin), t_t2 + (end - begin) + 0.6]
    np.testing.assert_allclose(found.times, times)
    before, one, other, after = found.pieces
    ta1, sa2 = target.pieces[1], source.pieces[1]
    u = np.linspace(0, 1, 50)
    for made, pattern in ((one, ta1), (other, sa2)):
        np.testing.assert_allclose(made.velocity(u * made.duration), pattern.velocity(u * pattern.duration))
    assert before == target.pieces[0]
    assert after.travel == pytest.approx(target.pieces[2].travel)
    assert (after.duration, after.skew) == (0.6, 0.5)  # type: ignore[union-attr]


@given(tracks(max_pieces=2), tracks())
def test_all_instants_of_rest_in_the_cut_are_pasted(target: Track, source: Track) -> None:
    slack = 1e-3
    assume(min(source.pieces[0].duration, source.pieces[-1].duration) > 2 * slack)
    found = insert(target, source, (slack, source.duration - slack), target.duration / 2)
    inner = [piece.duration for piece in source.pieces[1:-1]]
    place = int(np.searchsorted(target.times, target.duration / 2)) - 1
    if len(source.pieces) > 1:
        pasted = found.pieces[place + 1 : place + 1 + len(inner)]
        assert [p.duration for p in pasted] == inner
        np.testing.assert_allclose(
            [p.travel for p in pasted], [p.travel for p in source.pieces[1:-1]], atol=1e-9
        )


@given(scores(whole=False), scores(), shares)
def test_insertion_into_a_score_is_smooth_in_all_dofs(target: Score, source: Score, where: float) -> None:
    cut = (0.1 * source.duration, 0.8 * source.duration)
    found = insert(target, source, cut, where * target.duration)
    assert found.duration == pytest.approx(target.duration + 0.7 * source.duration)
    for track in found.tracks.values():
        assert_smooth(track)


@given(periodic_tracks, st.floats(0.2, 5), st.floats(-10, 10), shares)
def test_a_group_follows_as_the_equation_says(p: Track, scale: float, phase: float, share: float) -> None:
    q = synchronise(p, scale, phase)
    period = p.duration
    assert q.duration == pytest.approx(period / scale)
    t = share * q.duration
    assert float(q.angle(t)) == pytest.approx(float(p.angle((scale * t + phase) % period)), abs=1e-5)
    assert is_periodic(q)


@given(periodic_tracks, st.integers(1, 4), shares)
def test_repetition_goes_round_and_round(track: Track, count: int, share: float) -> None:
    found = repeated(track, count)
    assert found.duration == pytest.approx(count * track.duration)
    t = share * found.duration
    assert float(found.angle(t)) == pytest.approx(float(track.angle(t % track.duration)), abs=1e-5)
    assert_smooth(found)
    assert is_periodic(found)


@given(periodic_tracks, st.floats(-10, 10))
def test_going_on_by_a_phase_and_back_is_nothing(track: Track, phase: float) -> None:
    there = synchronise(synchronise(track, phase=phase), phase=-phase)
    t = np.linspace(0, track.duration, 50)
    np.testing.assert_allclose(there.angle(t), track.angle(t), atol=1e-5)


@given(tracks(whole=False), st.floats(0.1, 10))
def test_stretching_is_the_same_way_slower(track: Track, factor: float) -> None:
    found = stretched(track, factor)
    t = np.linspace(0, track.duration, 50)
    np.testing.assert_allclose(found.angle(t * factor), track.angle(t), atol=1e-6)
    np.testing.assert_allclose(found.velocity(t * factor) * factor, track.velocity(t), atol=1e-5)


amounts = st.one_of(st.just(1.0), shares)
seeds = st.integers(0, 2**32)


@given(scores(whole=False), amounts, seeds)
def test_a_mutation_is_smooth_and_keeps_directions_silences_and_ranges(
    score: Score, amount: float, seed: int
) -> None:
    reach = {name: track.extremes for name, track in score.tracks.items()}
    ranges = {name: (float(angles.min()), float(angles.max())) for name, angles in reach.items()}
    found = mutate(score, np.random.default_rng(seed), amount, ranges)
    assert found.dofs == score.dofs
    for name, track in found.tracks.items():
        assert_smooth(track)
        low, high = ranges[name]
        assert ((track.extremes >= low) & (track.extremes <= high)).all()
        for one, other in zip(score[name].pieces, track.pieces, strict=True):
            assert other.is_silence or not one.is_silence
            if abs(one.travel) > 1e-6:
                assert np.sign(one.travel) == np.sign(other.travel)


@given(scores(whole=False), seeds)
def test_a_mutation_by_nothing_changes_nothing(score: Score, seed: int) -> None:
    found = mutate(score, np.random.default_rng(seed), 0.0)
    times = np.linspace(0, score.duration, 50)
    np.testing.assert_allclose(found.angles(times), score.angles(times), atol=1e-6)


@given(tracks(periodic=True), shares, amounts, seeds, st.integers(1, 3))
def test_a_mutation_keeps_what_is_synchronised_so(
    leader: Track, share: float, amount: float, seed: int, cycles: int
) -> None:
    p = repeated(leader, cycles)
    score = Score({"hip": p, "knee": synchronise(p, phase=share * leader.duration)})
    found = mutate(score, np.random.default_rng(seed), amount)
    hip, knee = found["hip"], found["knee"]
    assert is_periodic(hip)
    assert is_periodic(knee)
    assert hip.duration == pytest.approx(knee.duration)
    # Where one is slower than before, so is the other: extremes at one instant stay at one instant.
    for time, new in zip(score["hip"].times, hip.times, strict=True):
        at_once = np.flatnonzero(np.abs(score["knee"].times - time) < 1e-9)
        np.testing.assert_allclose(knee.times[at_once], new, atol=1e-6)
    for old, new in ((score["hip"], hip), (score["knee"], knee)):
        assert (np.diff(new.times) > 0).all()
        assert len(old.times) == len(new.times)


@given(scores(), seeds)
def test_only_groups_share_their_times(score: Score, seed: int) -> None:
    assume(len(score.dofs) == 3)
    doubled = Score({**score.tracks, "like dof 0": score["dof 0"], "alone": score["dof 0"]})
    found = mutate(doubled, np.random.default_rng(seed), 0.5, groups=[["dof 0", "like dof 0"]])
    np.testing.assert_allclose(found["like dof 0"].times, found["dof 0"].times)
    if len(score["dof 0"].pieces) > 1:
        assert not np.allclose(found["alone"].times, found["dof 0"].times, rtol=1e-12, atol=1e-12)


@given(scores(), st.integers(0, 1000), st.integers(0, 50))
def test_a_variation_is_the_same_whatever_others_are_made(score: Score, seed: int, index: int) -> None:
    alone = variation(score, index, seed, 0.3)
    among = [variation(score, i, seed, 0.3) for i in (index + 1, index)][-1]
    assert alone == among
    other = variation(score, index + 1, seed, 0.3)
    assert other.duration != alone.duration


@given(scores(curves=False), st.lists(measured, min_size=1, max_size=3), seeds)
def test_a_substitution_keeps_extremes_and_takes_other_velocities(
    score: Score, others: list[Measured], seed: int
) -> None:
    found = substituted(score, dict.fromkeys(score.dofs, others), np.random.default_rng(seed))
    for name, track in found.tracks.items():
        np.testing.assert_allclose(track.extremes, score[name].extremes, atol=1e-9)
        np.testing.assert_allclose(track.times, score[name].times, atol=1e-9)
        for old, new in zip(score[name].pieces, track.pieces, strict=True):
            same_way = any(other.travel * old.travel > 0 for other in others)
            assert isinstance(new, Measured) == same_way


ONE = Track((Actionlet(0.0, 1.0, 1.0),))
ROUND = Track((Actionlet(0.0, 1.0, 1.0), Actionlet(1.0, 0.0, 1.0)))
NAN = float("nan")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: concatenate(ONE, ONE, "glue"), "'glue' is no way to join"),  # type: ignore[arg-type]
        (lambda: concatenate(ONE, ONE, seconds=0), "duration of a transition is 0"),
        (lambda: concatenate(ONE, Score({"a": ONE})), "a track and a score"),  # type: ignore[type-var]
        (lambda: insert(ONE, ONE, (0.6, 0.4), 0.5), "cut from 0.6 to 0.4 s"),
        (lambda: insert(ONE, ONE, (0.5, 1.4), 0.5), "cut from 0.5 to 1.4 s"),
        (lambda: insert(ONE, ONE, (0.5, NAN), 0.5), "time of the cut is nan"),
        (lambda: insert(ONE, ONE, (0.2, 0.4), 1.5), "inserted at 1.5 s"),
        (
            lambda: synchronise(Score({"knee": ONE})),
            "'knee' is not periodic: it begins and ends at 0",
        ),
        (lambda: synchronise(ROUND, scale=0), "scale of a synchronisation is 0"),
        (lambda: synchronise(ROUND, phase=NAN), "phase of a synchronisation is nan"),
        (lambda: repeated(ROUND, 0), "repeated 0 times"),
        (lambda: repeated(ROUND.excerpt(0.2, 1.0), 2), "not periodic"),
        (lambda: stretched(ONE, -1), "factor of a stretch is -1"),
        (lambda: mutate(Score({"a": ONE}), np.random.default_rng(0), 1.5), "amount of a mutation is 1.5"),
        (
            lambda: mutate(Score({"a": ONE}), np.random.default_rng(0), 0.1, {"a": (-0.5, 0.5)}),
            "'a' is at 57.2958 degrees after 1 s, its range is -28.6479 to 28.6479",
        ),
        (
            lambda: mutate(Score({"a": ONE}), np.random.default_rng(0), 0.1, groups=[["a"], ["a"]]),
            "'a' is in two groups",
        ),
        (lambda: mutate(Score({"a": ONE}), np.random.default_rng(0), 0.1, groups=[["b"]]), "no track 'b'"),
        (lambda: variation(Score({"a": ONE}), -1), "index of a variation is -1"),
        (lambda: Score({"a": ONE}).beside(Score({"a": ONE})), "both scores move 'a'"),
        (lambda: Score({"a": ONE, "b": ONE}).renamed({"a": "b"}), "two tracks would be named 'b'"),
    ],
)
def test_what_cannot_be_done_is_refused_in_words(make: Callable[[], object], words: str) -> None:
    with pytest.raises(gmr.ActionletError, match=words):
        make()


def test_what_follows_in_the_target_keeps_its_travels() -> None:
    target = Track((Actionlet(0, 1, 1), Actionlet(1, 0.2, 1), Actionlet(0.2, 0.7, 1)))
    found = insert(target, ROUND, (0.5, 1.5), 0.5)
    np.testing.assert_allclose(
        [p.travel for p in found.pieces[2:]], [p.travel for p in target.pieces[1:]], atol=1e-12
    )
    assert all(one.end == other.start for one, other in pairwise(found.pieces))
