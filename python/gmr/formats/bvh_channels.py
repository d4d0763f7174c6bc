"""The channels that a joint of a BVH file lists."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import pairwise

from gmr.formats.text import Text, shown

__all__ = ["read_channels"]

_MOST = 6
_MOST_SHOWN = 8
_CHANNELS = re.compile(
    rb"\s*+([^\s{}]*+)((?:\s++[XYZ](?:position|rotation)(?![^\s{}])){0,64}+)", re.IGNORECASE
)
_LIKE_A_CHANNEL = (b"rotation", b"position", b"scale")


def read_channels(text: Text) -> tuple[str, ...]:
    """Reads a count and as many names of channels.

    Raises:
        ValueError: what is wrong with them and how to mend it, to be said of a joint.
    """
    match = text.take_match(_CHANNELS)
    assert match is not None
    count, listed = match[1], match[2].split()
    if not count.isdigit() or len(count) > 9:
        said = shown(count) if count else "nothing"
        raise ValueError(f"has CHANNELS followed by {said}. Write how many channels there are.")
    after = text.peek()
    if after.lower().endswith(_LIKE_A_CHANNEL) and len(listed) <= _MOST:
        raise ValueError(
            f"has a channel {shown(after)}. There are only Xposition, Yposition, Zposition, Xrotation, "
            "Yrotation and Zrotation."
        )
    return _checked(int(count), tuple(listed))


@lru_cache(maxsize=256)
def _checked(count: int, listed: tuple[bytes, ...]) -> tuple[str, ...]:
    """The names, of which there must be ``count``, and no more than a joint can have."""
    names = tuple(name.decode() for name in listed)
    shorter = " ".join(names[:_MOST_SHOWN]) + " ..." * (len(names) > _MOST_SHOWN) if names else "none"
    if len(names) > _MOST:
        raise ValueError(f"lists more than {_MOST} channels ({shorter}). Write each position and angle once.")
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
    if len(turns) > 3 or any(one == other for one, other in pairwise(turns)):
        what = f"has rotations that are no Euler angles ({shorter})"
        raise ValueError(f"{what}. Write at most three, no two alike in succession.")
    return names
