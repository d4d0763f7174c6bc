"""Skeleton and channel layout of a BVH file; files with the same hierarchy share them."""

from __future__ import annotations

from typing import NamedTuple

from gmr.channels import ChannelLayout
from gmr.formats.bvh_hierarchy import read_hierarchy
from gmr.formats.text import Text
from gmr.skeleton import Skeleton

__all__ = ["Shape", "read_shape"]

_LONGEST_SHARED = 1 << 16
_MOST_SHARED = 64


class Shape(NamedTuple):
    """What a BVH file says before MOTION."""

    skeleton: Skeleton
    layout: ChannelLayout


_shared: dict[tuple[bytes, bool], Shape] = {}
"""Shapes by the bytes before MOTION and by ``adds_offset``.

The takes of a session have the same hierarchy, byte by byte; reading it anew takes as long as the numbers
of a short take.
"""


def read_shape(text: Text, *, adds_offset: bool) -> Shape:
    """Reads the hierarchy and leaves ``text`` after it.

    Raises:
        FormatError: as :func:`gmr.formats.bvh_hierarchy.read_hierarchy`.
    """
    end = text.data.find(b"MOTION", text.at, text.at + _LONGEST_SHARED)
    key = text.data[text.at : end], adds_offset
    if end >= 0 and (known := _shared.get(key)):
        text.at = end
        return known
    shape = _read(text, adds_offset)
    if end >= 0 and text.peek_at() == end and not text.oddities:
        if len(_shared) >= _MOST_SHARED:
            _shared.clear()
        _shared[key] = shape
    return shape


def _read(text: Text, adds_offset: bool) -> Shape:
    found = read_hierarchy(text)
    turning = [joint for joint, channels in enumerate(found.channels) if channels]
    skeleton = Skeleton.post_rotation(
        found.names, found.parents, found.offsets, ends=found.ends, turning=turning
    )
    return Shape(skeleton, ChannelLayout.of(skeleton, found.channels, adds_offset=adds_offset))
