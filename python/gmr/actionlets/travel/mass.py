"""The centre of mass, in the frame of the heading."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gmr import _core
from gmr.actionlets.body import Body
from gmr.actionlets.posing import turning
from gmr.arrays import read_only

__all__ = ["mass_from_pelvis"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]

_NOTHING = read_only(np.empty((0, 3), np.int32))


def mass_from_pelvis(body: Body, angles: Floats) -> Floats:
    """(F, 3) the centre of mass from the pelvis, in the frame of the heading: the segments' centres by their
    masses.

    Args:
        body: D degrees of freedom; its segments have masses that sum to 1.
        angles: (F, D) radians.
    """
    hung = _hung(body)
    places = np.empty((len(angles), len(hung.masses), 3))
    _core.forward_kinematics_euler(
        hung.topology, np.degrees(angles) * hung.signs, hung.columns, hung.axes, _NOTHING[:, 0], _NOTHING,
        False, hung.offsets, hung.centres, _NOTHING[:, 0], places,
    )  # fmt: skip
    found: Floats = np.einsum("k,fki->fi", hung.masses, places)
    return found


class _Hung(NamedTuple):
    """A body whose segments' centres hang on its joints as further joints.

    Args:
        topology: J joints, K of them centres.
        columns, axes, signs: of the angles, see :func:`gmr.actionlets.posing.turning`.
        offsets: (J, 3) metres.
        centres: (K,) which of the joints they are.
        masses: (K,) shares of the body's.
    """

    topology: _core.Topology
    columns: Indices
    axes: NDArray[np.uint8]
    signs: Floats
    offsets: Floats
    centres: Indices
    masses: Floats


@lru_cache(maxsize=32)
def _hung(body: Body) -> _Hung:
    skeleton, segments = body.skeleton, body.segments
    proper = [name for name, end in zip(skeleton.names, skeleton.ends.tolist(), strict=True) if not end]
    joints = np.array([skeleton.names.index(segment.joint) for segment in segments], np.int32)
    slots = np.array([proper.index(segment.joint) for segment in segments], np.int32)
    offsets = np.concatenate([skeleton.offsets, [segment.centre for segment in segments]])
    offsets[skeleton.roots] = 0
    return _Hung(
        _core.Topology(
            np.concatenate([skeleton.parents, joints]),
            np.concatenate([skeleton.slots, slots]),
            skeleton.slot_count,
        ),
        *turning(body.dofs, tuple(proper)),
        read_only(offsets),
        np.arange(skeleton.joint_count, len(offsets), dtype=np.int32),
        np.array([segment.mass for segment in segments]),
    )
