"""Several datasets beside each other: the same trials for each, and what one does that others cannot."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gmr.errors import DatasetError
from gmr.evaluation.comparison_words import comparison_verdict
from gmr.evaluation.result import Evaluation, Verdict
from gmr.evaluation.table_files import write_tables
from gmr.table import Table

__all__ = ["Comparison", "comparison_of"]


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

    def write_figures(self, folder: str | os.PathLike[str]) -> tuple[Path, ...]:
        """Write the figures as SVG: those of all datasets into a folder, those of each into one in it.

        Raises:
            MissingExtraError: vl-convert-python is not installed.
            OSError: the folder may not be written to, or the disk is full.
        """
        from gmr.evaluation.figures.comparison import svg_of_comparison

        return svg_of_comparison(self.evaluations, folder)

    def report(self, path: str | os.PathLike[str]) -> None:
        """Write one report for all datasets: a self-contained HTML file that opens offline.

        Raises:
            OSError: the file cannot be written.
        """
        from gmr.evaluation.report import write_comparison

        write_comparison(self, path)


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


def _asked(evaluation: Evaluation) -> list[Any]:
    trials = evaluation.measured.trials
    return [trials[name].tolist() for name in ("scenario", "tracking", "speed", "turn_rate_deg")]


def _joined(tables: Sequence[Table]) -> Table:
    return Table(
        {column: np.concatenate([table[column] for table in tables]) for column in tables[0].column_names}
    )
