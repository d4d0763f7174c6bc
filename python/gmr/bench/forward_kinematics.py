"""Forward kinematics: world positions of every node of many frames, with and without rotations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import cmu_like_motion
from gmr.bench.peers import Peers, find_peers, label

__all__ = ["frame_cost", "positions", "positions_from_rows"]

Array = np.ndarray[Any, np.dtype[Any]]


def positions(frame_count: int) -> Iterator[Contest]:
    """World positions in float32 from ready quaternions; then with world rotations too."""
    motion = cmu_like_motion(frame_count)
    peers = find_peers("pymotion", "pybvh")
    ours = OurKinematics(motion)
    theirs: dict[str, Callable[[], object]] = {}
    if "pymotion" in peers:
        theirs[label("pymotion")] = _pymotion_call(motion, ours)
    if "pybvh" in peers:
        theirs[label("pybvh")] = _pybvh_call(peers, motion, ours)
    targets = {label("pymotion"): 35.0, label("pybvh"): 75.0}
    joint_count = len(motion.skeleton.names)
    for work, call in (
        (f"FK, f32 positions, {joint_count} nodes", ours.positions),
        (f"FK, f32 positions and rotations, {joint_count} nodes", ours.positions_and_rotations),
    ):
        yield Contest(work, "M frames/s", frame_count / 1e6, call, theirs, targets, peers.absent)


def positions_from_rows(frame_count: int) -> Iterator[Contest]:
    """World positions in float32 straight from the Euler rows of the file."""
    motion = cmu_like_motion(frame_count)
    peers = find_peers("pybvh")
    ours = OurKinematics(motion)
    theirs = {label("pybvh"): _pybvh_call(peers, motion, ours)} if "pybvh" in peers else {}
    yield Contest(
        "FK, f32 positions from Euler rows",
        "M frames/s",
        frame_count / 1e6,
        ours.positions_from_rows,
        theirs,
        absent=peers.absent,
    )


def frame_cost(frame_count: int) -> Iterator[Contest]:
    """Cost a frame for clips of very different lengths: it should not grow."""
    for count in (1_000, 10_000, 100_000, 1_000_000):
        if count > 28 * frame_count:
            return
        ours = OurKinematics(cmu_like_motion(min(count, frame_count)), frame_count=count)
        yield Contest(f"FK, f32 positions of {count:,} frames", "M frames/s", count / 1e6, ours.positions)


class OurKinematics:
    """gmr's forward kinematics into arrays that are allocated once.

    Args:
        motion: the motion to compute.
        frame_count: repeat its frames to this many; None for the motion's own.
    """

    def __init__(self, motion: gmr.Motion, *, frame_count: int | None = None) -> None:
        skeleton = motion.skeleton
        count = frame_count or motion.frame_count
        frames = np.arange(count) % motion.frame_count
        self._motion = motion
        self._topology = skeleton.topology
        self._offsets = skeleton.offsets.astype(np.float32)
        self._rotations = motion.rotations[frames].astype(np.float32)
        self._translations = motion.translations[frames].astype(np.float32)
        self._translated = motion.translated
        self._slots = self._topology.world_slots
        self.positions_out = np.empty((count, len(skeleton.names), 3), np.float32)
        self.rotations_out = np.empty((count, len(skeleton.names), 4), np.float32)

    def positions(self) -> Array:
        """World positions from quaternions."""
        self._run(None, None)
        return self.positions_out

    def positions_and_rotations(self) -> Array:
        """World positions and bone rotations from quaternions."""
        self._run(self._slots, self.rotations_out)
        return self.positions_out

    def positions_from_rows(self) -> Array:
        """World positions from Euler rows."""
        return self._motion.positions(out=self.positions_out, threads=1)

    def _run(self, slots: Array | None, rotations_out: Array | None) -> None:
        gmr._core.forward_kinematics(
            self._topology,
            self._rotations,
            self._translated,
            self._translations,
            self._offsets,
            None,
            slots,
            self.positions_out,
            rotations_out,
            1,
        )


def _pymotion_call(motion: gmr.Motion, ours: OurKinematics) -> Callable[[], object]:
    """PyMotion's ``fk_quat`` on the same nodes: End Sites are joints that do not turn."""
    from pymotion.ops.skeleton import fk_quat

    skeleton = motion.skeleton
    rotations = np.zeros((motion.frame_count, len(skeleton.names), 4), np.float32)
    rotations[..., 0] = 1.0
    own = joint_slots(skeleton)
    turning = own >= 0
    rotations[:, turning] = motion.rotations[:, own[turning]][..., [3, 0, 1, 2]]
    root = motion.translations[:, 0].astype(np.float32)
    offsets = skeleton.offsets.astype(np.float32)
    parents = np.maximum(skeleton.parents, 0)
    found = fk_quat(rotations, root, offsets, parents)[0]
    np.testing.assert_allclose(ours.positions(), found, atol=1e-3)
    return lambda: fk_quat(rotations, root, offsets, parents)


def _pybvh_call(peers: Peers, motion: gmr.Motion, ours: OurKinematics) -> Callable[[], object]:
    """pybvh's ``frames_to_node_positions`` from arrays, which begin as Euler angles."""
    pybvh = peers["pybvh"]
    skeleton = motion.skeleton
    own = joint_slots(skeleton)
    rows = motion.rows
    layout = motion.layout
    assert layout is not None, "a motion that was read has channels"
    columns, axes = layout.rotation_columns, layout.rotation_axes
    topology = pybvh.FkTopology(
        offsets=skeleton.offsets,
        parent_idx=skeleton.parents,
        joint_idx=own,
        euler_orders=["".join("XYZ"[axis] for axis in slot) for slot in axes],
    )
    root = np.ascontiguousarray(rows[:, :3])
    angles = np.deg2rad(rows[:, columns])
    found = pybvh.frames_to_node_positions(topology, root, angles)
    np.testing.assert_allclose(ours.positions(), found, atol=1e-3)
    return lambda: pybvh.frames_to_node_positions(topology, root, angles)


def joint_slots(skeleton: gmr.Skeleton) -> Array:
    """Slot that carries each joint's own rotation in a post-rotation skeleton, -1 for an end, ``(J,)``."""
    own = np.full(len(skeleton.names), -1, np.int32)
    children = skeleton.parents >= 0
    own[skeleton.parents[children]] = skeleton.slots[children]
    return own
