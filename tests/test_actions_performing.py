"""An action performed: cycles at their times, parameters at theirs, contacts and variations with them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from action_files import library_of, swinging
from gmr.actionlets import Action, Actionlet, Body, Performance, library
from gmr.actionlets.travel.plan import kinds
from gmr.errors import ActionletError

SHIPPED = tuple(library())
CYCLIC = ("walk", "run", "jog", "sneak", "march")
PARAMETERS = st.floats(0, 1)


def chosen(action: Action, share: float) -> dict[str, float]:
    return {name: p.low + share * (p.high - p.low) for name, p in action.parameters.items()}


def rising(performance: Performance, dof: str) -> np.ndarray:
    """Times at which a degree of freedom is at an extreme."""
    track = performance.score[dof]
    return track.times[(track.times > 0) & (track.times < track.duration)]


def test_extremes_come_once_a_period(tmp_path: Path) -> None:
    done = swinging(tmp_path)["swing"].perform({"speed": 2}, 5)
    times = rising(done, "left_hip.flexion")
    np.testing.assert_allclose(
        times, np.sort(np.concatenate([np.arange(5) + 0.1, np.arange(5) + 0.6])), atol=1e-6
    )
    angles = np.degrees(done.score["left_hip.flexion"].angle(times))
    np.testing.assert_allclose(angles, np.tile([-25, 40], 5), atol=1e-6)
    skews = [piece.skew for piece in done.score["left_hip.flexion"].pieces if isinstance(piece, Actionlet)]
    np.testing.assert_allclose(skews[1:3], [0.4, 0.5])


@given(speed=st.floats(0, 2), share=st.floats(0, 1))
def test_one_side_follows_the_other_half_a_period_later(speed: float, share: float) -> None:
    action = library()["walk"]
    done = action.perform({"speed": speed}, 6)
    period = float(action.unit.span.at({"speed": speed, "stride": 1.0}))  # type: ignore[attr-defined]
    t = share * (6 - period / 2)
    left = done.score.angles([t], ["left_knee.flexion", "left_hip.flexion", "left_shoulder.flexion"])
    right = done.score.angles(
        [t + period / 2], ["right_knee.flexion", "right_hip.flexion", "right_shoulder.flexion"]
    )
    np.testing.assert_allclose(left, right, atol=1e-6)


def test_arms_swing_against_the_legs() -> None:
    score = library()["walk"].perform(seconds=8).score
    times = np.linspace(0, 8, 500)
    arm, leg, other = score.angles(
        times, ["left_shoulder.flexion", "left_hip.flexion", "right_hip.flexion"]
    ).T
    assert np.corrcoef(arm, leg)[0, 1] < -0.7
    assert np.corrcoef(arm, other)[0, 1] > 0.7


@given(name=st.sampled_from(SHIPPED), share=PARAMETERS, seed=st.integers(0, 2**40), variation=st.floats(0, 1))
@settings(max_examples=60)
def test_every_performance_keeps_the_ranges_of_motion_and_its_velocity_is_continuous(
    name: str, share: float, seed: int, variation: float
) -> None:
    action = library()[name]
    done = action.perform(chosen(action, share), None, seed, variation)
    Body.of().check(done.score)
    for dof in done.score.dofs:
        track = done.score[dof]
        assert track.duration == pytest.approx(done.seconds)
        inner = track.times[1:-1]
        np.testing.assert_allclose(track.velocity(inner[(inner > 0) & (inner < done.seconds)]), 0, atol=1e-6)


@given(name=st.sampled_from(SHIPPED), share=PARAMETERS, seed=st.integers(0, 99), variation=st.floats(0, 1))
@settings(max_examples=40)
def test_contacts_are_apart_and_in_order(name: str, share: float, seed: int, variation: float) -> None:
    action = library()[name]
    done = action.perform(chosen(action, share), None, seed, variation)
    for spans in done.contacts.values():
        assert spans.shape[1] == 2
        assert (spans[:, 1] > spans[:, 0]).all()
        assert (spans[1:, 0] > spans[:-1, 1]).all()
        assert spans[0, 0] < done.seconds
        assert spans[-1, 1] > 0


def test_walking_always_has_a_foot_on_the_ground_and_running_has_not() -> None:
    times = np.linspace(0, 6, 2000)
    for name, flies in (("walk", False), ("sneak", False), ("march", False), ("run", True), ("jog", True)):
        done = library()[name].perform(seconds=6)
        down = [
            ((times[:, None] >= spans[:, 0]) & (times[:, None] <= spans[:, 1])).any(axis=1)
            for spans in done.contacts.values()
        ]
        assert (~(down[0] | down[1])).any() == flies, name


@given(speeds=st.lists(st.floats(0.3, 2.3), min_size=2, max_size=5))
def test_a_parameter_that_changes_is_followed_at_every_extreme(speeds: list[float]) -> None:
    seconds = 3.0 * len(speeds)
    points = list(zip(np.linspace(0, seconds, len(speeds)).tolist(), speeds, strict=True))
    done = library()["walk"].perform({"speed": points}, seconds)
    times = np.linspace(0, seconds, 40)
    asked = np.interp(times, done.speed[:, 0], done.speed[:, 1])
    assert asked.min() >= min(speeds) - 1e-6
    assert asked.max() <= max(speeds) + 1e-6
    np.testing.assert_allclose(np.interp([0, seconds], *done.speed.T), [speeds[0], speeds[-1]], atol=1e-6)
    steps = np.diff(rising(done, "left_knee.flexion")[::4])
    assert steps.min() > 0.7
    assert steps.max() < 1.6


def test_a_faster_walk_takes_more_and_longer_steps() -> None:
    slow, fast = (library()["walk"].perform({"speed": speed}, 20) for speed in (0.8, 1.8))
    assert len(fast.contacts["left"]) > len(slow.contacts["left"])
    assert 1.8 / len(fast.contacts["left"]) > 0.8 / len(slow.contacts["left"])


def test_a_stop_ends_at_rest_with_both_feet_down_and_a_start_begins_so() -> None:
    for name, at in (("stop", -1), ("start", 0)):
        done = library()[name].perform(seconds=5)
        assert np.abs(done.score.velocities([0.0 if at == 0 else 5.0])).max() < 1e-2
        assert done.speed[at, 1] == pytest.approx(0, abs=1e-9)
        assert done.speed[-1 - at, 1] == pytest.approx(1.3)
        for spans in done.contacts.values():
            begin, end = spans[at]
            assert begin <= (0 if at == 0 else 4.9)
            assert end >= (0.1 if at == 0 else 5)


def test_the_same_numbers_give_the_same_performance_and_others_another() -> None:
    action = library()["walk"]
    times = np.linspace(0, 4, 100)
    one, same, other = (
        action.perform(seconds=4, seed=seed, variation=0.5).score.angles(times, ["left_knee.flexion"])
        for seed in (7, 7, 8)
    )
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.01


@given(name=st.sampled_from(CYCLIC), seed=st.integers(0, 2**20), variation=st.floats(0.05, 1))
@settings(max_examples=30)
def test_a_variation_keeps_one_period_in_all_that_is_synchronised(
    name: str, seed: int, variation: float
) -> None:
    done = library()[name].perform(None, 8, seed, variation)
    periods = []
    for dof in done.score.dofs:
        track = done.score[dof]
        peaks = track.times[track.extremes >= track.extremes.max() - 1e-9]
        peaks = peaks[(peaks > 0.2) & (peaks < 7.8)]
        if np.ptp(track.extremes) > 1e-6 and len(peaks) > 2:
            periods.append(np.diff(peaks).mean() * round(np.diff(peaks).mean() / np.diff(peaks).min()))
    strikes = np.diff(done.contacts["left"][1:, 0]).mean()
    ratios = strikes / np.array(periods)
    np.testing.assert_allclose(ratios, np.round(ratios), atol=0.02)


@given(seed=st.integers(0, 2**20), variation=st.floats(0.05, 1))
@settings(max_examples=30)
def test_contacts_follow_the_phases_that_a_variation_moves(seed: int, variation: float) -> None:
    """The knee of a walk is bent most in the middle of the time between two contacts of its foot."""
    action = library()["walk"]
    done = action.perform(None, 10, seed, variation)
    track = done.score["left_knee.flexion"]
    peaks = track.times[track.extremes > track.extremes.max() - 1e-6]
    spans = done.contacts["left"]
    for lift, strike in zip(spans[:-1, 1], spans[1:, 0], strict=True):
        inside = peaks[(peaks > lift) & (peaks < strike)]
        assert len(inside) == 1
        assert 0.05 < (inside[0] - lift) / (strike - lift) < 0.6


def test_a_users_file_does_not_change_how_what_ships_varies(tmp_path: Path) -> None:
    alone, beside = (
        known["walk"].perform(seed=3, variation=0.4) for known in (library(), swinging(tmp_path))
    )
    assert alone.score == beside.score


def test_a_variation_takes_velocity_functions_of_the_same_type_from_the_library() -> None:
    done = library()["march"].perform(seconds=1, seed=1, variation=1).score["left_shoulder.flexion"]
    written = library()["march"].perform(seconds=1).score["left_shoulder.flexion"]
    skews = [[p.skew for p in track.pieces if isinstance(p, Actionlet)] for track in (done, written)]
    assert set(np.round(skews[1], 6)) == {0.5}
    assert np.abs(np.array(skews[0]) - 0.5).max() > 0.02


def test_a_variation_of_nothing_is_the_action_as_written() -> None:
    action = library()["run"]
    assert action.perform(seconds=3, seed=5).score == action.perform(seconds=3).score


def test_what_is_done_once_rests_afterwards(tmp_path: Path) -> None:
    action = swinging(tmp_path)["nod_once"]
    done = action.perform(seconds=4)
    assert np.degrees(done.score.angles([0.75], ["neck.flexion"])[0, 0]) == pytest.approx(30)
    np.testing.assert_allclose(done.score.angles(np.linspace(1.5, 4, 20), ["neck.flexion"]), 0, atol=1e-12)
    assert action.perform().seconds == pytest.approx(1.5)
    with pytest.raises(ActionletError, match=r"takes 1\.5 s with these parameters"):
        action.perform(seconds=1)


def test_labels_tile_the_time_that_their_phases_tile(tmp_path: Path) -> None:
    done = swinging(tmp_path)["swing"].perform({"speed": 2}, 3)
    assert [label for label, _, _ in done.phases] == ["first", "second"] * 3
    ends = np.array([row[1:] for row in done.phases])
    np.testing.assert_allclose(ends[1:, 0], ends[:-1, 1], atol=1e-6)
    assert (ends[0, 0], ends[-1, 1]) == pytest.approx((0, 3))


def test_a_sequence_is_continuous_and_goes_on_with_the_same_step() -> None:
    done = library()["walk_and_run"].perform()
    assert done.seconds == pytest.approx(5)
    times = np.linspace(0, 5, 50001)
    assert np.abs(np.diff(done.score.velocities(times), axis=0)).max() < 0.1
    for spans in done.contacts.values():
        assert np.diff(spans[:, 0]).min() > 0.4
    assert done.speed[0, 1] == pytest.approx(1.8)
    assert done.speed[-1, 1] == pytest.approx(2.2)


@pytest.mark.parametrize(("first", "then"), [(1.4, 2.0), (1.8, 2.2), (2.2, 3.0)])
def test_a_sequence_leaves_out_no_large_extreme(tmp_path: Path, first: float, then: float) -> None:
    """Knees bend to swing and ankles push off once a cycle, also in the cycle in which the gait changes."""
    steps = [
        f'{{ action = "{name}", seconds = 3, speed = {v} }}' for name, v in (("walk", first), ("run", then))
    ]
    text = f"format = 1\n[sequence.faster]\nactions = [{', '.join(steps)}]\n"
    score = library_of(text, tmp_path)["faster"].perform().score
    for side in ("left", "right"):
        for dof, largest in (("knee.flexion", 50.0), ("ankle.flexion", -10.0)):
            track = score[f"{side}_{dof}"]
            angles = np.degrees(track.extremes)
            swings = track.times[angles > largest if largest > 0 else angles < largest]
            assert np.diff(swings).max() < 1.2
            assert np.diff(swings).min() > 0.4


def test_a_sequence_goes_along_a_path_and_then_is_carried_by_its_feet() -> None:
    take = library()["walk_and_sit"].take(fps=60)
    (_, first), (seconds, then) = kinds(take.performance.travel)
    assert (first, then) == ("path", "feet")
    walked = round(seconds * 60)
    pelvis = take.motion.positions(joints=["pelvis"], dtype=np.float64)[:, 0]
    assert pelvis[walked, 2] - pelvis[0, 2] > 2
    assert pelvis[walked, 2] - pelvis[-1, 2] > 0.3  # it sits down behind its feet
    assert pelvis[walked, 1] - pelvis[-1, 1] > 0.3
    assert take.report.slide_mm < 1
    assert not take.report.beyond_deg


def test_more_time_for_a_sequence_goes_to_its_last_action() -> None:
    action = library()["walk_and_run"]
    name, begin, end = action.perform(seconds=9).phases[1]
    assert name == "run"
    assert 2.5 <= begin < 3.5
    assert end == pytest.approx(9)
    with pytest.raises(ActionletError, match="takes 5 s"):
        action.perform(seconds=4)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"parameters": {"sped": 1}}, "no parameter 'sped'. Did you mean speed"),
        ({"parameters": {"speed": 9}}, r"'speed' of 'walk' is 9 m/s; its range is 0 to 2\.3 m/s"),
        ({"parameters": {"speed": float("nan")}}, "is nan m/s"),
        ({"parameters": {"speed": [(0, 1), (0, 2)]}}, "with their seconds rising"),
        ({"parameters": {"speed": "fast"}}, "give a number"),
        ({"seconds": 0}, "more than 0"),
        ({"seconds": float("inf")}, "at most 36,000"),
        ({"variation": 2}, "a variation of 2 cannot be"),
    ],
)
def test_what_cannot_be_performed_is_refused(asked: dict[str, object], says: str) -> None:
    with pytest.raises(ActionletError, match=says):
        library()["walk"].perform(**asked)  # type: ignore[arg-type]


def test_limping_is_ten_lines(tmp_path: Path) -> None:
    text = """format = 1
[action.trudge]
from = "walk"
parameters.speed = { low = 0.3, high = 1.0, default = 0.6 }
dofs."waist.flexion" = { add = 15 }
"""
    known = library_of(text, tmp_path)
    walk, trudge = (known[name].perform({"speed": 0.6}, 3).score for name in ("walk", "trudge"))
    times = np.linspace(0, 3, 30)
    bent = trudge.angles(times, ["waist.flexion"]) - walk.angles(times, ["waist.flexion"])
    np.testing.assert_allclose(np.degrees(bent), 15, atol=1e-9)


@given(size=st.floats(0.5, 1.3), speed=st.floats(0.3, 1.5))
@settings(max_examples=15)
def test_bodies_of_other_sizes_walk_alike_where_their_froude_numbers_are(size: float, speed: float) -> None:
    """Times go with the root of the leg's length, and so do speeds."""
    root = float(np.sqrt(size))
    action = library()["walk"]
    one, other = (
        action.perform({"speed": speed}, 4),
        action.perform({"speed": speed * root}, 4 * root, size=size),
    )
    times = np.linspace(0, 4, 50)
    dofs = ["left_hip.flexion", "left_knee.flexion", "right_ankle.flexion", "waist.rotation"]
    np.testing.assert_allclose(
        other.score.angles(times * root, dofs), one.score.angles(times, dofs), atol=2e-3
    )
    for side, spans in one.contacts.items():
        inside = spans[(spans[:, 0] > 0) & (spans[:, 1] < 4)]
        np.testing.assert_allclose(
            [other.contacts[side][np.abs(other.contacts[side][:, 0] - root * a).argmin()] for a, _ in inside],
            root * inside,
            atol=1e-6,
        )
    assert other.speed[0, 1] == pytest.approx(speed * root)


def test_a_small_body_takes_more_steps_than_a_tall_one_at_the_same_speed_and_both_keep_it() -> None:
    small, tall = (library()["walk"].take(10, body=Body.of(height), speed=1.2) for height in (1.25, 1.95))
    steps = [len(take.performance.contacts["left"]) for take in (small, tall)]
    assert steps[0] > 1.15 * steps[1]
    for take in (small, tall):
        assert take.report.speed == pytest.approx(1.2, rel=0.03)
        assert take.report.feet_speed == pytest.approx(1.2, rel=0.15)


def test_the_beat_of_a_march_and_the_time_of_a_jump_do_not_follow_the_size() -> None:
    for name in ("march", "jump"):
        one, other = (library()[name].perform(size=size) for size in (1.0, 0.7))
        assert one.seconds == other.seconds
        for side in ("left", "right"):
            np.testing.assert_allclose(other.contacts[side], one.contacts[side], atol=1e-9)


TURNING = ("walk", "run", "jog", "sneak", "march")


@given(name=st.sampled_from(SHIPPED), share=PARAMETERS, seed=st.integers(0, 2**20), variation=st.floats(0, 1))
@settings(max_examples=25)
def test_however_it_varies_no_hip_twists(name: str, share: float, seed: int, variation: float) -> None:
    """A foot that leaves the ground on the tip of its toes points nowhere: hips once followed it by more than
    100 degrees."""
    action = library()[name]
    asked = {k: v for k, v in chosen(action, share).items() if k != "turn_rate" or name == "turn"}
    report = action.take(None, 60, seed, None, variation, **asked).report
    twists = [c for dof, c in report.corrections_deg.items() if dof.endswith("hip.rotation")]
    assert max(twists, default=0.0) < 40


@given(name=st.sampled_from(TURNING), share=PARAMETERS)
@settings(max_examples=25)
def test_planned_feet_pass_as_fast_as_is_asked(name: str, share: float) -> None:
    action = library()[name]
    low, high = {"walk": (0.9, 2.2), "sneak": (0.3, 1.0), "march": (0.5, 1.6)}.get(name, (1.6, 6.0))
    speed = min(low + share * (high - low), action.parameters["speed"].high)
    report = action.take(4, 60, speed=speed).report
    assert report.feet_speed == pytest.approx(speed, rel=0.12)


@given(height=st.floats(0.1, 0.5))
@settings(max_examples=12)
def test_a_jump_from_a_stand_comes_down_where_it_began(height: float) -> None:
    take = library()["jump"].take(height=height)
    root = take.carried.root
    assert np.linalg.norm((root[-1] - root[0])[::2]) < 0.04
    (flight,) = take.report.flights
    assert flight.end - flight.begin == pytest.approx(np.sqrt(8 * height / 9.81), abs=0.02)
