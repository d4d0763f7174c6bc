"""What is odd among the clips of a dataset and yet no reason to leave one out, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from gmr.body.measures import Poses, up_axis
from gmr.listing import quoted
from gmr.motion import Motion

__all__ = ["oddities"]

_NAMED = 3


def oddities(
    motions: Mapping[str, Motion], poses: Mapping[str, Poses], roles: Mapping[str, int], up: str
) -> Iterator[str]:
    """Rates that differ, clips that are there more than once, and clips that lie where the others stand.

    Args:
        motions: the clips by name.
        poses: some poses of each.
        roles: joints of the body.
        up: the axis that is up in all of them together.
    """
    yield from _rates(motions)
    yield from _copies(motions)
    yield from _lying(poses, roles, up)


def _rates(motions: Mapping[str, Motion]) -> Iterator[str]:
    rates = sorted({round(1 / motion.frame_time, 1) for motion in motions.values()})
    if len(rates) > 1:
        told = f"{', '.join(f'{rate:g}' for rate in rates[:-1])} and {rates[-1]:g}"
        yield f"The clips were recorded at {told} frames per second; all were brought to one rate."


def _copies(motions: Mapping[str, Motion]) -> Iterator[str]:
    firsts: dict[tuple[object, ...], list[str]] = {}
    copies: dict[str, str] = {}
    for name, motion in motions.items():
        numbers = motion.source.numbers
        alike = firsts.setdefault((motion.frame_count, *(part[-1:].tobytes() for part in numbers)), [])
        first = next((other for other in alike if _same(motions[other], motion)), None)
        if first is None:
            alike.append(name)
        else:
            copies[name] = first
    if copies:
        name, first = next(iter(copies.items()))
        clips = "1 clip holds" if len(copies) == 1 else f"{len(copies)} clips hold"
        yield (
            f"{clips} the same motion as another ('{name}' as '{first}'"
            f"{f' and {len(copies) - 1} more' if len(copies) > 1 else ''}): seconds that add no movement. "
            "Remove the copies: the character jumps from one to the other as if they were different clips."
        )


def _same(one: Motion, other: Motion) -> bool:
    """Whether two clips with the same joints hold the same numbers."""
    ours, theirs = one.source.numbers, other.source.numbers
    return (
        one.frame_time == other.frame_time
        and len(ours) == len(theirs)
        and all(np.array_equal(mine, yours) for mine, yours in zip(ours, theirs, strict=True))
        and np.array_equal(one.skeleton.offsets, other.skeleton.offsets)
    )


def _lying(poses: Mapping[str, Poses], roles: Mapping[str, int], up: str) -> Iterator[str]:
    lying = [name for name, clip in poses.items() if up_axis(clip, roles) != up]
    if lying:
        yield (
            f"In {len(lying)} of {len(poses)} clips ({quoted(lying, _NAMED)}) the hips do not lie above the "
            f"feet along {up} as in the others: the body lies, or the file has another axis up. They were "
            "used as they are; give files with another axis a folder of their own, where it is found."
        )
