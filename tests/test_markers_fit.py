"""From markers to a motion: exact where markers are, honest where they are not."""

from __future__ import annotations

import json
import os
import warnings
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import gmr
from gmr.guesses import guess_body
from gmr.markers import MarkerFit, Markers, Up, load_relation, read_relation, wear
from marker_scene import PARTS, exchanged, hanging_axes, hidden, noisy, walk, worn
from marker_scene import places as ior_places

Array = NDArray[np.float64]

DATA = os.environ.get("GMR_DATA")

JOINTS = [joint for joint in PARTS if joint != "Hips"]


def places(motion: gmr.Motion, joints: list[str]) -> Array:
    """(F, K, 3) metres."""
    unit = motion.unit or 1.0
    return np.asarray(motion.positions(dtype=np.float64, joints=joints) * unit, np.float64)


def off(fit: MarkerFit, joints: list[str] = JOINTS) -> Array:
    """(F, K) metres from the joints of a fit to the true ones."""
    return np.asarray(np.linalg.norm(places(fit.motion, joints) - places(walk(), joints), axis=2))


def test_without_noise_every_joint_is_where_it_was() -> None:
    fit = worn().fit("ior")
    assert off(fit).max() < 1e-9
    assert np.nanmax(fit.residuals) < 1e-9
    assert not fit.left_out
    assert not fit.unknown


@pytest.mark.parametrize("seed", range(3))
def test_noise_moves_joints_little(seed: int) -> None:
    """Half a millimetre of noise: the legs within a centimetre, the others as well as anatomy knows them."""
    found = off(noisy(worn(), 0.5, seed).fit("ior")).max(axis=0)
    assert found.max() < 0.03
    legs = [k for k, joint in enumerate(JOINTS) if joint.endswith(("Leg", "Foot"))]
    assert found[legs].max() < 0.012


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10)
def test_where_the_laboratory_is_and_faces_changes_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = Rotation.from_euler("y", rng.uniform(-np.pi, np.pi)).as_matrix()
    step = rng.uniform(-5, 5, 3)
    markers = noisy(worn(), 1.0)
    here = markers.fit("ior").motion
    there = replace(markers, positions=markers.positions @ turn.T + step).fit("ior").motion
    np.testing.assert_allclose(there.skeleton.offsets, here.skeleton.offsets, atol=1e-7)
    np.testing.assert_allclose(
        there.positions(dtype=np.float64), here.positions(dtype=np.float64) @ turn.T + step, atol=1e-7
    )


@pytest.mark.parametrize("axis", ["+X", "-X", "+Z", "-Z", "-Y"])
@pytest.mark.parametrize("told", [True, False])
def test_any_axis_may_be_up_and_the_body_tells_which(axis: str, told: bool) -> None:
    markers = worn().with_up(axis)
    if not told:
        markers = replace(markers, up=None)
    fit = markers.fit("ior")
    here = worn().fit("ior").motion
    apart = places(fit.motion, JOINTS)[..., 1] - places(here, JOINTS)[..., 1]
    np.testing.assert_allclose(apart, 0, atol=1e-9)
    assert any("nothing says which way is up" in note for note in fit.notes) is not told


def test_a_body_along_another_axis_is_said() -> None:
    fit = replace(worn(), up=Up("+Z", "a mistake")).fit("ior")
    assert any("does not stand upright" in note for note in fit.notes)


@pytest.mark.parametrize("unit", ["mm", "cm", "in"])
def test_the_motion_keeps_the_unit_of_the_recording(unit: str) -> None:
    motion = worn().to_unit(unit).fit("ior").motion
    assert motion.unit == gmr.units.UNITS[unit]
    np.testing.assert_allclose(places(motion, JOINTS), places(walk(), JOINTS), atol=1e-9)


def test_at_rest_the_body_stands_upright_and_faces_forward() -> None:
    motion = noisy(worn(), 0.5).fit("ior").motion
    skeleton = motion.skeleton
    rest = {name: np.zeros(3) for name in skeleton.names}
    for joint in skeleton.parents_first:
        if skeleton.parents[joint] >= 0:
            above = skeleton.names[skeleton.parents[joint]]
            rest[skeleton.names[joint]] = rest[above] + skeleton.offsets[joint]
    assert rest["Head_end"][1] > rest["Head"][1] > rest["Hips"][1] > rest["LeftLeg"][1] > rest["LeftFoot"][1]
    assert rest["LeftUpLeg"][0] > 0 > rest["RightUpLeg"][0]
    assert rest["LeftFoot_end"][2] > rest["LeftFoot"][2] + 0.05
    assert rest["LeftHand"][1] < rest["LeftForeArm"][1] < rest["LeftArm"][1]
    assert guess_body(motion).up is not None


def test_a_joint_turns_what_hangs_on_it_and_bones_keep_their_length() -> None:
    motion = noisy(worn(), 1.0).fit("ior").motion
    assert motion.joint_rotations().shape == (316, motion.skeleton.joint_count, 4)
    positions = motion.positions(dtype=np.float64)
    for joint, parent in enumerate(motion.skeleton.parents.tolist()):
        if parent >= 0:
            lengths = np.linalg.norm(positions[:, joint] - positions[:, parent], axis=1)
            np.testing.assert_allclose(lengths, np.linalg.norm(motion.skeleton.offsets[joint]), atol=1e-9)


def test_measured_bones_put_every_part_where_it_was_fitted() -> None:
    """``M_c = M_parent L_c`` holds to rounding where the translations of ``L_c`` are kept."""
    fit = noisy(worn(), 2.0).fit("ior", bones="measured")
    for segment in fit.segments.values():
        joint = segment.part.joint
        np.testing.assert_allclose(places(fit.motion, [joint])[:, 0], segment.fit.origins, atol=1e-9)
        turns = Rotation.from_quat(
            fit.motion.joint_rotations(dtype=np.float64)[:, fit.motion.skeleton.index(joint)]
        )
        apart = (Rotation.from_matrix(segment.fit.rotations).inv() * turns).magnitude()
        assert apart.max() < 1e-7


def test_markers_worn_by_the_motion_are_the_markers_measured() -> None:
    """Round: the motion that was fitted wears the templates where the markers were."""
    fit = noisy(worn(), 1.0).fit("ior", bones="measured")
    templates = {
        label: (segment.part.joint, tuple(segment.points[label]))
        for segment in fit.segments.values()
        for label in segment.labels
    }
    again = wear(fit.motion, templates)
    for k, label in enumerate(again.labels):
        column = fit.markers.index(label)
        apart = np.linalg.norm(again.positions[:, k] - fit.markers.positions[:, column], axis=1)
        np.testing.assert_allclose(1000 * apart, fit.residuals[:, column], atol=1e-6)


def test_a_short_time_without_a_part_is_bridged_and_said() -> None:
    markers = worn()
    for label in ("L_FLE", "L_FME"):
        markers = hidden(markers, label, 100, 12)
    fit = markers.fit("ior")
    assert [(s.first, s.length, s.became) for s in fit.stretches["left_thigh"]] == [(100, 12, "bridged")]
    assert not fit.unknown
    assert off(fit).max() < 0.02
    assert "left_thigh: frames 100 to 111: too few markers seen; bridged" in str(fit.report)


@pytest.mark.parametrize(("first", "length"), [(100, 40), (0, 3), (310, 6)])
def test_a_long_time_without_a_part_or_one_at_an_edge_is_unknown(first: int, length: int) -> None:
    markers = worn()
    for label in ("L_FLE", "L_FME"):
        markers = hidden(markers, label, first, length)
    fit = markers.fit("ior")
    held = places(fit.motion, ["LeftUpLeg", "LeftLeg", "LeftFoot", "RightLeg", "Head"])
    there = np.asarray(np.isfinite(held).all(axis=2))
    gone = np.zeros(len(there), np.bool_)
    gone[first : first + length] = True
    np.testing.assert_array_equal(there[:, 0], True)
    np.testing.assert_array_equal(there[:, 1:3], ~gone[:, None] * [True, True])
    np.testing.assert_array_equal(there[:, 3:], True)
    assert list(fit.unknown) == ["left_thigh", "left_shank"]
    assert "unknown, NaN in the motion" in str(fit.report)


def test_half_a_body_is_a_motion_of_that_half() -> None:
    below = [f"L_{label}" for label in ("FAX", "TTC", "WAND2", "FAL", "TAM", "FCC", "FM1", "FM5")]
    fit = worn().select(below).fit("ior")
    assert fit.motion.roots == ("LeftLeg",)
    assert fit.motion.skeleton.names == ("LeftLeg", "LeftFoot", "LeftFoot_end")
    assert off(fit, ["LeftFoot"]).max() < 0.02
    assert fit.left_out["pelvis"] == "none of its markers is in the recording"


def test_a_part_missing_in_the_middle_makes_a_forest() -> None:
    gone = ("L_FTC", "L_WAND1", "L_FLE", "L_FME")
    fit = worn().select([label for label in worn().labels if label not in gone]).fit("ior")
    assert fit.motion.roots == ("Hips", "LeftLeg")
    assert "left_thigh" in fit.left_out
    assert any("its joint is a root" in note for note in fit.segments["left_shank"].notes)
    assert off(fit, ["RightFoot", "Head", "LeftHand"]).max() < 1e-9


def test_a_part_with_two_markers_uses_its_joint_as_the_third() -> None:
    fit = worn().fit("ior")
    assert fit.segments["left_hand"].third
    assert off(fit, ["LeftHand", "RightHand"]).max() < 1e-9
    alone = worn().select([label for label in worn().labels if label != "L_HM5"]).fit("ior")
    assert alone.left_out["left_hand"] == "it has 1 marker of the 3 that a turn takes"


def test_a_part_that_lost_one_marker_of_several_is_fitted_and_says_so() -> None:
    fit = worn().select([label for label in worn().labels if label != "L_WAND2"]).fit("ior")
    assert off(fit).max() < 1e-9
    assert "without 'L_WAND2'" in fit.segments["left_shank"].notes


def test_an_exchange_shows_in_the_report() -> None:
    markers = exchanged(worn(), "L_FLE", "L_FME", 60, 20)
    notes = " ".join(markers.fit("ior").report.notes)
    assert "off its place on 'left_thigh'; look for exchanged markers" in notes
    undone = markers.undo_swaps(markers.findings("ior"))
    assert off(undone.fit("ior")).max() < 1e-9


def test_the_report_is_plain_and_its_figures_are_those_of_the_fit() -> None:
    fit = noisy(worn(), 1.0).fit("ior")
    plain = json.loads(json.dumps(fit.report.as_dict(), allow_nan=False))
    assert plain["mean"] == pytest.approx(np.nanmean(fit.residuals))
    thigh = next(part for part in plain["parts"] if part["part"] == "left_thigh")
    column = fit.markers.index(thigh["worst_marker"])
    assert fit.residuals[thigh["worst_frame"], column] == pytest.approx(thigh["worst"])
    bone = next(bone for bone in plain["bones"] if bone["lower"] == "LeftLeg")
    offset = fit.motion.skeleton.offsets[fit.motion.skeleton.index("LeftLeg")]
    assert bone["length"] == pytest.approx(1000 * np.linalg.norm(offset))
    assert 0 < bone["variation"] < 5
    for line in ("left_thigh", "LeftUpLeg - LeftLeg", "Harrington"):
        assert line in str(fit.report)


def test_the_motion_survives_a_bvh_file(tmp_path: Path) -> None:
    motion = noisy(worn(), 1.0).to_unit("mm").fit("ior").motion
    gmr.write(motion, tmp_path / "walk.bvh")
    again = gmr.read(tmp_path / "walk.bvh")
    assert again.skeleton.names == motion.skeleton.names
    np.testing.assert_allclose(
        again.positions(dtype=np.float64), motion.positions(dtype=np.float64), atol=1e-6
    )


def test_the_picture_shows_every_marker_and_bone_in_every_frame() -> None:
    fit = worn().fit("ior")
    drawn = ElementTree.fromstring(fit.picture(4))
    name = "{http://www.w3.org/2000/svg}"
    bones = fit.motion.skeleton.joint_count - 1
    assert len(drawn.findall(f"{name}circle")) == 2 * 4 * len(fit.markers.labels)
    assert len(drawn.findall(f"{name}line")) == 2 * (4 * bones + 1)


def test_what_cannot_be_fitted_is_refused() -> None:
    with pytest.raises(gmr.GmrError, match="does not say in what unit it is; declare it first"):
        worn().with_unit(None).fit("ior")
    with pytest.raises(gmr.GmrError, match="has no frames"):
        worn()[:0].fit("ior")
    with pytest.raises(ValueError, match="bones='rubber' is not known"):
        worn().fit("ior", bones="rubber")


def plug_in_gait() -> Markers:
    """The walk wearing Plug-in Gait, knees, ankles and elbows as the relation supposes them."""
    skeleton = walk().skeleton
    found: dict[str, tuple[str, Array]] = {}
    named = {"LASI": "L_IAS", "RASI": "R_IAS", "LPSI": "L_IPS", "RPSI": "R_IPS", "C7": "CV7", "T10": "TV8"}
    named |= {
        "CLAV": "SNJ",
        "STRN": "SXS",
        "LSHO": "L_SAJ",
        "RSHO": "R_SAJ",
        "LFHD": "L_HDF",
        "RFHD": "R_HDF",
    }
    named |= {"LBHD": "L_HDB", "RBHD": "R_HDB"}
    ior = ior_places()
    found |= {label: ior[other] for label, other in named.items()}
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        letter = side[0]
        for part, lower, outside, on, width in (
            ("UpLeg", "Leg", "KNE", "THI", 0.06),
            ("Leg", "Foot", "ANK", "TIB", 0.043),
            ("Arm", "ForeArm", "ELB", "UPA", 0.045),
        ):
            offset = skeleton.offsets[skeleton.index(f"{side}{lower}")]
            axes = hanging_axes(offset)
            # Seen from the lower joint, the marker beside it and the upper joint are at a right angle.
            found[f"{letter}{outside}"] = f"{side}{part}", offset + sign * width * axes[:, 0]
            found[f"{letter}{on}"] = f"{side}{part}", 0.5 * offset + sign * 0.09 * axes[:, 0]
        for label, other in (
            ("WRA", "RSP"),
            ("WRB", "UHE"),
            ("FRM", "WAND4"),
            ("HEE", "FCC"),
            ("TOE", "FM2"),
        ):
            found[f"{letter}{label}"] = ior[f"{letter}_{other}"]
    return wear(walk(), {label: (joint, tuple(place)) for label, (joint, place) in found.items()})


def test_plug_in_gait_makes_a_motion_with_joints_as_third_points() -> None:
    """Hips are where Harrington has them, 1 to 2 cm off this body's: what hangs on them is off as far."""
    fit = plug_in_gait().fit()
    assert fit.relation.name == "Plug-in Gait full body"
    assert fit.segments["left_thigh"].third
    assert fit.segments["left_shank"].third
    assert off(fit, ["LeftUpLeg", "RightUpLeg"]).max() < 0.02
    assert off(fit, ["LeftLeg", "RightLeg", "LeftFoot", "RightFoot"]).max() < 0.02
    assert off(fit, ["LeftArm", "LeftForeArm"]).max() < 0.02


def test_a_relation_of_ones_own_may_offer_only_what_the_motion_tells() -> None:
    text = """
    [parts.pelvis]
    joint = "Hips"
    markers = ["L_IAS", "R_IAS", "L_IPS", "R_IPS"]
    left = { from = ["R_IAS"], to = ["L_IAS"] }
    forward = { from = ["L_IPS", "R_IPS"], to = ["L_IAS", "R_IAS"] }

    [parts.thigh]
    joint = "LeftUpLeg"
    parent = "pelvis"
    markers = ["L_FTC", "L_WAND1", "L_FLE", "L_FME"]
    up = { from = ["L_FLE", "L_FME"], to = ["LeftUpLeg"] }
    left = { from = ["L_FME"], to = ["L_FLE"] }
    """
    fit = worn().fit(read_relation(text.encode(), "mine.toml"))
    assert off(fit, ["LeftUpLeg"]).max() < 1e-9
    assert fit.report.joints[0].weight == 1
    assert fit.report.joints[0].rule == ""


@pytest.fixture(scope="module")
def qualisys() -> Markers:
    if DATA is None:
        pytest.skip("GMR_DATA is not set")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gmr.FormatWarning)
        return gmr.read_markers(Path(DATA) / "c3d" / "Qualisys.c3d")


def test_a_real_walk_has_a_possible_body(qualisys: Markers) -> None:
    fit = qualisys.fit()
    assert fit.relation is load_relation("ior")
    means = [part.mean for part in fit.report.parts]
    assert min(means) > 0.5
    assert max(means) < 3.35
    assert np.nanmax(fit.residuals) < 11.5
    lengths = {bone.lower: bone.length for bone in fit.report.bones}
    pelvis = fit.segments["pelvis"].points
    assert 0.160 < np.linalg.norm(pelvis["LeftUpLeg"] - pelvis["RightUpLeg"]) < 0.200
    for joint in ("Leg", "Foot", "ForeArm", "Hand"):
        assert lengths[f"Left{joint}"] == pytest.approx(lengths[f"Right{joint}"], rel=0.03)
    assert max(bone.variation for bone in fit.report.bones) < 10
    thighs = [fit.segments[f"{side}_thigh"].centre for side in ("left", "right")]
    for estimate, width in (("functional", 0.277), ("anatomical", 0.173)):
        left, right = (getattr(centre, estimate) for centre in thighs)
        assert np.linalg.norm(left - right) == pytest.approx(width, abs=0.001)


def test_in_a_real_walk_knees_bend_forward_and_feet_stay_on_the_floor(qualisys: Markers) -> None:
    motion = qualisys.fit("ior").motion
    forward = places(motion, ["Hips"])[-1, 0] - places(motion, ["Hips"])[0, 0]
    forward /= np.linalg.norm(forward)
    for side in ("Left", "Right"):
        hip, knee, foot, toe = np.moveaxis(
            places(motion, [f"{side}UpLeg", f"{side}Leg", f"{side}Foot", f"{side}Foot_end"]), 1, 0
        )
        straight = (
            hip
            + (foot - hip)
            * (
                np.linalg.norm(knee - hip, axis=1)
                / (np.linalg.norm(knee - hip, axis=1) + np.linalg.norm(foot - knee, axis=1))
            )[:, None]
        )
        assert ((knee - straight) @ forward).min() > -0.02
        assert ((knee - straight) @ forward).max() > 0.1
        assert 0.0 < toe[:, 1].min() < 0.05
        assert 0.03 < foot[:, 1].min() < 0.12
        assert ((toe - foot) @ forward).mean() > 0.05


SHOULDER = """
name = "right shoulder"

[parts.trunk]
joint = "Spine"
markers = ["STERr", "STERl", "STER", "XIPH", "T1", "T10"]
up = { from = ["XIPH", "T10"], to = ["STER", "T1"] }
forward = { from = ["T1", "T10"], to = ["STER", "XIPH"] }

[parts.upper_arm]
joint = "RightArm"
parent = "trunk"
markers = ["DELT", "ARMl", "ARMm", "ARMp_up", "ARMp_do", "EPICl", "EPICm"]
up = { from = ["RightForeArm"], to = ["RightArm"] }
left = { from = ["EPICl"], to = ["EPICm"] }

[parts.forearm]
joint = "RightForeArm"
parent = "upper_arm"
markers = ["LARMm", "LARMl", "LARM_elb", "LARM_ant", "STYLr", "STYLr_up", "STYLu", "WRIST"]
up = { from = ["STYLr", "STYLu"], to = ["RightForeArm"] }
left = { from = ["STYLr"], to = ["STYLu"] }
centre = { rule = "midpoint", of = ["EPICl", "EPICm"] }
"""


def test_a_real_arm_is_fitted_by_a_relation_of_ones_own() -> None:
    if DATA is None:
        pytest.skip("GMR_DATA is not set")
    markers = gmr.read_markers(Path(DATA) / "c3d" / "Vicon.c3d")
    fit = markers.fit(read_relation(SHOULDER.encode(), "shoulder.toml"), subject="Daphnee")
    assert fit.motion.roots == ("Spine",)
    lengths = {bone.lower: bone.length for bone in fit.report.bones}
    assert 150 < lengths["RightForeArm"] < 350
    assert all(part.mean < 6 for part in fit.report.parts)


def test_parts_that_no_frame_shows_together_are_not_joined() -> None:
    markers = worn()
    half = markers.frame_count // 2
    relation = load_relation("ior")
    for name, first in (("left_thigh", half), ("left_shank", 0)):
        part = relation.by_name[name]
        for label in (*part.markers, *part.loose):
            markers = hidden(markers, label, first, half + 1 if first else half)
    fit = markers.fit("ior")
    assert fit.left_out == {"left_shank": "its joint cannot be placed: no frame shows it and the part above"}
    assert "LeftFoot" in fit.motion.roots


def test_directions_that_are_one_line_are_refused() -> None:
    text = """
    [parts.pelvis]
    joint = "Hips"
    markers = ["L_IAS", "R_IAS", "L_IPS", "R_IPS"]
    left = { from = ["R_IAS"], to = ["L_IAS"] }
    up = { from = ["L_IAS"], to = ["R_IAS"] }
    """
    with pytest.raises(gmr.GmrError, match=r"\[parts.pelvis\]: its two directions are one line"):
        worn().fit(read_relation(text.encode(), "mine.toml"))


def test_a_subject_who_is_not_there_is_refused() -> None:
    with pytest.raises(gmr.GmrError, match="no marker is of the subject 'Ben'; labels begin with no name"):
        worn().fit("ior", subject="Ben")
    named = replace(worn(), labels=tuple(f"Anna:{label}" for label in worn().labels))
    with pytest.raises(gmr.GmrError, match="no marker is of the subject 'Ben'; there are 'Anna'"):
        named.fit("ior", subject="Ben")


def test_a_gap_as_long_as_is_allowed_is_bridged_whatever_the_rounding() -> None:
    markers = replace(worn(), frame_time=0.1)
    for label in ("L_FLE", "L_FME"):
        markers = hidden(markers, label, 100, 3)
    assert 0.3 / markers.frame_time < 3
    fit = markers.fit("ior", max_gap=0.3)
    assert [stretch.became for stretch in fit.stretches["left_thigh"]] == ["bridged"]
