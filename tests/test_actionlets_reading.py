"""The angles of a body, read from any motion."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import gmr
from bodies import bodies, in_range, seeds
from gmr import Motion
from gmr.actionlets import Body, posing, read
from gmr.actionlets.anatomy import anatomy
from gmr.demo import demo_folder
from gmr.errors import ActionletError
from gmr.quaternions import about, multiply, rotated
from gmr.skeleton import Skeleton

Floats = NDArray[np.float64]

FREE = Path(os.environ.get("GMR_DATA", "/nowhere"))
WALKS = [demo_folder() / "07_01.bvh", demo_folder() / "08_01.bvh"]
MORE = [FREE / "cmu_asf_amc" / f"{name}.amc" for name in ("35_01", "16_15", "07_01")]
JOINTS = ("knee", "ankle")


@given(bodies, seeds)
def test_angles_come_back(body: Body, seed: int) -> None:
    angles, rng = in_range(body, seed), np.random.default_rng(seed)
    root, heading = rng.normal(size=(20, 3)), rng.uniform(-3, 3, 20)
    moving = posing.motion(body, angles, root, heading)
    assert np.abs(posing.angles(body, moving, root, heading) - angles).max() < 1e-9


@given(bodies, seeds)
def test_what_was_read_poses_the_same_motion(body: Body, seed: int) -> None:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.uniform(-0.3, 0.3, 20))
    moving = posing.motion(body, in_range(body, seed), rng.normal(size=(20, 3)), heading)
    again = read(body, moving).motion()
    assert np.allclose(again.positions(dtype=np.float64), moving.positions(dtype=np.float64), atol=1e-9)


@given(seeds, st.floats(1.3, 2.2))
def test_angles_do_not_depend_on_the_size_of_the_body(seed: int, height: float) -> None:
    body, other = Body.of(), Body.of(height)
    angles = in_range(body, seed)
    assert np.allclose(posing.angles(other, posing.motion(body, angles), 0.0, 0.0)[:, :34], angles[:, :34])


def test_arms_straight_aside_leave_no_gap() -> None:
    """At the right angle itself flexion and rotation are one: what comes back need not be what was, but its
    pose is, and it does not jump."""
    body = Body.of()
    angles = np.zeros((200, 40))
    for side in ("left", "right"):
        angles[:, body.column(f"{side}_shoulder.abduction")] = np.linspace(0.8, 2.2, 200)
        angles[:, body.column(f"{side}_shoulder.flexion")] = 0.3
    aside = angles[:, body.column("left_shoulder.abduction")]
    aside[np.abs(aside - np.pi / 2).argmin()] = np.pi / 2
    moving = posing.motion(body, angles)
    found = read(body, moving)
    again = found.motion().positions(dtype=np.float64)
    assert np.allclose(again, moving.positions(dtype=np.float64), atol=1e-9)
    assert np.abs(np.diff(found.angles, axis=0)).max() < 0.02


def other_skeleton(moving: Motion, seed: int) -> Motion:
    """The same movement on a skeleton with Mixamo's names, a T-pose for its rest, and a spine of three."""
    body = moving.skeleton
    rng = np.random.default_rng(seed)
    theirs = {
        "pelvis": "Hips", "waist": "Spine2", "neck": "Neck",
        **{f"{s}_{a}": f"{s.capitalize()}{b}" for s in ("left", "right") for a, b in (
            ("shoulder", "Arm"), ("elbow", "ForeArm"), ("wrist", "Hand"), ("hip", "UpLeg"), ("knee", "Leg"),
            ("ankle", "Foot"), ("ankle_end", "ToeBase"), ("wrist_end", "HandMiddle1"))},
        "neck_end": "Head",
    }  # fmt: skip
    # In the T-pose the arms are turned about Z; every joint's frame there is that of the world.
    turn = {
        name: about(np.array([0.0, 0.0, 1.0]), np.array(np.pi / 2 * (1 if name.startswith("left") else -1)))
        for name in body.names
        if "shoulder" in name or "elbow" in name or "wrist" in name
    }
    still = np.array([0.0, 0.0, 0.0, 1.0])
    world = moving.joint_rotations(dtype=np.float64)
    names, parents, offsets, frames = [], [], [], []
    for joint, name in enumerate(body.names):
        above = int(body.parents[joint])
        carried = turn.get(body.names[above], still) if above >= 0 else still
        offset = rotated(carried, body.offsets[joint])
        names.append("mixamorig:" + theirs.get(name, name))
        parents.append(above)
        offsets.append(offset)
        frames.append(multiply(world[:, joint], _inverse(turn.get(name, still))))
    ends = np.zeros(len(names), np.uint8)
    skeleton = Skeleton.post_rotation(names, parents, np.array(offsets) * 100, ends=ends)
    inner = [joint for joint, children in enumerate(skeleton.children) if children]
    local = [
        multiply(_inverse(frames[parents[j]]), frames[j]) if parents[j] >= 0 else frames[j] for j in inner
    ]
    facing = about(np.array([0.0, 1.0, 0.0]), np.array(rng.uniform(-3, 3)))
    local[0] = multiply(facing, local[0])
    places = rotated(facing, moving.translations * 100)
    return Motion.from_pose(
        skeleton, np.stack(local, axis=1), places, moving.frame_time, unit=0.01, name="other.bvh"
    )


def _inverse(turn: Floats) -> Floats:
    return np.asarray(turn * np.array([-1.0, -1.0, -1.0, 1.0]), np.float64)


@given(seeds)
@settings(max_examples=20)
def test_another_skeleton_with_another_rest_pose_shows_the_same_angles(seed: int) -> None:
    body = Body.of()
    rng = np.random.default_rng(seed)
    start, end = in_range(body, seed, 2) * 0.4
    share = np.linspace(0, 1, 40)[:, None]
    angles = start + share * (end - start)
    angles[:, 34:] = 0
    for side in ("left", "right"):
        angles[:, body.column(f"{side}_knee.flexion")] = np.linspace(0.3, 1.2, 40)
        angles[:, body.column(f"{side}_elbow.flexion")] = np.linspace(0.3, 1.2, 40)
        # The foot of the other skeleton is flat where its rest says so; contacts would say otherwise.
        for motion in ("flexion", "inversion", "rotation"):
            angles[:, body.column(f"{side}_ankle.{motion}")] = 0
    moving = posing.motion(body, angles, np.array([0.0, 3.0, 0.0]), float(rng.uniform(-3, 3)))
    found = posing.angles(body, other_skeleton(moving, seed))
    kept = [c for c, dof in enumerate(body.dofs[:34]) if "ankle" not in dof.joint]
    assert np.abs(found[:, kept] - angles[:, kept]).max() < 1e-6


def assert_is_gait(motion: Motion) -> None:
    """As in Perry, Gait Analysis (1992): the hip from 30 degrees of flexion to 10 or 20 of extension, the
    knee to 60 or 70 in swing, nearly straight before and after; ankle, pelvis, trunk near their zeros."""
    body = Body.like(motion)
    found = read(body, motion)
    degrees = {name: np.degrees(found.angles[:, column]) for name, column in body.columns.items()}
    for side in ("left", "right"):
        hip, knee = degrees[f"{side}_hip.flexion"], degrees[f"{side}_knee.flexion"]
        assert 25 < np.quantile(hip, 0.98) < 48  # long strides
        assert -30 < np.quantile(hip, 0.02) < -5
        assert 55 < np.quantile(knee, 0.98) < 80
        assert -5 < np.quantile(knee, 0.02) < 20
        assert np.abs(degrees[f"{side}_hip.abduction"]).max() < 20
        assert np.abs(degrees[f"{side}_hip.rotation"]).max() < 20
        ankle = degrees[f"{side}_ankle.flexion"]
        assert 5 < np.quantile(ankle, 0.95) < 25
        assert -35 < np.quantile(ankle, 0.02) < -5
        assert abs(np.median(degrees[f"{side}_ankle.inversion"])) < 8
        # The knee is bent most while the hip swings forward, and is nearly straight when it is there.
        assert np.quantile(hip[knee > 50], 0.9) < np.quantile(hip, 0.98)
        assert np.corrcoef(hip, degrees[f"{'right' if side == 'left' else 'left'}_hip.flexion"])[0, 1] < -0.7
    for part in ("waist.flexion", "waist.lateral", "waist.rotation", "root.tilt", "root.obliquity"):
        assert np.abs(degrees[part]).max() < 20
    steps = np.abs(np.diff(found.angles[:, :22], axis=0)).max()
    assert steps < np.radians(15)


@pytest.mark.parametrize("file", WALKS, ids=lambda file: file.stem)
def test_a_captured_walk_reads_like_gait(file: Path) -> None:
    assert_is_gait(gmr.read(file))


@pytest.mark.skipif(not FREE.exists(), reason="GMR_DATA is not set")
@pytest.mark.parametrize("file", MORE, ids=lambda file: file.stem)
def test_more_captured_walks_read_like_gait(file: Path) -> None:
    assert_is_gait(gmr.read(file))


@pytest.mark.parametrize("file", WALKS, ids=lambda file: file.stem)
def test_a_captured_walk_posed_again_stays_by_the_captured_one(file: Path) -> None:
    motion = gmr.read(file)
    body = Body.like(motion)
    shown = anatomy(motion)
    again = read(body, motion).motion()
    names = [f"{side}_{joint}" for side in ("left", "right") for joint in JOINTS]
    places = again.positions(dtype=np.float64, joints=names)
    for k, name in enumerate(names):
        off = places[:, k] - shown.place(name)
        off[:, 1] -= np.median(off[:, 1])  # the sole's thickness
        assert np.linalg.norm(off, axis=-1).mean() < 0.015
    measured = np.median(np.linalg.norm(shown.place("left_knee") - shown.place("left_hip"), axis=-1))
    thigh = -body.skeleton.offsets[body.skeleton.names.index("left_knee"), 1]
    assert thigh == pytest.approx(measured, rel=0.03)


@given(st.floats(1.3, 2.2), st.sampled_from(["male", "female", "average"]))
def test_a_body_like_one_of_ours_is_that(height: float, sex: str) -> None:
    body = Body.of(height, sex)
    for same in (Body.like(body.skeleton, sex), Body.like(posing.motion(body, np.zeros((2, 40))), sex)):
        assert np.allclose(same.skeleton.offsets, body.skeleton.offsets, atol=1e-9)
        assert same.height == pytest.approx(height)


def test_what_shows_no_body_says_so() -> None:
    skeleton = Skeleton.post_rotation(["a", "b"], [-1, 0], np.eye(2, 3))
    motion = Motion.from_pose(
        skeleton, np.tile([0.0, 0, 0, 1], (2, 1, 1)), np.zeros((2, 1, 3)), 0.1, unit=1.0
    )
    with pytest.raises(ActionletError, match="no joint that is known as left hip"):
        read(Body.of(), motion)
    with pytest.raises(ActionletError, match="no frames"):
        Body.like(motion[:0])


def test_poses_that_are_not_known_are_refused() -> None:
    body = Body.of()
    angles = np.zeros((3, 40))
    angles[1] = np.nan
    with pytest.raises(ActionletError, match="not known"):
        read(body, posing.motion(body, angles))
