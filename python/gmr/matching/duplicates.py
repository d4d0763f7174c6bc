"""Clips that are there more than once: a motion is matched once, whatever the number of its files.

Matching forbids jumps to frames close to those that are shown, for they show nothing new; a second file of
the same motion would be a way around that, and weigh twice where features are scaled.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.matching.database_rows import DatabaseRows

__all__ = ["duplicates", "duplicates_note"]

_ALIKE: Final = 1e-4
"""Metres by which joints may differ, seen from the simulation root: digits that were not written."""

_STEPS_ALIKE: Final = 1e-5
"""Metres, and radians, by which what the root does in a frame may differ."""


def duplicates(rows: DatabaseRows, mirrored: NDArray[np.bool_]) -> dict[str, str]:
    """The clips that equal another, or its mirrored copy, frame by frame and tag by tag.

    They are compared as the database has them: whatever their rate, their unit, where they lie in the world,
    and whether a converter put a T-pose before them.

    Args:
        rows: of a database.
        mirrored: (C,) which of its clips are mirrored copies, each behind its original.

    Returns:
        Their names, and the name of the clip that stands for each: the shortest, as copies are named after
        what they were made of; of equals the first.
    """
    found: dict[str, str] = {}
    for alike in _alike(rows, mirrored):
        stays = min(alike, key=len)
        found.update({name: stays for name in alike if name != stays})
    return found


def _alike(rows: DatabaseRows, mirrored: NDArray[np.bool_]) -> Iterator[list[str]]:
    """The clips by their motion, mirrored copies not named."""
    groups: list[list[str]] = []
    # By the number of frames: a number of the last one, the clip, and its group.
    known: dict[int, list[tuple[float, int, int]]] = {}
    group = 0
    for clip, (start, end) in enumerate(rows.core.clip_ranges):
        same_length = known.setdefault(end - start, [])
        told = float(rows.positions[end - 1].mean(dtype=np.float64))
        if not mirrored[clip]:
            near = same_length[bisect_left(same_length, (told - _ALIKE,)) :]
            same = (of for number, other, of in near if number <= told + _ALIKE and _same(rows, other, clip))
            group = next(same, len(groups))
            if group == len(groups):
                groups.append([])
            groups[group].append(rows.clip_names[clip])
        insort(same_length, (told, clip, group))
    yield from groups


def _same(rows: DatabaseRows, one: int, other: int) -> bool:
    """Whether two clips of one length show the same."""
    ours, theirs = rows.clip_rows(one), rows.clip_rows(other)
    compared = ((rows.displacements, _STEPS_ALIKE), (rows.turns, _STEPS_ALIKE), (rows.positions, _ALIKE))
    return np.array_equal(rows.tags[ours], rows.tags[theirs]) and all(
        bool((np.abs(values[ours] - values[theirs]) <= within).all()) for values, within in compared
    )


def duplicates_note(found: Mapping[str, str]) -> str:
    """Which clips were left out for others, in a sentence."""
    (name, first), more = next(iter(found.items())), len(found) - 1
    if not more:
        return f"'{name}' holds the same motion as '{first}' and was left out: every motion counts once."
    return (
        f"{len(found)} clips hold the same motion as others ('{name}' as '{first}' and {more} more) and were "
        "left out: every motion counts once."
    )
