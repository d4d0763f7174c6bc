"""Laws of bodies with rigid ankles: their feet rock over heels and toes and do not slide."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from asked_takes import checked_take
from gaits import gait
from gmr.actionlets import Body, Score, Track, library, posing
from gmr.actionlets.travel import Carried, Plan, carried
from gmr.actionlets.travel.legs import legs_of
from gmr.actionlets.travel.rocking import _pitch
from gmr.actionlets.upright import sampled
from gmr.quaternions import rotated

Floats = NDArray[np.float64]

DETAILED, PAPER = Body.of(), Body.of(detailed=False)
SHIPPED = tuple(library())
FPS = 60

walks = st.tuples(st.floats(0.3, 2.5), st.floats(-np.pi, np.pi), st.just(False))
runs = st.tuples(st.floats(2.0, 5.0), st.floats(-np.pi, np.pi), st.just(True))


def travelled(speed: float, turn_rate: float, running: bool) -> Carried:
    angles, plan = gait(PAPER, speed, turn_rate, seconds=2, fps=FPS, runs=running)
    return carried(PAPER, angles, plan, FPS)


def soles(found: Carried) -> dict[str, tuple[Floats, Floats]]:
    """(F, 3) heel and tip of the toes in the world, by the kinematics of :mod:`gmr.actionlets.posing`."""
    body = found.body
    moving = posing.motion(body, found.angles, found.root, found.heading, found.fps)
    places = moving.positions(dtype=np.float64)
    turns = np.asarray(moving.joint_rotations(dtype=np.float64), np.float64)
    points = {}
    for side in ("left", "right"):
        ankle = body.skeleton.names.index(f"{side}_ankle")
        heel = places[:, ankle] + rotated(turns[:, ankle], np.array(body.foot.heel))
        points[side] = heel, places[:, body.skeleton.names.index(f"{side}_ankle_end")]
    return points


@given(st.one_of(walks, runs))
@settings(max_examples=12, deadline=None)
def test_the_point_on_which_a_rigid_foot_stands_rests(asked: tuple[float, float, bool]) -> None:
    found = travelled(*asked)
    for side, (heel, toe) in soles(found).items():
        assert min(heel[:, 1].min(), toe[:, 1].min()) > -1e-4
        for begin, end in found.plan.contacts[side].tolist():
            if end < 0:
                continue
            at = slice(max(int(np.ceil(begin * FPS - 1e-6)), 0), int(np.floor(end * FPS + 1e-6)) + 1)
            for point in (heel[at], toe[at]):
                touches = point[:, 1] < 1e-3
                steps = np.linalg.norm(np.diff(point[:, ::2], axis=0), axis=1)
                assert steps[touches[1:] & touches[:-1]].sum() < 3e-3
    assert found.report.slide_mm < 3
    assert found.report.speed == pytest.approx(asked[0], rel=0.03)
    assert found.report.turn_rate_deg == pytest.approx(np.degrees(asked[1]), abs=3)
    assert found.report.off_mm < 10


@given(
    name=st.sampled_from(SHIPPED),
    shares=st.lists(st.sampled_from((0.0, 0.3, 0.5, 0.8, 1.0)), min_size=4, max_size=4),
    seed=st.integers(0, 2**20),
    variation=st.sampled_from((0.0, 0.6, 1.0)),
    height=st.sampled_from((1.35, 1.75, 2.0)),
)
@settings(max_examples=10, deadline=None)
def test_in_every_motion_of_the_library_rigid_feet_stay_where_they_stand(
    name: str, shares: list[float], seed: int, variation: float, height: float
) -> None:
    report = checked_take(name, shares, FPS, seed, Body.of(height, detailed=False), variation).report
    assert report.lowest_mm > -0.1
    assert report.off_mm < 10


def test_a_rigid_leg_whose_hip_goes_far_behind_it_bends() -> None:
    """A hip that sat down behind a leg that did not give way took its foot 20 cm into the air."""
    take = library()["walk_and_sit"].take(None, FPS, 186397, Body.of(1.35, detailed=False), 0.6)
    assert take.report.slide_mm < 1
    assert take.report.lifted_mm < 100


def test_a_rigid_walk_is_held_up_by_a_foot_on_the_ground_at_every_moment() -> None:
    found = library()["walk"].take(3, FPS, body=PAPER).carried
    lowest = np.min([np.minimum(heel[:, 1], toe[:, 1]) for heel, toe in soles(found).values()], axis=0)
    assert lowest.max() < 0.012


def test_a_rigid_squat_stands_on_its_toes_and_says_that_nothing_slides() -> None:
    take = library()["squat"].take(None, FPS, body=PAPER)
    (heel, toe), _ = soles(take.carried).values()
    deepest = int(take.carried.root[:, 1].argmin())
    assert heel[deepest, 1] > 0.03
    assert toe[:, 1].max() < 0.005
    assert take.report.slide_mm < 1


def test_the_report_says_how_far_rigid_feet_are_lifted() -> None:
    take = library()["walk"].take(3, FPS, body=PAPER)
    heights = [np.minimum(heel[:, 1], toe[:, 1]) for heel, toe in soles(take.carried).values()]
    most = 0.0
    for side, height in zip(("left", "right"), heights, strict=True):
        for begin, end in take.performance.contacts[side].tolist():
            first = max(int(np.ceil(begin * FPS - 1e-6)), 0)
            most = max(most, float(height[first : int(np.floor(end * FPS + 1e-6)) + 1].max(initial=0)))
    assert take.report.lifted_mm == pytest.approx(1000 * most, abs=0.1)
    assert "above its place" in str(take.report)
    assert "above its place" not in str(library()["walk"].take(1, FPS).report)


@given(pitch=st.floats(-0.9, 0.4), lean=st.floats(-0.6, 0.6))
def test_the_pitch_of_a_rocking_foot_is_told_by_its_hip_where_the_knee_is_in_front(
    pitch: float, lean: float
) -> None:
    """A foot that is pitched, its shank, and a thigh that leans: where the hip is then tells the pitch."""
    leg = legs_of(PAPER)[0]
    point = leg.toe if pitch < 0 else leg.heel
    up, forward = -(leg.shank + point)[1:]
    knee = np.array(
        [forward * np.cos(pitch) - up * np.sin(pitch), forward * np.sin(pitch) + up * np.cos(pitch)]
    )
    thigh = -leg.thigh[1] * np.array([np.sin(lean), np.cos(lean)])
    bend = np.arctan2(knee[0], knee[1]) - lean
    if bend > 0.35:
        hip = knee + thigh
        found = _pitch(leg, point, point[2] + hip[:1], hip[1:])
        assert found[0] == pytest.approx(pitch, abs=1e-6)


def test_a_pelvis_that_does_not_turn_leaves_thighs_and_trunk_as_they_are() -> None:
    turns = {"root.tilt": 20, "root.obliquity": -6, "root.rotation": 9, "left_hip.flexion": 30}
    turns |= {"right_hip.abduction": 12, "waist.lateral": 8, "waist.rotation": -15, "waist.flexion": 10}
    score = Score(
        {name: Track.through([(0.0, 0.0), (0.2, np.radians(most))]) for name, most in turns.items()}
    )
    seen = {}
    for body in (DETAILED, PAPER):
        angles = sampled(body, score, FPS)
        rotations = posing.motion(body, angles).joint_rotations(dtype=np.float64)
        names = [body.skeleton.names.index(name) for name in ("left_hip", "right_hip", "waist")]
        seen[body.name] = np.asarray(rotations)[:, names]
    same = np.abs((seen["paper"] * seen["detailed"]).sum(axis=-1))
    np.testing.assert_allclose(same, 1, atol=1e-9)


def test_feet_that_are_still_leave_a_standing_body_as_it_is() -> None:
    planted, still = np.array([[0.0, 1.0]]), np.array([[0.0, 0.0]])
    angles = np.zeros((61, PAPER.dof_count))
    found = carried(PAPER, angles, Plan({"left": planted, "right": planted}, still, still, "feet"), FPS)
    assert found.report.lifted_mm < 1
    assert np.ptp(found.angles, axis=0).max() < 1e-9
