"""Writes the conformance files that a reader of the GMR format must read: tests/data/gmr/valid.

python tools/gmr_valid_files.py

Beside each file a JSON file tells what a reader must find: for each joint its name, its parent and offset at
home, and its world position in every frame.
"""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np

import gmr
from gmr.formats.gmr import read_gmr, write_gmr, write_gmrb

DATA = Path(__file__).parent.parent / "tests" / "data"
OUT = DATA / "gmr" / "valid"

MOTION = "MOTION\nFrames: {}\nFrame Time: 0.5\n{}"
POSITIONS = "Xposition Yposition Zposition"
QUATERNION = "Xquaternion Yquaternion Zquaternion Wquaternion"

ARM = f"""GMR 1
UNIT 0.01
ROOT Shoulder
{{
	OFFSET 0 140 0
	CHANNELS 3 {POSITIONS}
	JOINT Elbow
	{{
		OFFSET 30 0 0
		TURN 0
		CHANNELS 4 {QUATERNION}
	}}
}}
ROOT Hand
{{
	OFFSET 25 0 0
	LINK Elbow 25 0 0
	TURN 1
	CHANNELS 7 {POSITIONS} {QUATERNION}
}}
MOTION
Frames: 2
Frame Time: 0.5
0 140 0 0 0 0 1 55 140 0 0 0 0 1
0 140 0 0 0 1 0 -55 140 0 0 0 1 0
"""
"""The example of the document."""

BODY = """HIERARCHY
ROOT Hips
{
	OFFSET 0 0 0
	CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
	JOINT Left
	{
		OFFSET 1 -1 0
		CHANNELS 2 Xrotation Zrotation
		JOINT Heel
		{
			OFFSET 0 -2 0.5
			CHANNELS 3 Yrotation Zrotation Yrotation
		}
		JOINT Toe
		{
			OFFSET 0 -2 1
			CHANNELS 4 Yposition Xrotation Zrotation Yrotation
			End Site
			{
				OFFSET 0 0 0.25
			}
		}
	}
	JOINT Right
	{
		OFFSET -1 -1 0
		CHANNELS 3 Xposition Zposition Yposition
		End Site
		{
			OFFSET 0 -2 0
		}
	}
	JOINT Tail
	{
		OFFSET 0 0.1 -1
		CHANNELS 1 Yposition
	}
}
MOTION
Frames: 2
Frame Time: 0.008333
0 1 0.1 0 0 0 0 0 0 0 0 -2 0 0 0 -1 -1 0 0.1
3 0.3 -0.0 10 20 30 40 50 60 70 80 -2.5 15 25 35 -1.5 0.25 -1e-3 0.2
"""
"""A post-rotation file with all oddities at once: siblings, fewer angles, positions anywhere, no End Site."""


def by_hand() -> dict[str, str]:
    """Text files, each with what it is good for as its name."""
    turned = f"""GMR 1
ROOT Foot
{{
	NUMBER 2
	OFFSET 0 0 0
	CHANNELS 3 {POSITIONS}
	JOINT Knee
	{{
		NUMBER 1
		OFFSET -0 4 -0
		TURN 1
		CHANNELS 4 {QUATERNION}
		JOINT Hip
		{{
			NUMBER 0
			OFFSET -0 5 -0.5
			TOP 0.5 9 0
			TURN 0
			CHANNELS 4 {QUATERNION}
			End Site
			{{
				NUMBER 3
				OFFSET 0 1 0
				CHANNELS 4 {QUATERNION}
			}}
		}}
	}}
}}
""" + MOTION.format(2, "1 0 2 0 0 0 1 0 0 0 1 0 0 0 1\n1 0 2 0.6 0 0 0.8 0 0.8 0 0.6 -0.6 0 0 0.8\n")
    euler = f"""GMR 1
ROOT a
{{
	OFFSET 0 0 0
	TURN 0
	CHANNELS 6 {POSITIONS} Xrotation Yrotation Zrotation
	JOINT b {{ OFFSET 1 0 0 TURN 1 CHANNELS 2 Yrotation Xrotation }}
	JOINT c {{ OFFSET 0 1 0 TURN 1 }}
	JOINT d {{ OFFSET 0 0 1 TURN 2 CHANNELS 5 Zposition {QUATERNION} }}
	JOINT e {{ OFFSET 0 0 2 TURN 0 JOINT f {{ OFFSET 1 1 1 TURN 3 CHANNELS 1 Zrotation }} }}
}}
""" + MOTION.format(2, "0 0 0 0 0 0 0 0 1 0 0 0 1 0\n1 2 3 10 20 30 40 50 1.5 0.5 -0.5 0.5 -0.5 90\n")
    names = f"""GMR 1
ROOT "left leg"
{{
	OFFSET 0 0 0
	CHANNELS 3 {POSITIONS}
	JOINT "" {{ OFFSET 1 0 0 JOINT "{{}}#\\"\\n" {{ OFFSET 1 0 0 }} }}
	JOINT twice {{ OFFSET 0 1 0 JOINT twice {{ OFFSET 0 1 0 }} }}
	JOINT mixamorig:Füße {{
		OFFSET 0 0 1
		JOINT OFFSET {{ OFFSET 0 0 1 End Site "\\ud800" {{ OFFSET 0 0 1 }} }}
	}}
}}
ROOT "#3" {{ OFFSET 0 0 2 LINK #4 0 0 2 CHANNELS 3 {POSITIONS} }}
ROOT last {{ OFFSET 0 0 3 LINK "left leg" 0 0 3 CHANNELS 3 {POSITIONS} }}
""" + MOTION.format(1, "1 2 3 4 5 6 7 8 9\n")
    order = f"""GMR 1
TRANSLATED 3 2 0 1
ROOT a {{ OFFSET 0 0 0 CHANNELS 3 {POSITIONS}
	JOINT b {{ OFFSET 0 1 0 CHANNELS 2 Yposition Xposition
		JOINT c {{ OFFSET 0 1 0 CHANNELS 1 Zposition }} }} }}
""" + MOTION.format(1, "1 2 3 4 5 6\n")
    spelled = ARM.replace("TURN", "turn").replace("ROOT", "Root").replace("OFFSET", "Offset")
    spelled = spelled.replace("\n\t{", " {").replace("Frames:", "frames:\t").replace("\n", "\r\n\r\n")
    return {
        "arm": ARM,
        "turned_over": turned,
        "angles_and_quaternions": euler,
        "names": names,
        "translated_in_another_order": order,
        "spelled_otherwise": spelled.replace("quaternion", "QUATERNION") + "  \r\n\0\0",
        "no_frames": ARM.split("MOTION")[0] + MOTION.format(0, ""),
        "positions_add": euler.replace("GMR 1", "GMR 1\nPOSITIONS add"),
    }


def moved() -> dict[str, gmr.Motion]:
    """Motions in other configurations than home."""
    body = gmr.read(BODY.encode())
    walk = gmr.read(DATA / "cmu_07_01.bvh")[1:4]
    return {
        "rows": body,
        "rows_that_add": gmr.read(BODY.encode(), positions="add"),
        "cut_and_turned_over": body.split("Left").shift_root("Toe").shift_root("Right"),
        "end_site_as_root": body.with_roots(["Toe_end", "Hips"]),
        "all_roots": body.with_roots(range(body.skeleton.joint_count)),
        "without_dummies": walk.drop_dummies().with_roots(["Hips", "Head"]),
        "walk": walk,
        "walk_from_the_neck": walk.with_roots(["Neck", "LeftFoot"]),
    }


def other_binary(arm: bytes) -> dict[str, bytes]:
    """Binary files as other programs may write them."""
    length = int.from_bytes(arm[:8], "little")
    header, data = json.loads(arm[8 : 8 + length]), arm[8 + length :]
    unaligned = json.dumps(header, indent=1).encode()
    unaligned += b" " * ((3 - len(unaligned)) % 8)
    arrays = {
        key: data[slice(*entry["data_offsets"])] for key, entry in header.items() if key != "__metadata__"
    }
    narrow: dict[str, object] = {"__metadata__": {**header["__metadata__"], "author": "somebody"}}
    parts, at = [], 0
    for key in sorted(arrays):
        entry, raw = header[key], arrays[key]
        if entry["dtype"] == "F64":
            raw, entry = np.frombuffer(raw).astype("<f4").tobytes(), {**entry, "dtype": "F32"}
        narrow[key] = {**entry, "data_offsets": [at, at + len(raw)]}
        parts.append(raw)
        at += len(raw)
    narrow["contacts"] = {"dtype": "BOOL", "shape": [2], "data_offsets": [at, at + 2]}
    text = json.dumps(narrow, separators=(",", ":")).encode()
    return {
        "unaligned": len(unaligned).to_bytes(8, "little") + unaligned + data,
        "narrow_and_more": len(text).to_bytes(8, "little") + text + b"".join([*parts, b"\0\1"]),
    }


def told(motion: gmr.Motion) -> str:
    """What a reader must find, as JSON, a joint a line."""
    home = motion.skeleton.home or motion.skeleton
    positions = np.round(motion.positions(dtype=float), 9) + 0.0
    lines = [
        json.dumps({"name": name, "home_parent": parent, "home_offset": offset, "positions": places})
        for name, parent, offset, places in zip(
            home.names, home.parents.tolist(), home.offsets.tolist(), positions.swapaxes(0, 1).tolist(),
            strict=True,
        )
    ]  # fmt: skip
    return "[\n" + ",\n".join(lines) + "\n]\n"


def main() -> None:
    """Writes all files anew."""
    warnings.simplefilter("error")
    texts = by_hand()
    files = {f"{name}.gmr": text.encode() for name, text in texts.items()}
    motions = moved() | {name: read_gmr(text.encode()) for name, text in texts.items()}
    for name, motion in motions.items():
        files.setdefault(f"{name}.gmr", write_gmr(motion))
        files[f"{name}.gmrb"] = write_gmrb(motion)
    files |= {f"{name}.gmrb": data for name, data in other_binary(files["arm.gmrb"]).items()}
    empty(OUT)
    for file, data in files.items():
        (OUT / file).write_bytes(data)
        (OUT / file).with_suffix(".json").write_text(told(read_gmr(data)), encoding="utf-8")


def empty(folder: Path) -> None:
    """A folder without files."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()


if __name__ == "__main__":
    main()
