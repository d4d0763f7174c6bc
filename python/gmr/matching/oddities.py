"""What is odd among the clips of a dataset and yet no reason to leave one out, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from gmr.body.joints import find_joints
from gmr.body.measures import Poses, up_axis
from gmr.errors import DatasetError
from gmr.listing import quoted
from gmr.motion import Motion
from gmr.skeleton import Skeleton

__all__ = ["axes_apart", "no_facing", "oddities"]

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


def no_facing(clip: Poses, roles: Mapping[str, int], up: str) -> str | None:
    """Why a clip shows no facing, where that is because of its axis; None where it stands like the others.

    Args:
        clip: some poses of it, as in the file.
        roles: joints of the body.
        up: the axis that is up in all clips together.
    """
    own = up_axis(clip, roles)
    if own == up:
        return None
    return (
        f"its hips lie above its feet along {own} and not, as in the others, along {up}: the file has "
        "another axis up, or the body lies and shows no facing; give it a folder of its own"
    )


def axes_apart(
    skeleton: Skeleton, poses: Mapping[str, Poses], names: Mapping[str, str | int] | None
) -> str | None:
    """That clips stand along different axes, and which; None where they stand along one.

    Args:
        skeleton: whose joints they are.
        poses: some poses of each clip, as in its file.
        names: joints by role, where the caller knows them.
    """
    found: dict[str, list[str]] = {}
    for name, clip in poses.items():
        try:
            roles = find_joints(skeleton, clip, names).roles
        except DatasetError:
            continue
        found.setdefault(up_axis(clip, roles), []).append(name)
    if len(found) < 2:
        return None
    first, *others = found
    told = [f"{first} is up in {quoted(found[first], _NAMED)}"]
    told += [f"{axis} in {quoted(found[axis], _NAMED)}" for axis in others]
    return (
        f"the clips do not have one axis up: {'; '.join(told)}. Give the files of each axis a folder of "
        "their own, or export all of them with one axis up"
    )
