"""Left and right: which joint is the mirror image of which, told from names and hierarchy."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from gmr.errors import SkeletonError
from gmr.skeleton import Skeleton

__all__ = ["other_side", "pair_joints"]

# A strong mark says that a joint has a side; a weak one (the L of LHipJoint, of lfemur, of FootL) only where
# the joint of the other side is there too, for it may as well be the L of L5 or of lowerback.
_STRONG = (
    re.compile(r"Left(?![a-z])|Right(?![a-z])|(?<![A-Z])(?:LEFT|RIGHT)(?![A-Z])"),
    re.compile(r"(?<![A-Za-z])(?:left|right)(?![a-z])"),
    re.compile(r"(?<=[^A-Za-z0-9])[LRlr](?![A-Za-z0-9])|(?<![A-Za-z0-9])[LRlr](?=[^A-Za-z0-9])"),
)
_WEAK = (
    re.compile(r"left|right", re.IGNORECASE),
    re.compile(r"(?<![A-Za-z0-9])[LRlr](?=[A-Za-z])"),
    re.compile(r"(?<=[a-z0-9])[LR](?![A-Za-z0-9])"),
)
_OPPOSITE = {"left": "right", "right": "left", "l": "r", "r": "l"}


def other_side(name: str) -> tuple[str, ...]:
    """What the joint of the other side may be called, likeliest first; nothing for a name without a side."""
    found = [pattern.sub(_swap, name) for pattern in (*_STRONG, *_WEAK) if pattern.search(name)]
    return tuple(dict.fromkeys(found))


def pair_joints(
    skeleton: Skeleton, pairs: Mapping[str, str] | Iterable[tuple[str, str]] | None = None
) -> NDArray[np.int32]:
    """(J,) int32: the mirror image of each joint, itself for those in the middle.

    A joint's image is looked for among the children of its parent's image: by ``pairs``, by a name of the
    other side, below a sided parent by the same name; end sites by their order.

    Args:
        skeleton: any.
        pairs: names of joints of the two sides, where their names do not tell; a joint paired with itself is
            in the middle.

    Raises:
        SkeletonError: a joint of one side has no image, or the two sides hang together differently.
    """
    stated = _both_ways(skeleton, pairs)
    found = np.full(skeleton.joint_count, -1, np.int32)
    families = [(skeleton.roots, skeleton.roots)]
    while families:
        joints, images = families.pop()
        for joint, image in zip(joints, _images(skeleton, joints, images, stated), strict=True):
            found[joint] = image
            families.append((skeleton.children[joint], skeleton.children[image]))
    astray = np.flatnonzero(found[found] != np.arange(len(found)))
    if len(astray):
        raise _unpaired(skeleton, int(astray[0]))
    return found


def _images(
    skeleton: Skeleton, joints: tuple[int, ...], images: tuple[int, ...], stated: Mapping[str, str]
) -> Iterator[int]:
    """The image of each of ``joints``, which are siblings, among the children of their parent's image.

    Of several with the same name the first is the image of the first, and so on; end sites have no names of
    their own.
    """
    by_name: dict[str | None, list[int]] = {}
    for image in images:
        by_name.setdefault(_label(skeleton, image), []).append(image)
    seen: Counter[str | None] = Counter()
    for joint in joints:
        label = _label(skeleton, joint)
        wanted = [None] if label is None else _wanted(label, joints == images, stated)
        rank = seen[label]
        seen[label] += 1
        for name in wanted:
            if rank < len(by_name.get(name, ())):
                yield by_name[name][rank]
                break
        else:
            raise _unpaired(skeleton, joint)


def _label(skeleton: Skeleton, joint: int) -> str | None:
    """A joint's name, None for an end site."""
    return None if skeleton.ends[joint] else skeleton.names[joint]


def _wanted(name: str, in_the_middle: bool, stated: Mapping[str, str]) -> list[str | None]:
    """What the image of a joint may be called, likeliest first; its parent may be its own image."""
    if name in stated:
        return [stated[name]]
    has_a_side = any(pattern.search(name) for pattern in _STRONG)
    return [*other_side(name), *([] if in_the_middle and has_a_side else [name])]


def _both_ways(
    skeleton: Skeleton, pairs: Mapping[str, str] | Iterable[tuple[str, str]] | None
) -> dict[str, str]:
    """Each name of ``pairs`` with its partner; unknown names are refused."""
    if pairs is None:
        return {}
    found: dict[str, str] = {}
    for one, two in pairs.items() if isinstance(pairs, Mapping) else pairs:
        for name, partner in ((one, two), (two, one)):
            if name not in skeleton.names:
                skeleton.index(name)
            if found.setdefault(name, partner) != partner:
                raise SkeletonError(
                    f"pairs= gives joint '{name}' two partners: '{found[name]}' and '{partner}'"
                )
    return found


def _unpaired(skeleton: Skeleton, joint: int) -> SkeletonError:
    name, parent = skeleton.names[joint], int(skeleton.parents[joint])
    place = f"hanging on '{skeleton.names[parent]}'" if parent >= 0 else "a root"
    elsewhere = [partner for partner in other_side(name) if partner in skeleton.names]
    why = (
        f"'{elsewhere[0]}' hangs on a joint that is not the mirror image of its parent" if elsewhere
        else "there is no joint of the other side in the same place"
    )  # fmt: skip
    return SkeletonError(
        f"joint '{name}' ({place}) has no mirror image: {why}. "
        f"Name its partner with pairs=[('{name}', '...')], or itself if it is in the middle."
    )


def _swap(match: re.Match[str]) -> str:
    """The opposite word in the same case."""
    word = match.group()
    opposite = _OPPOSITE[word.lower()]
    if word.isupper():
        return opposite.upper()
    return opposite.capitalize() if word[0].isupper() else opposite
