"""A motion database: the clips of a dataset at one rate, with the features that matching compares.

Source: Holden et al., "Learned Motion Matching" (2020), Sec. 3; Clavet, "Motion Matching and The Road to
Next-Gen Animation" (2016).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from os import PathLike
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gmr import _core
from gmr.arrays import read_only
from gmr.body.joints import Joints
from gmr.errors import DatasetError
from gmr.matching import saved
from gmr.matching.assemble import Assembly, Tags, assemble
from gmr.matching.database_rows import DatabaseRows
from gmr.matching.duplicates import duplicates, duplicates_note, followed
from gmr.matching.naming import named
from gmr.matching.normalization import Normalization
from gmr.matching.schema import LOCOMOTION, Schema
from gmr.matching.survey import Survey, survey
from gmr.motion import Motion
from gmr.skeleton import Skeleton
from gmr.threads import thread_count

__all__ = ["Database"]

Weights: TypeAlias = ArrayLike | Mapping[str, float]
"""Of each dimension, of each of each query, or of groups of features by their names."""


@dataclass(frozen=True, eq=False, repr=False)
class Database(DatabaseRows):
    """N frames of C clips, ready to be searched; immutable.

    Rows are the frames of all clips, clip after clip, at :attr:`rate`. Lengths are metres; poses are seen
    from the simulation root of their own frame: origin below the hips, Y up, +Z where the body faces, +X
    to its left. Arrays are read-only and share the core's memory.
    """

    core: _core.Database
    """The core's database, for :func:`gmr._core.run_trials`."""
    schema: Schema
    skeleton: Skeleton
    """That of the first clip, in file units; names, parents and slots are those of all."""
    joints: Joints
    clip_names: tuple[str, ...]
    """(C,) as given; a mirrored copy is "<name> (mirrored)" and follows its original."""
    mirrored: NDArray[np.bool_]
    """(C,) whether the clip is a mirrored copy."""
    units: Mapping[str, float]
    """Metres per file unit, by the name of the clip's original."""
    notes: tuple[str, ...]
    """What was guessed, converted or left out, in sentences."""
    excluded: Mapping[str, str]
    """Clips that could not be used, by name, and why."""
    duplicates: Mapping[str, str]
    """Clips left out because another, or its mirrored copy, is the same motion with the same tags: by
    name, and for each the one in :attr:`clip_names` that is the same."""
    starts: NDArray[np.float64]
    """(C,) second of its file at which each clip begins (not 0 where a converter's T-pose was left out)."""

    @classmethod
    def build(
        cls,
        motions: Iterable[Motion] | Mapping[str, Motion],
        *,
        mirror: bool = False,
        pairs: Mapping[str, str] | None = None,
        schema: Schema = LOCOMOTION,
        rate: float = 60.0,
        names: Mapping[str, str | int] | None = None,
        unit: float | str | None = None,
        tags: Tags | None = None,
        normalization: Normalization | None = None,
        threads: int | None = None,
    ) -> Database:
        """The database of some clips.

        Args:
            motions: the clips, by name or with names of their own; of those that are the same motion with the
            same tags one is used, the others are named in :attr:`duplicates`.
            mirror: add the mirror image of each clip.
            pairs: joints of the two sides whose names do not tell that they belong together, for ``mirror``.
            schema: the features.
            rate: frames a second of the database.
            names: joints by role where they are not found by themselves, such as ``{"left_foot": "foot_l"}``.
            unit: metres per file unit (or "cm", ...) of motions that do not say; guessed from the body by
            default.
            tags: by a clip's name, bits of all its frames (one number) or of each (one number a frame).
            normalization: that of another database with this schema, to compare with it; fitted by default.
            threads: that build the index; 0 or None: all cores. The bits do not depend on it.

        Raises:
            DatasetError: no clip is usable, the skeletons differ, or hips, legs or feet are not found.
        """
        if not 1 <= rate <= 1000:
            raise DatasetError(f"a database cannot have {rate} frames a second; give 1 to 1000")
        total = thread_count(threads)

        def without(twice: Mapping[str, str]) -> Database:
            # What is decided for all clips together is decided without those that are there twice.
            seen = survey({n: given[n] for n in given if n not in twice}, schema.span, names, unit)
            its_tags = {name: bits for name, bits in (tags or {}).items() if name not in twice}
            return cls._of(seen, assemble(seen, schema, rate, mirror, pairs, its_tags), normalization, total)

        given, twice = named(motions), dict[str, str]()
        database = without(twice)
        while more := duplicates(database, given):
            twice = followed(twice, more)
            database = without(twice)
        if not twice:
            return database
        return replace(database, duplicates=twice, notes=(duplicates_note(twice), *database.notes))

    @classmethod
    def _of(
        cls, seen: Survey, assembly: Assembly, normalization: Normalization | None, threads: int
    ) -> Database:
        """The database of what was put together."""
        offset, scale = (normalization.offset, normalization.scale) if normalization else (None, None)
        try:
            core = assembly.builder.finish(offset, scale, threads)
        except ValueError as error:
            raise DatasetError(str(error)) from error
        return cls(
            core=core,
            schema=assembly.schema,
            skeleton=seen.skeleton,
            joints=seen.joints,
            clip_names=tuple(assembly.clip_names),
            mirrored=read_only(np.array(assembly.mirrored, bool)),
            units=seen.units,
            notes=_notes(seen, assembly.schema, core),
            excluded=assembly.excluded,
            duplicates={},
            starts=read_only(np.array(assembly.starts)),
        )

    def __reduce__(self) -> tuple[Callable[[bytes], Database], tuple[bytes]]:
        """As the bytes of a saved file."""
        from gmr.matching.pickled import packed, unpacked

        return unpacked, (packed(self),)

    def subset(self, left: ArrayLike, *, threads: int | None = None) -> Database:
        """The same database, of which only some rows may be shown; nothing is read or measured again.

        A row that is gone is neither jumped to nor played on to: where one follows, the clip ends. Nor is a
        row jumped to whose features look at one that is gone. All rows keep their numbers, their features and
        the scale of these, so that trials on whole clips have the bits of those on a database built of these
        clips with the same :attr:`normalization`.

        Args:
            left: (N,) whether a row may be shown, of those that may be so far.
            threads: that build the index; 0 or None: all cores. The bits do not depend on it.

        Raises:
            DatasetError: no row that may be jumped to is left.
            ValueError: ``left`` has not N entries.
        """
        mask = np.ascontiguousarray(left, bool)
        if mask.shape != (len(self),):
            raise ValueError(f"{mask.shape} rows left; give one entry for each of the {len(self)}")
        try:
            core = self.core.subset(mask, thread_count(threads))
        except ValueError as error:
            raise DatasetError(str(error)) from error
        return replace(self, core=core)

    def normalize(self, raw: ArrayLike) -> NDArray[np.float32]:
        """Queries (Q, D) from raw numbers (Q, D) in metres and metres a second, in the schema's order."""
        return self.core.normalize(_rows(raw, "raw features"))

    def search(
        self,
        queries: ArrayLike,
        k: int = 1,
        *,
        tags: ArrayLike = 0,
        weights: Weights | None = None,
        exclude: ArrayLike | None = None,
        max_cost: float = np.inf,
        threads: int = 0,
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The nearest candidates of each query: exact, ties to the lowest row.

        Args:
            queries: (Q, D), or one of (D,), scaled as :attr:`features` are.
            k: how many.
            tags: bits that a frame must all carry: one number for all queries, or (Q,); 32 bits.
            weights: what squared differences are multiplied by, 0 or more: by the names of groups (those left
                out count as ever), (D,) for all queries, or (Q, D). Those of weight 0 are not looked at.
            exclude: the first and one past the last row that is no candidate: (2,) for all, or (Q, 2).
            max_cost: only frames that cost less are found.
            threads: 0 means all cores; the answer is the same for every number.

        Returns:
            Costs (Q, k), the sums of squared differences, best first; rows of the database (Q, k), which
            :attr:`clips` and :attr:`frames` translate. Where there are fewer candidates: inf and -1.

        Raises:
            DatasetError: no feature group is called as a weight is.
            ValueError: a query has another number of features, or one that is not finite; a weight is below 0
                or not finite; tags or a range are none; or ``k`` is below 0 or above N.
        """
        if not 0 <= k <= len(self):
            raise ValueError(
                f"{k} nearest rows cannot be found among {len(self)}; give a k from 0 to {len(self)}"
            )
        asked = _rows(queries, "queries")
        return self.core.index.search(
            asked,
            k,
            _whole(tags, "tags", "bits from 0 to 2^32 - 1").reshape(-1),
            None if exclude is None else _ranges(exclude, len(asked)),
            max_cost,
            thread_count(threads),
            None if weights is None else self._weights(weights),
        )

    def _weights(self, weights: Weights) -> NDArray[np.float32]:
        """(1, D) or (Q, D) as they are, or of groups by their names."""
        given = self.schema.spread(weights) if isinstance(weights, Mapping) else weights
        return _rows(given, "weights")

    def costs_by_group(
        self, queries: ArrayLike, rows: ArrayLike, *, weights: Weights | None = None
    ) -> dict[str, NDArray[np.float32]]:
        """What rows cost queries, feature group by feature group.

        Args:
            queries: (Q, D), or one of (D,), as in :meth:`search`.
            rows: (Q, k) rows of the database, as :meth:`search` returns them.
            weights: as in :meth:`search`.

        Returns:
            For each group of the schema, by its name, the costs (Q, k); NaN where the row is -1. Over all
            groups they add up to the cost, but for rounding.

        Raises:
            ValueError: shapes do not fit, or a row is not there.
        """
        given = np.atleast_2d(np.asarray(rows, np.int64))
        parts = self.core.costs_by_group(
            _rows(queries, "queries"), given, None if weights is None else self._weights(weights)
        )
        return {group.name: parts[..., number] for number, group in enumerate(self.schema.groups)}

    def save(self, path: str | PathLike[str]) -> None:
        """Save the database in a file that :meth:`open` maps into memory; see docs/matching.md.

        A file that is there is replaced once the new one is whole.

        Raises:
            OSError: the file cannot be written.
        """
        saved.save(self, path)

    @classmethod
    def open(cls, path: str | PathLike[str], *, check: bool = False) -> Database:
        """A saved database, mapped into memory: rows, poses and the index are read when they are looked at.

        Opening takes as long for many rows as for few. Searches and trials have the same bits as those of the
        database that was saved. A search that meets a damaged part of the index raises a ``ValueError``.

        Args:
            check: read the whole index and hold it against the rows: every answer is then that of a look at
                every row.

        Raises:
            FormatError: the file is no saved database, is one of another version, or is damaged.
            OSError: it cannot be read.
        """
        return cls(**saved.contents(path, check))

    def __repr__(self) -> str:
        seconds = len(self) / self.rate
        return (
            f"Database({len(self.clip_names)} clips, {int(self.mirrored.sum())} of them mirrored, "
            f"{len(self)} frames at {self.rate:g} fps = {seconds:.1f} s, {self.schema.dims} features)"
        )


def _notes(seen: Survey, schema: Schema, core: _core.Database) -> tuple[str, ...]:
    constant = [schema.groups[group].name for group in core.constant_groups]
    scaled = [
        f"Feature group '{name}' does not vary in this dataset and so cannot be scaled; it keeps its unit."
        for name in constant
    ]
    return (*seen.notes, *scaled)


def _ranges(exclude: ArrayLike, count: int) -> NDArray[np.uint32]:
    """(Q, 2) rows from which no answer is wanted."""
    found = _whole(exclude, "exclude", "rows of the database")
    if found.shape not in ((2,), (count, 2)):
        raise ValueError(
            f"exclude has the shape {found.shape}; give the first and one past the last row, (2,) for all "
            f"queries or ({count}, 2)"
        )
    return np.ascontiguousarray(np.broadcast_to(found, (count, 2)))


def _whole(values: ArrayLike, what: str, wanted: str) -> NDArray[np.uint32]:
    """Whole numbers that fit 32 bits."""
    numbers = np.asarray(values)
    most = np.iinfo(np.uint32).max
    if numbers.dtype.kind not in "iu" or (numbers.size and not 0 <= numbers.min() <= numbers.max() <= most):
        raise ValueError(f"{what} must be whole numbers, {wanted}; they are {values!r}")
    return numbers.astype(np.uint32)


def _rows(values: ArrayLike, what: str) -> NDArray[np.float32]:
    rows = np.ascontiguousarray(values, np.float32)
    if rows.ndim not in (1, 2):
        raise ValueError(f"{what} must be (Q, D) or (D,), not {rows.shape}")
    return rows.reshape(-1, rows.shape[-1])
