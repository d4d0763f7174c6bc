"""The channels that a joint of a BVH file lists."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import pairwise

from gmr.formats.text import shown

__all__ = ["CHANNELS", "checked_channels"]

CHANNELS = re.compile(rb"\s*+([^\s{}]*+)((?:\s++[XYZ](?:position|rotation)(?![^\s{}]))*+)", re.IGNORECASE)
"""A count and the names of channels after it."""

_MOST_SHOWN = 8
_LIKE_A_CHANNEL = (b"rotation", b"position", b"scale")


@lru_cache(maxsize=256)
def checked_channels(count: bytes, listed: bytes, after: bytes) -> tuple[str, ...]:
    """The names of the channels that a joint lists.

    Args:
        count: what stands after CHANNELS.
        listed: the names after it.
        after: the token that follows them.

    Raises:
        ValueError: what is wrong with them and how to mend it, to be said of a joint.
    """
    names = tuple(listed.decode().split())
    if not count.isdigit() or len(count) > 9:
        raise ValueError(f"has CHANNELS followed by {_said(count)}. Write how many channels there are.")
    if after.lower().endswith(_LIKE_A_CHANNEL):
        raise ValueError(
            f"has a channel {shown(after)}. There are only Xposition, Yposition, Zposition, Xrotation, "
            "Yrotation and Zrotation."
        )
    if int(count) != len(names):
        raise ValueError(_count_mismatch(int(count), names))
    known = [name.lower() for name in names]
    places = [name for name in known if name.endswith("position")]
    turns = [name for name in known if name.endswith("rotation")]
    if len(set(places)) < len(places):
        raise ValueError(f"has a position twice ({_listed(names)}). Remove one.")
    if len(turns) > 3 or any(one == other for one, other in pairwise(turns)):
        raise ValueError(
            f"has rotations that are no Euler angles ({_listed(names)}). Write at most three, no two "
            "alike in succession."
        )
    return names


def _count_mismatch(count: int, names: tuple[str, ...]) -> str:
    ones = "one" if abs(count - len(names)) == 1 else "ones"
    mend = f"Write the missing {ones}" if len(names) < count else f"Remove the {ones} too many"
    return (
        f"declares {count} channel{'s' * (count != 1)} but CHANNELS lists {len(names)} ({_listed(names)}). "
        f"{mend}, or change the count."
    )


def _listed(names: tuple[str, ...]) -> str:
    return " ".join(names[:_MOST_SHOWN]) + " ..." * (len(names) > _MOST_SHOWN) if names else "none"


def _said(token: bytes) -> str:
    return shown(token) if token else "nothing"
