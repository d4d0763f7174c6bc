"""The channels that a joint of a text file lists: their count, then their names."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Final

from gmr.formats.text import Text, shown

__all__ = ["BVH", "GMR", "POST", "Vocabulary", "read_channels"]

_MOST_SHOWN = 8


@dataclass(frozen=True)
class Vocabulary:
    """The channels that a kind of file knows.

    Args:
        pattern: a count, and names of channels after it.
        most: that one joint may list.
        known: the names, for people.
        euler: rotations are angles, no two alike in succession.
    """

    pattern: re.Pattern[bytes]
    most: int
    known: str
    euler: bool


def _pattern(names: bytes) -> re.Pattern[bytes]:
    return re.compile(rb"\s*+([^\s{}]*+)((?:\s++(?:" + names + rb")(?![^\s{}])){0,64}+)", re.IGNORECASE)


_MOVING = "Xposition, Yposition, Zposition, Xrotation, Yrotation"
_ANGLES = _pattern(rb"[XYZ](?:position|rotation)")

BVH: Final = Vocabulary(_ANGLES, 6, f"{_MOVING} and Zrotation", euler=True)
"""Those of BVH."""

POST: Final = Vocabulary(_ANGLES, 6, f"{_MOVING} and Zrotation", euler=False)
"""What a GMR file keeps of the post-rotation file that it came from, be it as odd as it was."""

GMR: Final = Vocabulary(
    _pattern(rb"[XYZ](?:position|rotation)|[XYZW]quaternion|Idle"),
    10,
    f"{_MOVING}, Zrotation, Xquaternion, Yquaternion, Zquaternion, Wquaternion and Idle",
    euler=False,
)
"""Those of a GMR file."""

_LIKE_A_CHANNEL = (b"rotation", b"position", b"scale", b"quaternion")


def read_channels(text: Text, vocabulary: Vocabulary = BVH) -> tuple[str, ...]:
    """Reads a count and as many names of channels.

    Raises:
        ValueError: what is wrong with them and how to mend it, to be said of a joint.
    """
    match = text.take_match(vocabulary.pattern)
    assert match is not None
    count, listed = match[1], match[2].split()
    if not count.isdigit() or len(count) > 9:
        said = shown(count) if count else "nothing"
        raise ValueError(f"has CHANNELS followed by {said}. Write how many channels there are.")
    after = text.peek()
    if after.lower().endswith(_LIKE_A_CHANNEL) and len(listed) <= vocabulary.most:
        raise ValueError(f"has a channel {shown(after)}. There are only {vocabulary.known}.")
    return _checked(int(count), tuple(listed), vocabulary)


@lru_cache(maxsize=256)
def _checked(count: int, listed: tuple[bytes, ...], vocabulary: Vocabulary) -> tuple[str, ...]:
    """The names, of which there must be ``count``, and no more than a joint can have."""
    names = tuple(name.decode() for name in listed)
    shorter = " ".join(names[:_MOST_SHOWN]) + " ..." * (len(names) > _MOST_SHOWN) if names else "none"
    if len(names) > vocabulary.most:
        most = vocabulary.most
        raise ValueError(f"lists more than {most} channels ({shorter}). Write each position and angle once.")
    if count != len(names):
        ones = "one" if abs(count - len(names)) == 1 else "ones"
        mend = f"Write the missing {ones}" if len(names) < count else f"Remove the {ones} too many"
        raise ValueError(
            f"declares {count} channel{'s' * (count != 1)} but CHANNELS lists {len(names)} ({shorter}). "
            f"{mend}, or change the count."
        )
    known = [name.lower() for name in names]
    places = [name for name in known if name.endswith("position")]
    turns = [name for name in known if name.endswith("rotation")]
    if len(set(places)) < len(places):
        raise ValueError(f"has a position twice ({shorter}). Remove one.")
    if len(turns) > 3 or (vocabulary.euler and any(one == other for one, other in pairwise(turns))):
        what = f"has rotations that are no Euler angles ({shorter})"
        raise ValueError(f"{what}. Write at most three, no two alike in succession.")
    parts = sorted(name for name in known if name.endswith("quaternion"))
    if parts and (parts != _QUATERNION or turns):
        what = f"has {'angles and a quaternion' if turns else 'no whole quaternion'} ({shorter})"
        raise ValueError(f"{what}. Write Xquaternion Yquaternion Zquaternion Wquaternion, or angles.")
    return names


_QUATERNION = ["wquaternion", "xquaternion", "yquaternion", "zquaternion"]
