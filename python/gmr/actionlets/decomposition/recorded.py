"""The curves of the degrees of freedom that a recording has, and the recording with other curves.

Two kinds: the angle channels of the file (BVH channels, degrees of freedom of an AMC), and the degrees of
freedom of a body, read from any motion that shows one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gmr.actionlets.body import Body
from gmr.actionlets.posing import motion as posed
from gmr.actionlets.reading import read
from gmr.actionlets.score import Score
from gmr.dof_rows import DofRows
from gmr.errors import ActionletError
from gmr.frames import Rows
from gmr.listing import listed
from gmr.motion import Motion
from gmr.resample import nominal_fps
from gmr.tpose import without_leading_tpose

__all__ = ["Recorded", "recorded"]

Floats = NDArray[np.float64]

_SHOWN = 8
"""Joints that an error names; the others it counts."""


@dataclass(frozen=True, eq=False)
class Recorded:
    """Curves of a recording.

    Attributes:
        dofs: (D,) names: ``"LeftUpLeg.Zrotation"``, ``"lfemur.rx"`` or ``"left_hip.flexion"``.
        angles: (F, D) radians, unwrapped.
        fps: frames a second.
        remade: a motion from (G, D) radians and the (G,) frames of the recording, whole or between two, at
            which all that is not among ``dofs`` is taken.
        name: of the recording.
    """

    dofs: tuple[str, ...]
    angles: Floats
    fps: float
    remade: Callable[[Floats, Floats], Motion]
    name: str | None = None

    @property
    def times(self) -> Floats:
        """(F,) seconds, from 0."""
        return np.arange(len(self.angles)) / self.fps

    def played(self, score: Score) -> Motion:
        """The recording as a score has it, at the recording's rate.

        Degrees of freedom of which the score has no track, and where the body is, are those of the recording,
        hastened or slowed with the score.
        """
        times = score.times(self.fps)
        frames = times / score.duration * (len(self.angles) - 1)
        found = np.empty((len(times), len(self.dofs)))
        for column, dof in enumerate(self.dofs):
            track = score.tracks.get(dof)
            found[:, column] = (
                _between(self.angles[:, column], frames) if track is None else track.angle(times)
            )
        return self.remade(found, frames)


def recorded(motion: Motion, body: Body | None = None, joints: Iterable[str] | None = None) -> Recorded:
    """The curves of a motion; a T-pose that a converter put before the first frame is left out.

    Args:
        motion: two frames or more.
        body: whose degrees of freedom are read; None: the angle channels of the file.
        joints: those whose curves are wanted, in any order; None: all.

    Raises:
        ActionletError: fewer than two frames, a joint without curves, or rotations without channels.
        GmrError: the motion shows no body.
    """
    name = motion.name or "the motion"
    shown = without_leading_tpose(motion)
    if shown.frame_count < 2 or shown.frame_time <= 0:
        raise ActionletError(
            f"{name} has {shown.frame_count} frames at a frame time of {shown.frame_time:g} s; decomposing"
            " needs two frames or more and a rate"
        )
    found = _of_file(shown, name) if body is None else _of_body(shown, body)
    return found if joints is None else _only(found, list(joints), name)


def _of_file(motion: Motion, name: str) -> Recorded:
    source = motion.source
    match source:
        case Rows():
            layout = source.layout
            columns = np.flatnonzero(layout.column_turns)
            pairs = [layout.channel(int(column)) for column in columns]
            dofs = tuple(f"{motion.skeleton.names[joint]}.{channel}" for joint, channel in pairs)
            radians = False
        case DofRows():
            acclaim = source.acclaim
            columns = np.flatnonzero(acclaim.turns)
            named = [
                f"{joint}.{channel}"
                for joint, channels in zip(motion.skeleton.names, acclaim.channels, strict=True)
                for channel in channels
            ]
            dofs, radians = tuple(named[column] for column in columns), source.radians
        case _:
            raise ActionletError(
                f"{name} holds rotations and no angle channels; decompose the degrees of freedom of a body"
                " (body=gmr.actionlets.Body.of()), or motion.to_post_rotation() written as BVH"
            )
    values = source.values[:, columns]
    angles = np.unwrap(values if radians else np.radians(values), axis=0)

    def remade(changed: Floats, frames: Floats) -> Motion:
        rows = _between(source.values, frames)
        rows[:, columns] = changed if radians else np.degrees(changed)
        return replace(motion, source=replace(source, values=rows), dropped=None)

    return Recorded(dofs, angles, nominal_fps(motion), remade, motion.name)


def _of_body(motion: Motion, body: Body) -> Recorded:
    seen = read(body, motion)
    columns = np.array([n for n, dof in enumerate(body.dofs) if not dof.is_length])

    def remade(changed: Floats, frames: Floats) -> Motion:
        angles = _between(seen.angles, frames)
        angles[:, columns] = changed
        root, heading = _between(seen.root, frames), _between(seen.heading, frames)
        return posed(body, angles, root, heading, seen.fps, name=motion.name)

    dofs = tuple(body.dofs[column].name for column in columns)
    return Recorded(dofs, np.unwrap(seen.angles[:, columns], axis=0), seen.fps, remade, motion.name)


def _only(found: Recorded, joints: list[str], name: str) -> Recorded:
    of_joint = [dof.rpartition(".")[0] for dof in found.dofs]
    for joint in joints:
        if joint not in of_joint:
            there = listed(list(dict.fromkeys(of_joint)), _SHOWN)
            raise ActionletError(f"{name} has no angles of a joint '{joint}'; it has those of {there}")
    columns = np.array([n for n, joint in enumerate(of_joint) if joint in joints], np.intp)
    if not len(columns):
        raise ActionletError("no joints are named; name one or more, or leave them out for all")

    def remade(changed: Floats, frames: Floats) -> Motion:
        angles = _between(found.angles, frames)
        angles[:, columns] = changed
        return found.remade(angles, frames)

    dofs = tuple(found.dofs[column] for column in columns)
    return Recorded(dofs, found.angles[:, columns], found.fps, remade, found.name)


def _between(values: Floats, frames: Floats) -> Floats:
    """Values at frames, whole or between two: along the first axis, linearly."""
    last = len(values) - 1
    lower = np.clip(np.floor(frames + 1e-9).astype(int), 0, last)
    rest = np.clip(frames - lower, 0, 1).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(values[lower] + rest * (values[np.minimum(lower + 1, last)] - values[lower]))
