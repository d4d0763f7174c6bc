"""The motion of fitted parts: a joint for each part, turned by it, a bone to each part that hangs on it.

With ``M_c`` the frame-to-world transform of part c, ``L_c = M_parent(c)^-1 M_c``. The rotation of ``L_c``
turns c's joint; its translation is the joint's place in the part above: constant, where both parts see the
joint at one place on the average, or as measured in each frame. At rest the body stands in the anatomical
position: upright along +Y, facing +Z, arms hanging, palms forward.
Source: the General Motion Representation, its way in from marker data.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import read_only
from gmr.markers.bridging import Stretch, bridge_rotations, bridge_vectors, stretches
from gmr.markers.segments import Segment
from gmr.motion import Motion
from gmr.quaternions import from_matrices
from gmr.skeleton import End, Skeleton

__all__ = ["assemble"]

Array = NDArray[np.float64]

_ROUNDING = 1e-12
"""Metres of an offset that are rounding: a bone along an axis is written as such."""


def assemble(
    segments: Mapping[str, Segment],
    frame_time: float,
    unit: float,
    *,
    longest: float,
    bones: Literal["constant", "measured"],
    name: str | None,
) -> tuple[Motion, dict[str, tuple[Stretch, ...]]]:
    """The motion, in ``unit``, and the stretches in which each part was not seen.

    Args:
        segments: part -> oriented segment, parents first.
        frame_time: seconds.
        unit: metres per unit of the motion.
        longest: frames that are bridged.
        bones: whether bones keep one length, or change as the parts slide.
        name: of the motion.
    """
    order = list(segments)
    skeleton, joints = _skeleton(segments, unit)
    rotations, places, unknown = [], [], {}
    for part in order:
        segment = segments[part]
        turn, place, known = _local(segment, segments)
        unknown[part] = stretches(known, longest)
        rotations.append(bridge_rotations(from_matrices(turn), unknown[part]))
        places.append(bridge_vectors(place, unknown[part]))
    moving = [k for k, part in enumerate(order) if bones == "measured" or segments[part].parent is None]
    return (
        Motion.from_pose(
            skeleton,
            read_only(np.stack(rotations, axis=1)),
            read_only(np.stack([places[k] for k in moving], axis=1) / unit),
            frame_time,
            translated=[joints[k] for k in moving],
            unit=unit,
            name=name,
        ),
        unknown,
    )


def _local(segment: Segment, segments: Mapping[str, Segment]) -> tuple[Array, Array, NDArray[np.bool_]]:
    """(F, 3, 3) turn and (F, 3) place of a part in the part above, and the frames that tell them.

    Where the part above is not known but bridged, the part is bridged with it.
    """
    fit = segment.fit
    if segment.parent is None:
        return fit.rotations, fit.origins, fit.known
    above = segments[segment.parent].fit
    turn = np.swapaxes(above.rotations, 1, 2) @ fit.rotations
    return turn, above.seen_from(fit.origins), fit.known & above.known


def _skeleton(segments: Mapping[str, Segment], unit: float) -> tuple[Skeleton, list[int]]:
    """The skeleton in file units, and the joint of each segment."""
    names: list[str] = []
    parents: list[int] = []
    offsets: list[Array] = []
    ends: list[int] = []
    joints: dict[str, int] = {}
    for part, segment in segments.items():
        joints[part] = len(names)
        above = segments[segment.parent] if segment.parent else None
        names.append(segment.part.joint)
        parents.append(joints[segment.parent] if segment.parent else -1)
        offsets.append(above.points[segment.part.joint] if above else np.zeros(3))
        ends.append(End.JOINT)
        if not any(other.parent == part for other in segments.values()):
            names.append(f"{segment.part.joint}_end")
            parents.append(joints[part])
            offsets.append(_tip(segment))
            ends.append(End.SITE)
    held = np.array(offsets)
    held[np.abs(held) < _ROUNDING] = 0.0
    skeleton = Skeleton.post_rotation(names, parents, held / unit, ends=ends)
    return skeleton, list(joints.values())


def _tip(segment: Segment) -> Array:
    """(3,) where a part ends on which nothing hangs: its tip, else the middle of its markers."""
    places = [segment.points[name] for name in segment.part.tip if name in segment.points]
    places = places or [segment.points[name] for name in segment.labels if name in segment.points]
    tip: Array = np.mean(places, axis=0)
    return tip
