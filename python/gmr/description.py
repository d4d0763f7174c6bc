"""What is in a motion, and what is odd about it, as plain values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gmr.channels import POSITIONS, ROTATIONS
from gmr.dof_rows import DofRows
from gmr.guesses import UnitGuess, UpGuess, guess_body
from gmr.listing import listed
from gmr.resample import nominal_fps
from gmr.skeleton import End, Skeleton
from gmr.tpose import leading_rest_frames

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["Description", "describe"]

_SHOWN = 6
"""Names that a sentence lists; the others it counts."""


@dataclass(frozen=True)
class Description:
    """A motion in words and numbers; angles in degrees, lengths in file units, times in seconds."""

    frames: int
    frame_time: float
    fps: float
    seconds: float
    joints: tuple[str, ...]
    ends: int
    """End sites, which are joints too."""
    roots: tuple[str, ...]
    configuration: tuple[str, ...]
    """How the trees differ from those at home: a sentence for each soft link, and for each that is turned
    over."""
    dummies: tuple[str, ...]
    channels: int
    """Numbers in a row."""
    orders: dict[str, int]
    """How many joints have each set of channels, such as "Xposition Yposition Zposition Zrotation"."""
    moving: tuple[str, ...]
    """Joints other than roots with position channels."""
    unit: float | None
    unit_guess: UnitGuess | None
    height: float | None
    up_guess: UpGuess | None
    leading_rest_frames: int
    asf: str | None
    """The file that an AMC's skeleton is in."""
    oddities: tuple[str, ...]
    """One sentence for each thing that is unusual."""


def describe(motion: Motion, warnings: Sequence[str] = (), asf: str | None = None) -> Description:
    """What is in ``motion`` and what is odd about it.

    Args:
        motion: any.
        warnings: what reading it warned of; these come first among the oddities.
        asf: the file that its skeleton was read from, where that is another.
    """
    skeleton = motion.skeleton
    body = guess_body(motion)
    named = _channel_names(motion)
    rest = leading_rest_frames(motion)
    return Description(
        frames=motion.frame_count,
        frame_time=motion.frame_time,
        fps=nominal_fps(motion) if motion.frame_time else 0.0,
        seconds=motion.duration,
        joints=skeleton.names,
        ends=int((skeleton.ends == End.SITE).sum()),
        roots=motion.roots,
        configuration=tuple(_configuration(skeleton)),
        dummies=motion.dummies,
        channels=sum(len(channels) for channels in named),
        orders=dict(Counter(" ".join(channels) for channels in named if channels).most_common()),
        moving=tuple(skeleton.names[j] for j in motion.translated.tolist() if skeleton.parents[j] >= 0),
        unit=motion.unit,
        unit_guess=body.unit,
        height=body.height,
        up_guess=body.up,
        leading_rest_frames=rest,
        asf=asf,
        oddities=(*warnings, *_oddities(motion, rest, body.up)),
    )


_NAMES = {"t": "position", "r": "rotation"}


def _channel_names(motion: Motion) -> tuple[tuple[str, ...], ...]:
    """(J,) the numbers that each joint has in a row; degrees of freedom under the names of channels."""
    if isinstance(motion.source, DofRows):
        joints = motion.source.acclaim.channels
        return tuple(tuple(f"{name[1].upper()}{_NAMES[name[0]]}" for name in names) for names in joints)
    return motion.layout.names if motion.layout else ()


def _configuration(skeleton: Skeleton) -> list[str]:
    """What was done to each tree since home, in the order of the roots."""
    names, links, found = skeleton.names, skeleton.links, []
    for root in skeleton.roots:
        top = skeleton.forest.top_of(root)
        if links[top] >= 0:
            found.append(f"{names[top]} cut from {names[links[top]]}")
        if top != root:
            found.append(f"the tree of {names[top]} turned over onto {names[root]}")
    return found


def _oddities(motion: Motion, rest: int, up: UpGuess | None) -> list[str]:
    """A sentence for each unusual thing, in the order of the file."""
    skeleton = motion.skeleton
    names = Counter(name for name, end in zip(skeleton.names, skeleton.ends, strict=True) if end == End.JOINT)
    found = []
    if repeated := [name for name, count in names.items() if count > 1]:
        found.append(f"several joints share a name: {listed(repeated, _SHOWN)}")
    if tips := int((skeleton.ends == End.TIP).sum()):
        leaves = "1 turning leaf has" if tips == 1 else f"{tips} turning leaves have"
        found.append(f"{leaves} no End Site; a zero-length tip stands for it")
    if len(motion.roots) > 1:
        found.append(f"{len(motion.roots)} roots: {listed(motion.roots, _SHOWN)}")
    found += _channel_oddities(motion)
    if motion.frame_count == 0:
        found.append("no frames: a skeleton alone")
    elif motion.frame_count == 1:
        found.append("a single frame: a pose, not a recording")
    if isinstance(motion.source, DofRows) and motion.frame_count and not motion.source.rate_known:
        found.append(f"no frame rate, as in most AMC files; read as {motion.fps:.6g} frames a second")
    if motion.frame_time == 0 and motion.frame_count:
        found.append("frame time 0: the frames have no duration")
    if rest:
        frames = "frame 0 is a T-pose" if rest == 1 else f"frames 0 to {rest - 1} are rest poses"
        found.append(f"{frames} that a converter added and nobody recorded; evaluation leaves that out")
    if up is not None and up.sure and up.axis != "+Y":
        found.append(f"the body stands along {up.axis}, not +Y, which gmr takes as up")
    if broken := sum(int((~np.isfinite(values)).sum()) for values in motion.source.numbers):
        found.append(f"{broken} values are not finite")
    return found


def _channel_oddities(motion: Motion) -> list[str]:
    """What is unusual about the channels."""
    layout = motion.layout
    if layout is None:
        return []
    turns = [[name for name in channels if name.lower() in ROTATIONS] for channels in layout.names]
    orders = Counter("".join(name[0].upper() for name in joint) for joint in turns if len(joint) == 3)
    found = []
    if len(orders) > 1:
        counted = ", ".join(f"{order} ({count})" for order, count in orders.most_common())
        found.append(f"rotation orders differ between joints: {counted}")
    if few := sum(0 < len(joint) < 3 for joint in turns):
        joints = "1 joint has" if few == 1 else f"{few} joints have"
        found.append(f"{joints} fewer than three rotation channels")
    if any(_rotates_first(channels) for channels in layout.names):
        found.append("rotation channels come before position channels")
    return found


def _rotates_first(channels: Sequence[str]) -> bool:
    places = [name.lower() in POSITIONS for name in channels]
    return any(places) and not places[0]
