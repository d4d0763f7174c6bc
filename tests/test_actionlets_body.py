"""The body that actionlets move: its degrees of freedom, sizes, masses and poses."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from bodies import alone, bodies, heights, in_range, seeds, sexes
from gmr.actionlets import Actionlet, Body, Measured, Score, Track, posing
from gmr.actionlets.dofs import DETAILED, PAPER
from gmr.body.joints import find_joints
from gmr.demo import demo_folder
from gmr.errors import ActionletError
from gmr.quaternions import conjugate, matrices, multiply
from gmr.skinning.driving.body_parts import find_body

PAPER_JOINTS = {
    "neck": range(3),
    "left_shoulder": range(3, 6),
    "right_elbow": range(6, 7),
    "left_elbow": range(7, 8),
    "right_shoulder": range(8, 11),
    "waist": range(11, 14),
    "left_hip": range(14, 17),
    "right_hip": range(17, 20),
    "left_knee": range(20, 21),
    "right_knee": range(21, 22),
}
"""As the specification of the paper's body lists them."""

SIGNS = {
    "neck.flexion": ("neck_end", (0, -1, 1)),
    "neck.lateral": ("neck_end", (1, -1, 0)),
    "waist.flexion": ("neck_end", (0, -1, 1)),
    "waist.lateral": ("neck_end", (1, -1, 0)),
    "waist.rotation": ("right_shoulder", (1, 0, 1)),
    "left_shoulder.flexion": ("left_wrist", (0, 1, 1)),
    "left_shoulder.abduction": ("left_wrist", (1, 1, 0)),
    "right_shoulder.abduction": ("right_wrist", (-1, 1, 0)),
    "left_elbow.flexion": ("left_wrist", (0, 1, 1)),
    "right_elbow.flexion": ("right_wrist", (0, 1, 1)),
    "left_wrist.flexion": ("left_wrist_end", (-1, 1, 0)),
    "right_wrist.flexion": ("right_wrist_end", (1, 1, 0)),
    "left_wrist.deviation": ("left_wrist_end", (0, 1, 1)),
    "left_hip.flexion": ("left_ankle", (0, 1, 1)),
    "left_hip.abduction": ("left_ankle", (1, 1, 0)),
    "right_hip.abduction": ("right_ankle", (-1, 1, 0)),
    "left_hip.rotation": ("left_ankle_end", (-1, 0, -1)),
    "right_hip.rotation": ("right_ankle_end", (1, 0, -1)),
    "left_knee.flexion": ("left_ankle", (0, 1, -1)),
    "right_knee.flexion": ("right_ankle", (0, 1, -1)),
    "left_ankle.rotation": ("left_ankle_end", (-1, 0, -1)),
    "right_ankle.rotation": ("right_ankle_end", (1, 0, -1)),
    "root.sway": ("pelvis", (1, 0, 0)),
    "root.heave": ("pelvis", (0, 1, 0)),
    "root.surge": ("pelvis", (0, 0, 1)),
    "root.tilt": ("waist", (0, -1, 1)),
    "root.obliquity": ("left_hip", (-1, 1, 0)),
    "root.rotation": ("right_hip", (1, 0, 1)),
}
"""Which way a joint goes for a positive value: the signs of x (left), y (up), z (forward)."""


def test_the_paper_s_body_has_its_joints_and_its_numbers() -> None:
    body = Body.of(detailed=False)
    proper = [name for name, end in zip(body.skeleton.names, body.skeleton.ends, strict=True) if not end]
    assert len(proper) == 15
    assert [dof.index for dof in body.dofs] == list(range(22))
    for joint, numbers in PAPER_JOINTS.items():
        assert [dof.index for dof in body.dofs if dof.joint == joint] == list(numbers)


def test_the_detailed_body_adds_wrists_ankles_and_a_root() -> None:
    assert DETAILED[:22] == PAPER
    more = [dof.joint for dof in DETAILED[22:]]
    joints = ("left_wrist", "right_wrist", "left_ankle", "right_ankle", "pelvis", "pelvis")
    assert more == [joint for joint in joints for _ in range(3)]
    assert all(dof.low < 0 < dof.high or (dof.motion == "flexion" and dof.low <= 0) for dof in DETAILED)
    assert all(dof.source for dof in DETAILED if dof.joint != "pelvis")


@pytest.mark.parametrize("name", SIGNS)
def test_a_positive_value_goes_the_way_its_name_says(name: str) -> None:
    body = Body.of()
    joint, signs = SIGNS[name]
    rest, moved = (
        posing.motion(body, angles).positions(dtype=np.float64, joints=[joint])[0, 0]
        for angles in (np.zeros((1, 40)), alone(body, name, 0.2))
    )
    assert np.sign(np.round(moved - rest, 9)).tolist() == list(signs)


@pytest.mark.parametrize(("name", "up"), [("left_ankle.flexion", 1), ("right_ankle.flexion", 1)])
def test_an_ankle_that_flexes_lifts_the_toes(name: str, up: int) -> None:
    body = Body.of()
    ends = [name.replace(".flexion", "_end")]
    low, high = (
        posing.motion(body, alone(body, name, value)).positions(joints=ends)[0, 0, 1] for value in (0, 0.3)
    )
    assert np.sign(high - low) == up


@pytest.mark.parametrize(("side", "medial"), [("left", -1), ("right", 1)])
def test_turns_about_the_bone_are_inward_and_pronation_turns_the_palm_back(side: str, medial: int) -> None:
    body = Body.of()
    slots = [n for n, end in zip(body.skeleton.names, body.skeleton.ends, strict=True) if not end]
    for name, front in ((f"{side}_shoulder.rotation", (0, 0, 1)), (f"{side}_wrist.pronation", (0, 0, 1))):
        turn = posing.rotations(body, alone(body, name, 0.3))[0, slots.index(name.partition(".")[0])]
        turned = matrices(turn) @ np.array(front)
        assert np.sign(turned[0]) == medial, "what faces forward turns to the middle"
    turn = posing.rotations(body, alone(body, f"{side}_ankle.inversion", 0.3))[
        0, slots.index(f"{side}_ankle")
    ]
    assert np.sign((matrices(turn) @ np.array([0, -1, 0]))[0]) == medial, "the sole faces the middle"


@given(bodies, seeds)
def test_rotations_are_the_products_of_the_single_turns_in_their_order(body: Body, seed: int) -> None:
    angles = in_range(body, seed, 3)
    found = posing.rotations(body, angles)
    slots = [n for n, end in zip(body.skeleton.names, body.skeleton.ends, strict=True) if not end]
    for slot, joint in enumerate(slots):
        expected = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
        for dof in body.dofs:
            if dof.joint == joint and not dof.is_length:
                half = angles[:, body.column(dof.name), None] / 2
                turn = np.concatenate([np.sin(half) * np.array(dof.axis), np.cos(half)], axis=-1)
                expected = multiply(expected, turn)
        off = multiply(conjugate(found[:, slot]), expected)
        assert np.abs(off[:, :3]).max() < 1e-14


@given(heights, sexes)
def test_a_body_is_as_tall_as_asked_and_stands_on_the_ground(height: float, sex: str) -> None:
    body = Body.of(height, sex)
    assert body.rest[:, 1].max() == pytest.approx(height, abs=1e-12)
    assert body.rest[:, 1].min() == pytest.approx(0.0, abs=1e-12)
    names = body.skeleton.names
    assert body.rest[names.index("left_ankle"), 1] == pytest.approx(body.foot.ankle_height)
    assert body.foot.heel[2] < 0 < body.foot.ball[2] < body.foot.toe[2]
    mirrored = body.rest * np.array([-1, 1, 1])
    for name in names:
        other = name.replace("left", "?").replace("right", "left").replace("?", "right")
        assert np.allclose(body.rest[names.index(other)], mirrored[names.index(name)])


@given(heights, sexes)
def test_lengths_grow_with_the_stature_alone(height: float, sex: str) -> None:
    one, other = Body.of(height, sex), Body.of(1.75, sex)
    assert np.allclose(one.rest / height, other.rest / 1.75)


@given(sexes, st.floats(1, 99))
def test_percentile_and_stature_are_each_other_s_inverse(sex: str, percentile: float) -> None:
    body = Body.of(sex=sex, percentile=percentile)
    assert Body.of(body.height, sex).percentile == pytest.approx(percentile)
    assert body.percentile == pytest.approx(percentile)


@given(bodies)
def test_masses_make_one_whole_and_the_body_balances_in_the_middle(body: Body) -> None:
    assert sum(segment.mass for segment in body.segments) == pytest.approx(1)
    centre = posing.centre_of_mass(body, posing.motion(body, np.zeros((1, body.dof_count))))[0]
    assert centre[0] == pytest.approx(0, abs=1e-12)
    # Hellebrandt et al. 1938: 55 % of the stature in women, 56 % in men.
    assert 0.54 < centre[1] / body.height < 0.58
    assert body.foot.heel[2] < centre[2] < body.foot.ball[2]


@given(seeds)
def test_the_centre_of_mass_is_that_of_points_carried_by_the_joints(seed: int) -> None:
    body = Body.of()
    moving = posing.motion(body, in_range(body, seed, 4))
    names = list(body.skeleton.names)
    turns = matrices(moving.joint_rotations(dtype=np.float64))
    places = moving.positions(dtype=np.float64)
    expected = np.zeros((4, 3))
    for segment in body.segments:
        joint = names.index(segment.joint)
        expected += segment.mass * (places[:, joint] + turns[:, joint] @ np.array(segment.centre))
    assert np.allclose(posing.centre_of_mass(body, moving), expected, atol=1e-12)


@given(seeds)
def test_root_and_heading_carry_the_whole_body(seed: int) -> None:
    body = Body.of()
    angles, rng = in_range(body, seed, 4), np.random.default_rng(seed)
    root, heading = rng.normal(size=(4, 3)), rng.uniform(-9, 9, 4)
    here = posing.motion(body, angles, 0.0).positions(dtype=np.float64)
    there = posing.motion(body, angles, root, heading).positions(dtype=np.float64)
    cosine, sine = np.cos(heading), np.sin(heading)
    turn = np.zeros((4, 3, 3))
    turn[:, 0, 0] = turn[:, 2, 2] = cosine
    turn[:, 0, 2], turn[:, 2, 0], turn[:, 1, 1] = sine, -sine, 1
    assert np.allclose(there, np.einsum("fij,fkj->fki", turn, here) + root[:, None], atol=1e-12)


@pytest.mark.parametrize("suffix", ["bvh", "gmr", "gmrb", "glb"])
@pytest.mark.parametrize("detailed", [True, False])
def test_files_keep_the_motion(tmp_path: Path, suffix: str, detailed: bool) -> None:
    body = Body.of(detailed=detailed)
    moving = posing.motion(body, in_range(body, 7), heading=np.linspace(0, 9, 20), fps=60)
    path = tmp_path / f"moves.{suffix}"
    gmr.write(moving, path)
    exact = 1e-5 if suffix == "glb" else 1e-12  # glTF holds float32
    again = gmr.read(path)
    names = list(body.skeleton.names)
    one, other = (each.positions(dtype=np.float64, joints=names) for each in (again, moving))
    assert np.allclose(one, other, atol=exact)
    assert set(names) <= set(again.skeleton.names)


def test_the_columns_of_a_bvh_file_are_the_angles() -> None:
    body = Body.of()
    angles = in_range(body, 3, 5)
    moving = posing.motion(body, angles)
    layout = moving.layout
    assert layout is not None
    knee = int(layout.starts[body.skeleton.names.index("left_knee")])
    expected = np.degrees(angles[:, body.column("left_knee.flexion")])
    assert layout.names[body.skeleton.names.index("left_knee")][0] == "Xrotation"
    assert np.allclose(moving.rows[:, knee], expected, atol=1e-9)


@given(bodies)
def test_others_find_the_parts_of_the_body(body: Body) -> None:
    joints = find_joints(body.skeleton, body.rest[None])
    assert joints.found_by == "names"
    assert joints.described(body.skeleton)["left_foot"] == "left_ankle"
    parts = find_body(body.skeleton, body.rest)
    assert parts is not None
    assert parts.found_by == "gmr body"
    assert {"spine", "neck", "left_arm", "right_forearm", "left_hand", "right_leg"} <= parts.parts.keys()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"height": 0.9}, "height=0.9 m: the proportions are those of adults; give 1.2 to 2.3"),
        ({"height": math.nan}, "give 1.2 to 2.3 metres"),
        ({"sex": "other"}, "give one of male, female, average"),
        ({"percentile": 100}, "give more than 0 and less than 100"),
        ({"height": 1.7, "percentile": 50}, "give one of them, for the other follows"),
    ],
)
def test_a_body_that_cannot_be_is_refused(arguments: dict[str, object], words: str) -> None:
    with pytest.raises(ActionletError, match=words):
        Body.of(**arguments)  # type: ignore[arg-type]


def test_a_wrong_shape_says_what_was_needed() -> None:
    body = Body.of(detailed=False)
    with pytest.raises(ActionletError, match=r"\(frames, 22\)"):
        posing.rotations(body, np.zeros((3, 40)))
    with pytest.raises(ActionletError, match=r"root has the shape \(2, 3\)"):
        posing.motion(body, np.zeros((3, 22)), root=np.zeros((2, 3)))
    with pytest.raises(ActionletError, match="fps=0: give more than 0"):
        posing.motion(body, np.zeros((3, 22)), fps=0)


def test_an_unknown_degree_of_freedom_offers_the_nearest() -> None:
    with pytest.raises(ActionletError, match=r"did you mean .*'left_knee.flexion'"):
        Body.of().column("left_knee.flexoin")


@given(bodies, seeds)
def test_what_is_in_the_ranges_is_let_through_and_clipping_brings_all_there(body: Body, seed: int) -> None:
    angles = in_range(body, seed)
    body.check(angles)
    assert np.array_equal(body.clipped(angles), angles)
    body.check(body.clipped(angles * 5 + 1))


def test_an_angle_out_of_range_is_named_in_degrees() -> None:
    body = Body.of()
    angles = np.zeros((3, 40))
    angles[2, body.column("left_knee.flexion")] = math.radians(160)
    with pytest.raises(ActionletError) as caught:
        body.check(angles, times=[0, 0.5, 1.0], what="squat")
    assert "squat: joint 'left_knee', degree of freedom 'left_knee.flexion': 160 degrees in 1.000 s" in str(
        caught.value
    )
    assert "-10 to 150 degrees" in str(caught.value)
    angles[2] = np.nan
    with pytest.raises(ActionletError):
        body.check(angles)


def test_the_extremes_of_a_score_are_checked_and_the_samples_of_what_was_measured() -> None:
    body = Body.of()
    inside = Track((Actionlet(0.0, 1.0, 0.5, 0.5), Actionlet(1.0, 0.0, 0.5, 0.5)))
    body.check(Score({"left_hip.flexion": inside}))
    outside = Track((Actionlet(0.0, 1.0, 0.5, 0.5), Actionlet(1.0, 3.0, 0.5, 0.5)))
    with pytest.raises(ActionletError, match=r"left_hip.flexion.*0.500 s"):
        body.check(Score({"left_hip.flexion": outside}))
    over = Track((Measured(np.array([0.0, 1.0, 2.9, 1.0, 0.0]), 1.0),))
    with pytest.raises(ActionletError, match=r"left_hip\.flexion"):
        body.check(Score({"left_hip.flexion": over}))


def test_a_body_like_one_whose_joints_have_no_known_names_has_its_shoulders_apart(tmp_path: Path) -> None:
    numbers: dict[str, int] = {}
    text = re.sub(
        r"(ROOT|JOINT) (\S+)",
        lambda found: f"{found[1]} b{numbers.setdefault(found[2], len(numbers))}",
        (demo_folder() / "09_01.bvh").read_text(),
    )
    (tmp_path / "walk.bvh").write_text(text)
    body = Body.like(gmr.read(tmp_path / "walk.bvh"))
    at = {
        name: body.skeleton.offsets[body.skeleton.index(f"{name}_shoulder"), 0] for name in ("left", "right")
    }
    assert at["left"] == -at["right"]
    assert at["left"] > 0.15
