"""A motion: a clip on a skeleton, immutable.

What was read is kept as read (rows of channels, or of degrees of freedom); the pose that operations work on
(a quaternion for each rotation slot, translations of the roots and of the joints that move) is made once,
when needed.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from gmr.channels import ChannelLayout
from gmr.clip import Clip, check_frame_time
from gmr.dof_rows import DofRows
from gmr.errors import GmrError
from gmr.frames import Pose, Rows, check_fit
from gmr.listing import listed
from gmr.skeleton import ROOTS_SHOWN, Skeleton

if TYPE_CHECKING:
    from gmr.acclaim import Acclaim
    from gmr.dummies import Dropped

__all__ = ["Motion"]

Joint = str | int | np.integer[Any]
FloatArray = NDArray[Any]
"""float32 or float64, as asked."""


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Clip):
    """One continuous recording on a skeleton; immutable. Operations return a new one and share what they
    keep.

    Make one with :func:`gmr.read`, :meth:`from_rows` or :meth:`from_pose`. Two motions are equal when
    skeleton, timing, unit and the stored numbers are; the name does not count.
    """

    skeleton: Skeleton
    frame_time: float
    """Seconds from a frame to the next."""
    source: Rows | DofRows | Pose
    """The frames as they were given."""
    unit: float | None = None
    """Metres per file unit, None if unknown."""
    name: str | None = None
    """Name of the file it was read from."""
    dropped: Dropped | None = field(default=None)
    """What :meth:`drop_dummies` removed, so that it can come back. Whoever puts other frames on this skeleton
    gives None here, or what was removed from those."""

    def __post_init__(self) -> None:
        check_frame_time(self.frame_time)
        if self.unit is not None and not (math.isfinite(self.unit) and self.unit > 0):
            raise GmrError(f"a file unit cannot be {self.unit} metres; give more than 0, or None if unknown")
        check_fit(self.skeleton, self.source)

    @classmethod
    def from_rows(
        cls,
        skeleton: Skeleton,
        layout: ChannelLayout,
        rows: ArrayLike,
        frame_time: float,
        *,
        unit: float | None = None,
        name: str | None = None,
    ) -> Motion:
        """Motion from the rows of a post-rotation file.

        Args:
            skeleton: J joints, its slots numbered as :func:`gmr.skeleton.owned_slots` does.
            layout: C channels.
            rows: (F, C) degrees and file units; a float64 array that is read-only is shared, any other
                copied.
            frame_time: seconds.
            unit: metres per file unit.
            name: the file's name.
        """
        return cls(skeleton, float(frame_time), Rows(np.asarray(rows), layout), unit, name)

    @classmethod
    def from_pose(
        cls,
        skeleton: Skeleton,
        rotations: ArrayLike,
        translations: ArrayLike,
        frame_time: float,
        *,
        translated: Sequence[int] | NDArray[np.int32] | None = None,
        layout: ChannelLayout | None = None,
        unit: float | None = None,
        name: str | None = None,
    ) -> Motion:
        """Motion from quaternions.

        Args:
            skeleton: J joints, S slots.
            rotations: (F, S, 4) unit quaternions xyzw, local to the slot above.
            translations: (F, T, 3) file units; roots: world, others: the bone's vector in its slot's frame.
            frame_time: seconds.
            translated: (T,) the joints that ``translations`` is of; the roots by default.
            layout: channels to write it with in a post-rotation file.
            unit: metres per file unit.
            name: the file's name.
        """
        moving = np.array(skeleton.roots if translated is None else translated, np.int32)
        pose = Pose(np.asarray(rotations), moving, np.asarray(translations), layout)
        return cls(skeleton, float(frame_time), pose, unit, name)

    @property
    def frame_count(self) -> int:
        """F."""
        return len(self.source)

    @property
    def roots(self) -> tuple[str, ...]:
        """Names of the joints that carry a translation of their own in the world."""
        return tuple(self.skeleton.names[root] for root in self.skeleton.roots)

    @cached_property
    def dummies(self) -> tuple[str, ...]:
        """Names of the joints with zero offset in every frame, which only let siblings move independently."""
        from gmr.dummies import find_dummies

        return tuple(self.skeleton.names[joint] for joint in find_dummies(self))

    @property
    def layout(self) -> ChannelLayout | None:
        """Channels of the file it was read from, or that it is to be written with; None: not decided."""
        return self.source.layout

    @property
    def acclaim(self) -> Acclaim | None:
        """What the ASF of its file said: bones with axes, degrees of freedom and limits; None without one."""
        return None if isinstance(self.source, Rows) else self.source.acclaim

    @cached_property
    def pose(self) -> Pose:
        """The frames as rotations and translations; converted once where they were read as rows."""
        from gmr.euler import pose_from_rows

        if isinstance(self.source, Pose):
            return self.source
        if isinstance(self.source, DofRows):
            return self.source.pose
        return pose_from_rows(self.skeleton, self.source)

    @property
    def rotations(self) -> NDArray[np.float64]:
        """(F, S, 4) float64 xyzw: each slot's rotation in the frame of the slot above; read-only."""
        return self.pose.rotations

    @property
    def translated(self) -> NDArray[np.int32]:
        """(T,) int32: the joints that :attr:`translations` is of; read-only."""
        return self.source.layout.translated if isinstance(self.source, Rows) else self.source.translated

    @property
    def translations(self) -> NDArray[np.float64]:
        """(F, T, 3) float64 file units: roots in the world, others in their slot's frame; read-only."""
        return self.pose.translations

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """(F, C) float64, degrees and file units: as read, or as :attr:`layout` (else the standard) would
        write it.

        Raises:
            SkeletonError: siblings turn independently, or a joint moves that has no position channels.
        """
        from gmr.euler import rows_from_pose

        if isinstance(self.source, Rows):
            return self.source.values
        return rows_from_pose(self.skeleton, self.pose).values

    def positions(
        self,
        *,
        dtype: DTypeLike | None = None,
        joints: Iterable[Joint] | None = None,
        out: FloatArray | None = None,
        threads: int | None = None,
    ) -> FloatArray:
        """World positions.

        Args:
            dtype: float32 (default) or float64.
            joints: K names or indices; all joints by default.
            out: (F, K, 3) C-contiguous array to write into; its type decides where ``dtype`` is not given.
            threads: 0: all cores; None: all cores for long motions. The bits do not depend on it.

        Returns:
            (F, K, 3) file units; ``out`` where given.
        """
        from gmr.world import motion_positions

        return motion_positions(self, dtype, joints, out, threads)

    def bone_rotations(self, *, dtype: DTypeLike | None = None, threads: int | None = None) -> FloatArray:
        """(F, J, 4) xyzw: world rotation of the bone that ends in each joint at home (a root: its own).

        Every operation on the forest keeps it, wherever it makes the roots.
        """
        from gmr.world import motion_rotations

        return motion_rotations(self, self.skeleton.bone_slots, dtype, threads)

    def joint_rotations(self, *, dtype: DTypeLike | None = None, threads: int | None = None) -> FloatArray:
        """(F, J, 4) xyzw: world frame of each joint as BVH means it (post-rotation).

        Raises:
            SkeletonError: two children of a joint turn independently, so that it has no one frame.
        """
        from gmr.world import motion_rotations

        return motion_rotations(self, self.skeleton.frame_slots, dtype, threads)

    def __getitem__(self, part: slice) -> Motion:
        """Frames ``motion[10:50]``, sharing memory; ``motion[::2]`` has every second one, twice as long."""
        if not isinstance(part, slice):
            raise TypeError(f"a motion is cut by a slice: motion[{part}:{part} + 1] is the frame {part!r}")
        _, _, step = part.indices(self.frame_count)
        dropped = None if self.dropped is None else self.dropped.frames(part)
        frame_time = self.frame_time * abs(step)
        cut = replace(self, source=self.source.frames(part), frame_time=frame_time, dropped=dropped)
        if not isinstance(self.source, Pose) and "pose" in self.__dict__:
            cut.__dict__["pose"] = self.pose.frames(part)
        return cut

    def with_roots(self, roots: Iterable[Joint], *, threads: int | None = None) -> Motion:
        """The same motion with just these roots; see :func:`gmr.forest.with_roots`."""
        from gmr.forest import with_roots

        return with_roots(self, roots, threads=threads)

    def shift_root(self, joint: Joint, root: Joint | None = None, *, threads: int | None = None) -> Motion:
        """The same motion with ``joint`` as the root of its tree; see :func:`gmr.forest.shift_root`."""
        from gmr.forest import shift_root

        return shift_root(self, joint, root, threads=threads)

    def split(self, joint: Joint, *, threads: int | None = None) -> Motion:
        """The same motion with ``joint`` as a further root; see :func:`gmr.forest.split`."""
        from gmr.forest import split

        return split(self, joint, threads=threads)

    def join(self, root: Joint, *, threads: int | None = None) -> Motion:
        """The same motion without this root, its tree hanging on its old parent; see
        :func:`gmr.forest.join`."""
        from gmr.forest import join

        return join(self, root, threads=threads)

    def select(self, joints: Iterable[Joint], *, threads: int | None = None) -> Motion:
        """The motion of some of the joints alone; see :func:`gmr.partial.select`."""
        from gmr.partial import select

        return select(self, joints, threads=threads)

    def resample(self, fps: float) -> Motion:
        """The motion at another rate; see :func:`gmr.resample.resample`."""
        from gmr.resample import resample

        return resample(self, fps)

    def mirror(self, pairs: Mapping[str, str] | Iterable[tuple[str, str]] | None = None) -> Motion:
        """The mirror image across the plane x = 0, left for right; see :func:`gmr.mirror.mirror`."""
        from gmr.mirror import mirror

        return mirror(self, pairs)

    def to_unit(self, unit: float | str) -> Motion:
        """The same motion in another unit: "m", "cm" or metres; see :func:`gmr.units.to_unit`."""
        from gmr.units import to_unit

        return to_unit(self, unit)

    def with_unit(self, unit: float | str | None) -> Motion:
        """The same numbers, declared to be in this unit ("m", "cm", ... or metres per unit)."""
        from gmr.units import metres_per_unit

        return replace(self, unit=None if unit is None else metres_per_unit(unit))

    def with_name(self, name: str | None) -> Motion:
        """The same motion under another name."""
        return replace(self, name=name)

    def drop_dummies(self, *, threads: int | None = None) -> Motion:
        """The motion without its dummy joints, all others in place; see :func:`gmr.dummies.drop_dummies`."""
        from gmr.dummies import drop_dummies

        return drop_dummies(self, threads=threads)

    def restore_dummies(self, *, threads: int | None = None) -> Motion:
        """The motion with the dropped dummies back; see :func:`gmr.dummies.restore_dummies`."""
        from gmr.dummies import restore_dummies

        return restore_dummies(self, threads=threads)

    def to_post_rotation(self) -> Motion:
        """The motion as rows of channels can say it; see :func:`gmr.post_rotation.to_post_rotation`."""
        from gmr.post_rotation import to_post_rotation

        return to_post_rotation(self)

    def __repr__(self) -> str:
        unit = "unit unknown" if self.unit is None else f"unit {self.unit:g} m"
        roots = listed(self.roots, ROOTS_SHOWN) or "none"
        return (
            f"Motion({self.name!r}, {self.frame_count} frames at {self.fps:.6g} fps = {self.duration:.3f} s, "
            f"{self.skeleton.joint_count} joints, roots: {roots}, {unit})"
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Motion):
            return NotImplemented
        if self is other:
            return True
        described = (self.frame_time, self.unit, self.frame_count) == (
            other.frame_time,
            other.unit,
            other.frame_count,
        )
        return described and self.skeleton == other.skeleton and _same_frames(self, other)

    def __hash__(self) -> int:
        return hash((self.skeleton, self.frame_time, self.unit, self.frame_count))

    def __reduce__(self) -> tuple[Any, ...]:
        return Motion, (self.skeleton, self.frame_time, self.source, self.unit, self.name, self.dropped)


def _same_frames(one: Motion, other: Motion) -> bool:
    """Whether two motions on equal skeletons hold the same numbers."""
    a, b = one.source, other.source
    if isinstance(a, Rows) and isinstance(b, Rows):
        return a.layout == b.layout and np.array_equal(a.values, b.values)
    if (
        isinstance(a, DofRows)
        and isinstance(b, DofRows)
        and a.acclaim == b.acclaim
        and a.radians == b.radians
    ):
        return np.array_equal(a.values, b.values)
    return all(
        np.array_equal(getattr(one, key), getattr(other, key))
        for key in ("translated", "translations", "rotations")
    )
