"""A corpus is read: takes with their labels, each file when it is asked for."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr.actionlets.corpus.manifest import MANIFEST, read_manifest
from gmr.errors import FormatError, GmrError

if TYPE_CHECKING:
    import pyarrow

    from gmr.actionlets.corpus.windows import Windows
    from gmr.motion import Motion

__all__ = ["Corpus", "LabelledTake"]


@dataclass(frozen=True)
class LabelledTake:
    """A take of a corpus.

    Args:
        path: of its file.
        labels: its row of the manifest: "action", "parameters", "phases", "contacts", "seed" and more.
    """

    path: Path
    labels: Mapping[str, Any]

    @cached_property
    def motion(self) -> Motion:
        """The motion, read when it is first asked for; a .gmrb is mapped into memory, not read.

        Raises:
            FormatError: the file is missing or damaged.
        """
        import gmr

        return gmr.read(self.path)

    @property
    def action(self) -> str:
        """Which action it is of."""
        return str(self.labels["action"])

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters of the action, in its units."""
        own = self.labels.get("parameters") or {}
        return {name: value for name, value in own.items() if value is not None}

    @property
    def phases(self) -> tuple[tuple[str, float, float], ...]:
        """(label, begin, end) in seconds."""
        return tuple((span["label"], span["start"], span["end"]) for span in self.labels["phases"])

    @property
    def contacts(self) -> dict[str, NDArray[np.float64]]:
        """By "left" and "right", (n, 2) seconds between which that foot is on the ground."""
        return {side: _pairs(spans) for side, spans in self.labels["contacts"].items()}


class Corpus(Sequence[LabelledTake]):
    """The takes of a folder that ``gmr synthesize`` has filled, in the order of its manifest.

    Args:
        folder: where it lies.

    Raises:
        FormatError: there is no such folder, or its manifest is missing or damaged.
        MissingExtraError: pyarrow is not installed (the extra ``corpus``).
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        place = Path(folder)
        if not place.is_dir():
            raise FormatError("there is no such folder", file=str(folder))
        self._place = place
        self._table = read_manifest(place / MANIFEST)

    @property
    def folder(self) -> Path:
        """Where it lies."""
        return self._place

    @property
    def table(self) -> pyarrow.Table:
        """The manifest, a row a take."""
        return self._table

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions, in the order in which they first come."""
        return tuple(dict.fromkeys(self._table["action"].to_pylist()))

    def where(self, rows: ArrayLike) -> Corpus:
        """The corpus of some takes: (N,) booleans, or indices in the order wanted.

        Raises:
            GmrError: neither; or other than N booleans, or an index that there is not.
        """
        import pyarrow

        chosen = np.asarray(rows)
        found = object.__new__(Corpus)
        found._place = self._place
        found._table = self._table.take(pyarrow.array(_places(chosen, len(self))))
        return found

    def windows(
        self, frames: int, step: int | None = None, dtype: type[np.floating[Any]] = np.float32
    ) -> Windows:
        """Windows of equal length, as training wants them; see :class:`gmr.actionlets.corpus.Windows`."""
        from gmr.actionlets.corpus.windows import Windows

        return Windows(self, frames, step, dtype)

    def __len__(self) -> int:
        return int(self._table.num_rows)

    @overload
    def __getitem__(self, index: int) -> LabelledTake: ...
    @overload
    def __getitem__(self, index: slice) -> Corpus: ...
    def __getitem__(self, index: int | slice) -> LabelledTake | Corpus:
        if isinstance(index, slice):
            return self.where(np.arange(len(self))[index])
        row = range(len(self))[index]
        labels = self._table.slice(row, 1).to_pylist()[0]
        return LabelledTake(self._place / labels["file"], labels)

    def __iter__(self) -> Iterator[LabelledTake]:
        return (self[row] for row in range(len(self)))

    def __repr__(self) -> str:
        return f"Corpus({str(self._place)!r}, {len(self)} takes of {', '.join(self.actions)})"


def _places(chosen: NDArray[Any], count: int) -> NDArray[np.int64]:
    """The indices that (N,) booleans or indices, also from the end, mean."""
    if chosen.dtype == bool and chosen.shape == (count,):
        return np.flatnonzero(chosen).astype(np.int64)
    is_index = chosen.ndim == 1 and (not len(chosen) or np.issubdtype(chosen.dtype, np.integer))
    if not is_index or (len(chosen) and not -count <= chosen.min() <= chosen.max() < count):
        raise GmrError(
            f"takes cannot be chosen by {chosen.dtype} of the shape {chosen.shape}: give {count} booleans, "
            f"or whole numbers from 0 to {count - 1}"
        )
    return np.where(chosen < 0, chosen + count, chosen).astype(np.int64)


def _pairs(spans: Sequence[Mapping[str, float]]) -> NDArray[np.float64]:
    return np.array([(span["start"], span["end"]) for span in spans], np.float64).reshape(-1, 2)
