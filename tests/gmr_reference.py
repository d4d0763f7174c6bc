"""A second reader of GMR files, written from docs/gmr-format.md alone: Python, NumPy and SciPy.

It believes what a file says and checks nothing; the tests compare what it finds with what gmr finds.
"""

from __future__ import annotations

import json
import re
import struct
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"(?=[\s{}]|$)|[{}]|[^\s{}]+')
TYPES = {"F64": "<f8", "F32": "<f4", "I32": "<i4", "U8": "u1"}


@dataclass
class Joint:
    """A block of the text form."""

    name: str
    parent: Joint | None
    offset: list[float] = field(default_factory=list)
    number: int = -1
    turn: int = -1
    above: str | None = None
    home_offset: list[float] | None = None
    channels: list[str] = field(default_factory=list)


@dataclass
class Found:
    """What the reader makes of a file, by the joints' numbers."""

    names: list[str]
    positions: NDArray[np.float64]
    home_parents: list[int]
    home_offsets: NDArray[np.float64]


def read(data: bytes) -> Found:
    """Either form."""
    return read_binary(data) if data[8:9] == b"{" else read_text(data.decode("utf-8-sig"))


def read_text(text: str) -> Found:
    """The text form."""
    head, motion = re.split(r"^MOTION\b", text, maxsplit=1, flags=re.M | re.I)
    tokens = TOKEN.findall(head)
    adds = any(a.upper() == "POSITIONS" and b.lower() == "add" for a, b in pairwise(tokens))
    joints = parsed_blocks(tokens)
    for place, joint in enumerate(joints):
        joint.number = place if joint.number < 0 else joint.number
    lines = [line.split() for line in re.split(r"[\r\n]+", motion.rstrip("\0")) if line.strip()][2:]
    rows = np.array(lines, np.float64).reshape(len(lines), sum(len(joint.channels) for joint in joints))
    by_number = sorted(joints, key=lambda joint: joint.number)
    parents, offsets = home_of(by_number)
    positions = walked(joints, rows, adds)
    return Found([joint.name for joint in by_number], positions, parents, offsets)


def parsed_blocks(tokens: list[str]) -> list[Joint]:
    """The joints in the order in which their blocks begin."""
    joints: list[Joint] = []
    path: list[Joint] = []
    k = next(k for k, token in enumerate(tokens) if token.upper() == "ROOT")
    while k < len(tokens):
        word, rest = tokens[k].upper(), tokens[k + 1 :]
        if word in ("ROOT", "JOINT", "END"):
            skipped = 1 + (word == "END")
            name = f"{path[-1].name}_end" if tokens[k + skipped] == "{" else unquoted(tokens[k + skipped])
            joints.append(Joint(name, path[-1] if path else None))
            path.append(joints[-1])
            k = tokens.index("{", k + 1) + 1 if tokens[k + skipped] == "{" else k + skipped + 2
        elif word == "}":
            path.pop()
            k += 1
        else:
            k += 1 + item(path[-1], word, rest)
    return joints


def item(joint: Joint, word: str, rest: list[str]) -> int:
    """Takes an item of a block; how many tokens it has after its keyword."""
    match word:
        case "OFFSET":
            joint.offset = [float(token) for token in rest[:3]]
            return 3
        case "NUMBER":
            joint.number = int(rest[0])
        case "TURN":
            joint.turn = int(rest[0])
        case "LINK":
            joint.above = rest[0]
            joint.home_offset = [float(token) for token in rest[1:4]]
            return 4
        case "TOP":
            joint.home_offset = [float(token) for token in rest[:3]]
            return 3
        case "CHANNELS" | "POST":
            if word == "CHANNELS":
                joint.channels = [name.lower() for name in rest[1 : 1 + int(rest[0])]]
            return 1 + int(rest[0])
    return 1


def unquoted(token: str) -> str:
    return str(json.loads(token)) if token.startswith('"') else token


def home_of(joints: list[Joint]) -> tuple[list[int], NDArray[np.float64]]:
    """Parents and offsets at home."""
    parents = [-1 if joint.parent is None else joint.parent.number for joint in joints]
    offsets = np.array([joint.offset for joint in joints])
    for top in (joint for joint in joints if joint.home_offset is not None):
        here = top
        while here.parent is not None:
            parents[here.parent.number] = here.number
            offsets[here.parent.number] = -np.array(here.offset)
            here = here.parent
        parents[top.number] = -1 if top.above is None else referred(joints, top.above)
        offsets[top.number] = top.home_offset
    return parents, offsets


def referred(joints: list[Joint], reference: str) -> int:
    if reference.startswith("#"):
        return int(reference[1:])
    (found,) = [joint.number for joint in joints if joint.name == unquoted(reference)]
    return found


def walked(joints: list[Joint], rows: NDArray[np.float64], adds: bool) -> NDArray[np.float64]:
    """World positions, (F, J, 3): the section "Positions"."""
    frames = len(rows)
    world: dict[int, Rotation] = {}
    positions = np.zeros((frames, len(joints), 3))
    local: dict[tuple[int, int], Rotation] = {}
    column = 0
    for joint in joints:
        vector = np.tile(np.array(joint.offset), (frames, 1))
        angles: list[tuple[str, NDArray[np.float64]]] = []
        parts: dict[str, NDArray[np.float64]] = {}
        for name in joint.channels:
            values = rows[:, column]
            column += 1
            if name.endswith("position"):
                axis = "xyz".index(name[0])
                vector[:, axis] = vector[:, axis] + values if adds else values
            elif name.endswith("rotation"):
                angles.append((name[0].upper(), values))
            elif name.endswith("quaternion"):
                parts[name[0]] = values
        own = Rotation.from_quat(np.tile([0.0, 0.0, 0.0, 1.0], (max(frames, 1), 1)))[:frames]
        if frames and parts:
            own = Rotation.from_quat(np.stack([parts[axis] for axis in "xyzw"], axis=1))
        elif frames:
            for letter, values in angles:
                own = own * Rotation.from_euler(letter, values[:, None], degrees=True)
        if joint.parent is None:
            world[joint.number] = own
            positions[:, joint.number] = vector
            continue
        above = joint.parent.number
        if joint.turn == joint.parent.turn:
            world[joint.number] = world[above]
        else:
            own = local.setdefault((above, joint.turn), own)
            world[joint.number] = world[above] * own
        if frames:
            positions[:, joint.number] = positions[:, above] + world[joint.number].apply(vector)
    return positions


def read_binary(data: bytes) -> Found:
    """The binary form."""
    (length,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + length])
    metadata = header.pop("__metadata__")
    arrays: dict[str, NDArray[Any]] = {}
    for key, entry in header.items():
        begin, end = (8 + length + offset for offset in entry["data_offsets"])
        if entry["dtype"] in TYPES:
            arrays[key] = np.frombuffer(data[begin:end], TYPES[entry["dtype"]]).reshape(entry["shape"])
    names = json.loads(metadata["names"])
    parents, offsets = arrays["parents"].tolist(), arrays["offsets"].astype(float)
    home_parents = arrays.get("home_parents", arrays["parents"]).tolist()
    home_offsets = arrays.get("home_offsets", arrays["offsets"]).astype(float)
    if "rows" in arrays:
        positions = walked_rows(json.loads(metadata["post"]), parents, offsets, arrays["rows"])
    else:
        positions = walked_arrays(parents, offsets, arrays)
    return Found(names, positions, home_parents, home_offsets)


def walked_arrays(
    parents: list[int], offsets: NDArray[np.float64], arrays: dict[str, NDArray[Any]]
) -> NDArray[np.float64]:
    """Positions from rotations and translations."""
    frames, joints = len(arrays["translations"]), len(parents)
    moving = {joint: k for k, joint in enumerate(arrays["translated"].tolist())}
    positions = np.zeros((frames, joints, 3))
    world: dict[int, Rotation | None] = {}
    for joint in downwards(parents):
        slot, parent = int(arrays["slots"][joint]), parents[joint]
        own = Rotation.from_quat(arrays["rotations"][:, slot].astype(float)) if slot >= 0 and frames else None
        above = world[parent] if parent >= 0 else None
        world[joint] = own if above is None else above if own is None else above * own
        vector = np.tile(offsets[joint], (frames, 1))
        if joint in moving:
            vector = arrays["translations"][:, moving[joint]].astype(float)
        turn = world[joint]
        if parent >= 0:
            vector = positions[:, parent] + (vector if turn is None else turn.apply(vector))
        positions[:, joint] = vector
    return positions


def walked_rows(
    post: dict[str, Any], parents: list[int], offsets: NDArray[np.float64], rows: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Positions from rows of a post-rotation file: a joint's rotation turns all that hangs on it."""
    frames = len(rows)
    positions = np.zeros((frames, len(parents), 3))
    world: dict[int, Rotation] = {}
    starts = np.cumsum([0, *map(len, post["channels"])])
    for joint in downwards(parents) if frames else []:
        parent = parents[joint]
        vector = np.tile(offsets[joint], (frames, 1))
        turn = (
            world[parent] if parent >= 0 else Rotation.from_quat(np.tile([0.0, 0.0, 0.0, 1.0], (frames, 1)))
        )
        own = turn
        for column, name in enumerate(post["channels"][joint], starts[joint]):
            axis = name[0].lower()
            if name.lower().endswith("position"):
                place = "xyz".index(axis)
                base = vector[:, place] if post["positions"] == "add" else 0
                vector[:, place] = base + rows[:, column]
            else:
                own = own * Rotation.from_euler(axis.upper(), rows[:, [column]], degrees=True)
        positions[:, joint] = vector if parent < 0 else positions[:, parent] + turn.apply(vector)
        world[joint] = own
    return positions


def downwards(parents: list[int]) -> list[int]:
    """Joints, each after its parent."""
    order = [joint for joint, parent in enumerate(parents) if parent < 0]
    for joint in order:
        order += [child for child, parent in enumerate(parents) if parent == joint]
    return order


def configured_slots(
    home_parents: list[int], home_slots: list[int], parents: list[int], least: int = 0
) -> tuple[list[int], int]:
    """Slots of a configuration, and how many: the section "The binary form"; ``least`` slots are at home."""
    turns = [-1] * len(parents)
    for joint in downwards(home_parents):
        above = turns[home_parents[joint]] if home_parents[joint] >= 0 else -1
        turns[joint] = home_slots[joint] if home_slots[joint] >= 0 else above
    leads_from = {
        slot: turns[home_parents[joint]] if home_parents[joint] >= 0 else -1
        for joint, slot in enumerate(home_slots)
        if slot >= 0
    }
    carried = [turns[bone_of(joint, home_parents, parents)] for joint in range(len(parents))]
    groups: dict[tuple[int, int], list[int]] = {}
    for joint, parent in enumerate(parents):
        if carried[joint] != (carried[parent] if parent >= 0 else -1):
            key = (parent, carried[joint]) if parent >= 0 else (-1 - joint, -1)
            groups.setdefault(key, []).append(joint)
    numbers: dict[tuple[int, int], int] = {}
    for as_at_home in (True, False):
        for key, (first, *_) in groups.items():
            w, parent = carried[first], parents[first]
            above = carried[parent] if parent >= 0 else -1
            free = w != -1 and key not in numbers and w not in numbers.values()
            if free and (not as_at_home or leads_from[w] == above):
                numbers[key] = w
    count = max(least, 1 + max(home_slots))
    for key in groups:
        if key not in numbers:
            numbers[key] = count
            count += 1
    slots = [-1] * len(parents)
    for key, joints in groups.items():
        for joint in joints:
            slots[joint] = numbers[key]
    return slots, count


def bone_of(joint: int, home_parents: list[int], parents: list[int]) -> int:
    """The bone that a joint carries, by the joint in which it ends at home."""
    parent = parents[joint]
    if parent >= 0:
        return parent if home_parents[parent] == joint else joint
    while (above := home_parents[joint]) >= 0 and parents[above] == joint:
        joint = above
    return joint
