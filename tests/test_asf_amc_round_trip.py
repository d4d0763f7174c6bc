"""A motion that is written as ASF and AMC and read again is the same motion."""

from __future__ import annotations

import io
import math
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from amc_text import amc, asf, dof_motions, read_back, written
from gmr import FormatError, GmrError, Motion, SkeletonError
from gmr.dof_rows import DofRows
from gmr.formats.asf_amc import read_amc
from gmr.skeleton import End
from strategies import motions, poses


def dofs(motion: Motion) -> DofRows:
    assert isinstance(motion.source, DofRows)
    return motion.source


def assert_same_places(found: Motion, motion: Motion) -> None:
    """Every joint is where it was, to 1e-9 of the body's reach."""
    wanted = motion.positions(dtype=np.float64)
    root = motion.skeleton.roots[0]
    order = [root, *(joint for joint in range(wanted.shape[1]) if joint != root)]
    reach = 1 + np.abs(wanted).max(initial=0)
    np.testing.assert_allclose(found.positions(dtype=np.float64), wanted[:, order], rtol=0, atol=1e-9 * reach)


@given(dof_motions())
def test_what_was_read_is_written_to_the_bit(motion: Motion) -> None:
    found = read_back(motion)
    assert found == motion
    rows, wanted = dofs(found), dofs(motion)
    assert rows.values.tobytes() == wanted.values.tobytes()
    assert rows.acclaim == wanted.acclaim
    assert (rows.listed, rows.first, rows.notes) == (wanted.listed, wanted.first, wanted.notes)
    assert found.frame_time == motion.frame_time
    assert written(found) == written(motion)


def test_a_take_of_cmu_comes_back_with_its_names_axes_limits_and_values(data: Path, tmp_path: Path) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    gmr.write(motion, tmp_path / "copy.amc")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["copy.amc", "copy.asf"]
    found = gmr.read(tmp_path / "copy.amc")
    assert found == motion
    assert found.acclaim == motion.acclaim
    for kind, original in (("amc", "07_01.amc"), ("asf", "07.asf")):
        ours = (tmp_path / f"copy.{kind}").read_text().split()
        theirs = (data / "amc" / original).read_text().split()
        assert [plain(word) for word in ours] == [plain(word) for word in theirs]


def plain(word: str) -> float | str:
    """A number as one, whatever its digits."""
    try:
        return float(word.strip("()"))
    except ValueError:
        return word


@given(motions())
def test_any_motion_with_one_root_keeps_every_joint_in_place(motion: Motion) -> None:
    moving = [joint for joint in motion.translated.tolist() if motion.skeleton.parents[joint] >= 0]
    if len(motion.roots) > 1:
        with pytest.raises(SkeletonError, match="one root"):
            written(motion)
    elif moving and motion.frame_count > 1 and np.ptp(motion.translations[:, 1:], axis=0).any():
        with pytest.raises(SkeletonError, match="only the root"):
            written(motion)
    else:
        found = read_back(motion)
        assert_same_places(found, motion)
        assert found.skeleton.joint_count == motion.skeleton.joint_count


@given(dof_motions(min_frames=1))
def test_a_pose_keeps_the_bones_of_its_asf(motion: Motion) -> None:
    posed = replace(motion, source=motion.pose)
    found = read_back(posed)
    assert_same_places(found, motion)
    before, after = dofs(motion).acclaim, dofs(found).acclaim
    for bone, kept in zip(before.bones, after.bones, strict=True):
        assert (bone.name, bone.axis, bone.axis_order) == (kept.name, kept.axis, kept.axis_order)
        assert (kept.dofs, kept.limits) in (
            (bone.dofs, bone.limits),
            (("rx", "ry", "rz"), ((-math.inf, math.inf),) * 3),
        )
    assert after.root == before.root


def test_bones_keep_their_degrees_of_freedom_through_resampling_where_these_suffice(data: Path) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    slower = read_back(motion.resample(60))
    assert slower.acclaim == motion.acclaim
    between = read_back(motion.resample(50))
    assert between.fps == pytest.approx(50)
    assert between.acclaim is not None
    limits = between.acclaim.limits
    assert limits["ltibia"] == {"rx": (-10, 170)}  # a hinge turns between its angles
    assert set(limits["lfoot"]) == {"rx", "ry", "rz"}  # two degrees of freedom do not suffice there
    assert_same_places(between, motion.resample(50))


def test_a_mirrored_take_is_the_mirror_image_and_has_the_limits_of_the_other_side(data: Path) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    image = motion.mirror()
    partner = {"l": "r", "r": "l"}
    names = motion.skeleton.names
    pair = [
        names.index(partner[name[0]] + name[1:]) if partner.get(name[0], "-") + name[1:] in names else joint
        for joint, name in enumerate(names)
    ]
    wanted = motion.positions(dtype=np.float64)[:, pair] * (-1, 1, 1)
    np.testing.assert_allclose(image.positions(dtype=np.float64), wanted, rtol=0, atol=1e-12 * 40)
    assert image.acclaim is not None
    assert image.acclaim.limits["lfemur"] == {"rx": (-160, 20), "ry": (-70, 70), "rz": (-60, 70)}
    assert image.acclaim.limits["rfoot"] == {"rx": (-45, 90), "rz": (-20, 70)}
    assert image.mirror() == motion
    posed = replace(motion, source=motion.pose).mirror()
    np.testing.assert_allclose(posed.positions(dtype=np.float64), wanted, rtol=0, atol=1e-12 * 40)
    assert posed.acclaim == image.acclaim
    assert read_back(image) == image


def test_operations_on_frames_and_units_keep_what_the_asf_says(data: Path) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    part = motion[5:15]
    assert dofs(part).first == 6
    assert read_back(part) == part
    assert gmr.concatenate([motion[:7], motion[7:]]) == motion
    assert pickle.loads(pickle.dumps(motion)) == motion
    metres = motion.to_unit("m")
    np.testing.assert_allclose(metres.positions(), motion.positions() * (0.0254 / 0.45), rtol=1e-5, atol=1e-6)
    assert metres.acclaim is not None
    assert metres.acclaim.unit == pytest.approx(1)
    assert metres.acclaim.limits == (motion.acclaim and motion.acclaim.limits)
    found = read_back(metres)
    assert found.unit == pytest.approx(1)
    posed = replace(motion, source=motion.pose).to_unit("cm")
    assert_same_places(read_back(posed), posed)
    assert dofs(read_back(posed)).acclaim.limits == metres.acclaim.limits


@given(dof_motions(), st.floats(0.001, 10), st.sampled_from(["m", "cm", "in"]))
def test_a_centre_of_mass_keeps_its_place_along_the_bone_in_every_unit(
    motion: Motion, place: float, unit: str
) -> None:
    acclaim = dofs(motion).acclaim
    notes = (f"cofmass {place!r}", "bodymass 3", "cofmass unknown")
    noted = replace(
        acclaim, bones=tuple(replace(bone, length=2 * place, notes=notes) for bone in acclaim.bones)
    )
    for source in (replace(dofs(motion), acclaim=noted), replace(motion.pose, acclaim=noted)):
        found = replace(motion, skeleton=noted.skeleton, source=source, unit=0.3).to_unit(unit).acclaim
        assert found is not None
        for bone in found.bones:
            word, told = bone.notes[0].split()
            assert word == "cofmass"
            assert float(told) == pytest.approx(bone.length / 2, rel=1e-15)
            assert bone.notes[1:] == notes[1:]


FRAME_TIMES = st.sampled_from([0.0, 1 / 120, 0.0083333, 0.04, 1 / 29.97])


@given(poses(), FRAME_TIMES, st.sampled_from([None, 1.0, 0.01]))
def test_the_rate_and_the_unit_are_written(motion: Motion, frame_time: float, unit: float | None) -> None:
    motion = replace(motion[:1], frame_time=frame_time, unit=unit)
    if len(motion.roots) == 1:
        found = read_back(motion)
        assert found.frame_time == pytest.approx(frame_time, rel=1e-15)
        assert found.unit == (None if unit is None else pytest.approx(unit, rel=1e-15))


@given(st.data(), dof_motions(min_frames=1))
def test_roots_that_were_split_off_are_joined_and_every_value_comes_back(
    data: st.DataObject, motion: Motion
) -> None:
    names = motion.skeleton.names
    chosen = data.draw(st.lists(st.sampled_from(names), min_size=1, unique=True))
    apart = motion.with_roots(chosen)
    assert apart.with_roots(["root"]) == motion
    found = read_back(apart)
    if "root" in chosen:
        assert found == motion
    else:  # the tree that the root is in hangs on another joint, and is written so
        assert_same_places(found, motion.shift_root(apart.skeleton.forest.root_of(names.index("root"))))


@pytest.mark.parametrize("suffix", ["gmr", "gmrb"])
@pytest.mark.parametrize("root", ["thorax", "lfoot", "head"])
def test_a_take_whose_root_was_shifted_and_kept_in_a_file_is_written(
    data: Path, tmp_path: Path, root: str, suffix: str
) -> None:
    motion = gmr.read(data / "amc" / "07_01.amc")
    gmr.write(motion.shift_root(root), tmp_path / f"kept.{suffix}")
    kept = gmr.read(tmp_path / f"kept.{suffix}")
    gmr.write(kept, tmp_path / "turned.amc")
    found = gmr.read(tmp_path / "turned.amc")
    assert_same_places(found, motion.shift_root(root))
    assert found.roots == ("root",)
    assert set(found.skeleton.names) == (set(motion.skeleton.names) - {root}) | {"root2"}
    back = found.shift_root("root2")
    order = [{"root": root, "root2": "root"}.get(name, name) for name in found.skeleton.names]
    np.testing.assert_allclose(
        back.positions(dtype=np.float64), motion.positions(dtype=np.float64, joints=order), rtol=0, atol=1e-9
    )
    gmr.write(kept.with_roots(["root"]), tmp_path / "home.amc")
    home = gmr.read(tmp_path / "home.amc")
    assert home.skeleton.names == motion.skeleton.names
    assert_same_places(home, motion)


@pytest.mark.parametrize("root", ["Head", "LeftFoot", "Hips"])
def test_a_tree_that_was_turned_over_begins_at_its_root(walk_path: Path, root: str) -> None:
    turned = gmr.read(walk_path).shift_root(root)
    assert_same_places(read_back(turned), turned)


def test_the_root_turns_as_its_children_do_together(walk_path: Path) -> None:
    motion = gmr.read(walk_path)
    found = read_back(motion)
    rows = dofs(found)
    still = [bone.name for bone in rows.acclaim.bones if not bone.dofs]
    assert still == ["LHipJoint", "RHipJoint", "LowerBack"]
    told = dict(zip(motion.layout.names[0], motion.rows[3], strict=False) if motion.layout else ())
    wanted = [told[f"{axis}{kind}"] for kind in ("position", "rotation") for axis in "XYZ"]
    np.testing.assert_allclose(rows.values[3, :6], wanted, rtol=0, atol=1e-9)


def test_a_joint_that_is_called_as_the_root_must_be_is_numbered() -> None:
    head = b"HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation "
    joints = b"JOINT root { OFFSET 1 0 0 } JOINT root2 { OFFSET 2 0 0 } }"
    motion = gmr.read(head + joints + b"MOTION Frames: 1 Frame Time: 1\n90\n")
    assert read_back(motion).skeleton.names == ("root", "root3", "root2")


def test_end_sites_that_share_a_name_are_numbered() -> None:
    ends = b"End Site { OFFSET 1 0 0 } End Site { OFFSET 2 0 0 } }"
    head = b"HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xrotation "
    motion = gmr.read(head + ends + b"MOTION Frames: 1 Frame Time: 1\n90\n")
    assert motion.skeleton.ends.tolist() == [End.JOINT, End.SITE, End.SITE]
    assert read_back(motion).skeleton.names == ("root", "a_end", "a_end2")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        *((name, "one word") for name in ("left leg", "", "a#b", ":a", "a\x01", "a\ud800")),
        ("End", "something else"),
        ("hip", "share it"),
    ],
)
def test_a_name_that_would_not_read_back_is_refused_before_anything_is_written(
    name: str, said: str, tmp_path: Path
) -> None:
    children = b"JOINT hip { OFFSET 1 0 0 } JOINT b { OFFSET 1 0 0 } }"
    head = b"HIERARCHY ROOT a { OFFSET 0 0 0 "
    motion = gmr.read(head + children + b"MOTION Frames: 0 Frame Time: 1")
    motion = replace(motion, skeleton=replace(motion.skeleton, names=("a", "hip", name)))
    with pytest.raises(FormatError, match=said):
        gmr.write(motion, tmp_path / "walk.amc")
    assert not list(tmp_path.iterdir())


def test_a_value_that_is_no_number_is_refused_with_its_frame_and_bone(tmp_path: Path) -> None:
    motion = read_amc(amc(), asf=asf())
    values = dofs(motion).values.copy()
    values[1, 7] = np.nan
    broken = replace(motion, source=replace(dofs(motion), values=values))
    with pytest.raises(FormatError, match="bone 'thigh', ry is nan in frame 1"):
        gmr.write(broken, tmp_path / "walk.amc")
    assert not list(tmp_path.iterdir())


def test_both_files_are_replaced_or_none(tmp_path: Path) -> None:
    motion = read_amc(amc(), asf=asf())
    (tmp_path / "walk.amc").write_text("before")
    (tmp_path / "walk.asf").mkdir()
    with pytest.raises(GmrError, match="this is a folder"):
        gmr.write(motion, tmp_path / "walk.amc")
    assert (tmp_path / "walk.amc").read_text() == "before"
    gmr.write(motion, tmp_path / "RUN.AMC")
    assert (tmp_path / "RUN.ASF").exists()


def test_streams_take_one_file_each() -> None:
    motion = read_amc(amc(), asf=asf())
    skeleton, frames = io.BytesIO(), io.StringIO()
    gmr.write(motion, skeleton, format="asf")
    gmr.write(motion, frames, format="amc")
    assert gmr.read(frames.getvalue().encode(), asf=skeleton.getvalue()) == motion
