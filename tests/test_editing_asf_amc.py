"""Edits of AMC files: axes, limits and every value that the edit leaves alone stay as they were read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr import Motion, SkeletonError
from gmr.arrays import read_only
from gmr.dof_rows import DofRows
from gmr.editing import grip, lock_feet, reach, warp_path
from gmr.editing.limbs import hands_of, limb_that_moves
from gmr.editing.roles import known_roles
from gmr.frames import Pose
from gmr.skeleton import Skeleton


@pytest.fixture
def take(data: Path) -> Motion:
    return gmr.read(data / "amc" / "07_01.amc")


def dofs(motion: Motion) -> DofRows:
    assert isinstance(motion.source, DofRows)
    return motion.source


def test_a_joint_that_was_moved_is_not_lost_but_refused(take: Motion, tmp_path: Path) -> None:
    apart = take.split("lfoot")
    moved = apart.translations.copy()
    moved[:, apart.translated.tolist().index(apart.skeleton.index("lfoot"))] += 3
    pose = Pose(apart.rotations, apart.translated, read_only(moved), acclaim=apart.acclaim)
    with pytest.raises(SkeletonError, match="joint 'lfoot' moves"):
        gmr.write(replace(apart, source=pose).join("lfoot"), tmp_path / "moved.amc")


def test_an_edit_keeps_bones_and_all_values_that_it_does_not_change(take: Motion, tmp_path: Path) -> None:
    point = take.positions(joints=["rhumerus"])[15, 0] + np.array([0, 2, 4])
    edited = reach(take, "rhand", point, frame=15, window=0.05).motion
    before, after = dofs(take), dofs(edited)
    arm = {"rclavicle", "rhumerus", "rradius", "rwrist", "rhand"}
    for joint, name in enumerate(take.skeleton.names):
        ours = after.values[:, after.acclaim.starts[joint] : after.acclaim.starts[joint + 1]]
        theirs = before.values[:, before.acclaim.starts[joint] : before.acclaim.starts[joint + 1]]
        if name not in arm:
            assert ours.tobytes() == theirs.tobytes()
        elif ours.shape == theirs.shape:
            assert ours[:8].tobytes() == theirs[:8].tobytes()
    old, new = before.acclaim, after.acclaim
    assert [bone.axis for bone in new.bones] == [bone.axis for bone in old.bones]
    assert {bone.name for one, bone in zip(old.bones, new.bones, strict=True) if one != bone} <= arm
    gmr.write(edited, tmp_path / "edited.amc")
    again = gmr.read(tmp_path / "edited.amc")
    assert again == edited
    assert np.abs(again.positions(joints=["rhand"])[15, 0] - point).max() < 1e-4


@pytest.mark.parametrize("radians", [False, True])
def test_the_places_of_an_edit_are_those_of_its_values(take: Motion, radians: bool) -> None:
    if radians:
        held = dofs(take)
        values = np.where(held.acclaim.turns, np.radians(held.values), held.values)
        take = replace(take, source=replace(held, values=values, radians=True))
    for edit in (lock_feet, lambda motion: warp_path(motion, turn_deg=200)):
        edited = edit(take).motion
        as_pose = replace(take, source=replace(take.pose, acclaim=None))
        wanted = edit(as_pose).motion.positions(dtype=float)
        assert dofs(edited).radians == radians
        assert np.abs(edited.positions(dtype=float) - wanted).max() < 1e-9
        steps = np.abs(np.diff(dofs(edited).values, axis=0)).max()
        assert steps < (1 if radians else 60)  # no angle jumps by a turn


def test_a_limb_begins_in_shoulder_or_hip_though_joints_are_named_for_the_bones_above(take: Motion) -> None:
    names = take.skeleton.names
    roles = known_roles(take)
    for joint, limb in (
        ("rhand", ("rclavicle", "rhumerus", "rhand")),
        ("ltoes", ("lhipjoint", "lfemur", "ltibia")),
    ):
        found = limb_that_moves(take.skeleton, joint, roles)
        assert tuple(names[one] for one in (found.top, found.middle, found.end)) == limb
    places = take.positions(dtype=float, joints=["rclavicle", "rhumerus", "rhand"])[10]
    reachable = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    point = places[0] + 0.98 * reachable * np.array([0.0, 0.0, 1.0])
    assert reach(take, "rhand", point, frame=10).report.missed < 1e-9


def test_hands_are_found_however_they_are_called(take: Motion) -> None:
    assert grip(take).report.joints == ("lhand", "rhand")
    names = [f"mixamorig:{name}" for name in ("Hips", "LeftHand", "RightHand", "LeftHandIndex1")]
    mixamo = Skeleton.post_rotation(names, [-1, 0, 0, 1], np.zeros((4, 3)))
    assert hands_of(mixamo) == (1, 2)
    with pytest.raises(SkeletonError, match="no joint is named as the left hand; name both: joints="):
        hands_of(Skeleton.post_rotation(["Hips", "RightHand"], [-1, 0], np.zeros((2, 3))))
