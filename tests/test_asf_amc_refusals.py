"""What an ASF or AMC cannot be read as is said in one sentence, with line and bone."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import gmr
from amc_text import amc, asf
from gmr import FormatError
from gmr.formats.asf_amc import parse_asf, read_amc

ASF_FAULTS = [
    (("     name thigh\n", ""), 33, "a bone without a name has no name"),
    (("name thigh", "name upper thigh"), 25, "a name of several words"),
    (("name thigh", "name hip"), 34, "bone 'hip' is there twice"),
    (("name thigh", "name root"), 34, "bone 'root' is named root"),
    (("     direction 1 0 0\n", ""), 21, "bone 'hip' has no direction"),
    (("     length 2.5\n", ""), 21, "bone 'hip' has no length"),
    (("direction 1 0 0", "direction 1 0"), 19, "bone 'hip', direction has 2 of 3 numbers"),
    (("direction 1 0 0", "direction 1 0 nan"), 19, "'nan' stands for no number"),
    (("length 2.5", "length 2,5"), 20, "decimal comma"),
    (("axis 0 0 20 XYZ", "axis 0 0 20 XXZ"), 28, "bone 'thigh' has the axis order 'XXZ'"),
    (("dof rx ry rz", "dof rx ry rw"), 29, "bone 'thigh' has a degree of freedom 'rw'"),
    (("dof rx ry rz", "dof rx rx rz"), 29, "a degree of freedom twice"),
    (("dof rx ry rz", "dof rx ry tz"), 29, "bone 'thigh' has the degree of freedom tz: gmr reads"),
    (("dof rx ry rz", "dof rx ry l"), 29, "bone 'thigh' has the degree of freedom l"),
    (("(-70.0 70.0)\n", "\n"), 30, "bone 'thigh' has 2 limits for 3 degrees of freedom"),
    (("(-70.0 70.0)", "(-70.0)"), 30, "Write a pair in parentheses"),
    (("(-70.0 70.0)", "(-70.0 x)"), 30, "bone 'thigh', limits: 'x' is not a number"),
    (("length 7\n", "length 7\n length 8\n"), 28, "bone 'thigh' has length twice"),
    (("    hip thigh", "    hip thighs"), 47, "the hierarchy names 'thighs', which is no bone"),
    (("    hip thigh", "    hop thigh"), 47, "the hierarchy names 'hop'"),
    (("    hip thigh", "    hip thigh hip"), 47, "bone 'hip' hangs on two others"),
    (("    hip thigh", "    hip thigh root"), 47, "the root hangs on bone 'hip'"),
    (("    root hip\n    hip thigh", "    thigh hip\n    hip thigh"), 46, "bone 'hip' hangs on itself"),
    (("    hip thigh\n    thigh shin", "    hip shin"), 23, "bone 'thigh' has no place in the :hierarchy"),
    (("  begin\n    root", "    root"), 45, "outside the hierarchy's block"),
    (("  end\n  begin\n     id 2", "  begin\n     id 2"), 22, "bone 'hip' has no end before the next begins"),
    (("  end\n:hierarchy", ":hierarchy"), 43, "bone 'shin' has no end before ':hierarchy'"),
    (("  begin\n     id 1", "     id 1"), 16, "'id' stands outside a bone"),
    (("angle deg", "angle gon"), 7, "units, angle is 'gon'"),
    (("length 0.45", "length 0"), 6, "units, length is '0'"),
    (("TX TY TZ RX RY RZ", "TX TY TZ RX RY RW"), 11, "the root's order has 'RW'"),
    (("TX TY TZ RX RY RZ", "TX TX TZ RX RY RZ"), 11, "the root's order has a value twice"),
    (("position 1 2 3", "position 1 2"), 13, "the root's position has 2 of 3 numbers"),
    ((":version 1.10\n", "what is this\n"), 2, "begins with 'what'"),
    ((":version 1.10\n", ":version 1.10\nlost\n"), 3, "'lost' stands before a section"),
]  # fmt: skip

AMC_FAULTS = [
    (("thigh 5 -6 7.5", "thigh 5 -6"), 6, "bone 'thigh' has 2 numbers, but the ASF gives it 3 (rx ry rz)"),
    (("thigh 5 -6 7.5", "thigh 5 -6 7.5 8 9"), 6, "bone 'thigh' has 5 numbers"),
    (("thigh 5 -6 7.5", "hip 5"), 6, "bone 'hip' has 1 numbers, but the ASF gives it 0 (no deg"),
    (("thigh 5 -6 7.5", "thigh 5 nan 7.5"), 6, "bone 'thigh', ry: 'nan' stands for no number"),
    (("thigh 5 -6 7.5", "thigh 5 -6 1e999"), 6, "bone 'thigh', rz: '1e999' is too large"),
    (("root 1 2 3", "root 1 2,5 3"), 5, "bone 'root', ty: '2,5' has a decimal comma"),
    (("thigh 5 -6 7.5", "thumb 5 -6 7.5"), 6, "'thumb' is no bone of small.asf"),
    (("thigh 5 -6 7.5", "root 1 2 3 4 5 6"), 6, "bone 'root' is there twice in one frame"),
    (("\n1\n", "\n"), 4, "the frames begin with 'root'"),
    (("\n1\n", "\n1.5\n"), 4, "the frames begin with '1.5'"),
    (("\n2\n", "\n-2\n"), 8, "'-2' is no bone"),
    ((":DEGREES", ":SAMPLES-PER-SECOND fast"), 3, "'fast' is not a number"),
    ((":DEGREES", ":SAMPLES-PER-SECOND -1"), 3, "'-1' frames a second"),
    (("\n2\n", "\n:RADIANS\n2\n"), 8, "':RADIANS' is no bone"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "line", "said"), ASF_FAULTS, ids=lambda value: str(value)[:40])
def test_a_fault_of_an_asf_is_told_with_its_line(change: tuple[str, str], line: int, said: str) -> None:
    with pytest.raises(FormatError, match=re.escape(said)) as caught:
        parse_asf(asf(change), name="small.asf")
    assert (caught.value.file, caught.value.line) == ("small.asf", line)


@pytest.mark.parametrize(("change", "line", "said"), AMC_FAULTS, ids=lambda value: str(value)[:40])
def test_a_fault_of_an_amc_is_told_with_its_line(
    change: tuple[str, str], line: int, said: str, tmp_path: Path
) -> None:
    skeleton = tmp_path / "small.asf"
    skeleton.write_bytes(asf())
    with pytest.raises(FormatError, match=re.escape(said)) as caught:
        read_amc(amc(change), name="walk.amc", asf=skeleton)
    assert (caught.value.file, caught.value.line) == ("walk.amc", line)


@pytest.mark.parametrize("data", [b"", b"# nothing\n", b":version 1.10\n", b":bonedata\n", b"\0\0"])
def test_half_an_asf_is_refused(data: bytes) -> None:
    with pytest.raises(FormatError):
        parse_asf(data)


def test_without_a_skeleton_it_is_said_what_was_looked_for(data: Path, tmp_path: Path) -> None:
    shutil.copy(data / "amc" / "07_01.amc", tmp_path)
    with pytest.raises(FormatError, match=re.escape("07_01.asf and 07.asf")) as caught:
        gmr.read(tmp_path / "07_01.amc")
    assert "asf=" in str(caught.value)
    for name in ("one", "two"):
        (tmp_path / f"{name}.asf").write_bytes(asf())
    with pytest.raises(FormatError, match="there are 2 others"):
        gmr.read(tmp_path / "07_01.amc")
    with pytest.raises(FormatError, match="cannot be read: No such file"):
        gmr.read(tmp_path / "07_01.amc", asf=tmp_path / "none.asf")
    with pytest.raises(FormatError, match="give its ASF"):
        gmr.read((tmp_path / "07_01.amc").read_bytes())
    with pytest.raises(FormatError, match=r"is no bone of one\.asf"):
        gmr.read(tmp_path / "07_01.amc", asf=tmp_path / "one.asf")


def test_an_option_of_another_format_is_refused(data: Path, walk_path: Path) -> None:
    with pytest.raises(FormatError, match="asf= says nothing of BVH files"):
        gmr.read(walk_path, asf=data / "amc" / "07.asf")
    with pytest.raises(FormatError, match="positions= says nothing of AMC files"):
        gmr.read(data / "amc" / "07_01.amc", positions="add")
    for fps in (-1.0, float("nan"), float("inf")):
        with pytest.raises(FormatError, match="frames a second"):
            gmr.read(data / "amc" / "07_01.amc", fps=fps)
