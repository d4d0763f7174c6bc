"""Laws of a body that travels: feet stand still on the ground, hips follow the path, flight falls freely."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from gaits import bell, gait, mirrored
from gmr import editing
from gmr.actionlets import Body, library, posing
from gmr.actionlets.travel import Carried, Plan, carried
from gmr.actionlets.travel.sole import yaw_of
from gmr.actionlets.travel.turns import about_y, pitched
from gmr.body.joints import find_joints
from gmr.editing.contacts import slide
from gmr.errors import ActionletError
from gmr.matching.root import root_track
from gmr.quaternions import rotated

Floats = NDArray[np.float64]

DETAILED, PAPER = Body.of(), Body.of(detailed=False)
STILL = np.array([[0.0, 0.0]])
few = settings(max_examples=20, deadline=None)

walks = st.tuples(st.floats(0.3, 2.5), st.floats(-np.pi, np.pi), st.just(False))
runs = st.tuples(st.floats(2.0, 5.0), st.floats(-np.pi, np.pi), st.just(True))


def travelled(body: Body, speed: float, turn_rate: float, running: bool, fps: float = 120.0) -> Carried:
    angles, plan = gait(body, speed, turn_rate, runs=running, fps=fps)
    return carried(body, angles, plan, fps)


def world(found: Carried) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Heels and toes in the world, by the kinematics of :mod:`gmr.actionlets.posing`."""
    body = found.body
    moving = posing.motion(body, found.angles, found.root, found.heading, found.fps)
    places = moving.positions(dtype=np.float64)
    turns = np.asarray(moving.joint_rotations(dtype=np.float64), np.float64)
    heels, toes = {}, {}
    for side in ("left", "right"):
        ankle = body.skeleton.names.index(f"{side}_ankle")
        heels[side] = places[:, ankle] + rotated(turns[:, ankle], np.array(body.foot.heel))
        toes[side] = places[:, body.skeleton.names.index(f"{side}_ankle_end")]
    return heels, toes


@given(st.one_of(walks, runs))
@few
def test_feet_on_the_ground_stand_still_and_none_is_below_it(asked: tuple[float, float, bool]) -> None:
    found = travelled(DETAILED, *asked)
    heels, toes = world(found)
    for side in ("left", "right"):
        assert min(heels[side][:, 1].min(), toes[side][:, 1].min()) > -1e-4
        for begin, end in found.plan.contacts[side].tolist():
            at = slice(max(int(np.ceil(begin * 120 - 1e-6)), 0), int(np.floor(end * 120 + 1e-6)) + 1)
            heel, toe = heels[side][at], toes[side][at]
            if end < 0 or len(heel) < 2:
                continue
            assert np.abs(np.minimum(heel[:, 1], toe[:, 1])).max() < 1e-6
            on_heel, on_toe = heel[:, 1] < 1e-6, toe[:, 1] < 1e-6
            for point, on in ((heel, on_heel), (toe, on_toe)):
                if on.any():
                    assert np.ptp(point[on], axis=0).max() < 1e-3
    assert found.report.slide_mm < 1
    assert found.report.lowest_mm > -0.1


@given(st.one_of(walks, runs))
@few
def test_speed_and_turn_rate_are_those_asked(asked: tuple[float, float, bool]) -> None:
    speed, turn_rate, _ = asked
    report = travelled(DETAILED, *asked).report
    assert report.speed == pytest.approx(speed, rel=0.03)
    assert report.turn_rate_deg == pytest.approx(np.degrees(turn_rate), abs=3)


@given(runs)
@few
def test_without_a_foot_on_the_ground_the_centre_of_mass_falls_freely(
    asked: tuple[float, float, bool],
) -> None:
    found = travelled(DETAILED, *asked)
    moving = posing.motion(DETAILED, found.angles, found.root, found.heading, 120)
    centre = posing.centre_of_mass(DETAILED, moving)
    assert found.report.flights
    for flight in found.report.flights:
        at = slice(round(flight.begin * 120) + 1, round(flight.end * 120))
        falls = np.diff(centre[at], 2, axis=0) * 120**2
        np.testing.assert_allclose(falls, np.broadcast_to([0, -9.81, 0], falls.shape), atol=0.1)
        assert flight.off_mm < 0.1


@given(st.one_of(walks, runs), st.sampled_from([DETAILED, PAPER]))
@few
def test_a_mirrored_plan_gives_the_mirrored_result(asked: tuple[float, float, bool], body: Body) -> None:
    speed, turn_rate, running = asked
    angles, plan = gait(body, speed, turn_rate, runs=running)
    one = carried(body, angles, plan)
    other = carried(body, *mirrored(body, angles, plan))
    np.testing.assert_allclose(other.angles, mirrored(body, one.angles, plan)[0], atol=1e-6)
    np.testing.assert_allclose(other.root, one.root * [-1, 1, 1], atol=1e-6)
    np.testing.assert_allclose(other.heading, -one.heading, atol=1e-9)


@given(st.one_of(walks, runs), st.floats(-5, 5))
@few
def test_when_it_begins_does_not_matter(asked: tuple[float, float, bool], later: float) -> None:
    speed, turn_rate, running = asked
    angles, plan = gait(DETAILED, speed, turn_rate, runs=running)
    shifted = dataclasses.replace(
        plan,
        contacts={side: times + later for side, times in plan.contacts.items()},
        speed=plan.speed + np.array([later, 0]),
        turn_rate=plan.turn_rate + np.array([later, 0]),
    )
    one, other = carried(DETAILED, angles, plan), carried(DETAILED, angles, shifted, start=later)
    np.testing.assert_allclose(other.angles, one.angles, atol=1e-9)
    np.testing.assert_allclose(other.root, one.root, atol=1e-9)


@given(st.one_of(walks, runs), st.sampled_from([DETAILED, PAPER]))
@few
def test_bones_keep_their_lengths_and_only_legs_are_corrected(
    asked: tuple[float, float, bool], body: Body
) -> None:
    speed, turn_rate, running = asked
    angles, plan = gait(body, speed, turn_rate, runs=running)
    found = carried(body, angles, plan)
    places = posing.motion(body, found.angles, found.root, found.heading).positions(dtype=np.float64)
    bones = body.skeleton.parents >= 0
    ways = places[:, bones] - places[:, body.skeleton.parents[bones]]
    lengths = np.linalg.norm(np.asarray(body.skeleton.offsets, np.float64)[bones], axis=1)
    np.testing.assert_allclose(
        np.linalg.norm(ways, axis=2), np.broadcast_to(lengths, ways.shape[:2]), atol=1e-6
    )
    legs = [name.split("_")[-1].startswith(("hip", "knee", "ankle")) for name in body.names]
    np.testing.assert_array_equal(found.angles[:, ~np.array(legs)], angles[:, ~np.array(legs)])
    assert np.isfinite(found.angles).all()
    assert np.isfinite(found.root).all()


@given(st.floats(0.5, 2.0), st.floats(-0.5, 0.5))
@few
def test_finer_frames_make_smaller_steps_of_velocity(speed: float, turn_rate: float) -> None:
    """C1: with four times the frames, velocities change by less from frame to frame."""
    steps = []
    for fps in (960.0, 3840.0):
        angles, plan = gait(DETAILED, speed, turn_rate, seconds=1.5, fps=fps)
        found = carried(DETAILED, angles, plan, fps)
        steps.append(np.abs(np.diff(found.angles, 2, axis=0)).max() * fps)
    assert steps[1] < 0.6 * steps[0]


def test_the_report_tells_how_fast_the_planned_feet_go() -> None:
    """A leg without knee that swings by the angle of a pendulum passes below the pelvis at l d(sin)/dt."""
    times = np.arange(121) / 120
    angles = np.zeros((121, DETAILED.dof_count))
    angles[:, DETAILED.column("left_hip.flexion")] = 0.2 - 0.4 * times
    angles[:, DETAILED.column("left_ankle.flexion")] = -(0.2 - 0.4 * times)
    found = carried(DETAILED, angles, Plan({"left": np.array([[0.0, 1.0]])}, np.array([[0.0, 0.3]]), STILL))
    length = -DETAILED.skeleton.offsets[
        [DETAILED.skeleton.names.index(f"left_{j}") for j in ("knee", "ankle")], 1
    ]
    assert found.report.feet_speed == pytest.approx(4 * np.sin(0.1) * length.sum(), rel=0.01)


def test_a_walk_is_a_walk_by_gmr_s_own_measures() -> None:
    found = travelled(DETAILED, 1.3, np.radians(30), False)
    moving = posing.motion(DETAILED, found.angles, found.root, found.heading, 120)
    toes = [f"{side}_ankle_end" for side in ("left", "right")]
    held = editing.contacts(moving, toes)
    asked = [one for side in ("left", "right") for one in found.plan.contacts[side].tolist()]
    inside = [(begin, end) for begin, end in asked if begin > 0.1 and end < 2.9]
    assert len(held) >= len(inside)
    up = np.array([0.0, 1.0, 0.0])
    places = moving.positions(dtype=np.float64)
    for contact in held:
        joint = DETAILED.skeleton.names.index(contact.joint)
        flat = places[contact.first : contact.end, joint]
        low = flat[flat[:, 1] < 1e-4]
        assert len(low)
        assert slide(low, up) < 1e-3
    track = root_track(moving, moving.positions(), find_joints(DETAILED.skeleton, moving.positions()), None)
    middle = slice(90, -90)
    speed = np.linalg.norm(np.diff(track.ground[middle], axis=0), axis=1).mean() * 120
    assert speed == pytest.approx(1.3, rel=0.03)
    turn_rate = np.degrees(np.diff(track.heading[middle]).mean() * 120)
    assert turn_rate == pytest.approx(30, abs=3)


def test_walking_the_pelvis_rises_once_a_step_by_some_centimetres() -> None:
    angles, plan = gait(DETAILED, 1.3, 0.0, seconds=6)
    found = carried(DETAILED, angles, plan)
    height = found.root[120:-120, 1]
    assert 0.02 < np.ptp(height) < 0.06
    steps = sum(
        120 <= begin * 120 < len(found.root) - 120 for one in plan.contacts.values() for begin, _ in one
    )
    smooth = np.convolve(height, np.ones(9) / 9, "valid")
    tops = ((smooth[1:-1] > smooth[:-2]) & (smooth[1:-1] >= smooth[2:])).sum()
    assert abs(tops - steps) <= 1


def test_a_body_starts_and_stops_with_its_feet_on_the_ground() -> None:
    angles, plan = gait(DETAILED, 1.2, 0.0, seconds=5)
    profile = np.array([[0.0, 0.0], [1.5, 1.2], [3.5, 1.2], [5.0, 0.0]])
    found = carried(DETAILED, angles, dataclasses.replace(plan, speed=profile))
    assert found.report.slide_mm < 1
    assert found.report.lowest_mm > -0.1
    assert found.report.speed == pytest.approx(found.report.speed_asked, rel=0.03)


def acted(tracks: dict[str, list[tuple[float, float]]], plan: Plan, body: Body = DETAILED) -> Carried:
    """A body that acts on planted feet for 3 seconds."""
    times = np.arange(361) / 120
    angles = np.zeros((361, body.dof_count))
    for name, points in tracks.items():
        for one in (name,) if name in body.columns else (f"left_{name}", f"right_{name}"):
            if one in body.columns:
                angles[:, body.column(one)] = bell(times, points)
    return carried(body, angles, plan)


BOTH = {side: np.array([[0.0, 3.0]]) for side in ("left", "right")}


@pytest.mark.parametrize("body", [DETAILED, PAPER])
def test_standing_still_stays_where_it_is(body: Body) -> None:
    found = acted({}, Plan(BOTH, STILL, STILL, "feet"), body)
    np.testing.assert_allclose(found.root, np.broadcast_to(found.root[0], found.root.shape), atol=1e-9)
    assert max(found.report.corrections_deg.values(), default=0) < 4


def test_squatting_feet_stay_and_hips_go_down() -> None:
    squat = {
        "hip.flexion": [(0.0, 0.0), (1.4, 100), (1.6, 100), (3.0, 0)],
        "knee.flexion": [(0.0, 0.0), (1.4, 110), (1.6, 110), (3.0, 0)],
        "ankle.flexion": [(0.0, 0.0), (1.4, 10), (1.6, 10), (3.0, 0)],
    }
    found = acted(squat, Plan(BOTH, STILL, STILL, "feet"))
    heels, toes = world(found)
    for point in (*heels.values(), *toes.values()):
        assert np.ptp(point, axis=0).max() < 1e-4
    assert found.root[180, 1] < found.root[0, 1] - 0.4
    knee = DETAILED.column("left_knee.flexion")
    assert np.degrees(found.angles[180, knee]) == pytest.approx(110, abs=1)


def test_jumping_both_feet_leave_and_the_body_flies() -> None:
    jump = {
        "hip.flexion": [(0.0, 0.0), (0.8, 70), (1.25, 0), (1.85, 50), (2.8, 0)],
        "knee.flexion": [(0.0, 0.0), (0.8, 90), (1.25, 8), (1.85, 70), (2.8, 0)],
        "ankle.flexion": [(0.0, 0.0), (0.8, 18), (1.25, -40), (1.85, 15), (2.8, 0)],
    }
    contacts = {side: np.array([[0.0, 1.2], [1.6, 3.0]]) for side in ("left", "right")}
    found = acted(jump, Plan(contacts, np.array([[0.0, 1.5]]), STILL, "feet"))
    report = found.report
    assert len(report.flights) == 1
    assert report.off_mm < 0.1
    assert report.slide_mm < 1
    assert report.lowest_mm > -0.1
    moving = posing.motion(DETAILED, found.angles, found.root, found.heading)
    centre = posing.centre_of_mass(DETAILED, moving)
    way = centre[round(1.6 * 120)] - centre[round(1.2 * 120)]
    assert way[2] == pytest.approx(1.5 * 0.4, abs=0.03)
    # Thrown up at g T / 2 the body rises by g T^2 / 8 and falls back.
    assert centre[144:193, 1].max() - max(centre[144, 1], centre[192, 1]) > 9.81 * 0.4**2 / 8 - 0.15


def test_kicking_the_planted_foot_stays() -> None:
    kick = {
        "right_hip.flexion": [(0.0, 0.0), (0.5, -15), (1.0, 85), (1.5, 0), (3, 0)],
        "right_knee.flexion": [(0.0, 0.0), (0.55, 60), (1.0, 10), (1.3, 40), (1.6, 0), (3, 0)],
    }
    contacts = {"left": np.array([[0.0, 3.0]]), "right": np.array([[0.0, 0.4], [1.6, 3.0]])}
    found = acted(kick, Plan(contacts, STILL, STILL, "feet"))
    heels, toes = world(found)
    assert np.ptp(toes["left"], axis=0).max() < 1e-4
    assert np.ptp(heels["left"], axis=0).max() < 0.01
    assert toes["right"][120, 1] > 0.5
    assert found.report.slide_mm < 1


def test_the_paper_s_body_says_what_its_rigid_ankles_could_not_keep() -> None:
    found = travelled(PAPER, 1.3, 0.0, False)
    heels, toes = world(found)
    assert min(point[:, 1].min() for point in (*heels.values(), *toes.values())) > -1e-3
    assert found.report.speed == pytest.approx(1.3, rel=0.03)
    assert found.report.slide_mm == pytest.approx(_slide(found, heels, toes), rel=0.05, abs=0.5)


def _slide(found: Carried, heels: dict[str, Floats], toes: dict[str, Floats]) -> float:
    """Millimetres that the lower point of a foot goes in a stance, at most."""
    longest = 0.0
    for side in ("left", "right"):
        for begin, end in found.plan.contacts[side].tolist():
            first, last = max(int(np.ceil(begin * 120 - 1e-6)), 0), int(np.floor(end * 120 + 1e-6))
            way = 0.0
            for k in range(first, min(last, len(found.root) - 1)):
                heel, toe = heels[side][k : k + 2], toes[side][k : k + 2]
                lower = heel if heel[:, 1].sum() < toe[:, 1].sum() else toe
                way += float(np.hypot(*(lower[1] - lower[0])[::2]))
            longest = max(longest, way)
    return 1000 * longest


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"travel": "air"}, "travels by 'path' or by 'feet'"),
        ({"contacts": {"port": np.array([[0.0, 1.0]])}}, "called 'left' and 'right'"),
        ({"contacts": {"left": np.array([[1.0, 0.5]])}}, "must begin before it ends"),
        ({"contacts": {"left": np.array([[0.0, 1.0], [0.5, 2.0]])}}, "begins before the one before ends"),
        ({"contacts": {}}, "no foot touches the ground"),
        ({"speed": np.array([[0.0, np.nan]])}, "speed must be finite"),
        ({"turn_rate": np.array([0.0])}, "turn_rate has the shape"),
    ],
)
def test_what_makes_no_sense_is_said(change: dict[str, Any], said: str) -> None:
    angles, plan = gait(DETAILED, 1.0, 0.0, seconds=1)
    with pytest.raises(ActionletError, match=said):
        carried(DETAILED, angles, dataclasses.replace(plan, **change))


def test_angles_of_another_body_are_refused() -> None:
    angles, plan = gait(PAPER, 1.0, 0.0, seconds=1)
    with pytest.raises(ActionletError, match="needs \\(frames, 40\\)"):
        carried(DETAILED, angles, plan)
    with pytest.raises(ActionletError, match="fps"):
        carried(PAPER, angles, plan, fps=0)
    broken = angles.copy()
    broken[3, 0] = np.nan
    with pytest.raises(ActionletError, match=r"neck\.flexion is nan in frame 3"):
        carried(PAPER, broken, plan)


@given(st.floats(-3.1, 3.1), st.floats(-3.1, 3.1))
def test_the_yaw_of_a_foot_is_the_same_however_it_is_pitched(yaw: float, pitch: float) -> None:
    foot = about_y(np.array([yaw])) @ pitched(np.array([pitch]))
    np.testing.assert_allclose(yaw_of(foot), yaw, atol=1e-9)


@pytest.mark.parametrize("seed", [4059472349530935237, 1, 10])
def test_a_leg_whose_foot_leaves_the_ground_past_upright_is_not_turned_round(seed: int) -> None:
    found = library()["walk"].take(seconds=1.5, fps=60, seed=seed, variation=1.0, speed=1.57)
    turned_by = {
        name: change for name, change in found.report.corrections_deg.items() if name.endswith("hip.rotation")
    }
    assert max(turned_by.values(), default=0.0) < 30
