"""Clips that are there more than once: a motion is matched once, whatever the number of its files.

Matching forbids jumps to frames close to those that are shown, for they show nothing new; a second file of
the same motion would be a way around that, and weigh twice where features are scaled.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike

from gmr.motion import Motion

__all__ = ["duplicates", "duplicates_note"]


def duplicates(motions: Mapping[str, Motion], tags: Mapping[str, ArrayLike]) -> dict[str, str]:
    """The clips that equal another in all numbers and tags, by name, and the name of the one that stands for
    them: the shortest, as copies are named after what they were made of; of equals the first.

    Args:
        motions: the clips by name.
        tags: bits of some of them, as :meth:`gmr.matching.Database.build` takes them.
    """
    found = {}
    for alike in _alike(motions, tags):
        stays = min(alike, key=len)
        found.update({name: stays for name in alike if name != stays})
    return found


def _alike(motions: Mapping[str, Motion], tags: Mapping[str, ArrayLike]) -> Iterator[list[str]]:
    """The clips by their motion and tags."""
    kinds: dict[tuple[object, ...], list[list[str]]] = {}
    for name, motion in motions.items():
        # Clips are compared whole only where their lengths and last frames agree.
        ends = (numbers[-1:].tobytes() for numbers in motion.source.numbers)
        groups = kinds.setdefault((motion.frame_count, *ends), [])
        for group in groups:
            if motions[group[0]] == motion and _tagged_alike(tags, group[0], name):
                group.append(name)
                break
        else:
            groups.append([name])
    for groups in kinds.values():
        yield from groups


def _tagged_alike(tags: Mapping[str, ArrayLike], one: str, other: str) -> bool:
    return np.array_equal(np.asarray(tags.get(one, 0)), np.asarray(tags.get(other, 0)))


def duplicates_note(found: Mapping[str, str]) -> str:
    """Which clips were left out for others, in a sentence."""
    (name, first), more = next(iter(found.items())), len(found) - 1
    if not more:
        return f"'{name}' holds the same motion as '{first}' and was left out: every motion counts once."
    return (
        f"{len(found)} clips hold the same motion as others ('{name}' as '{first}' and {more} more) and were "
        "left out: every motion counts once."
    )
