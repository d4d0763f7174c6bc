"""Writes the conformance files that a reader of the GMR format must refuse: tests/data/gmr/invalid.

python tools/gmr_invalid_files.py

``sentences.json`` holds what gmr says of each; it is written only where that says what is expected here.
"""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
from gmr_valid_files import ARM, DATA, POSITIONS, QUATERNION, empty

from gmr.errors import FormatError
from gmr.formats.gmr import read_gmr, write_gmrb

OUT = DATA / "gmr" / "invalid"


def broken_text() -> dict[str, tuple[str, str]]:
    """Text files, and what is said of each."""
    arm = ARM

    def change(old: str, new: str) -> str:
        assert old in arm, old
        return arm.replace(old, new, 1)

    return {
        "not_gmr": ("HIERARCHY\n", "begins with GMR and a version"),
        "version": (change("GMR 1", "GMR 2"), "GMR is followed by '2', but this gmr reads version 1"),
        "header": (change("UNIT 0.01", "LENGTH 0.01"), "'LENGTH' stands in the header"),
        "header_twice": (change("UNIT 0.01", "UNIT 0.01 UNIT 1"), "there are two UNITs"),
        "unit": (change("UNIT 0.01", "UNIT 0"), "a unit is longer than 0"),
        "no_root": ("GMR 1\nMOTION", "'MOTION' stands in the header"),
        "no_offset": (change("OFFSET 30 0 0", ""), "joint 'Elbow' has no OFFSET"),
        "short_offset": (change("OFFSET 30 0 0", "OFFSET 30 0"), "joint 'Elbow': OFFSET has 2 numbers"),
        "two_offsets": (change("OFFSET 30 0 0", "OFFSET 30 0 0 OFFSET 30 0 0"), "'Elbow' has two OFFSETs"),
        "name": (change("Elbow\n", "\n"), "'{' stands where a name should"),
        "json_name": (change("ROOT Hand", 'ROOT "\\x"'), "is no JSON string"),
        "brace": (change("\t}\n}", "\t}\n"), "ROOT stands inside joint 'Shoulder'"),
        "too_many_braces": (change("}\nMOTION", "}\n}\nMOTION"), "there is one '}' too many"),
        "item": (change("TURN 0", "SPIN 0"), "'SPIN' stands inside joint 'Elbow'"),
        "end_with_joint": (
            change("JOINT Elbow", "End Site Elbow").replace("TURN 0", "JOINT x { OFFSET 0 0 0 }"),
            "'JOINT' stands inside the End of joint 'Elbow'",
        ),
        "no_motion": (arm.split("MOTION")[0], "the file ends before MOTION"),
        "kind": (change("TURN 0", "KIND Bone"), "KIND is followed by 'Bone'"),
        "turn": (change("TURN 0", "TURN -1"), "has TURN followed by '-1'"),
        "turn_beyond": (change("TURN 0", "TURN 3"), "has TURN 3, but 3 joints"),
        "turn_gap": (change("TURN 0", "TURN 2"), "has TURN 2, but lower numbers turn no bone"),
        "turn_of_no_sibling": (
            change("}\nROOT", f"\tJOINT Thumb {{ OFFSET 1 0 0 TURN 1 CHANNELS 4 {QUATERNION} }}\n}}\nROOT"),
            "has the same TURN 1 as 'Thumb', but they are no siblings at home",
        ),
        "no_turn": (
            change("TURN 1\n\tCHANNELS 7", "CHANNELS 3").replace(
                f"3 {POSITIONS} {QUATERNION}", f"3 {POSITIONS}"
            ),
            "joint 'Hand' has no TURN, but hangs at home on 'Elbow', which has one",
        ),
        "link_nowhere": (
            change("LINK Elbow", "LINK Elbo"),
            "hangs at home on 'Elbo', but there is no such joint",
        ),
        "link_number": (change("LINK Elbow", "LINK #3"), "hangs at home on '#3'".replace("'", "")),
        "link_ambiguous": (
            change("JOINT Elbow", "JOINT Shoulder").replace("LINK Elbow", "LINK Shoulder"),
            "but 2 joints have that name",
        ),
        "link_to_itself": (change("LINK Elbow", "LINK Hand"), "which hangs on it in turn"),
        "link_circle": (
            change("OFFSET 0 140 0", "OFFSET 0 140 0 LINK Hand 0 140 0"),
            "which hangs on it in turn",
        ),
        "link_length": (
            change("LINK Elbow 25", "LINK Elbow 26"),
            "an OFFSET and a LINK of different lengths",
        ),
        "link_and_top": (change("LINK Elbow 25 0 0", "LINK Elbow 25 0 0 TOP 0 0 0"), "has a LINK and a TOP"),
        "top_of_root": (change("LINK Elbow 25 0 0", "TOP 25 0 0"), "is the root and the top of its tree"),
        "two_tops": (
            change("TURN 0", "TURN 0 TOP 0 0 0").replace(
                "OFFSET 0 140 0", "OFFSET 0 140 0 LINK Hand 0 140 0"
            ),
            "are both the top of one tree",
        ),
        "root_offset": (change("TURN 0", "TURN 0 TOP 0 0 0"), "whose top is 'Elbow'"),
        "numbers_missing": (change("TURN 0", "TURN 0 NUMBER 0"), "has a NUMBER, unlike joint 'Shoulder'"),
        "channel": (change("Xquaternion", "Xscale"), "has a channel 'Xscale'"),
        "channel_count": (change("CHANNELS 4", "CHANNELS 3"), "declares 3 channels but CHANNELS lists 4"),
        "part_of_a_quaternion": (
            change(f"4 {QUATERNION}", "3 Xquaternion Yquaternion Zquaternion"),
            "has no whole quaternion",
        ),
        "angles_and_quaternion": (
            change(f"4 {QUATERNION}", f"5 Xrotation {QUATERNION}"),
            "has angles and a quaternion",
        ),
        "position_twice": (change("3 Xposition", "3 Yposition"), "has a position twice"),
        "root_without_place": (change(f"CHANNELS 3 {POSITIONS}", ""), "is a root without position channels"),
        "turn_without_channels": (
            change(f"CHANNELS 4 {QUATERNION}", ""),
            "has a TURN of its own, but no rotation",
        ),
        "rotation_without_turn": (change("TURN 0\n", "\n"), "has rotation channels, but its bone turns as"),
        "post_without_header": (
            change("TURN 0", "TURN 0 POST 1 Xrotation"),
            "has POST, but the header has none",
        ),
        "post_of_another": (
            change("UNIT 0.01", "POST replace").replace("TURN 1", "TURN 2").replace("TURN 0", "TURN 1"),
            "the TURNs are not those of the joints with POST",
        ),
        "translated": (change("UNIT 0.01", "TRANSLATED 2 1 0"), "TRANSLATED must list all roots"),
        "translated_beyond": (change("UNIT 0.01", "TRANSLATED 2 2 7"), "TRANSLATED must list all roots"),
        "translated_again": (change("UNIT 0.01", "TRANSLATED 3 0 2 2"), "TRANSLATED must list all roots"),
        "translated_count": (change("UNIT 0.01", "TRANSLATED 3 1 0"), "TRANSLATED is no list"),
        "frames": (change("Frames: 2", "Frames: two"), "'Frames:' is followed by 'two'"),
        "not_a_number": (
            change("-55", "nan"),
            "joint 'Hand', Xposition, frame 1: 'nan' stands for no number",
        ),
        "infinite": (change("-55", "-1e999"), "joint 'Hand', Xposition, frame 1: '-1e999' is too large"),
        "row_too_short": (change("55 140 0 0 0 0 1\n", "55 140\n"), "frame 0 has 9 of 14 numbers"),
    }


def broken_binary(arm: bytes) -> dict[str, tuple[bytes, str]]:
    """Binary files, and what is said of each."""
    length = int.from_bytes(arm[:8], "little")
    header, data = json.loads(arm[8 : 8 + length]), arm[8 + length :]

    def with_header(change: Callable[[dict[str, dict[str, object]]], object]) -> bytes:
        changed = json.loads(json.dumps(header))
        change(changed)
        text = json.dumps(changed, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 8)
        return len(text).to_bytes(8, "little") + text + data

    def metadata(**changes: str) -> bytes:
        return with_header(lambda header: header["__metadata__"].update(changes))

    def tensor(key: str, **changes: object) -> bytes:
        return with_header(lambda header: header[key].update(changes))

    def values(key: str, new: bytes, at: int = 0) -> bytes:
        begin = 8 + length + header[key]["data_offsets"][0] + at
        return arm[:begin] + new + arm[begin + len(new) :]

    twice = arm[8 : 8 + length].replace(b'"parents":', b'"slots":')
    rotations = header["rotations"]["data_offsets"]
    return {
        "cut_off": (arm[:-9], "ends 9 bytes after the file"),
        "cut_in_header": (arm[:200], "the header claims"),
        "too_long": (arm + b"\0", "1 bytes at the end belong to no array"),
        "header_of_2_60": ((1 << 60).to_bytes(8, "little") + arm[8:], "claims 1,152,921,504,606,846,976"),
        "no_json": (arm[:9] + b"'" + arm[10:], "the header is no JSON"),
        "no_utf8": (arm[:30] + b"\xff" + arm[31:], "the header is no UTF-8 at its byte 22"),
        "array_twice": (arm[:8] + twice + b" " * (length - len(twice)) + data, "'slots' stands twice"),
        "another_kind": (metadata(format="pt"), "this safetensors file holds no motion"),
        "another_version": (metadata(version="2"), "the version is '2', but this gmr reads 1"),
        "frame_time": (metadata(frame_time="nan"), "frame_time in the metadata is 'nan'"),
        "names": (metadata(names='["a"'), "names in the metadata is no JSON"),
        "too_few_names": (metadata(names='["a"]'), "parents is I32 of the shape [3]; it must be I32 of [1]"),
        "unknown_type": (tensor("ends", dtype="U7"), "the array 'ends' is of the unknown type 'U7'"),
        "wrong_type": (tensor("ends", dtype="I8"), "ends is I8 of the shape [3]; it must be U8"),
        "wrong_shape": (tensor("rotations", shape=[2, 3, 4]), "does not take 128 bytes"),
        "endless_shape": (tensor("rotations", shape=[2**62, 2, 4]), "does not take 128 bytes"),
        "overlap": (
            tensor("translations", data_offsets=[rotations[0], rotations[0] + 96]), "overlap",
        ),
        "gap": (
            with_header(lambda header: header.pop("rotations")),
            "128 bytes before the array 'translations'",
        ),
        "no_array": (with_header(lambda header: header.pop("ends")), "3 bytes at the end belong to no array"),
        "parent_beyond": (values("parents", (3).to_bytes(4, "little"), 4), "parents holds numbers below -1"),
        "circle": (values("home_parents", b"\1\0\0\0\0\0\0\0"), "joint 0 is its own ancestor"),
        "no_bone": (values("parents", bytes(4), 8), "parents is no configuration"),
        "slots_of_another": (values("slots", (1).to_bytes(4, "little"), 4), "slots of joint 'Elbow' is 1"),
        "offsets_of_another": (values("offsets", np.float64(31).tobytes(), 24), "joint 'Elbow' is [31"),
        "offset_nan": (
            values("home_offsets", np.float64(np.nan).tobytes()), "home_offsets holds numbers that",
        ),
        "end": (values("ends", b"\3"), "ends holds other numbers than 0"),
        "translated_twice": (values("translated", bytes(8)), "translated must hold all roots"),
    }  # fmt: skip


def sentence(file: str, data: bytes) -> str:
    """What gmr says of a file."""
    try:
        read_gmr(data, name=file)
    except FormatError as error:
        return str(error)
    raise AssertionError(f"{file} is read as if nothing were wrong")


def main() -> None:
    """Writes all files anew."""
    files = {f"{name}.gmr": (text.encode(), part) for name, (text, part) in broken_text().items()}
    arm = write_gmrb(read_gmr(ARM.encode()))
    files |= {f"{name}.gmrb": entry for name, entry in broken_binary(arm).items()}
    sentences = {}
    for file, (data, part) in sorted(files.items()):
        sentences[file] = sentence(file, data)
        if part not in sentences[file]:
            raise SystemExit(f"{file}: {sentences[file]!r} does not say {part!r}")
    empty(OUT)
    for file, (data, _) in files.items():
        (OUT / file).write_bytes(data)
    text = json.dumps(sentences, indent=1, ensure_ascii=False)
    (OUT / "sentences.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
