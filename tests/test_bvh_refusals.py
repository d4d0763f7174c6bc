"""What no BVH file may hold, and the sentence that says so: file, line, joint, remedy."""

from __future__ import annotations

import pytest

from bvh_text import WALK, walk
from gmr import FormatError
from gmr.formats.bvh import read_bvh

TURNS = "CHANNELS 3 Zrotation Xrotation Yrotation"


def refusal(data: bytes) -> FormatError:
    with pytest.raises(FormatError) as caught:
        read_bvh(data, name="walk.bvh")
    return caught.value


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            TURNS,
            "CHANNELS 3 Zrotation Xrotation",
            "walk.bvh:9: joint 'LeftLeg' declares 3 channels but CHANNELS lists 2 (Zrotation Xrotation). "
            "Write the missing one, or change the count.",
        ),
        (
            TURNS,
            "CHANNELS 1 Zrotation Xrotation Yrotation",
            "walk.bvh:9: joint 'LeftLeg' declares 1 channel but CHANNELS lists 3 "
            "(Zrotation Xrotation Yrotation). Remove the ones too many, or change the count.",
        ),
        (
            TURNS,
            "CHANNELS 2",
            "walk.bvh:9: joint 'LeftLeg' declares 2 channels but CHANNELS lists 0 (none). "
            "Write the missing ones, or change the count.",
        ),
        (
            "5 6 7",
            "5 6 1,5",
            "walk.bvh:19:13: joint 'LeftLeg', Zrotation, frame 0: '1,5' has a decimal comma. "
            "Write a point, '1.5', here and everywhere.",
        ),
        (
            "OFFSET 1 -2 3.5",
            "OFFSET 1 -2",
            "walk.bvh:8: joint 'LeftLeg': OFFSET has 2 numbers. Write three: x, y and z.",
        ),
        (
            "\t}\n}\n",
            "\t}\n",
            "walk.bvh:15:1: MOTION stands inside joint 'Hips', which begins at line 2. "
            "Write the closing brace '}' that is missing.",
        ),
    ],
)
def test_a_refusal_names_file_line_joint_and_remedy(old: str, new: str, sentence: str) -> None:
    assert str(refusal(walk((old, new)))) == sentence


@pytest.mark.parametrize(
    ("token", "why"),
    [
        ("nan", "stands for no number"),
        ("-NaN(ind)", "stands for no number"),
        ("1.#IND", "stands for no number"),
        ("-1.#QNAN", "stands for no number"),
        ("inf", "stands for no number"),
        ("-Infinity", "stands for no number"),
        ("1,5", "Write a point, '1.5'"),
        ("-,5", "Write a point, '-.5'"),
        ("1,2,3", "Part numbers by blanks"),
        ("1e999", "too large for a 64-bit number"),
        ("--5", "'--5' is not a number"),
        ("1_000", "'1_000' is not a number"),
        ("0x1p3", "'0x1p3' is not a number"),
        ("٣", "'٣' is not a number"),
        ("\x07", "'\\x07' is not a number"),
        ("\x00", "a NUL byte"),
    ],
)
@pytest.mark.parametrize(("old", "line"), [("5 6 7", 19), ("-2 3.5", 8)])
def test_what_is_no_number_is_named_with_its_joint_and_a_remedy(
    token: str, why: str, old: str, line: int
) -> None:
    first, *rest = old.split()
    error = refusal(walk((old, " ".join([first, token, *rest[1:]]))))
    assert why in str(error)
    assert error.line == line
    assert "joint 'Hips', Yrotation" in str(error) or "joint 'LeftLeg', OFFSET" in str(error)


@pytest.mark.parametrize(
    ("old", "new", "part", "line"),
    [
        (TURNS, "CHANNELS 3 Zrotation Xrotation Wrotation", "a channel 'Wrotation'", 9),
        (TURNS, "CHANNELS 3 Xscale Yscale Zscale", "a channel 'Xscale'", 9),
        (TURNS, "CHANNELS three", "has CHANNELS followed by 'three'", 9),
        (TURNS, f"CHANNELS {'9' * 5000}", "Write how many", 9),
        (TURNS, "CHANNELS 2 Xposition Xposition", "a position twice", 9),
        (TURNS, "CHANNELS 3 Zrotation Xrotation Xrotation", "no Euler angles", 9),
        (TURNS, "CHANNELS 4 Zrotation Xrotation Yrotation Xrotation", "no Euler angles", 9),
        (TURNS, "CHANNELS 7 " + "Xrotation " * 7, "lists more than 6 channels", 9),
        (TURNS, "CHANNELS 99 " + "Xrotation " * 99, "lists more than 6 channels", 9),
        (TURNS, f"{TURNS}\n{TURNS}", "two CHANNELS", 10),
        ("OFFSET 1 -2 3.5", "OFFSET 1 2 3\nOFFSET 1 2 3", "two OFFSETs", 9),
        ("OFFSET 1 -2 3.5", "", "joint 'LeftLeg' has no OFFSET", 14),
        ("OFFSET 1 -2 3.5", "OFFSET 1 2 3 4", "'4' stands inside joint 'LeftLeg'", 8),
        ("\t\tOFFSET 0 -1 0\n", "", "End Site of joint 'LeftLeg' has no OFFSET", 10),
        ("OFFSET 0 -1 0", "OFFSET 0 -1 0 CHANNELS 0", "holds more than an OFFSET", 12),
        ("\t\t{\n\t\t\tOFFSET", "OFFSET", "End Site of joint 'LeftLeg' has no block", 10),
        ("\t{\n\t\tOFFSET", "\t\tOFFSET", "joint 'LeftLeg' has no block", 6),
        ("\t\tEnd Site", "{", "a second '{'", 10),
        ("JOINT LeftLeg", "ROOT LeftLeg", "ROOT stands inside joint 'Hips'", 6),
        ("JOINT LeftLeg", "JOINT Left\x00Leg", "control characters", 6),
        ("}\nMOTION", "}}\nMOTION", "one '}' too many", 15),
        ("}\nMOTION", "}\nEND", "'END' follows the last joint", 16),
        ("HIERARCHY\n", "", "begins with 'ROOT', but a BVH file begins with HIERARCHY", 1),
        ("ROOT", "JOINT", "HIERARCHY is followed by 'JOINT'", 2),
        ("Frames: 2", "Frames:", "'Frames:' is followed by nothing", 17),
        ("Frames: 2", "Frames: 2.5", "followed by '2.5'. Write how many", 17),
        ("Frames: 2", "Frames: -2", "followed by '-2'. Write how many", 17),
        ("Frames: 2\n", "", "MOTION is followed by 'Frame'", 16),
        ("Frame Time: 0.0083333", "", "the frame count is followed by '1'", 17),
        ("Frame Time: 0.0083333", "Frame Time: -1", "'-1' is negative", 18),
        ("Frame Time: 0.0083333", "Frame Time: 0,0083333", "'0.0083333'", 18),
        ("Frame Time: 0.0083333", "Frame Time: nan", "stands for no number", 18),
        ("5 6 7 8 9\n", "5 6 7 8\n", "joint 'LeftLeg', Yrotation: frame 0 has 8 of 9 numbers", 19),
        ("5 6 7 8 9\n", "5 6 7 8\n9\n", "Write each frame on a line of its own", 19),
        ("5 6 7 8 9\n", "5 6 7 8 9 10 11\n", "frame 0 has 11 numbers, but the joints have 9 channels", 19),
    ],
)
def test_a_broken_part_is_refused_at_its_line(old: str, new: str, part: str, line: int) -> None:
    error = refusal(walk((old, new)))
    assert part in str(error)
    assert error.line == line
    assert error.file == "walk.bvh"


def test_channels_after_children_are_refused() -> None:
    end = "\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 -1 0\n\t\t}\n"
    error = refusal(walk((f"\t\t{TURNS}\n", ""), (end, f"{end}\t\t{TURNS}\n")))
    assert "joint 'LeftLeg' has CHANNELS after its children" in str(error)


@pytest.mark.parametrize(
    ("data", "part"),
    [
        (b"", "is empty"),
        (b" \r\n\t", "is empty"),
        (b"\x89PNG\r\n\x1a\n", "begins with '\ufffdPNG'"),
        (WALK.encode("utf-16-le"), "UTF-16 without a byte order mark"),
        (WALK.encode("utf-16-be"), "UTF-16 without a byte order mark"),
        (b"\xff\xfea", "begins as UTF-16 but is not"),
        (b"HIERARCHY", "HIERARCHY is followed by the end of the file"),
        (b"HIERARCHY ROOT a {", "the file ends inside joint 'a', which begins at line 1"),
        (b"HIERARCHY ROOT a { OFFSET 0 0 0 } MOTION", "MOTION is followed by the end of the file"),
    ],
)
def test_what_is_no_bvh_file_is_said_to_be_none(data: bytes, part: str) -> None:
    assert part in str(refusal(data))


def test_lines_are_counted_alike_for_all_line_ends() -> None:
    for newline in ("\n", "\r\n", "\r"):
        bad = WALK.replace("-3 -4", "-3 x").replace("\n", newline)
        error = refusal(bad.encode())
        assert (error.line, error.column) == (20, 15)


def test_columns_count_characters_not_bytes() -> None:
    assert refusal(walk(("1 2 3 4", "1 é"))).column == 3
    assert refusal(walk(("LeftLeg\n\t{", "gauché { x"))).column == 17


def test_a_message_stays_short_whatever_the_file_holds() -> None:
    for data in (
        walk(("LeftLeg", "a" * 9999), ("5 6 7", f"5 6 {'x' * 9999}")),
        walk((TURNS, "CHANNELS 3 " + "Xrotation " * 9999)),
        walk(("HIERARCHY", "x" * 9999)),
    ):
        assert len(str(refusal(data))) < 400
