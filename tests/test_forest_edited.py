"""Motions that were edited in one configuration and go to another: nothing of the edit is lost."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import gmr
import strategies
from gmr import editing, forest
from gmr.apart import turned_apart
from gmr.demo import demo_folder
from gmr.frames import Pose
from gmr.motion import Motion
from test_forest import assert_same_motion, reach
from walks import choices, walks_of

motions = strategies.motions(max_joints=8) | strategies.poses(max_joints=8)


@st.composite
def edited_motions(draw: st.DrawFn) -> Motion:
    """A motion in some configuration in which some rotations and places were changed by hand."""
    _, moved = draw(walks_of(motions))
    pose = moved.pose
    rotations, translations = pose.rotations.copy(), pose.translations.copy()
    random = np.random.default_rng(draw(st.integers(0, 1000)))
    turning = sorted(set(moved.skeleton.slots.tolist()) - {-1})
    slots = draw(st.sets(st.sampled_from(turning), max_size=3)) if turning else set()
    for slot in slots:
        turn = Rotation.random(max(len(pose), 1), random_state=random).as_quat()
        rotations[:, slot] = turn[: len(pose)]
    if draw(st.booleans()) and translations.size:
        translations += random.normal(size=translations.shape)
    # A hinge that was turned otherwise is not what its channels say.
    layout = None if slots else pose.layout
    source = replace(pose, rotations=rotations, translations=translations, rows=None, layout=layout)
    return replace(moved, source=source)


@given(edited_motions(), st.data())
def test_whatever_was_edited_stays_in_every_configuration(edited: Motion, data: st.DataObject) -> None:
    moved = edited
    for _ in range(data.draw(st.integers(1, 4))):
        moved = data.draw(st.sampled_from(choices(moved)))()
    assert_same_motion(moved, edited)
    assert_same_motion(forest.home(moved), edited)
    assert_same_motion(forest.home(edited), edited)


@given(edited_motions())
def test_bones_that_turn_apart_share_no_turn(edited: Motion) -> None:
    apart = turned_apart(edited)
    assert_same_motion(apart, edited)
    np.testing.assert_array_equal(apart.skeleton.parents, edited.skeleton.parents)
    assert turned_apart(apart) is apart or apart.skeleton.home is None
    home = apart.skeleton if apart.skeleton.home is None else apart.skeleton.home
    turns = apart.bone_rotations(dtype=float)
    world = np.asarray(home.topology.world_slots)
    for number in np.unique(world):
        first, *others = np.flatnonzero(world == number)
        for other in others:
            alike = np.abs(np.einsum("fc,fc->f", turns[:, first], turns[:, other]))
            np.testing.assert_allclose(alike, 1, rtol=0, atol=1e-11)


@given(edited_motions())
def test_what_is_written_as_bvh_is_the_edited_motion(edited: Motion) -> None:
    plain = edited.to_post_rotation()
    joints = range(edited.skeleton.joint_count)
    places = plain.positions(dtype=float, joints=joints), edited.positions(dtype=float)
    np.testing.assert_allclose(*places, rtol=0, atol=1e-11 * reach(edited))
    plain.rows  # noqa: B018  its channels can say it


@given(walks_of(strategies.motions(max_joints=8)), st.sampled_from([0.7, 1.9, 2.5]))
def test_a_rate_is_changed_alike_in_every_configuration(walk: tuple[Motion, Motion], factor: float) -> None:
    motion, moved = (replace(one, frame_time=0.01) for one in walk)
    fps = 100 * factor
    assert_same_motion(moved.resample(fps), motion.resample(fps))
    np.testing.assert_array_equal(moved.resample(fps).skeleton.parents, moved.skeleton.parents)


@pytest.fixture(scope="module")
def walk() -> Motion:
    return gmr.read(demo_folder() / "07_01.bvh")[:40]


def assert_same_places(read: Motion, written: Motion) -> None:
    """Every joint that was written is where it was, whatever else the file has."""
    joints = read.skeleton.indices(written.skeleton.names)
    places = read.positions(dtype=float, joints=joints), written.positions(dtype=float)
    np.testing.assert_allclose(*places, rtol=0, atol=1e-9)


def turned_root(motion: Motion, name: str) -> Motion:
    loose = editing.cut_at(motion, [name])
    turn = Rotation.from_euler("x", 20, degrees=True).as_quat()
    return editing.moved_roots(loose, {}, turns={loose.skeleton.index(name): np.tile(turn, (len(motion), 1))})


@pytest.mark.parametrize("suffix", [".bvh", ".gmr", ".gmrb"])
def test_a_sibling_that_was_turned_by_itself_is_written_turned(
    walk: Motion, tmp_path: Path, suffix: str
) -> None:
    edited = turned_root(walk, "RHipJoint")
    joined = edited.join("RHipJoint")
    assert_same_motion(joined, edited)
    assert joined.skeleton.slots[walk.skeleton.index("RHipJoint")] == walk.skeleton.slot_count
    gmr.write(edited, tmp_path / f"edited{suffix}")
    read = gmr.read(tmp_path / f"edited{suffix}")
    assert_same_places(read, edited)
    assert_same_motion(forest.home(read), read)


def test_a_joint_that_moves_gets_position_channels_and_keeps_those_of_all_others(
    walk: Motion, tmp_path: Path
) -> None:
    apart = walk.split("LeftHand")
    hand = apart.skeleton.index("LeftHand")
    translations = apart.translations.copy()
    translations[10:30, apart.translated.tolist().index(hand), 1] += 2
    pose = Pose(apart.rotations, apart.translated, translations, apart.layout)
    lifted = replace(apart, source=pose).join("LeftHand")
    gmr.write(lifted, tmp_path / "lifted.bvh")
    read = gmr.read(tmp_path / "lifted.bvh")
    np.testing.assert_allclose(read.positions(dtype=float), lifted.positions(dtype=float), rtol=0, atol=1e-9)
    assert read.layout is not None
    assert walk.layout is not None
    before, after = list(walk.layout.names), list(read.layout.names)
    assert after[hand][:3] == ("Xposition", "Yposition", "Zposition")
    assert set(after.pop(hand)) >= set(before.pop(hand))
    assert after == before


def test_an_end_site_can_be_a_root_in_a_file(walk: Motion, tmp_path: Path) -> None:
    part = walk.select(["Hips", "LeftHandIndex1_end"])
    gmr.write(part, tmp_path / "part.bvh")
    read = gmr.read(tmp_path / "part.bvh")
    assert_same_places(read, part)


@pytest.mark.parametrize("root", ["LeftFoot", "Neck1", "RightHand"])
def test_dropped_dummies_further_roots_and_another_rate_go_together(
    walk: Motion, tmp_path: Path, root: str
) -> None:
    lean = walk.drop_dummies().with_roots(["Hips", root]).resample(77)
    whole = lean.restore_dummies()
    joints = whole.skeleton.indices(lean.skeleton.names)
    np.testing.assert_allclose(
        whole.positions(dtype=float, joints=joints), lean.positions(dtype=float), rtol=0, atol=1e-11
    )
    gmr.write(lean, tmp_path / "lean.bvh")
    read = gmr.read(tmp_path / "lean.bvh")
    assert_same_places(read, lean)
