"""Several datasets beside each other: the same trials for each, and what one does that others cannot."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from gmr.errors import DatasetError
from gmr.evaluation.comparison_words import comparison_verdict
from gmr.evaluation.evaluate import Source, evaluate
from gmr.evaluation.result import Evaluation, Tables, Verdict
from gmr.evaluation.table_files import write_tables
from gmr.table import Table

__all__ = ["Comparison", "compare", "comparison_of"]

Progress: TypeAlias = Callable[[str, int, int], object]


@dataclass(frozen=True, slots=True)
class Comparison:
    """What :func:`gmr.compare` found.

    Attributes:
        evaluations: one a dataset, in the order given, of the same trials; no two have the same name.
        verdict: in words, which dataset does what.
    """

    evaluations: tuple[Evaluation, ...]
    verdict: Verdict

    @property
    def datasets(self) -> tuple[str, ...]:
        """The names of the datasets, in order."""
        return tuple(evaluation.dataset for evaluation in self.evaluations)

    @property
    def failed(self) -> dict[str, str]:
        """``<dataset>: <file>`` of each file that could not be used -> why, in one sentence."""
        return {
            f"{evaluation.dataset}: {file}": why
            for evaluation in self.evaluations
            for file, why in evaluation.failed.items()
        }

    def tables(self) -> dict[str, Table]:
        """The tables by name, dataset after dataset, told apart by the column ``dataset``."""
        every = [evaluation.tables() for evaluation in self.evaluations]
        return {name: _joined([tables[name] for tables in every]) for name in every[0]}

    def write_tables(
        self, folder: str | os.PathLike[str], formats: Sequence[str] = ("csv",)
    ) -> tuple[Path, ...]:
        """Write every table into a folder, as :meth:`Evaluation.write_tables` does."""
        return write_tables(self.tables(), folder, formats)

    def report(self, path: str | os.PathLike[str]) -> None:
        """Write one report for all datasets: a self-contained HTML file that opens offline.

        Raises:
            OSError: the file cannot be written.
        """
        from gmr.evaluation.report import write_comparison

        write_comparison(self, path)


def compare(
    sources: Iterable[Source] | Mapping[str, Source],
    *,
    progress: Progress | None = None,
    **settings: Any,
) -> Comparison:
    """Measure what several sets of locomotion clips can do, by the same trials.

    Args:
        sources: two or more of what :func:`gmr.evaluate` takes, or such by the name of the dataset.
        progress: as of :func:`gmr.evaluate`; phases are told as ``<dataset>: <phase>``.
        settings: all others of :func:`gmr.evaluate`, for every dataset.

    Returns:
        The evaluations and what they show beside each other. Datasets of one name get that of the folder that
        theirs is in before it, else a number.

    Raises:
        DatasetError: fewer than two sources; or as :func:`gmr.evaluate`, with the dataset named.
        ValueError, FormatError: as :func:`gmr.evaluate`.
    """
    given = list(sources.values()) if isinstance(sources, Mapping) else list(sources)
    names = list(sources) if isinstance(sources, Mapping) else dataset_names(given)
    if len(given) < 2:
        raise DatasetError("a comparison needs two datasets or more; give them, or use gmr.evaluate for one")
    tell = progress or (lambda phase, done, of: None)

    def found(source: Source, name: str) -> Evaluation:
        try:
            evaluation = evaluate(
                source, progress=lambda phase, done, of: tell(f"{name}: {phase}", done, of), **settings
            )
        except DatasetError as error:
            raise DatasetError(f"{name}: {error}") from error
        return _renamed(evaluation, name)

    return comparison_of([found(source, name) for source, name in zip(given, names, strict=True)])


def comparison_of(evaluations: Iterable[Evaluation]) -> Comparison:
    """What evaluations show beside each other.

    Raises:
        DatasetError: they are fewer than two, of other trials than each other, or two have the same name.
    """
    held = tuple(evaluations)
    if len(held) < 2:
        raise DatasetError(f"{len(held)} evaluation cannot be compared; give two or more")
    for evaluation in held[1:]:
        if _asked(evaluation) != _asked(held[0]):
            raise DatasetError(
                f"{evaluation.dataset} was sent through other trials than {held[0].dataset}; evaluate both "
                "with the same speeds, turn rates, scenarios and tracking"
            )
    twice = [name for name, times in Counter(one.dataset for one in held).items() if times > 1]
    if twice:
        raise DatasetError(f"two datasets are called {twice[0]}; give one of them another name")
    return Comparison(held, comparison_verdict(held))


def dataset_names(sources: Sequence[Source]) -> list[str]:
    """A name for each source, no two the same: of its folder, with that of the folder around it where two
    agree, else with a number.
    """
    places = [Path(source).resolve() if isinstance(source, str | os.PathLike) else None for source in sources]
    names = ["motions" if place is None else _printable(place.name) for place in places]
    alike = {name for name, times in Counter(names).items() if times > 1}
    names = [
        _printable(f"{place.parent.name}/{place.name}") if place is not None and name in alike else name
        for name, place in zip(names, places, strict=True)
    ]
    unique: list[str] = []
    for name in names:
        again, number = name, 1
        while again in unique:
            number += 1
            again = f"{name} ({number})"
        unique.append(again)
    return unique


def _printable(text: str) -> str:
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def _asked(evaluation: Evaluation) -> list[Any]:
    trials = evaluation.measured.trials
    return [trials[name].tolist() for name in ("scenario", "tracking", "speed", "turn_rate_deg")]


def _renamed(evaluation: Evaluation, name: str) -> Evaluation:
    """The evaluation with another name of its dataset, in its tables too."""
    if evaluation.dataset == name:
        return evaluation
    tables = {
        each: Table({**dict(table), "dataset": np.full(len(table), name, object)})
        for each, table in evaluation.tables().items()
    }
    return replace(
        evaluation,
        dataset=name,
        measured=Tables(**tables),
        summary=replace(evaluation.summary, dataset=name),
    )


def _joined(tables: Sequence[Table]) -> Table:
    return Table(
        {column: np.concatenate([table[column] for table in tables]) for column in tables[0].column_names}
    )
