"""Several sets of clips, each evaluated by the same trials."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from gmr.errors import DatasetError
from gmr.evaluation.comparison import Comparison, comparison_of
from gmr.evaluation.evaluate import Source, evaluate
from gmr.evaluation.reading import Read, printable
from gmr.evaluation.result import Evaluation, Tables
from gmr.table import Table

__all__ = ["compare", "dataset_names", "renamed"]

Progress: TypeAlias = Callable[[str, int, int], object]


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
        return renamed(evaluation, name)

    return comparison_of([found(source, name) for source, name in zip(given, names, strict=True)])


def dataset_names(sources: Sequence[Source]) -> list[str]:
    """A name for each source, no two the same: of its folder, with that of the folder around it where two
    agree, else with a number.
    """
    places = [Path(source).resolve() if isinstance(source, str | os.PathLike) else None for source in sources]
    names = [
        printable(place.name) if place is not None else source.name if isinstance(source, Read) else "motions"
        for source, place in zip(sources, places, strict=True)
    ]
    alike = {name for name, times in Counter(names).items() if times > 1}
    names = [
        printable(f"{place.parent.name}/{place.name}") if place is not None and name in alike else name
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


def renamed(evaluation: Evaluation, name: str) -> Evaluation:
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
