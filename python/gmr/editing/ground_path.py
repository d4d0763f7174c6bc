"""The path of a body along the ground: where it is and faces in each frame, and paths bent from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.arrays import frozen
from gmr.body.joints import Joints, find_joints
from gmr.body.measures import turned_upright
from gmr.editing.scene import scene_of
from gmr.errors import GmrError
from gmr.forest import home
from gmr.motion import Motion
from gmr.tpose import leading_rest_frames

__all__ = ["GroundPath", "ground_path"]

Floats = NDArray[np.float64]

_POSITION_WINDOW = 0.5
_HEADING_WINDOW = 1.0
"""Seconds to which the smoothed hips and facing are fitted, as :mod:`gmr.matching.root` does."""

_SAMPLES = 200


@dataclass(frozen=True, eq=False)
class GroundPath:
    """Places and headings of F frames.

    Args:
        ground: (F, 2) x and z, file units, of a world whose up axis is +Y.
        heading: (F,) radians, continuous; forward is (sin, cos) in (x, z), positive turns to the left.

    Raises:
        GmrError: the shapes do not fit, or a number is not finite.
    """

    ground: Floats
    heading: Floats

    def __post_init__(self) -> None:
        ground, heading = frozen(self.ground, np.float64), frozen(self.heading, np.float64)
        if ground.ndim != 2 or ground.shape[1] != 2 or heading.shape != (len(ground),):
            raise GmrError(
                f"a path needs (F, 2) places and (F,) headings; these are {ground.shape} and {heading.shape}"
            )
        if not (np.isfinite(ground).all() and np.isfinite(heading).all()):
            raise GmrError("a path must be of finite numbers")
        object.__setattr__(self, "ground", ground)
        object.__setattr__(self, "heading", heading)

    def __len__(self) -> int:
        return len(self.ground)

    def bent(self, turn_deg: float = 0.0, scale: float = 1.0) -> GroundPath:
        """The path from the same start, longer by ``scale`` and turning by ``turn_deg`` more until its end.

        The turn is added in proportion to the way gone: a straight path becomes an arc of a circle.

        Args:
            turn_deg: degrees, positive to the left.
            scale: of every step, above 0.
        """
        if not (np.isfinite(scale) and scale > 0 and np.isfinite(turn_deg)):
            raise GmrError(f"scale={scale}, turn_deg={turn_deg}: give a scale above 0 and finite degrees")
        if len(self) < 2:
            return self
        steps = np.diff(self.ground, axis=0)
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
        share = way / way[-1] if way[-1] > 0 else np.linspace(0, 1, len(self))
        turned = np.radians(turn_deg) * share
        steps = scale * _turned(steps, (turned[1:] + turned[:-1]) / 2)
        ground = self.ground[0] + np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
        return GroundPath(ground, self.heading + turned)

    def through(self, points: Mapping[int, ArrayLike]) -> GroundPath:
        """The path moved so that it passes through points, smoothly between them, and turned along with it.

        What is added to the places is a cubic between the frames of the points (Catmull-Rom, level at the
        first and the last, constant outside of them); the heading turns as much as the direction of the path
        does.

        Args:
            points: for each frame x and z, file units; frame 0 keeps its place unless it is given.
        """
        knots = {
            0: self.ground[0],
            **{frame: np.asarray(point, np.float64) for frame, point in points.items()},
        }
        for frame, point in knots.items():
            if not 0 <= frame < len(self):
                raise GmrError(f"there is no frame {frame}; the path has frames 0 to {len(self) - 1}")
            if point.shape != (2,) or not np.isfinite(point).all():
                raise GmrError(f"the point of frame {frame} must be x and z, not {point.tolist()}")
        frames = np.array(sorted(knots))
        moves = np.stack([knots[frame] for frame in frames.tolist()]) - self.ground[frames]
        ground = self.ground + _cubic(frames, moves, np.arange(len(self)))
        return replace(self, ground=ground, heading=self.heading + _turn_between(self.ground, ground))


def ground_path(motion: Motion, names: Mapping[str, str | int] | None = None) -> GroundPath:
    """The path of a motion: its hips on the ground and its facing, both smoothed.

    A T-pose that a converter put before the recording has the place and heading of the first frame after it.

    Args:
        motion: any.
        names: joints by role, where they are not found by their names: ``{"hips": "pelvis", ...}``.

    Raises:
        DatasetError: the joints of a body are not found.
        GmrError: the body has no facing in any frame, a pose is not known (NaN), or there is no frame.
    """
    lead = leading_rest_frames(motion)
    recorded = home(motion[lead:])
    if not recorded.frame_count:
        raise GmrError(f"{motion.name or 'this motion'} has no frames, so it has no path")
    places = recorded.positions(dtype=np.float64)
    unknown = np.flatnonzero(~np.isfinite(places).all(axis=(1, 2)))
    if len(unknown):
        raise GmrError(
            f"{motion.name or 'this motion'} has no path: {len(unknown)} of its poses are not known (NaN), "
            f"the first in frame {lead + int(unknown[0])}; cut them out, or fill them"
        )
    joints = find_joints(recorded.skeleton, places[:: max(1, len(places) // _SAMPLES)], names)
    ground, heading = _smoothed(recorded, places, joints, scene_of(motion).up)
    return GroundPath(
        np.pad(ground, ((lead, 0), (0, 0)), mode="edge"), np.pad(heading, (lead, 0), mode="edge")
    )


def _smoothed(motion: Motion, places: Floats, joints: Joints, up: str) -> tuple[Floats, Floats]:
    upright = np.ascontiguousarray(turned_upright(places, up), np.float32)
    rate = motion.fps if motion.frame_time else 1.0
    windows = [round(seconds * rate) | 1 for seconds in (_POSITION_WINDOW, _HEADING_WINDOW)]
    try:
        ground, heading = _core.simulation_root(upright, joints["hips"], joints.across, *windows)
    except ValueError as error:
        raise GmrError(f"{motion.name or 'this motion'} has no path: {error}") from None
    return ground, heading


def _turned(vectors: Floats, angles: Floats) -> Floats:
    """(n, 2) vectors (x, z) turned to the left."""
    sine, cosine = np.sin(angles), np.cos(angles)
    x, z = vectors[:, 0], vectors[:, 1]
    return np.stack([cosine * x + sine * z, cosine * z - sine * x], axis=1)


def _cubic(frames: NDArray[np.int_], values: Floats, at: NDArray[np.int_]) -> Floats:
    """(F, 2) cubics through values at ascending frames, with the slopes of Catmull and Rom."""
    if len(frames) == 1:
        return np.broadcast_to(values[0], (len(at), 2)).copy()
    slopes = np.zeros_like(values)
    slopes[1:-1] = (values[2:] - values[:-2]) / (frames[2:] - frames[:-2])[:, None]
    clamped = np.clip(at, frames[0], frames[-1])
    piece = np.clip(np.searchsorted(frames, clamped, side="right") - 1, 0, len(frames) - 2)
    length = (frames[piece + 1] - frames[piece])[:, None].astype(np.float64)
    t = (clamped - frames[piece])[:, None] / length
    found: Floats = (
        (1 + 2 * t) * (1 - t) ** 2 * values[piece]
        + t * (1 - t) ** 2 * length * slopes[piece]
        + t * t * (3 - 2 * t) * values[piece + 1]
        - t * t * (1 - t) * length * slopes[piece + 1]
    )
    return found


def _turn_between(old: Floats, new: Floats) -> Floats:
    """(F,) by how much the direction of a new path is turned from that of the old one.

    Where the body hardly moves there is no direction; the turn there is that of the frames around.
    """
    if len(old) < 2:
        return np.zeros(len(old))
    before, after = np.gradient(old, axis=0), np.gradient(new, axis=0)
    cross = before[:, 1] * after[:, 0] - before[:, 0] * after[:, 1]
    dot = (before * after).sum(axis=1)
    speeds = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    moves = speeds > 0.01 * speeds.max()
    if not moves.any():
        return np.zeros(len(old))
    turns = np.unwrap(np.arctan2(cross[moves], dot[moves]))
    return np.asarray(np.interp(np.arange(len(old)), np.flatnonzero(moves), turns), np.float64)
