"""Which joints have a role: names of real exporters, shapes without names, clear errors for the rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gmr
from gmr.body.joints import Joints
from gmr.body.naming import CONVENTIONS, roles_by_name, side_and_part
from gmr.errors import DatasetError
from gmr.matching import find_joints
from gmr.motion import Motion
from gmr.skeleton import Skeleton
from walkers import CMU, body, walker

EXPORTERS = {
    "CMU by cgspeed": "Hips LHipJoint LeftUpLeg LeftLeg LeftFoot LeftToeBase RHipJoint RightUpLeg "
    "RightLeg RightFoot RightToeBase LowerBack Spine Spine1 Neck Neck1 Head "
    "LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder RightArm RightForeArm "
    "RightHand",
    "CMU with 43 joints": "hip abdomen chest neck head leftEye rightEye rCollar rShldr rForeArm rHand "
    "lCollar lShldr lForeArm lHand rButtock rThigh rShin rFoot lButtock lThigh lShin "
    "lFoot",
    "Bandai-Namco": "joint_Root Hips Spine Chest Neck Head Shoulder_L UpperArm_L LowerArm_L Hand_L "
    "Shoulder_R UpperArm_R LowerArm_R Hand_R UpperLeg_L LowerLeg_L Foot_L Toes_L "
    "UpperLeg_R LowerLeg_R Foot_R Toes_R",
    "Mixamo": "mixamorig:Hips mixamorig:Spine mixamorig:Neck mixamorig:Head "
    "mixamorig:LeftShoulder mixamorig:LeftArm mixamorig:LeftForeArm "
    "mixamorig:RightShoulder mixamorig:RightArm mixamorig:RightUpLeg "
    "mixamorig:RightLeg mixamorig:RightFoot mixamorig:RightToeBase "
    "mixamorig:LeftUpLeg mixamorig:LeftLeg mixamorig:LeftFoot mixamorig:LeftToeBase",
    "LaFAN1": "Hips LeftUpLeg LeftLeg LeftFoot LeftToe RightUpLeg RightLeg RightFoot RightToe "
    "Spine Spine1 Spine2 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand "
    "RightShoulder RightArm RightForeArm RightHand",
    "Xsens": "Pelvis L5 L3 T12 T8 Neck Head RightShoulder RightUpperArm RightForeArm RightHand "
    "LeftShoulder LeftUpperArm LeftForeArm LeftHand RightUpperLeg RightLowerLeg "
    "RightFoot RightToe LeftUpperLeg LeftLowerLeg LeftFoot LeftToe",
    "MVN's BVH": "Hips Chest Chest2 Neck Head RightCollar RightShoulder RightElbow RightWrist "
    "LeftCollar LeftShoulder LeftElbow LeftWrist RightHip RightKnee RightAnkle "
    "RightToe LeftHip LeftKnee LeftAnkle LeftToe",
    "Rokoko": "Hips Spine1 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder "
    "RightArm RightForeArm RightHand LeftThigh LeftShin LeftFoot LeftToe RightThigh "
    "RightShin RightFoot RightToe",
    "Unreal": "root pelvis spine_01 clavicle_l upperarm_l lowerarm_l hand_l clavicle_r "
    "upperarm_r lowerarm_r hand_r neck_01 head thigh_l thigh_twist_01_l calf_l foot_l "
    "ball_l thigh_r calf_r foot_r ball_r",
    "3ds Max Biped": "Bip01 Bip01_Pelvis Bip01_Spine Bip01_Neck Bip01_Head Bip01_L_Clavicle "
    "Bip01_L_UpperArm Bip01_R_Clavicle Bip01_R_UpperArm Bip01_L_Thigh Bip01_L_Calf "
    "Bip01_L_Foot Bip01_L_Toe0 Bip01_R_Thigh Bip01_R_Calf Bip01_R_Foot Bip01_R_Toe0",
    "Rigify": "spine thigh.L shin.L foot.L toe.L thigh.R shin.R foot.R toe.R upper_arm.L "
    "upper_arm.R hips head",
    "SMPL": "Pelvis L_Hip R_Hip Spine1 L_Knee R_Knee L_Ankle R_Ankle L_Foot R_Foot Neck "
    "L_Collar R_Collar Head L_Shoulder R_Shoulder",
    "ASF names": "root lowerback thorax neck head lshoulderjoint lhumerus lradius rshoulderjoint "
    "rhumerus rradius rfemur rtibia rfoot rtoes lfemur ltibia lfoot ltoes",
}

EXPECTED = {
    "CMU by cgspeed": ("Hips", "LeftUpLeg", "LeftFoot", "LeftToeBase", "LeftArm"),
    "CMU with 43 joints": ("hip", "lThigh", "lFoot", None, "lShldr"),
    "Bandai-Namco": ("Hips", "UpperLeg_L", "Foot_L", "Toes_L", "UpperArm_L"),
    "Mixamo": ("mixamorig:Hips", "mixamorig:LeftUpLeg", "mixamorig:LeftFoot", "mixamorig:LeftToeBase"),
    "LaFAN1": ("Hips", "LeftUpLeg", "LeftFoot", "LeftToe", "LeftArm"),
    "Xsens": ("Pelvis", "LeftUpperLeg", "LeftFoot", "LeftToe", "LeftUpperArm"),
    "MVN's BVH": ("Hips", "LeftHip", "LeftAnkle", "LeftToe", "LeftShoulder"),
    "Rokoko": ("Hips", "LeftThigh", "LeftFoot", "LeftToe", "LeftArm"),
    "Unreal": ("pelvis", "thigh_l", "foot_l", "ball_l", "upperarm_l"),
    "3ds Max Biped": ("Bip01_Pelvis", "Bip01_L_Thigh", "Bip01_L_Foot", "Bip01_L_Toe0", "Bip01_L_UpperArm"),
    "Rigify": ("hips", "thigh.L", "foot.L", "toe.L", "upper_arm.L"),
    "SMPL": ("Pelvis", "L_Hip", "L_Ankle", "L_Foot", "L_Shoulder"),
    "ASF names": ("root", "lfemur", "lfoot", "ltoes", "lhumerus"),
}


@pytest.mark.parametrize("exporter", EXPORTERS)
def test_names_of_common_skeletons_tell_the_roles(exporter: str) -> None:
    names = EXPORTERS[exporter].split()
    roles = roles_by_name(names, CONVENTIONS[0])
    found = [roles.get(role) for role in ("hips", "left_up_leg", "left_foot", "left_toe", "left_shoulder")]
    expected = EXPECTED[exporter]
    assert tuple(None if joint is None else names[joint] for joint in found)[: len(expected)] == expected
    assert {"right_up_leg", "right_foot", "right_shoulder"} <= set(roles)


@pytest.mark.parametrize(
    ("name", "side", "part"),
    [
        ("mixamorig:LeftUpLeg", "left", "upleg"),
        ("upleg_l", "left", "upleg"),
        ("L UpLeg", "left", "upleg"),
        ("RThumb", "right", "thumb"),
        ("lfoot", "left", "foot"),
        ("LEFTFOOT", "left", "foot"),
        ("Skeleton_001_RThigh", "right", "thigh"),
        ("ValveBiped.Bip01_R_Foot", "right", "foot"),
        ("lowerback", "", "lowerback"),
        ("rig|root", "", "root"),
        ("L5", "left", "5"),
        ("", "", ""),
    ],
)
def test_a_name_tells_side_and_part(name: str, side: str, part: str) -> None:
    assert side_and_part(name) == (side, part)


def found_in(motion: Motion, names: dict[str, str | int] | None = None) -> Joints:
    return find_joints(motion.skeleton, motion.positions(dtype=np.float64)[::10], names)


def test_real_files_are_understood(data: Path) -> None:
    cgspeed = gmr.read(data / "cmu_07_01.bvh")[1:]
    assert found_in(cgspeed).described(cgspeed.skeleton) == {
        "hips": "Hips",
        "left_up_leg": "LeftUpLeg",
        "right_up_leg": "RightUpLeg",
        "left_foot": "LeftFoot",
        "right_foot": "RightFoot",
        "left_shoulder": "LeftArm",
        "right_shoulder": "RightArm",
        "left_toe": "LeftToeBase",
        "right_toe": "RightToeBase",
        "head": "Head",
    }
    poser = gmr.read(data / "cmu_10_03.bvh")
    assert found_in(poser).described(poser.skeleton)["left_foot"] == "lFoot"


def nameless() -> dict[str, str]:
    return {part: f"bone_{number:02}" for number, part in enumerate(CMU)}


def test_a_body_with_names_that_say_nothing_is_known_by_its_shape() -> None:
    motion = walker(names=nameless())
    joints = found_in(motion)
    parts = list(CMU)
    assert joints.found_by == "shape"
    assert {role: parts[joint] for role, joint in joints.roles.items()} == {
        role: role for role in ("hips", "left_up_leg", "right_up_leg", "left_foot", "right_foot")
    }


def test_names_where_a_joint_is_named_for_the_bone_that_ends_in_it_are_told_by_the_shape() -> None:
    asf = nameless() | {
        "hips": "root", "left_up_leg": "lhipjoint", "left_knee": "lfemur", "left_foot": "ltibia",
        "left_toe": "lfoot", "right_up_leg": "rhipjoint", "right_knee": "rfemur", "right_foot": "rtibia",
        "right_toe": "rfoot",
    }  # fmt: skip
    motion = walker(names=asf)
    joints = found_in(motion)
    assert joints.found_by == "names"
    assert joints.described(motion.skeleton)["left_foot"] == "ltibia"
    assert joints.described(motion.skeleton)["right_toe"] == "rfoot"


def test_joints_that_the_caller_names_go_before_any_guess() -> None:
    motion = walker()
    joints = found_in(motion, {"left_foot": "LeftToeBase", "right_foot": "RightToeBase"})
    assert motion.skeleton.names[joints["left_foot"]] == "LeftToeBase"
    assert motion.skeleton.names[joints["left_up_leg"]] == "LeftUpLeg"
    assert joints.found_by == "given"


def test_a_wrong_role_is_refused_and_says_what_contradicts_it() -> None:
    motion = walker()
    for names, reason in (
        ({"left_foot": "RightFoot"}, "cannot be the right foot too"),
        ({"left_foot": "Head"}, "'Head' .left_foot. does not lie below"),
        ({"left_up_leg": "Hips", "right_up_leg": "Hips"}, "are in the same place"),
        ({"hips": "Head"}, "lies farther from 'Head'"),
        (
            {
                "left_foot": "RightFoot",
                "right_foot": "LeftFoot",
                "left_up_leg": "RightUpLeg",
                "right_up_leg": "LeftUpLeg",
            },
            "left and right are swapped",
        ),
    ):
        with pytest.raises(DatasetError, match=reason) as caught:
            found_in(motion, dict(names))
        assert "names={" in str(caught.value)


def test_unknown_roles_and_joints_are_refused_with_what_there_is() -> None:
    with pytest.raises(DatasetError, match="no role is called 'left_paw'; the roles are hips"):
        found_in(walker(), {"left_paw": "LeftFoot"})
    with pytest.raises(DatasetError, match="did you mean 'LeftFoot'"):
        found_in(walker(), {"left_foot": "LeftFoo"})


def test_a_skeleton_without_feet_is_refused_with_its_joints_and_the_remedy() -> None:
    skeleton = body()
    kept = [skeleton.index(name) for name in ("Hips", "Spine", "Head", "LeftArm", "RightArm")]
    names = [skeleton.names[joint] for joint in kept]
    poses = walker().positions(dtype=np.float64)[::30, kept]
    torso = Skeleton.post_rotation(names, [-1, 0, 1, 1, 1], skeleton.offsets[kept])
    with pytest.raises(
        DatasetError, match=r"left foot or right foot\. The joints are 'Hips', .*names=\{'hips'"
    ):
        find_joints(torso, poses)
