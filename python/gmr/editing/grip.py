"""Hands on a bar: both hands are roots, put on one line, and the arms are joined to them again."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.arrays import frozen
from gmr.editing.easing import blend_weights
from gmr.editing.edited import Edited, Stretch
from gmr.editing.limbs import hands_of, limb_that_moves
from gmr.editing.rejoin import cut_at, moved_roots, rejoin
from gmr.editing.roles import known_roles
from gmr.errors import GmrError, SkeletonError
from gmr.motion import Motion
from gmr.tpose import leading_rest_frames

__all__ = ["Bar", "GripReport", "grip"]

Joint = str | int | np.integer[Any]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Bar:
    """A straight bar, fixed in the world or carried through it.

    Args:
        point: (3,) on the bar, file units; (F, 3) for a bar that moves.
        direction: (3,) or (F, 3) along the bar, from the first hand to the second, of any length above 0.

    Raises:
        GmrError: these are no vectors, or a direction is 0.
    """

    point: ArrayLike
    direction: ArrayLike

    def __post_init__(self) -> None:
        for name in ("point", "direction"):
            vectors = frozen(getattr(self, name), np.float64)
            if vectors.ndim not in (1, 2) or vectors.shape[-1] != 3 or not np.isfinite(vectors).all():
                raise GmrError(f"a bar's {name} must be (3,) or (F, 3) numbers; these are {vectors.shape}")
            object.__setattr__(self, name, vectors)
        if not np.all(np.any(self.direction, axis=-1)):
            raise GmrError("a bar's direction must not be 0; give a vector along it")

    def over(self, frames: int) -> tuple[Floats, Floats]:
        """(F, 3) points and (F, 3) unit directions.

        Raises:
            GmrError: it moves over another number of frames.
        """
        for vectors in (np.asarray(self.point), np.asarray(self.direction)):
            if vectors.ndim == 2 and len(vectors) != frames:
                raise GmrError(
                    f"the bar moves over {len(vectors)} frames, the motion over {frames}; give as many"
                )
        point = np.broadcast_to(np.asarray(self.point, np.float64), (frames, 3))
        direction = np.asarray(self.direction, np.float64)
        direction = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
        return point, np.broadcast_to(direction, (frames, 3))


@dataclass(frozen=True, eq=False)
class GripReport:
    """What gripping changed.

    Args:
        joints: the two that hold the bar.
        spacing: file units between them on the bar.
        moved: (F, 2) how far each was to be moved, file units; NaN where the pose is not known.
        stretch: for each arm, how far it was too short.
    """

    joints: tuple[str, str]
    spacing: float
    moved: Floats
    stretch: tuple[Stretch, ...]

    @property
    def spacing_mm(self) -> float:
        """Millimetres."""
        return self.spacing * self._mm

    @property
    def moved_mm(self) -> Floats:
        """(F, 2) millimetres."""
        return self.moved * self._mm

    @property
    def _mm(self) -> float:
        return 1000 / self.stretch[0].unit.per_metre("a report in millimetres")

    def __str__(self) -> str:
        unit = self.stretch[0].unit
        return (
            f"{' and '.join(self.joints)} {unit.said(self.spacing)} apart, moved by "
            f"{unit.said(float(np.nanmax(self.moved, initial=0)))} at most; "
            f"{'; '.join(str(one) for one in self.stretch)}{unit.note}"
        )


def grip(
    motion: Motion,
    joints: tuple[Joint, Joint] | None = None,
    bar: Bar | None = None,
    *,
    spacing: float | None = None,
    frames: tuple[int, int] | None = None,
    blend: float = 0.2,
    hold_rotation: bool = False,
) -> Edited[GripReport]:
    """The motion with both hands on a bar, always the same distance apart.

    Each arm is bent to reach the bar, and its hand turns along with the forearm.

    Args:
        motion: any.
        joints: the two hands, names or indices, in the order in which they are along the bar; by default the
            joints that are named as the left and the right hand.
        bar: on which the hands hold the place that is nearest to where they are (the median over the frames).
            None: a bar that goes along with the hands: their middle is its middle, and it points from the one
            to the other.
        spacing: file units from hand to hand along the bar; as the motion has it on average by default.
        frames: (first, one past last) in which the bar is held; by default all of the recording, without what
            a converter put before it.
        blend: seconds before and after, in which the hands are led to the bar and back.
        hold_rotation: the hands keep their rotation in the world instead.

    Returns:
        The motion, equal to the bit in the frames that neither gripping nor blending touch. A bar out of
        reach is no error; the report says how far each arm was too short.

    Raises:
        SkeletonError: a joint does not exist, or both are moved by one arm.
        GmrError: the frames are not of the motion, or the bar is none.
    """
    count = motion.frame_count
    first, end = _frames(motion, frames)
    hands_named = hands_of(motion.skeleton) if joints is None else tuple(joints)
    indices = motion.skeleton.indices(hands_named).tolist()
    roles = known_roles(motion)
    limbs = [limb_that_moves(motion.skeleton, joint, roles) for joint in indices]
    if not hold_rotation:
        limbs = [replace(limb, end=joint) for limb, joint in zip(limbs, indices, strict=True)]
    if len(indices) != 2 or limbs[0].middle == limbs[1].middle:
        raise SkeletonError(f"joints={hands_named}: name two joints, one of each arm")
    hands = motion.positions(dtype=np.float64, joints=indices)
    point, along = _carried_bar(hands, motion, first, end) if bar is None else bar.over(count)
    apart = ((hands[:, 1] - hands[:, 0]) * along).sum(axis=1)[first:end]
    width = float(apart.mean()) if spacing is None else float(spacing)
    middle = float(np.median(((hands.mean(axis=1) - point) * along).sum(axis=1)[first:end]))
    places = np.stack([point + (middle + side * width / 2) * along for side in (-1, 1)], axis=1)

    weights = blend_weights(count, first, end, round(blend * motion.fps) if motion.frame_time else 0)
    weights[: min(leading_rest_frames(motion), first)] = 0
    moves = weights[:, None, None] * (places - hands)
    ends = [limb.end for limb in limbs]
    wrists = motion.positions(dtype=np.float64, joints=ends) + moves
    loose = moved_roots(cut_at(motion, ends), dict(zip(ends, np.moveaxis(wrists, 1, 0), strict=True)))
    edited = rejoin(loose, motion, limbs=limbs, hold_rotation=hold_rotation)
    names = motion.skeleton.names[indices[0]], motion.skeleton.names[indices[1]]
    stretch = edited.report.stretch if ends == sorted(ends) else edited.report.stretch[::-1]
    report = GripReport(names, width, np.linalg.norm(moves, axis=2), stretch)
    return Edited(edited.motion, report)


def _carried_bar(hands: Floats, motion: Motion, first: int, end: int) -> tuple[Floats, Floats]:
    """(F, 3) middle of the hands, and (F, 3) unit vectors from the one to the other."""
    apart = hands[:, 1] - hands[:, 0]
    size = np.linalg.norm(apart, axis=1)
    together = np.flatnonzero(size[first:end] <= 1e-6 * np.abs(hands).max(initial=0))
    if len(together):
        raise GmrError(
            f"{motion.name or 'this motion'}: the hands are in one place in frame {first + together[0]}, so "
            "no bar points from the one to the other; give one: bar=Bar(point, direction)"
        )
    return hands.mean(axis=1), apart / np.where(size > 0, size, 1.0)[:, None]


def _frames(motion: Motion, frames: tuple[int, int] | None) -> tuple[int, int]:
    """The frames in which the bar is held."""
    count = motion.frame_count
    first, end = (leading_rest_frames(motion), count) if frames is None else frames
    if not 0 <= first < end <= count:
        raise GmrError(
            f"frames={(first, end)}: give the first and one past the last of the motion's {count} frames"
        )
    return first, end
