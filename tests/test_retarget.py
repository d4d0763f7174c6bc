"""A motion laid on the skeleton of another."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import gmr
from gmr.quaternions import matrices, rotated
from gmr.skinning import retarget
from gmr.skinning.driving.rest_frame import rest_frame
from restless import without_rest
from walkers import walker

DEMO = Path(gmr.__file__).parent / "data" / "demo"

LIMBS = [
    ("LeftUpLeg", "LeftLeg"),
    ("RightLeg", "RightFoot"),
    ("RightArm", "RightForeArm"),
    ("LeftForeArm", "LeftHand"),
]


@pytest.fixture(scope="module")
def walk() -> gmr.Motion:
    return gmr.read(DEMO / "07_01.bvh")


@pytest.fixture(scope="module")
def other() -> gmr.Motion:
    """A body of other names and bone lengths, whose rest pose is no T-pose and in which Z points up."""
    run = gmr.read(DEMO / "09_01.bvh")[1:]
    names = [name.replace("Left", "l_").replace("Right", "r_") for name in run.skeleton.names]
    scaled = gmr.Skeleton.post_rotation(
        names, run.skeleton.parents, 5.0 * run.skeleton.offsets, ends=run.skeleton.ends
    )
    turn = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    rotations = run.rotations.copy()
    from gmr.quaternions import multiply

    rotations[:, 0] = multiply(turn, rotations[:, 0])
    return gmr.Motion.from_pose(
        scaled, rotations, 5.0 * rotated(turn, run.translations), run.frame_time, unit=0.01129
    )


def directions(motion: gmr.Motion, limbs: list[tuple[str, str]]) -> NDArray[np.float64]:
    names = list(motion.skeleton.names)
    places = motion.positions(dtype=np.float64)
    bones = np.stack([places[:, names.index(b)] - places[:, names.index(a)] for a, b in limbs], axis=1)
    return np.asarray(bones / np.linalg.norm(bones, axis=2, keepdims=True))


def test_a_motion_laid_on_its_own_skeleton_is_itself(walk: gmr.Motion) -> None:
    same = retarget(walk, walk, ground=False).motion
    apart = np.abs(same.positions(dtype=np.float64) - walk[1:].positions(dtype=np.float64))
    assert apart.max() < 1e-9
    assert same.skeleton is walk.skeleton


def test_skeleton_unit_and_axes_are_those_of_the_other(walk: gmr.Motion, other: gmr.Motion) -> None:
    made = retarget(walk, other).motion
    assert made.skeleton is other.skeleton
    assert made.unit == other.unit
    hips = made.positions(dtype=np.float64)[:, 0]
    assert np.ptp(hips[:, 2]) < 0.1 * np.ptp(hips[:, :2], axis=0).max(), "it walks on the ground, Z up"
    assert hips[:, 2].min() > 50


def test_limbs_point_where_those_of_the_motion_point(walk: gmr.Motion, other: gmr.Motion) -> None:
    made = retarget(walk, other, ground=False).motion
    renamed = [tuple(n.replace("Left", "l_").replace("Right", "r_") for n in limb) for limb in LIMBS]
    up = matrices(np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]))
    wanted = directions(walk[1:], LIMBS) @ up.T
    got = directions(made, [(a, b) for a, b in renamed])
    angle = np.degrees(np.arccos(np.clip((wanted * got).sum(axis=2), -1, 1)))
    assert angle.max() < 8


def test_bones_keep_the_lengths_of_the_other(walk: gmr.Motion, other: gmr.Motion) -> None:
    made = retarget(walk, other).motion

    def lengths(motion: gmr.Motion) -> NDArray[np.float64]:
        places = motion.positions(dtype=np.float64)
        bones = places[:, 1:] - places[:, motion.skeleton.parents[1:]]
        return np.asarray(np.linalg.norm(bones, axis=2))

    assert np.allclose(lengths(made), lengths(other)[0], atol=1e-9)


def test_the_rate_may_be_another(walk: gmr.Motion, other: gmr.Motion) -> None:
    made = retarget(walk, other, fps=30).motion
    assert made.fps == pytest.approx(30)
    assert made.frame_count == pytest.approx(walk.frame_count / 4, abs=1)


def test_a_root_on_the_ground_goes_along(walk: gmr.Motion) -> None:
    """As in datasets whose topmost joint is the simulation root."""
    lead = walk[1:]
    parents = np.concatenate([[-1], lead.skeleton.parents + 1])
    skeleton = gmr.Skeleton.post_rotation(
        ["root", *lead.skeleton.names],
        parents,
        np.concatenate([np.zeros((1, 3)), lead.skeleton.offsets]),
        ends=np.concatenate([[0], lead.skeleton.ends]),
    )
    hips = lead.positions(dtype=np.float64)[:, 0]
    still = np.tile([0.0, 0.0, 0.0, 1.0], (lead.frame_count, 1, 1))
    ground = hips * [1.0, 0.0, 1.0]
    like = gmr.Motion.from_pose(
        skeleton,
        np.concatenate([still, lead.rotations], axis=1),
        np.stack([ground, hips - ground], axis=1),
        lead.frame_time,
        translated=[0, 1],
        unit=walk.unit,
    )
    made = retarget(walk, like).motion
    places = made.positions(dtype=np.float64)
    assert np.abs(places[:, 0, 1]).max() < 1e-6
    assert np.abs((places[:, 0] - places[:, 1])[:, [0, 2]]).max() < 2


def test_what_is_no_body_is_refused(walk: gmr.Motion) -> None:
    tail = gmr.Skeleton.post_rotation(["a", "b", "c"], [-1, 0, 1], np.eye(3))
    like = gmr.Motion.from_pose(tail, np.tile([0.0, 0, 0, 1], (2, 2, 1)), np.zeros((2, 1, 3)), 0.01, unit=1.0)
    with pytest.raises(gmr.SkeletonError, match="no body is found"):
        retarget(walk, like)


def test_a_motion_without_a_rest_pose_gets_the_frame_in_which_it_stands(walk: gmr.Motion) -> None:
    assert rest_frame(walk) is None
    moving = walk[40:100:4]
    restless = without_rest(moving, 2)
    frame = rest_frame(restless)
    assert frame is not None
    laid, usual = retarget(restless, walk, rest=frame).motion, retarget(moving, walk).motion
    assert (directions(laid, LIMBS) * directions(usual, LIMBS)).sum(axis=2).min() > 0.98


def test_a_motion_that_never_stands_gets_none() -> None:
    walking = walker(1.0, 0.0)
    rotations = walking.rotations.copy()
    rotations[:, walking.skeleton.index("LeftUpLeg")] = (1.0, 0.0, 0.0, 0.0)
    kicking = gmr.Motion.from_pose(
        walking.skeleton, rotations, walking.translations, walking.frame_time, unit=1.0
    )
    assert rest_frame(kicking) is None
    with pytest.raises(gmr.GmrError, match=r"stands in no frame.*in Python: gmr\.skinning\.retarget\("):
        rest_frame(without_rest(kicking, 1))
