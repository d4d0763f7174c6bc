"""What an ASF and an AMC say is what the motion does."""

from __future__ import annotations

import math
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given

import gmr
from amc_text import ASF, amc, asf, dof_motions, matrices_by_definition
from gmr import FormatWarning, Motion
from gmr.formats.asf_amc import parse_asf, read_amc
from gmr.formats.asf_finder import find_asf, serving_asf
from gmr.quaternions import matrices

SAME = {
    "root": "Hips", "lowerback": "Spine", "upperback": "Spine1",
    "lhipjoint": "LeftUpLeg", "lfemur": "LeftLeg", "ltibia": "LeftFoot", "lfoot": "LeftToeBase",
    "ltoes": "LeftToeBase_end", "rtoes": "RightToeBase_end",
    "rhipjoint": "RightUpLeg", "rfemur": "RightLeg", "rtibia": "RightFoot", "rfoot": "RightToeBase",
}  # fmt: skip
"""Joints of the ASF files of CMU by those of the BVH files made of them, which agree."""

ABOVE = {
    "thorax": "Neck", "lowerneck": "Neck1", "upperneck": "Head", "lclavicle": "LeftArm",
    "lhumerus": "LeftForeArm", "lradius": "LeftHand", "rclavicle": "RightArm", "rhumerus": "RightForeArm",
    "rradius": "RightHand",
}  # fmt: skip
"""Those that lack the thorax bone in BVH: the conversion gave it no length."""

DATA = Path(os.environ.get("GMR_DATA", ""))
LATE = {"07_03": 10}
"""Frames by which a BVH begins before its AMC, where it is more than the T-pose."""


def takes_held_twice() -> list[str]:
    held = (file.stem for file in sorted((DATA / "cmu_asf_amc").glob("*.amc")))
    return [stem for stem in held if (DATA / "cmu_bvh_01_09" / stem[:2] / f"{stem}.bvh").exists()]


def assert_same_recording(motion: Motion, converted: Motion, late: int = 1) -> None:
    """The AMC and the BVH of a take agree to 1e-4 file units, but for the thorax bone."""
    count = min(motion.frame_count, converted.frame_count - late)
    ours, theirs = motion[:count], converted[late : late + count]
    for names, shift in ((SAME, None), (ABOVE, "thorax")):
        found = ours.positions(joints=list(names), dtype=np.float64)
        if shift is not None:
            found -= np.diff(ours.positions(joints=["upperback", shift], dtype=np.float64), axis=1)
        wanted = theirs.positions(joints=list(names.values()), dtype=np.float64)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-4)


def test_a_take_of_cmu_is_the_same_as_amc_and_as_bvh(data: Path, walk_path: Path) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    assert motion.frame_count == 20
    assert motion.unit == pytest.approx(0.0254 / 0.45)
    assert_same_recording(motion, gmr.read(walk_path))


@pytest.mark.skipif("GMR_DATA" not in os.environ, reason="GMR_DATA names no folder of large files")
def test_every_take_of_cmu_is_the_same_as_amc_and_as_bvh() -> None:
    takes = takes_held_twice()
    assert len(takes) == 20
    for take in takes:
        motion = gmr.read(DATA / "cmu_asf_amc" / f"{take}.amc", strict=True)
        converted = gmr.read(DATA / "cmu_bvh_01_09" / take[:2] / f"{take}.bvh")
        assert motion.frame_count + LATE.get(take, 1) <= converted.frame_count
        assert_same_recording(motion, converted, LATE.get(take, 1))


@given(dof_motions(min_frames=1))
def test_positions_and_rotations_are_the_products_of_the_definition(motion: Motion) -> None:
    wanted = matrices_by_definition(motion)
    positions = motion.positions(dtype=np.float64)
    reach = 1 + np.abs(wanted[..., 3]).max(initial=0)
    np.testing.assert_allclose(positions, wanted[..., :3, 3], rtol=0, atol=1e-12 * reach)
    single = motion.positions()
    np.testing.assert_allclose(single, wanted[..., :3, 3], rtol=0, atol=1e-5 * reach)
    rotations = matrices(motion.bone_rotations(dtype=np.float64))
    np.testing.assert_allclose(rotations, wanted[..., :3, :3], rtol=0, atol=1e-12)


def test_what_the_asf_says_can_be_asked_for() -> None:
    motion = read_amc(amc(), asf=asf())
    acclaim = motion.acclaim
    assert acclaim is not None
    assert acclaim.limits["thigh"] == {"rx": (-160, 20), "ry": (-70, 70), "rz": (-math.inf, 70)}
    assert acclaim.limits["shin"] == {"rx": (-10, 170), "rz": (0, 5)}
    assert acclaim.limits["hip"] == {}
    thigh = acclaim.bones[1]
    assert (thigh.axis, thigh.axis_order, thigh.number, thigh.notes) == (
        (0, 0, 20),
        "XYZ",
        "2",
        ("bodymass 3",),
    )
    assert (acclaim.name, acclaim.mass, acclaim.notes) == ("SMALL", 2.5, (" a small man",))
    assert acclaim.documentation == ("   one leg # and no arm",)
    assert motion.skeleton.names == ("root", "hip", "thigh", "shin")
    assert motion.skeleton.offsets.tolist() == [[0, 0, 0], [2.5, 0, 0], [0, -7, 0], [0, -6, 0]]
    np.testing.assert_array_equal(motion.translations[:, 0], [[2, 4, 6], [2.5, 4.5, 6.5]])


def test_an_asf_alone_is_a_motion_without_frames(data: Path) -> None:
    motion = gmr.read(data / "amc" / "07.asf")
    assert motion.frame_count == 0
    assert motion.skeleton == gmr.read(data / "amc" / "07_01.amc").skeleton
    assert motion.positions().shape == (0, 31, 3)
    assert gmr.read((data / "amc" / "07.asf").read_bytes()) == motion


@pytest.mark.parametrize(
    ("length", "unit"), [("0.45", 0.0254 / 0.45), ("2.54", 0.01), ("1", None), ("1.0", None)]
)
def test_lengths_are_file_units_of_an_inch(length: str, unit: float | None) -> None:
    found = parse_asf(asf(("length 0.45", f"length {length}"))).unit
    assert found == (None if unit is None else pytest.approx(unit))


def test_radians_turn_as_degrees_do() -> None:
    degrees = read_amc(amc(), asf=asf())
    text = amc((":DEGREES", ":RADIANS")).decode().splitlines()
    lines = [_in_radians(line) if line[:1].isalpha() else line for line in text]
    radians = read_amc("\n".join(lines).encode(), asf=asf())
    np.testing.assert_allclose(radians.positions(), degrees.positions(), rtol=0, atol=1e-4)
    told = asf(("angle deg", "angle rad"), ("0 0 20", f"0 0 {math.radians(20)}"))
    axis = " ".join(str(math.radians(angle)) for angle in (10, 20, 30))
    told = told.replace(b"axis 10 20 30", f"axis {axis}".encode())
    np.testing.assert_allclose(read_amc(amc(), asf=told).positions(), degrees.positions(), rtol=0, atol=1e-5)
    unsaid = "\n".join(line for line in lines if line != ":RADIANS").encode()
    np.testing.assert_allclose(read_amc(unsaid, asf=told).positions(), degrees.positions(), rtol=0, atol=1e-4)


def _in_radians(line: str) -> str:
    name, *values = line.split()
    lengths = 3 if name == "root" else 0
    turned = [repr(math.radians(float(value))) for value in values[lengths:]]
    return " ".join([name, *values[:lengths], *turned])


@pytest.mark.parametrize(
    ("rate", "fps", "found"),
    [
        ("", None, 120),
        (":SAMPLES-PER-SECOND 60\n", None, 60),
        (":SAMPLES-PER-SECOND 60\n", 30, 30),
        ("", 25, 25),
    ],
)
def test_the_rate_is_told_or_in_the_file_or_that_of_cmu(rate: str, fps: float | None, found: float) -> None:
    motion = read_amc(amc((":DEGREES", f"{rate}:DEGREES")), asf=asf(), fps=fps)
    assert motion.fps == found
    still = read_amc(amc((":DEGREES", ":SAMPLES-PER-SECOND 0\n:DEGREES")), asf=asf())
    assert still.frame_time == 0


@pytest.mark.parametrize("ends", ["\r\n", "\r", "\n\n", " \t\r\n"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_line_ends_blanks_and_encodings_change_nothing(ends: str, encoding: str) -> None:
    plain = read_amc(amc(), asf=asf())
    skeleton, frames = (
        text.decode().replace("\n", ends).replace("  ", "\t").encode(encoding) for text in (asf(), amc())
    )
    assert np.array_equal(read_amc(frames, asf=skeleton).positions(), plain.positions())


def test_keywords_are_known_in_any_case_and_order() -> None:
    plain = parse_asf(asf())
    shouted = "\n".join(
        line.upper()
        if line.split()[:1] and line.split()[0] in ("begin", "end", "name", "dof", "limits")
        else line
        for line in ASF.replace("hip", "HIP").replace("thigh", "THIGH").replace("shin", "SHIN").splitlines()
    )
    found = parse_asf(shouted.encode())
    assert [bone.dofs for bone in found.bones] == [bone.dofs for bone in plain.bones]
    assert found.limits["THIGH"] == plain.limits["thigh"]
    swapped = asf(("     length 7\n", ""), ("     bodymass 3\n", "     length 7\n     bodymass 3\n"))
    assert parse_asf(swapped) == plain


@pytest.mark.parametrize(
    ("name", "beside", "found"),
    [
        ("07_01.amc", ["07.asf", "07_01.asf", "08.asf"], "07_01.asf"),
        ("07_01.amc", ["07.asf", "08.asf"], "07.asf"),
        ("07_01_late.amc", ["07.asf", "07_01.ASF", "x.bvh"], "07_01.ASF"),
        ("WALK.AMC", ["walk.asf", "run.asf"], "walk.asf"),
        ("walk.amc", ["actor.asf", "walk.bvh"], "actor.asf"),
        ("walk.amc", ["one.asf", "two.asf"], None),
        ("walk.amc", [], None),
    ],
)
def test_the_skeleton_beside_is_found_by_its_name(name: str, beside: list[str], found: str | None) -> None:
    assert find_asf(name, beside) == found
    assert serving_asf([name, *beside]) == ({found} if found else set())


def test_a_path_bytes_and_streams_give_the_same_motion(data: Path, tmp_path: Path) -> None:
    path, skeleton = data / "amc" / "07_01.amc", data / "amc" / "07.asf"
    motion = gmr.read(path)
    assert gmr.read(path.read_bytes(), asf=skeleton.read_bytes()) == motion
    with path.open("rb") as stream:
        assert gmr.read(stream) == motion
    shutil.copy(path, tmp_path / "walk.amc")
    assert gmr.read(tmp_path / "walk.amc", asf=skeleton) == motion
    shutil.copy(skeleton, tmp_path / "actor.asf")
    assert gmr.read(tmp_path / "walk.amc") == motion


def test_a_folder_is_read_without_the_skeletons_as_motions(
    data: Path, tmp_path: Path, walk_path: Path
) -> None:
    shutil.copytree(data / "amc", tmp_path / "seven")
    shutil.copy(data / "amc" / "07.asf", tmp_path / "alone.asf")
    shutil.copy(walk_path, tmp_path / "walk.bvh")
    takes = gmr.read_folder(tmp_path, fps=60, positions="add")
    assert list(takes) == ["alone.asf", "seven/07_01.amc", "walk.bvh"]
    assert takes["seven/07_01.amc"].fps == 60
    assert takes["alone.asf"].frame_count == 0


@pytest.mark.parametrize(
    ("changes", "said", "first", "second"),
    [
        ([("thigh 5 -6 7.5\n", "")], "bone 'thigh' is missing in a frame", [0, 0, 0], [5, -6, 8.5]),
        ([("thigh 5 -6 8.5\n", "")], "inside a frame", [5, -6, 7.5], None),
        ([("\n2\n", "\n9\n")], "frame numbers skip", [5, -6, 7.5], [5, -6, 8.5]),
        (
            [(":DEGREES", ":DEGREES\n:WHATEVER")],
            "does not know the keyword ':WHATEVER'",
            [5, -6, 7.5],
            [5, -6, 8.5],
        ),
        ([("8.5\nshin 81 0\n", "8.5\nshin 81 -")], "inside a frame", [5, -6, 7.5], None),
    ],
)
def test_what_is_odd_is_read_with_a_warning_and_refused_when_strict(
    changes: list[tuple[str, str]], said: str, first: list[float], second: list[float] | None
) -> None:
    data = amc(*changes)
    with pytest.warns(FormatWarning, match=said) as caught:
        motion = read_amc(data, name="walk.amc", asf=asf())
    assert len(caught) == 1
    values = motion.source.numbers[0][:, 6:9].tolist()
    assert values == ([first] if second is None else [first, second])
    with pytest.raises(gmr.FormatError, match=said):
        read_amc(data, name="walk.amc", asf=asf(), strict=True)


@pytest.mark.parametrize(
    ("direction", "length", "said"),
    [
        (
            "3 0 0",
            "2.5",
            "direction of length 3, not 1: with the length 2.5 it is 7.5 long. Write",
        ),
        ("0 0 0", "2.5", "direction of length 0, not 1: with the length 2.5 it is 0 long"),
        ("0.9996 0 0", "2.5", None),
        ("0 0 0", "0", None),
    ],
)
def test_a_direction_that_changes_a_bones_length_is_told(
    direction: str, length: str, said: str | None
) -> None:
    text = asf(("direction 1 0 0\n     length 2.5", f"direction {direction}\n     length {length}"))
    if said is None:
        parse_asf(text)
        return
    with pytest.warns(FormatWarning, match=f"bone 'hip' has a {said}"):
        parse_asf(text)


def test_a_bone_missing_later_keeps_its_last_values() -> None:
    data = amc(("thigh 5 -6 8.5\n", "")) + b"3\nroot 1 2 3 4 5 6\nshin 1 2\nthigh 1 2 3\n"
    with pytest.warns(FormatWarning, match="number 2"):
        motion = read_amc(data, asf=asf())
    assert motion.source.numbers[0][:, 6:9].tolist() == [[5, -6, 7.5], [5, -6, 7.5], [1, 2, 3]]


def test_odd_items_of_an_asf_are_passed_over_with_a_warning() -> None:
    for change, said in (
        (("     bodymass 3\n", "     colour red\n"), "bone 'thigh' has 'colour'"),
        ((":bonedata", ":skin\n  file a\n:bonedata"), "':skin' is no section"),
        (("  mass 2.5", "  force 2"), "units have 'force'"),
        (("   axis XYZ", "   colour red"), "the root has 'colour'"),
        (("length 2.5", "length 2.5\n limits (1 2)"), "bone 'hip' has limits but no dof"),
    ):
        with pytest.warns(FormatWarning, match=said):
            parse_asf(asf(change))
        with pytest.raises(gmr.FormatError, match=said):
            parse_asf(asf(change), strict=True)


def test_names_in_latin_1_are_the_same_in_both_files() -> None:
    skeleton, frames = (
        text.decode().replace("thigh", "b\xfcgel").encode("latin-1") for text in (asf(), amc())
    )
    with pytest.warns(FormatWarning, match="read as Latin-1"):
        motion = read_amc(frames, asf=skeleton)
    assert "b\xfcgel" in motion.skeleton.names
    assert motion.source.numbers[0].tolist() == read_amc(amc(), asf=asf()).source.numbers[0].tolist()
