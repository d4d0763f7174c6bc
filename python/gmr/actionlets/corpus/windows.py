"""Windows of equal length out of the takes of a corpus, as arrays, for training."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gmr.errors import GmrError

if TYPE_CHECKING:
    import pyarrow

    from gmr.actionlets.corpus.reading import Corpus
    from gmr.motion import Motion

__all__ = ["Window", "Windows"]

Window: TypeAlias = dict[str, Any]

_HELD: Final = 64
"""Motions that are kept open; those of .gmrb files take no memory but what is looked at."""


class Windows:
    """All windows of some frames in the takes of a corpus: ``len(windows)``, ``windows[i]``.

    It has the shape of a ``torch.utils.data.Dataset`` and can be sent to the workers of a ``DataLoader``.
    A take that is shorter than a window has none; frames at the end of a take that fill no window are left
    out.

    Args:
        corpus: T takes on skeletons with the same joints.
        frames: W, of a window.
        step: frames from the beginning of a window to that of the next in the same take; W where left out.
        dtype: of rotations and translations.

    Raises:
        GmrError: ``frames`` or ``step`` is below 1.
    """

    def __init__(
        self, corpus: Corpus, frames: int, step: int | None = None, dtype: type[np.floating[Any]] = np.float32
    ) -> None:
        if frames < 1 or (step is not None and step < 1):
            raise GmrError(f"windows of {frames} frames, {step} frames apart, cannot be; give at least 1")
        table = corpus.table
        self.actions = corpus.actions
        self.frames = frames
        self.step = frames if step is None else step
        self.dtype = dtype
        self._folder = corpus.folder
        self._files = table["file"].to_pylist()
        self._action = np.array([self.actions.index(name) for name in table["action"].to_pylist()], np.int64)
        self._fps = table["fps"].to_numpy()
        self._contacts = [_Spans(table["contacts"], side) for side in ("left", "right")]
        lengths = table["frames"].to_numpy()
        counts = np.where(lengths < frames, 0, (lengths - frames) // self.step + 1)
        self._ends = np.cumsum(counts)
        self._open: OrderedDict[int, Motion] = OrderedDict()

    def __len__(self) -> int:
        return int(self._ends[-1]) if len(self._ends) else 0

    def __getitem__(self, index: int) -> Window:
        """A window, its arrays its own.

        Returns:
            "rotations" (W, S, 4) unit quaternions xyzw, each slot's in the frame of the slot above;
            "translations" (W, T, 3) metres, of the root and of other joints that move;
            "contacts" (W, 2) bool, left and right foot on the ground;
            "action" its place in ``actions``; "take" which of the corpus; "frame" its first.
        """
        number = range(len(self))[index]
        take = int(np.searchsorted(self._ends, number, side="right"))
        start = (number - (int(self._ends[take - 1]) if take else 0)) * self.step
        part = slice(start, start + self.frames)
        motion = self._motion(take)
        times = np.arange(part.start, part.stop) / self._fps[take]
        return {
            "rotations": motion.rotations[part].astype(self.dtype),
            "translations": motion.translations[part].astype(self.dtype),
            "contacts": np.column_stack([spans.cover(take, times) for spans in self._contacts]),
            "action": int(self._action[take]),
            "take": take,
            "frame": start,
        }

    def __iter__(self) -> Iterator[Window]:
        return (self[index] for index in range(len(self)))

    def _motion(self, take: int) -> Motion:
        if take in self._open:
            self._open.move_to_end(take)
        else:
            import gmr

            self._open[take] = gmr.read(self._folder / self._files[take])
            if len(self._open) > _HELD:
                self._open.popitem(last=False)
        return self._open[take]

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_open": OrderedDict()}


class _Spans:
    """The contacts of one foot in all takes, as flat arrays: a million takes are three arrays."""

    def __init__(self, contacts: pyarrow.ChunkedArray, side: str) -> None:
        own = contacts.combine_chunks().field(side)
        spans = own.flatten()
        self._starts: NDArray[np.float64] = spans.field("start").to_numpy()
        self._ends: NDArray[np.float64] = spans.field("end").to_numpy()
        counts = own.value_lengths().to_numpy()
        self._bounds = np.concatenate([[0], np.cumsum(counts)])

    def cover(self, take: int, times: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether each of the times lies in a span of the take: at or after its start, before its end."""
        own = slice(self._bounds[take], self._bounds[take + 1])
        began = np.searchsorted(self._starts[own], times, side="right")
        ended = np.searchsorted(self._ends[own], times, side="right")
        covered: NDArray[np.bool_] = began > ended
        return covered
