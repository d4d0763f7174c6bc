"""The frames of a motion: rows of channels as a file writes them, or rotations and translations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gmr.arrays import frozen, read_only
from gmr.channels import ChannelLayout
from gmr.errors import GmrError, SkeletonError
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.acclaim import Acclaim
    from gmr.dof_rows import DofRows

__all__ = ["Pose", "Rows", "check_fit"]


@dataclass(frozen=True, eq=False)
class Rows:
    """Frames as a post-rotation file writes them.

    Args:
        values: (F, C) float64, degrees and file units.
        layout: what each column moves.
    """

    values: NDArray[np.float64]
    layout: ChannelLayout

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", _frames_of(self.values, "rows", (self.layout.column_count,)))

    def __len__(self) -> int:
        return len(self.values)

    @property
    def numbers(self) -> tuple[NDArray[np.float64], ...]:
        """All that was given, whatever its form."""
        return (self.values,)

    def frames(self, part: slice) -> Rows:
        """Some of the frames; consecutive ones share memory."""
        return Rows(read_only(np.ascontiguousarray(self.values[part])), self.layout)

    def __reduce__(self) -> tuple[Any, ...]:
        return _owned, (Rows, self.values, self.layout)


@dataclass(frozen=True, eq=False)
class Pose:
    """Frames as rotations of slots and translations of joints.

    Args:
        rotations: (F, S, 4) float64 unit quaternions xyzw, each slot's rotation in the frame of the slot
            above it.
        translated: (T,) int32, the joints with a translation per frame; all roots are among them.
        translations: (F, T, 3) float64 file units: a root's place in the world, another joint's vector from
            its parent in the frame of its own bone.
        layout: the channels that a post-rotation file would write it with, at home; None: the standard ones.
        rows: the rows that these frames were read as, at home, where they are the same motion still.
        acclaim: the skeleton that an ASF would describe it with, at home, where it fits; None: made for it.
    """

    rotations: NDArray[np.float64]
    translated: NDArray[np.int32]
    translations: NDArray[np.float64]
    layout: ChannelLayout | None = None
    rows: Rows | DofRows | None = None
    acclaim: Acclaim | None = None

    def __post_init__(self) -> None:
        translated = frozen(self.translated, np.int32)
        object.__setattr__(self, "translated", translated)
        object.__setattr__(self, "rotations", _frames_of(self.rotations, "rotations", (None, 4)))
        object.__setattr__(
            self, "translations", _frames_of(self.translations, "translations", (len(translated), 3))
        )
        if len(self.rotations) != len(self.translations):
            raise GmrError(
                f"{len(self.rotations)} frames of rotations but {len(self.translations)} of translations; "
                "give as many of each"
            )

    def __len__(self) -> int:
        return len(self.translations)

    @cached_property
    def single(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Rotations and translations in float32, for kernels that are asked for it again and again."""
        return self.rotations.astype(np.float32), self._single_translations

    def single_of(self, slots: NDArray[np.int32]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """As :attr:`single`, with the rotations of these slots alone; kept while the same are asked for."""
        held = self.__dict__.get("_part")
        if held is None or not np.array_equal(held[0], slots):
            held = self.__dict__["_part"] = slots, self.rotations.take(slots, axis=1).astype(np.float32)
        return held[1], self._single_translations

    @cached_property
    def _single_translations(self) -> NDArray[np.float32]:
        return self.translations.astype(np.float32)

    @property
    def numbers(self) -> tuple[NDArray[np.float64], ...]:
        """All that was given, whatever its form."""
        return self.rotations, self.translations

    def frames(self, part: slice) -> Pose:
        """Some of the frames; consecutive ones share memory."""
        rotations, translations = (np.ascontiguousarray(a[part]) for a in (self.rotations, self.translations))
        rows = None if self.rows is None else self.rows.frames(part)
        return replace(self, rotations=read_only(rotations), translations=read_only(translations), rows=rows)

    def __reduce__(self) -> tuple[Any, ...]:
        rest = (self.layout, self.rows, self.acclaim)
        return _owned, (Pose, self.rotations, self.translated, self.translations, *rest)


def check_fit(skeleton: Skeleton, source: Rows | DofRows | Pose) -> None:
    """Raises unless the frames are those of this skeleton."""
    if isinstance(source, Rows):
        if not source.layout.fits(skeleton):
            raise SkeletonError(
                "the channel layout is not that of the skeleton: parents or rotation slots differ. "
                "Make both from the same parents and channels (Skeleton.post_rotation, ChannelLayout.of)."
            )
        return
    if not isinstance(source, Pose):
        if skeleton != source.acclaim.skeleton:
            raise SkeletonError("these values move another skeleton; use acclaim.skeleton, which is theirs")
        return
    slots = source.rotations.shape[1]
    if slots != skeleton.slot_count:
        raise SkeletonError(f"rotations for {slots} slots, but the skeleton has {skeleton.slot_count}")
    translated = source.translated.tolist()
    moving = set(translated)
    if len(moving) < len(translated) or not moving <= set(range(skeleton.joint_count)):
        raise SkeletonError(f"translated joints {translated} must be distinct joints of the skeleton")
    lacking = [skeleton.names[root] for root in skeleton.roots if root not in moving]
    if lacking:
        raise SkeletonError(f"root '{lacking[0]}' has no translation; every root needs one")


def _frames_of(array: NDArray[Any], what: str, shape: tuple[int | None, ...]) -> NDArray[np.float64]:
    """``array`` read-only as (F, *shape) float64, or an error that names ``what``."""
    found = frozen(array, np.float64)
    if found.ndim != 1 + len(shape) or any(
        n is not None and n != m for n, m in zip(shape, found.shape[1:], strict=True)
    ):
        wanted = ", ".join("any" if n is None else str(n) for n in shape)
        raise GmrError(f"{what} has the shape {found.shape}; it must be (frames, {wanted})")
    return found


def _owned(kind: type[Rows] | type[Pose], *fields: Any) -> Rows | Pose:
    """Frames from unpickled arrays, which nobody else holds and so need no copy."""
    held: list[Any] = [read_only(field) if isinstance(field, np.ndarray) else field for field in fields]
    return kind(*held)
