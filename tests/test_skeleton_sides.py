"""Left and right, told from the names of real rigs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

import gmr
from gmr import Motion, Skeleton, SkeletonError
from gmr.sides import other_side, pair_joints
from strategies import symmetric_motions


def tree(**parents: str) -> Skeleton:
    """Joints by name, each with its parent's; "" for a root."""
    names = list(parents)
    indices = [names.index(parent) if parent else -1 for parent in parents.values()]
    return Skeleton.post_rotation(names, indices, np.zeros((len(names), 3)))


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("LeftUpLeg", "RightUpLeg"), ("Left Shoulder", "Right Shoulder"), ("left_hip", "right_hip"),
        ("mixamorig:LeftFoot", "mixamorig:RightFoot"), ("hipLeft", "hipRight"), ("leftfoot", "rightfoot"),
        ("LEFT_ARM", "RIGHT_ARM"), ("UpperLeg_L", "UpperLeg_R"), ("thigh.l", "thigh.r"), ("l_arm", "r_arm"),
        ("Bip01 L Thigh", "Bip01 R Thigh"), ("LHipJoint", "RHipJoint"), ("lfemur", "rfemur"),
        ("lThigh", "rThigh"), ("FootL", "FootR"),
    ],
)  # fmt: skip
def test_names_of_the_two_sides_are_told(left: str, right: str) -> None:
    assert right in other_side(left)
    assert left in other_side(right)


@pytest.mark.parametrize("name", ["Hips", "Spine1", "Head", "Neck", "Chest", "T8", ""])
def test_names_in_the_middle_have_no_other_side(name: str) -> None:
    assert other_side(name) == ()


@given(symmetric_motions())
def test_pairs_go_both_ways_and_keep_the_hierarchy(motion: Motion) -> None:
    skeleton = motion.skeleton
    pair = pair_joints(skeleton)
    assert np.array_equal(pair[pair], np.arange(skeleton.joint_count))
    above = skeleton.parents >= 0
    assert np.array_equal(skeleton.parents[pair[above]], pair[skeleton.parents[above]])
    sided = [joint for joint, name in enumerate(skeleton.names) if "Limb" in name]
    assert (pair[sided] != sided).all()


def test_the_l_of_a_vertebra_is_no_side() -> None:
    skeleton = tree(joint_Root="", L5="joint_Root", lowerback="L5", upright="lowerback")
    assert pair_joints(skeleton).tolist() == [0, 1, 2, 3]


def test_joints_below_a_sided_one_need_no_side_in_their_names() -> None:
    skeleton = Skeleton.post_rotation(
        ["Hips", "LeftHand", "Thumb", "RightHand", "Thumb"], [-1, 0, 1, 0, 3], np.zeros((5, 3))
    )
    assert pair_joints(skeleton).tolist() == [0, 3, 4, 1, 2]


def test_an_unpaired_joint_is_named_with_its_remedy() -> None:
    with pytest.raises(SkeletonError, match=r"'LeftHand' \(hanging on 'Hips'\) has no mirror image.*pairs="):
        pair_joints(tree(Hips="", LeftHand="Hips", Tail="Hips"))
    with pytest.raises(SkeletonError, match="'LeftHand' hangs on a joint that is not the mirror image"):
        pair_joints(tree(Hips="", Chest="Hips", LeftHand="Chest", RightHand="Hips"))


def test_pairs_can_be_stated() -> None:
    skeleton = tree(Hips="", Port="Hips", Starboard="Hips", LeftOver="Hips")
    stated = {"Port": "Starboard", "LeftOver": "LeftOver"}
    assert pair_joints(skeleton, stated).tolist() == [0, 2, 1, 3]
    assert pair_joints(skeleton, list(stated.items())).tolist() == [0, 2, 1, 3]
    with pytest.raises(SkeletonError, match="no joint 'Bow'"):
        pair_joints(skeleton, {"Bow": "Stern"})
    with pytest.raises(SkeletonError, match="two partners"):
        pair_joints(skeleton, [("Port", "Starboard"), ("Port", "Hips")])


@pytest.mark.parametrize(
    ("file", "paired"), [("cmu_07_01.bvh", 30), ("cmu_10_03.bvh", 52), ("cmu_12_01.bvh", 30)]
)
def test_real_bodies_are_symmetric(file: str, paired: int, data: Path) -> None:
    skeleton = gmr.read(data / file).skeleton
    pair = pair_joints(skeleton)
    for joint in np.flatnonzero(pair != np.arange(len(pair))).tolist():
        assert skeleton.names[pair[joint]] in other_side(skeleton.names[joint])
    assert (pair != np.arange(len(pair))).sum() == paired
