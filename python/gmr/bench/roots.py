"""The experiment of the General Motion Representation: all positions from k random roots, and from BVH.

37 recordings of 2,768 frames, 14.2 minutes at 120 frames a second; per k ten random sets of k roots; the time
to compute the positions of all joints in all frames, one recording after the other into the same array, which
is as long as one recording. BVH computes the same joints by gmr's own kinematics: once from Euler rows as
read, once from ready quaternions.
Source: "General Motion Representation", experimental results and Figure 4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import cycle
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr.bench.harness import Contest
from gmr.bench.inputs import LARGE_FRAME_COUNT, data_folder
from gmr.demo import demo_folder
from gmr.world import quaternion_job

__all__ = ["EULER_ROWS", "QUATERNIONS", "SETS", "Recordings", "Work", "random_roots", "record", "roots"]

EULER_ROWS: Final = "gmr's BVH, Euler rows"
QUATERNIONS: Final = "gmr's BVH, quaternions"

RECORDINGS: Final = 37
FRAMES_EACH: Final = 2_768
SETS: Final = 10

_LEFT_OUT: Final = ("LThumb_end", "RThumb_end")
"""Of the 28 joints of a CMU skeleton without its dummies, those that the paper's 26 do not have."""

Array = NDArray[Any]
Work = Callable[[], Array]


def roots(frame_count: int) -> Iterator[Contest]:
    """All positions from 1, 13 and 26 roots, ten random sets each, against our own BVH kinematics."""
    recordings = record(frame_count)
    peers: dict[str, Work] = {
        EULER_ROWS: recordings.from_euler_rows(),
        QUATERNIONS: recordings.from_quaternions(),
    }
    count = recordings.joint_count
    targets = {1: {QUATERNIONS: 1.0}, count: {EULER_ROWS: 7.0}}
    for k in (1, (count + 1) // 2, count):
        sets = random_roots(count, k)
        calls = [recordings.from_roots(roots) for roots in (sets if k < count else sets[:1])]
        recordings.check(calls)
        turn = cycle(calls)
        yield Contest(
            work=f"C_{k} of {count} joints, {recordings.source}",
            unit="M frames/s",
            amount=recordings.frame_count / 1e6,
            ours=lambda turn=turn: next(turn)(),  # type: ignore[misc]
            peers=peers,
            targets=targets.get(k, {}),
        )


def random_roots(joint_count: int, k: int) -> list[list[int]]:
    """Ten sets of k joints, the same in every run."""
    random = np.random.default_rng([joint_count, k])
    return [sorted(random.choice(joint_count, k, replace=False).tolist()) for _ in range(SETS)]


@dataclass(frozen=True)
class Recordings:
    """The recordings of the experiment.

    Args:
        bvh: as files have them, all on one skeleton.
        lean: the same without dummies and thumbs: the joints of the experiment.
        source: where they are from.
    """

    bvh: Sequence[gmr.Motion]
    lean: Sequence[gmr.Motion]
    source: str

    @property
    def joint_count(self) -> int:
        """J, of the experiment."""
        return self.lean[0].skeleton.joint_count

    @property
    def frame_count(self) -> int:
        """F, of all recordings."""
        return sum(map(len, self.lean))

    @property
    def joints(self) -> NDArray[np.int32]:
        """(J,) The experiment's joints in the skeleton that files have."""
        return self.bvh[0].skeleton.indices(self.lean[0].skeleton.names)

    def from_euler_rows(self) -> Work:
        """The positions by BVH's kinematics, straight from the rows in float64 that reading gives."""
        out = self._room()
        joints = self.joints.tolist()
        return lambda: _last(motion.positions(joints=joints, out=out, threads=1) for motion in self.bvh)

    def from_quaternions(self) -> Work:
        """The positions by BVH's kinematics from quaternions in float32 that are there."""
        return self._solving(self.bvh, self.joints)

    def from_roots(self, roots: Sequence[int]) -> Work:
        """The positions from the configuration with these roots, in float32 that is there."""
        configured = (motion.with_roots(roots) for motion in self.lean)
        return self._solving(configured, np.arange(self.joint_count, dtype=np.int32))

    def check(self, calls: Sequence[Work]) -> None:
        """Raises unless every call gives the positions that the rows give, as far as float32 can tell."""
        wanted = self.from_euler_rows()().copy()
        for call in calls:
            np.testing.assert_allclose(call(), wanted, rtol=0, atol=1e-3)

    def _solving(self, motions: Iterator[gmr.Motion] | Sequence[gmr.Motion], joints: Array) -> Work:
        """Forward kinematics of poses in float32; only these are kept, so that many sets fit into memory."""
        out = self._room()
        jobs = [quaternion_job(motion, out.dtype, only_positions=True) for motion in motions]
        return lambda: _last(_positions(*job, joints, out) for job in jobs)

    def _room(self) -> NDArray[np.float32]:
        return np.empty((len(self.lean[0]), self.joint_count, 3), np.float32)


@cache
def record(frame_count: int = LARGE_FRAME_COUNT) -> Recordings:
    """37 recordings cut from CMU's rows, end to end: subjects 01 to 09 below GMR_DATA, else what ships.

    Args:
        frame_count: fewer than :data:`LARGE_FRAME_COUNT` for a smoke run.
    """
    folder = data_folder("cmu_bvh_01_09")
    takes = list(gmr.read_folder(folder or demo_folder()).values())
    each = FRAMES_EACH if frame_count >= LARGE_FRAME_COUNT else max(4, frame_count // RECORDINGS)
    rows = np.concatenate([take.rows for take in takes])
    rows = rows[np.arange(RECORDINGS * each) % len(rows)]
    first = takes[0]
    assert first.layout is not None, "a motion that was read has channels"
    bvh = [
        gmr.Motion.from_rows(first.skeleton, first.layout, part, first.frame_time)
        for part in np.split(rows, RECORDINGS)
    ]
    lean = [_without_thumbs(motion.drop_dummies()) for motion in bvh]
    source = "CMU 01 to 09" if folder else "shipped clips repeated"
    return Recordings(bvh, lean, source)


def _without_thumbs(motion: gmr.Motion) -> gmr.Motion:
    return motion.select([name for name in motion.skeleton.names if name not in _LEFT_OUT])


def _positions(
    topology: gmr._core.Topology,
    rotations: Array,
    translated: Array,
    translations: Array,
    offsets: Array,
    joints: Array,
    out: Array,
) -> Array:
    gmr._core.forward_kinematics(
        topology, rotations, translated, translations, offsets, joints, None, out, None, 1
    )
    return out


def _last(results: Iterator[Array]) -> Array:
    """Draws all results, of which the last is told."""
    for result in results:
        found = result
    return found
