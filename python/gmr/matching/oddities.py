"""What is odd among the clips of a dataset and yet no reason to leave one out, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gmr.body.measures import Poses, up_axis
from gmr.listing import quoted
from gmr.motion import Motion

__all__ = ["oddities"]

_NAMED = 3


def oddities(
    motions: Mapping[str, Motion], poses: Mapping[str, Poses], roles: Mapping[str, int], up: str
) -> Iterator[str]:
    """Rates that differ, and clips that lie where the others stand.

    Args:
        motions: the clips by name.
        poses: some poses of each.
        roles: joints of the body.
        up: the axis that is up in all of them together.
    """
    yield from _rates(motions)
    yield from _lying(poses, roles, up)


def _rates(motions: Mapping[str, Motion]) -> Iterator[str]:
    rates = sorted({round(1 / motion.frame_time, 1) for motion in motions.values()})
    if len(rates) > 1:
        told = f"{', '.join(f'{rate:g}' for rate in rates[:-1])} and {rates[-1]:g}"
        yield f"The clips were recorded at {told} frames per second; all were brought to one rate."


def _lying(poses: Mapping[str, Poses], roles: Mapping[str, int], up: str) -> Iterator[str]:
    lying = [name for name, clip in poses.items() if up_axis(clip, roles) != up]
    if lying:
        yield (
            f"In {len(lying)} of {len(poses)} clips ({quoted(lying, _NAMED)}) the hips do not lie above the "
            f"feet along {up} as in the others: the body lies, or the file has another axis up. They were "
            "used as they are; give files with another axis a folder of their own, where it is found."
        )
