"""Angles of a body become rotations and a motion.

The frame of a joint is turned by ``R = R_1 R_2 R_3``, its degrees of freedom in their order
(:mod:`gmr.actionlets.dofs`). The pelvis is turned by ``R_y(heading) R_tilt R_obliquity R_rotation`` and
stands at ``root + R_y(heading) (sway, heave, surge)``.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.actionlets.dofs import Dof
from gmr.arrays import read_only
from gmr.errors import ActionletError
from gmr.motion import Motion
from gmr.quaternions import about, multiply, rotated

if TYPE_CHECKING:
    from gmr.actionlets.body import Body

__all__ = ["angles", "centre_of_mass", "motion", "rotations", "turning"]

Floats = NDArray[np.float64]

_UP = np.array([0.0, 1.0, 0.0])


def rotations(body: Body, angles: ArrayLike) -> Floats:
    """Rotations of the joints, each in the frame of the joint above.

    Args:
        body: D degrees of freedom, S = 15 joints that turn.
        angles: (F, D) radians; columns as ``body.dofs``. Those of the root are included, but not its
            translation.

    Returns:
        (F, S, 4) xyzw, one for each slot of ``body.skeleton``: the joints proper in file order.

    Raises:
        ActionletError: the angles have another shape.
    """
    values = _checked(body, angles)
    columns, axes, signs = turning(body.dofs, tuple(_proper(body)))
    found = np.empty((len(values), len(columns), 4))
    _core.euler_to_quaternions(np.degrees(values) * signs, columns, axes, found)
    return found


def motion(
    body: Body,
    angles: ArrayLike,
    root: ArrayLike | None = None,
    heading: ArrayLike | None = None,
    fps: float = 120.0,
    *,
    name: str | None = None,
) -> Motion:
    """The body in motion.

    Args:
        body: D degrees of freedom.
        angles: (F, D) radians and metres.
        root: (F, 3) or (3,) metres: where the pelvis is when sway, heave and surge are 0; the standing
            posture on the ground at the origin where left out.
        heading: (F,) or one, radians: which way the body faces, 0 along +Z, positive to the left.
        fps: frames a second.
        name: of the motion.

    Returns:
        F frames in metres, in post-rotation form, which BVH, GMR and glTF write.

    Raises:
        ActionletError: a shape does not fit, or there is no such frame rate.
    """
    values = _checked(body, angles)
    if not (math.isfinite(fps) and fps > 0):
        raise ActionletError(f"fps={fps}: give more than 0")
    count = len(values)
    facing = _frames(0.0 if heading is None else heading, (count,), "heading")
    path = _frames([0.0, body.hip_height, 0.0] if root is None else root, (count, 3), "root")
    turns = rotations(body, values)
    upright = about(_UP, facing)
    turns[:, 0] = multiply(upright, turns[:, 0])
    if "root.sway" in body.columns:
        moves = body.subset(f"root.{part}" for part in ("sway", "heave", "surge"))
        path = path + rotated(upright, values[:, moves])
    return Motion.from_pose(
        body.skeleton,
        read_only(turns),
        read_only(np.ascontiguousarray(path[:, None])),
        1.0 / fps,
        layout=body.layout,
        unit=1.0,
        name=name,
    )


def angles(
    body: Body,
    moving: Motion,
    root: ArrayLike | None = None,
    heading: ArrayLike | None = None,
    *,
    rest_frame: int | None = None,
) -> Floats:
    """The way back: (F, D) angles of a body in any motion that shows one; see
    :func:`gmr.actionlets.reading.read`, which tells root and heading too.

    Within the ranges of motion ``angles(body, motion(body, a, root, heading), root, heading)`` is ``a``.
    """
    from gmr.actionlets.reading import read

    return read(body, moving, root, heading, rest_frame=rest_frame).angles


def centre_of_mass(body: Body, moving: Motion) -> Floats:
    """(F, 3) centre of mass of a body in motion, metres.

    Args:
        body: whose segments have masses.
        moving: made by :func:`motion` of this body.

    Raises:
        ActionletError: the motion is of another skeleton.
    """
    if moving.skeleton.names != body.skeleton.names:
        raise ActionletError("this motion is not of that body's skeleton; make it with posing.motion")
    joints = [body.skeleton.names.index(segment.joint) for segment in body.segments]
    places = moving.positions(dtype=np.float64, joints=joints)
    frames = np.asarray(moving.joint_rotations(dtype=np.float64), np.float64)[:, joints]
    centres = np.array([segment.centre for segment in body.segments])
    masses = np.array([segment.mass for segment in body.segments])
    return np.asarray(masses @ (places + rotated(frames, centres)), np.float64)


@cache
def turning(
    dofs: tuple[Dof, ...], joints: tuple[str, ...]
) -> tuple[NDArray[np.int32], NDArray[np.uint8], Floats]:
    """Which column turns what: (S, 3) columns (-1: none), (S, 3) axes, (D,) signs."""
    columns = np.full((len(joints), 3), -1, np.int32)
    axes = np.tile(np.array([0, 2, 1], np.uint8), (len(joints), 1))
    signs = np.ones(len(dofs))
    counts = dict.fromkeys(joints, 0)
    for column, dof in enumerate(dofs):
        if dof.is_length:
            continue
        slot, step = joints.index(dof.joint), counts[dof.joint]
        columns[slot, step] = column
        axes[slot, step] = int(np.abs(dof.axis).argmax())
        signs[column] = float(np.sum(dof.axis))
        counts[dof.joint] += 1
    return read_only(columns), read_only(axes), read_only(signs)


def _proper(body: Body) -> list[str]:
    """Names of the joints that turn, in file order, which is that of their slots."""
    skeleton = body.skeleton
    return [name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True) if not end]


def _checked(body: Body, angles: ArrayLike) -> Floats:
    values = np.asarray(angles, np.float64)
    if values.ndim != 2 or values.shape[1] != body.dof_count:
        raise ActionletError(
            f"angles have the shape {values.shape}; the {body.name} body needs (frames, {body.dof_count}), a "
            "column for each of body.dofs"
        )
    return values


def _frames(values: ArrayLike, shape: tuple[int, ...], what: str) -> Floats:
    """``values`` for each frame."""
    found = np.asarray(values, np.float64)
    try:
        return np.broadcast_to(found, shape)
    except ValueError:
        raise ActionletError(f"{what} has the shape {found.shape}; these angles need {shape}") from None
