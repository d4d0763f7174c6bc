"""A hand or foot that passes through a point: its path is bent around one frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.editing.easing import blend_weights
from gmr.editing.edited import Edited, Stretch
from gmr.editing.limbs import Limb, feet_of, limb_that_moves
from gmr.editing.rejoin import cut_at, moved_roots, rejoin
from gmr.editing.roles import known_roles
from gmr.errors import GmrError
from gmr.motion import Motion

__all__ = ["ReachReport", "reach"]

Joint = str | int | np.integer[Any]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ReachReport:
    """What reaching for a point changed.

    Args:
        frame: in which the joint is at the point.
        moved: file units from where the joint was in that frame to the point.
        missed: file units between the joint and the point in that frame, for want of a longer limb.
        stretch: the same for the joint's bent path, in all frames.
    """

    frame: int
    moved: float
    missed: float
    stretch: Stretch

    @property
    def missed_mm(self) -> float:
        """Millimetres."""
        return self.missed * 1000 / self.stretch.unit.per_metre("a report in millimetres")

    def __str__(self) -> str:
        unit = self.stretch.unit
        return (
            f"moved by {unit.said(self.moved)} in frame {self.frame}, {unit.said(self.missed)} short of the "
            f"point; {self.stretch}{unit.note}"
        )


def reach(
    motion: Motion,
    joint: Joint,
    target: ArrayLike,
    frame: int,
    window: float = 0.5,
    *,
    hold: float = 0.0,
    hold_rotation: bool | None = None,
    limb: Limb | None = None,
) -> Edited[ReachReport]:
    """The motion with a joint's path bent so that it passes through a point.

    The joint is moved by the whole way to the point in one frame and less and less before and after, without
    a jump of speed or acceleration; the two bones above bend.

    Args:
        motion: any.
        joint: name or index; one below a hand or foot (a finger, a toe) moves that.
        target: (3,) world, file units.
        frame: in which the joint is to be there; a negative one counts from the end.
        window: seconds before and after over which the path is bent.
        hold: seconds before and after in which the whole move is kept.
        hold_rotation: what hangs on the limb's end keeps its rotation in the world; else it turns along with
            the limb's lower bone. None: feet keep it, all others turn along.
        limb: that moves the joint, where :func:`gmr.editing.limb_of` does not find it.

    Returns:
        The motion, equal to the bit outside the window. A point out of reach is no error: the limb is
        stretched out towards it, and the report says how far it stays short.

    Raises:
        SkeletonError: the joint does not exist, or no two bones are above it.
        GmrError: the frame does not exist, or the target is no point.
    """
    at = _frame(motion, frame)
    point = np.asarray(target, np.float64)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise GmrError(f"target={target!r}: give the three coordinates of a point, in the motion's unit")
    if not (np.isfinite(window) and window >= 0 and np.isfinite(hold) and hold >= 0):
        raise GmrError(f"window={window}, hold={hold}: give seconds, 0 or more")
    index = motion.skeleton.index(joint)
    roles = known_roles(motion)
    chosen = limb or limb_that_moves(motion.skeleton, index, roles)
    if hold_rotation is None:
        hold_rotation = chosen.end in feet_of(motion.skeleton, roles)
    if limb is None and not hold_rotation:
        chosen = replace(chosen, end=index)
    path, end = np.moveaxis(motion.positions(dtype=np.float64, joints=[index, chosen.end]), 1, 0)
    held, blend = (round(seconds * motion.fps) if motion.frame_time else 0 for seconds in (hold, window))
    weights = blend_weights(motion.frame_count, at - held, at + held + 1, blend)
    way = point - path[at]
    places = end + weights[:, None] * way
    edited = rejoin(
        moved_roots(cut_at(motion, [chosen.end]), {chosen.end: places}),
        motion,
        limbs=[chosen],
        hold_rotation=hold_rotation,
    )
    (stretch,) = edited.report.stretch
    there = edited.motion[at : at + 1].positions(dtype=np.float64, joints=[index])[0, 0]
    missed, moved = (float(np.linalg.norm(vector)) for vector in (point - there, way))
    return Edited(edited.motion, ReachReport(at, moved, missed, stretch))


def _frame(motion: Motion, frame: int) -> int:
    """The frame counted from the beginning."""
    count = motion.frame_count
    if not count:
        raise GmrError(f"{motion.name or 'this motion'} has no frames, so nothing can be reached in it")
    if not -count <= frame < count:
        raise GmrError(f"there is no frame {frame}; the motion has frames 0 to {count - 1}")
    return frame % count
