"""What a BVH file may look like, and what is read from it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bvh_text import WALK, spellings, walk
from gmr import FormatError, FormatWarning, Motion
from gmr.formats.bvh import read_bvh
from gmr.skeleton import End
from strategies import motions

ROWS: list[list[float]] = [[1, 2, 3, 4, 5, 6, 7, 8, 9], [-1.5, -2.25, -3, -4, -5, -6, -7, -8, -9.125]]
TURNS = "CHANNELS 3 Zrotation Xrotation Yrotation"


def test_a_file_becomes_a_motion_with_all_that_it_says() -> None:
    motion = read_bvh(walk(), name="walk.bvh")
    assert motion.skeleton.names == ("Hips", "LeftLeg", "LeftLeg_end")
    assert motion.skeleton.parents.tolist() == [-1, 0, 1]
    assert motion.skeleton.offsets.tolist() == [[0, 0, 0], [1, -2, 3.5], [0, -1, 0]]
    assert motion.skeleton.ends.tolist() == [End.JOINT, End.JOINT, End.SITE]
    assert motion.skeleton.slots.tolist() == [-1, 0, 1]
    assert motion.layout is not None
    assert motion.layout.names[1] == ("Zrotation", "Xrotation", "Yrotation")
    assert motion.rows.tolist() == ROWS
    assert (motion.frame_time, motion.unit, motion.name) == (0.0083333, None, "walk.bvh")


@pytest.mark.parametrize(
    "changes",
    [
        [("\n", "\r\n")],
        [("Frames: 2", "Frames:\t2")],
        [("Frames: 2", "FRAMES  :  2"), ("Frame Time:", "frame time:")],
        [("Frames: 2", "Frames 2")],
        [("0.0083333", ".0083333")],
        [("0.0083333", "8.3333e-3")],
        [(TURNS, TURNS + " \t ")],
        [("HIERARCHY", "  hierarchy"), ("ROOT", "Root"), ("JOINT", "joint"), ("MOTION", "Motion")],
        [("End Site", "END SITE")],
        [("End Site", "End Site LeftToe")],
        [("End Site\n\t\t{\n", "End Site {")],
        [("1 2 3 4", "\t1   2\t3  4")],
        [("8 9\n", "8 9 \t\n\n  \n")],
        [("MOTION\n", "\n\nMOTION\n\n")],
        [("-9.125\n", "-9.125")],
        [("-9.125\n", "-9.125\n\n\0\0\0\0")],
        [("-9.125\n", "-9.125\r\n\x1a")],
        [("7 8 9", "7.000 +8 0.9E1")],
        [("Zrotation Xrotation Yrotation\n\t\tEnd", "ZROTATION xrotation Yrotation\n\t\tEnd")],
    ],
)
def test_spelling_does_not_matter(changes: list[tuple[str, str]]) -> None:
    motion = read_bvh(walk(*changes))
    assert motion.rows.tolist() == ROWS
    assert motion.frame_time == 0.0083333
    assert motion.skeleton == read_bvh(walk()).skeleton


@pytest.mark.parametrize("newline", ["\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-32"])
def test_encodings_with_a_byte_order_mark_and_all_line_ends_are_read(newline: str, encoding: str) -> None:
    text = WALK.replace("LeftLeg", "左腿").replace("\n", newline)
    motion = read_bvh(text.encode(encoding))
    assert motion.rows.tolist() == ROWS
    assert motion.skeleton.names[1] == "左腿"


@given(st.data(), motions(max_joints=4, max_frames=3))
def test_any_programs_manner_of_writing_is_read_alike(data: st.DataObject, motion: Motion) -> None:
    found = read_bvh(data.draw(spellings(motion)))
    assert found.skeleton == motion.skeleton
    assert found.rows.tobytes() == motion.rows.tobytes()


@pytest.mark.parametrize(
    "name",
    ["left leg", "mixamorig:Hips", "Hips", "a.b-c_d|e", "Bip01 L Thigh", "jambe gauché", "JOINT", "MOTION"],
)
def test_names_are_kept_as_they_are(name: str) -> None:
    assert read_bvh(walk(("LeftLeg", name))).skeleton.names == ("Hips", name, f"{name}_end")


@pytest.mark.parametrize("spelling", ["JOINT\n", "JOINT \n", "JOINT{ \n"])
def test_a_joint_may_have_no_name(spelling: str) -> None:
    brace = "" if "{" in spelling else "{"
    motion = read_bvh(walk(("JOINT LeftLeg\n\t{", spelling + brace)))
    assert motion.skeleton.names == ("Hips", "", "_end")
    assert motion.rows.tolist() == ROWS


def test_a_name_may_stand_on_the_next_line() -> None:
    assert read_bvh(walk(("JOINT LeftLeg", "JOINT\n left leg "))).skeleton.names[1] == "left leg"


def test_a_hierarchy_may_stand_on_one_line() -> None:
    head, rows = WALK.split("MOTION")
    assert read_bvh(f"{' '.join(head.split())} MOTION {rows}".encode()) == read_bvh(walk())


def test_rotations_may_come_before_positions_and_in_an_order_for_each_joint() -> None:
    root = "CHANNELS 6 Yrotation Zrotation Xrotation Zposition Xposition Yposition"
    motion = read_bvh(
        walk(
            ("CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation", root),
            (TURNS, "CHANNELS 3 Xrotation Yrotation Xrotation"),
        )
    )
    assert motion.layout is not None
    assert motion.layout.rotation_axes.tolist() == [[1, 2, 0], [0, 1, 0]]
    assert motion.layout.translation_columns.tolist() == [[4, 5, 3]]
    assert motion.translations[0].tolist() == [[5, 6, 4]]


def test_position_channels_of_any_joint_replace_its_offset_or_add_to_it() -> None:
    changes = (TURNS, "CHANNELS 3 Xrotation Yposition Zrotation")
    replaced = read_bvh(walk(changes))
    assert replaced.translations[0].tolist() == [[1, 2, 3], [1, 8, 3.5]]
    added = read_bvh(walk(changes), positions="add")
    assert added.translations[0].tolist() == [[1, 2, 3], [1, 6, 3.5]]
    assert added.rows.tolist() == replaced.rows.tolist()
    with pytest.raises(ValueError, match="'replace' or 'add'"):
        read_bvh(walk(), positions="both")  # type: ignore[arg-type]


def test_a_turning_leaf_without_end_site_is_given_a_tip() -> None:
    motion = read_bvh(walk(("\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 -1 0\n\t\t}\n", "")))
    assert motion.skeleton.names == ("Hips", "LeftLeg", "LeftLeg_end")
    assert motion.skeleton.ends.tolist() == [End.JOINT, End.JOINT, End.TIP]
    assert motion.skeleton.offsets[2].tolist() == [0, 0, 0]
    assert motion.skeleton.slots.tolist() == [-1, 0, 1]


def test_several_roots_are_read() -> None:
    second = "ROOT Prop\n{\nOFFSET 9 9 9\nCHANNELS 3 Xposition Yposition Zposition\n}\nMOTION"
    motion = read_bvh(walk(("MOTION", second), ("7 8 9", "7 8 9 10 11 12"), ("-9.125", "-9.125 0 1 2")))
    assert motion.roots == ("Hips", "Prop")
    assert motion.positions(dtype=np.float64)[:, 3].tolist() == [[10, 11, 12], [0, 1, 2]]


def test_a_joint_may_have_no_channels_and_several_end_sites() -> None:
    end = "End Site { OFFSET 1 1 1 }"
    motion = read_bvh(walk((TURNS, end), ("7 8 9", ""), ("-7 -8 -9.125", "")))
    assert motion.skeleton.names == ("Hips", "LeftLeg", "LeftLeg_end", "LeftLeg_end")
    assert motion.rows.shape == (2, 6)


def test_a_file_without_frames_or_with_one_is_read() -> None:
    none = read_bvh(walk(("Frames: 2", "Frames: 0")).split(b"1 2 3")[0])
    assert none.rows.shape == (0, 9)
    pose = read_bvh(walk(("Frames: 2", "Frames: 1"), ("0.0083333", "0")).split(b"-1.5")[0])
    assert pose.rows.tolist() == ROWS[:1]
    assert pose.frame_time == 0


def test_files_with_the_same_hierarchy_share_their_skeleton() -> None:
    one, other = read_bvh(walk()), read_bvh(walk(("7 8 9", "0 0 0")))
    assert one.skeleton is other.skeleton
    assert one.skeleton is not read_bvh(walk(("LeftLeg", "RightLeg"))).skeleton
    added = read_bvh(walk(), positions="add")
    assert added.layout is not None
    assert added.layout.adds_offset


ODD: list[tuple[list[tuple[str, str]], list[list[float]], str | None]] = [
    (
        [("Frames: 2", "Frames: 1")],
        ROWS[:1],
        "walk.bvh:17: 1 frame is declared, but 2 rows are there",
    ),
    ([("Frames: 2", "Frames: 3")], ROWS, "walk.bvh:17: 3 frames are declared, but 2 are there"),
    (
        [("Frames: 2", f"Frames: 1{26 * '0'}")],
        ROWS,
        "walk.bvh:17: at least 1,000,000,000,000,000,000 frames are declared, but 2 are there",
    ),
    ([("Frames: 2", "Frames: 0")], [], "0 frames are declared, but 2 rows are there"),
    ([(" -8 -9.125\n", "")], ROWS[:1], "walk.bvh:20: the file ends inside frame 1, after 7 of its 9 numbers"),
    ([(" -9.125\n", " -9.")], [ROWS[0], [*ROWS[1][:8], -9]], None),
    ([(" -9.125\n", " -")], ROWS[:1], "the file ends inside frame 1, after 8 of its 9 numbers"),
    ([("0.0083333", "0")], ROWS, "walk.bvh:18: the frame time is 0"),
]


@pytest.mark.parametrize(("changes", "rows", "warning"), ODD)
def test_what_is_odd_is_read_with_a_warning_and_refused_when_strict(
    changes: list[tuple[str, str]], rows: list[list[float]], warning: str | None
) -> None:
    data = walk(*changes)
    if warning is None:
        assert read_bvh(data, strict=True).rows.tolist() == rows
        return
    with pytest.warns(FormatWarning) as caught:
        assert read_bvh(data, name="walk.bvh").rows.tolist() == rows
    assert warning in str(caught[0].message)
    with pytest.raises(FormatError) as refused:
        read_bvh(data, name="walk.bvh", strict=True)
    assert str(refused.value) == str(caught[0].message)


def test_a_file_without_motion_is_a_skeleton_without_frames() -> None:
    with pytest.warns(FormatWarning, match="no MOTION"):
        motion = read_bvh(walk().split(b"MOTION")[0])
    assert motion.rows.shape == (0, 9)
    assert motion.frame_time == 0


def test_names_in_an_old_encoding_are_read_as_latin_1_and_said_once_a_file() -> None:
    data = WALK.replace("Hips", "Hüfte").replace("LeftLeg", "gauché").encode("latin-1")
    for _ in range(2):
        with pytest.warns(FormatWarning, match="'Hüfte' is not written in UTF-8") as caught:
            assert read_bvh(data).skeleton.names == ("Hüfte", "gauché", "gauché_end")
        assert len(caught) == 1
