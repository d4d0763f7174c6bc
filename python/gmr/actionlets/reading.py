"""The way back: the angles of a body in any motion that shows one.

A motion on gmr's own skeleton gives back the angles that it was posed with. In any other the segments' turns
are found first (:mod:`gmr.actionlets.turned_segments`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.anatomy import Anatomy, anatomy
from gmr.actionlets.body import Body
from gmr.actionlets.euler_dofs import angles_of
from gmr.actionlets.likeness import leg_of
from gmr.actionlets.posing import motion as posed
from gmr.actionlets.turned_segments import turned_segments
from gmr.errors import ActionletError
from gmr.forest import home
from gmr.motion import Motion
from gmr.quaternions import about, conjugate, multiply, rotated

__all__ = ["Reading", "read"]

Floats = NDArray[np.float64]

_UP = np.array([0.0, 1.0, 0.0])
_SMOOTH = 0.4
"""Seconds, standard deviation of the Gaussian that takes the sway of a stride out of path and heading."""
_STANDING = 0.1
"""Quantile of the lower ankle's heights that counts as its height when it stands."""
_SOLE = 0.1
"""Metres by which the heights of ankles above the ground may differ."""


@dataclass(frozen=True, eq=False)
class Reading:
    """What a body does in a motion; :meth:`motion` poses it again.

    Args:
        body: whose angles these are.
        angles: (F, D) radians and metres, columns as ``body.dofs``.
        root: (F, 3) metres: where the pelvis is without sway, heave and surge.
        heading: (F,) radians.
        fps: frames a second.
        rest: which pose of the motion was taken for its rest, in words.
        name: of the motion.
    """

    body: Body
    angles: Floats
    root: Floats
    heading: Floats
    fps: float
    rest: str
    name: str | None = None

    def motion(self, body: Body | None = None) -> Motion:
        """The motion of the body that was read, or of another one."""
        return posed(body or self.body, self.angles, self.root, self.heading, self.fps, name=self.name)


def read(
    body: Body,
    motion: Motion,
    root: ArrayLike | None = None,
    heading: ArrayLike | None = None,
    *,
    rest_frame: int | None = None,
) -> Reading:
    """The angles of a body in a motion.

    Args:
        body: D degrees of freedom, of any size: the pelvis goes as far as its legs are longer.
        motion: F frames, after a T-pose that a converter put before the recording: that is left out.
        root: (F, 3) or (3,) metres: where the pelvis is without sway, heave and surge. Left out: below the
            smoothed path of the pelvis, at the height at which the body stands. The paper's body has no such
            degrees of freedom, so that its root is the pelvis itself.
        heading: (F,) or one, radians: where it faces without tilt, obliquity and rotation. Left out: where
            the smoothed pelvis faces.
        rest_frame: in which the motion stands upright, where it has no rest pose of its own.

    Raises:
        ActionletError: the motion shows no body, its unit is not known, or it has poses that are not known.
    """
    at_home = home(motion)
    if not np.isfinite(at_home.rotations).all() or not np.isfinite(at_home.translations).all():
        raise ActionletError(
            f"{motion.name or 'the motion'} has poses that are not known; fill them or cut them off first"
        )
    if _is_own(body, at_home):
        local = {name: at_home.rotations[:, slot] for slot, name in enumerate(_turning_joints(body))}
        places = at_home.translations[:, 0] * (at_home.unit or 1.0)
        hinges: dict[str, Floats] = {}
        said, shown = "its own", at_home
    else:
        found = anatomy(at_home)
        turned = turned_segments(body, found, rest_frame)
        local = _local(body, turned.world, turned.hinges)
        hinges, said, shown = dict(turned.hinges), turned.rest, found.motion
        hips = (found.place("left_hip") + found.place("right_hip")) / 2
        scale = body.leg_length / leg_of(found)
        places = hips * scale - np.array([0.0, _sunk(body, found, scale), 0.0])
    values = np.zeros((len(places), body.dof_count))
    for joint in _turning_joints(body):
        _write(values, body, joint, local[joint], hinges.get(joint), shown.frame_time)
    facing, path = _root(body, values, local["pelvis"], places, root, heading, shown.frame_time)
    fps = 1 / shown.frame_time if shown.frame_time > 0 else 1.0
    return Reading(body, values, path, facing, fps, said, motion.name)


def _sunk(body: Body, found: Anatomy, scale: float) -> float:
    """How far the body has to go down to stand as deep as the motion's: where the lower ankle is in the
    lowest frames, it is that much above the height at which the body's own is. Beyond a shoe's sole it is
    another floor, which stays."""
    ankles = np.minimum(found.place("left_ankle")[:, 1], found.place("right_ankle")[:, 1])
    above = scale * float(np.quantile(ankles, _STANDING)) - body.foot.ankle_height
    return above if abs(above) < _SOLE else 0.0


def _is_own(body: Body, motion: Motion) -> bool:
    """Whether a motion is on the skeleton of a body of some size."""
    one, other = body.skeleton, motion.skeleton
    return (
        one.names == other.names
        and np.array_equal(one.parents, other.parents)
        and np.array_equal(one.slots, other.slots)
    )


def _turning_joints(body: Body) -> list[str]:
    """Joints in the order of their slots."""
    skeleton = body.skeleton
    return [name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True) if not end]


def _local(body: Body, world: Mapping[str, Floats], hinges: Mapping[str, Floats]) -> dict[str, Floats]:
    """Each segment's turn in the frame of the one above, which hinges carry as far as they can."""
    skeleton = body.skeleton
    carried: dict[str, Floats] = {}
    found: dict[str, Floats] = {}
    for joint in skeleton.parents_first:
        if skeleton.ends[joint]:
            continue
        name, above = skeleton.names[joint], int(skeleton.parents[joint])
        if above < 0:
            carried[name] = found[name] = world[name]
            continue
        frame = carried[skeleton.names[above]]
        if name in hinges:
            axis = np.array(body.dof(f"{name}.flexion").axis)
            found[name] = about(axis, hinges[name])
            carried[name] = multiply(frame, found[name])
        else:
            carried[name] = world[name]
            found[name] = multiply(conjugate(frame), world[name])
    return found


def _write(
    values: Floats, body: Body, joint: str, turns: Floats, hinge: Floats | None, frame_time: float
) -> None:
    """Writes the angles of a joint into their columns; what the body has no degree of freedom for is lost."""
    dofs = [dof for dof in body.dofs if dof.joint == joint and not dof.is_length]
    if not dofs or joint == "pelvis":
        return
    columns = [body.columns[dof.name] for dof in dofs]
    if len(dofs) == 3:
        values[:, columns] = angles_of(turns, dofs, frame_time)
    else:
        (dof,) = dofs
        axis = np.array(dof.axis)
        values[:, columns[0]] = _about(turns, axis) if hinge is None else hinge


def _about(turns: Floats, axis: Floats) -> Floats:
    """(F,) angle of the turn about an axis that comes nearest to a turn, from -pi to pi."""
    half = np.arctan2(turns[:, :3] @ axis, turns[:, 3])
    return np.asarray(2 * half - 2 * np.pi * np.round(half / np.pi), np.float64)


def _root(
    body: Body,
    values: Floats,
    pelvis: Floats,
    places: Floats,
    root: ArrayLike | None,
    heading: ArrayLike | None,
    frame_time: float,
) -> tuple[Floats, Floats]:
    """Heading and root; writes the degrees of freedom of the root."""
    count = len(places)
    is_free = "root.sway" in body.columns
    ahead = rotated(pelvis, np.array([0.0, 0.0, 1.0]))
    across = rotated(pelvis, np.array([1.0, 0.0, 0.0]))
    # Where the pelvis faces: its left side tells it also when it lies on its back or its face.
    level = np.hypot(across[:, 0], across[:, 2]) > 0.5
    faced = np.where(level, np.arctan2(-across[:, 2], across[:, 0]), np.arctan2(ahead[:, 0], ahead[:, 2]))
    if heading is None:
        facing = np.unwrap(faced)
        facing = _smoothed(facing[:, None], frame_time)[:, 0] if is_free else facing
    else:
        facing = np.broadcast_to(np.asarray(heading, np.float64), (count,)).copy()
    if root is None:
        path = _smoothed(places, frame_time) if is_free else places.copy()
        if is_free:
            path[:, 1] = body.hip_height
    else:
        path = np.broadcast_to(np.asarray(root, np.float64), (count, 3)).copy()
    if is_free:
        back = about(_UP, -facing)
        moves = body.subset(f"root.{part}" for part in ("sway", "heave", "surge"))
        values[:, moves] = rotated(back, places - path)
        dofs = [dof for dof in body.dofs if dof.joint == "pelvis" and not dof.is_length]
        values[:, [body.columns[dof.name] for dof in dofs]] = angles_of(
            multiply(back, pelvis), dofs, frame_time
        )
    return facing, path


def _smoothed(values: Floats, frame_time: float) -> Floats:
    """(F, N) values under a Gaussian, continued beyond their ends by point reflection, which keeps slopes."""
    count = len(values)
    reach = min(round(3 * _SMOOTH / frame_time), count - 1) if frame_time > 0 else 0
    if reach < 1:
        return values.copy()
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) * frame_time / _SMOOTH) ** 2)
    kernel /= kernel.sum()
    before = 2 * values[:1] - values[reach:0:-1]
    after = 2 * values[-1:] - values[-2 : -reach - 2 : -1]
    padded = np.concatenate([before, values, after])
    return np.stack([np.convolve(column, kernel, "valid") for column in padded.T], axis=-1)
