"""Clips that are there more than once: a motion is matched once, whatever the number of its files.

Matching forbids jumps to frames close to those that are shown, for they show nothing new; a second file of
the same motion would be a way around that, and weigh twice where features are scaled.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gmr.matching.database_rows import DatabaseRows
from gmr.matching.naming import image_of, recording_of
from gmr.motion import Motion

__all__ = ["duplicates", "duplicates_clause", "duplicates_note", "followed"]

_ALIKE: Final = 1e-4
"""Metres by which joints may differ, seen from the simulation root: digits that were not written."""

_STEPS_ALIKE: Final = 1e-5
"""Metres, and radians, by which what the root does in a frame may differ."""

_TURNS_ALIKE: Final = 5e-4
"""By which the numbers of a quaternion may differ: half an angle in radians."""


def duplicates(rows: DatabaseRows, motions: Mapping[str, Motion]) -> dict[str, str]:
    """The clips that equal another, or its mirrored copy, frame by frame, joint by joint and tag by tag.

    They are compared as the database has them: whatever their unit, where they lie in the world, and whether
    a converter put a T-pose before them.

    Args:
        rows: of a database.
        motions: what its clips were read from, by name.

    Returns:
        Their names, and for each the name of the clip in the database that is the same: of the file with the
        highest rate, of equals the one with the shortest name, as copies are named after what they were made
        of, of equals the first.
    """
    found: dict[str, str] = {}
    for alike in _alike(rows):
        stays = min(alike, key=lambda name: (round(motions[name].frame_time, 6), len(name)))
        for name, image in alike.items():
            if name != stays:
                found[name] = stays if image == alike[stays] else image_of(stays)
    return found


def _alike(rows: DatabaseRows) -> list[dict[str, bool]]:
    """The clips by their motion, mirrored copies not named; whether each is the mirror image of the first."""
    groups: list[dict[str, bool]] = []
    # By the number of frames: a number of the last one, the clip, its group and whether it is an image there.
    known: dict[int, list[tuple[float, int, int, bool]]] = {}
    group, image = 0, False
    for clip, (start, end) in enumerate(rows.core.clip_ranges):
        same_length = known.setdefault(end - start, [])
        told = float(rows.positions[end - 1].mean(dtype=np.float64))
        if rows.mirrored[clip]:
            image = not image
        else:
            near = same_length[bisect_left(same_length, (told - _ALIKE,)) :]
            same = (
                (of, turned)
                for number, other, of, turned in near
                if number <= told + _ALIKE and _same(rows, other, clip)
            )
            group, image = next(same, (len(groups), False))
            if group == len(groups):
                groups.append({})
            groups[group][rows.clip_names[clip]] = image
        insort(same_length, (told, clip, group, image))
    return groups


def _same(rows: DatabaseRows, one: int, other: int) -> bool:
    """Whether two clips of one length show the same."""
    ours, theirs = rows.clip_rows(one), rows.clip_rows(other)
    compared = (
        (rows.displacements, _STEPS_ALIKE),
        (rows.turns, _STEPS_ALIKE),
        (rows.positions, _ALIKE),
        (rows.core.translations, _ALIKE),
    )
    return (
        np.array_equal(rows.tags[ours], rows.tags[theirs])
        and all(bool((np.abs(values[ours] - values[theirs]) <= within).all()) for values, within in compared)
        and _turned_alike(rows.core.rotations[ours], rows.core.rotations[theirs])
    )


def _turned_alike(ours: NDArray[np.float32], theirs: NDArray[np.float32]) -> bool:
    """Whether bones are turned alike, those too that nothing hangs on; q and -q are one rotation."""
    apart = np.minimum(np.abs(ours - theirs).max(axis=-1), np.abs(ours + theirs).max(axis=-1))
    return bool((apart <= _TURNS_ALIKE).all())


def followed(found: Mapping[str, str], more: Mapping[str, str]) -> dict[str, str]:
    """All duplicates, when some clips that stood for others turn out to be duplicates themselves."""
    stand = {}
    for name, first in found.items():
        of = recording_of(first)
        then = more.get(of, of)
        is_image = (first != of) != (then != recording_of(then))
        stand[name] = image_of(recording_of(then)) if is_image else recording_of(then)
    return {**stand, **more}


def duplicates_clause(found: Mapping[str, str]) -> str:
    """Which clips hold the same motion as which, as the beginning of a sentence on them."""
    (name, first), more = next(iter(found.items())), len(found) - 1
    if not more:
        return f"'{name}' holds the same motion as '{first}'"
    return f"{len(found)} clips hold the same motion as others ('{name}' as '{first}' and {more} more)"


def duplicates_note(found: Mapping[str, str]) -> str:
    """Which clips were left out for others, in a sentence."""
    were = "was" if len(found) == 1 else "were"
    return f"{duplicates_clause(found)} and {were} left out: every motion counts once."
