"""The figures of a comparison: of all datasets in one, and each figure of one beside that of the others."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from gmr.evaluation.figures import figures
from gmr.evaluation.figures.compared_coverage import compared_coverage
from gmr.evaluation.figures.compared_trials import compared_trials
from gmr.evaluation.figures.same_axes import on_same_axes
from gmr.evaluation.figures.svg_files import write_svg
from gmr.evaluation.result import Evaluation
from gmr.pages.figure import Figure

__all__ = ["ComparedFigures", "comparison_figures", "in_columns", "svg_of_comparison"]

_REPLACED: Final = ("coverage_scatter",)
"""Figures of one dataset whose place another takes."""


@dataclass(frozen=True, slots=True)
class ComparedFigures:
    """The figures of a comparison.

    Attributes:
        trials, coverage: of all datasets in one.
        rows: by the name of the figure of one dataset, that of each with the dataset's place, on the same
            axes. A dataset whose evaluation lacks it has none.
    """

    trials: Figure
    coverage: Figure
    rows: dict[str, list[tuple[int, Figure]]]

    def every(self) -> list[Figure]:
        """All of them, those of one row to stand side by side."""
        rows = [in_columns(figure, len(row)) for row in self.rows.values() for _, figure in row]
        return [in_columns(self.trials, 2), self.coverage, *rows]


def comparison_figures(evaluations: Sequence[Evaluation]) -> ComparedFigures:
    """Draw several evaluations of the same trials."""
    drawn: dict[str, list[tuple[int, Figure]]] = {}
    for place, evaluation in enumerate(evaluations):
        for figure in figures(evaluation):
            if figure.name not in _REPLACED:
                drawn.setdefault(figure.name, []).append((place, figure))
    rows = {
        name: [
            (place, replace(figure, name=f"{name}--{place + 1}"))
            for (place, _), figure in zip(row, on_same_axes([figure for _, figure in row]), strict=True)
        ]
        for name, row in drawn.items()
    }
    return ComparedFigures(compared_trials(evaluations), compared_coverage(evaluations), rows)


def svg_of_comparison(evaluations: Sequence[Evaluation], folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """Write every figure as SVG: those of all datasets into a folder, those of each into one in it.

    Args:
        evaluations: what to draw.
        folder: where to; made where it is missing.

    Returns:
        The files written: ``<figure>.svg``, and on the same axes for all ``<dataset>/<figure>.svg``.

    Raises:
        MissingExtraError: vl-convert-python is not installed.
        OSError: the folder may not be written to, or the disk is full.
    """
    drawn = comparison_figures(evaluations)
    own = (drawn.trials, drawn.coverage)
    folders = _folders([evaluation.dataset for evaluation in evaluations])
    return write_svg(
        {
            **{Path(folder) / f"{figure.name}.svg": figure for figure in own},
            **{
                Path(folder) / folders[place] / f"{name}.svg": figure
                for name, row in drawn.rows.items()
                for place, figure in row
            },
        }
    )


def _folders(names: Sequence[str]) -> list[str]:
    """Names of datasets as names of folders, no two alike."""
    found: list[str] = []
    for place, name in enumerate(names):
        plain = re.sub(r"[^\w.-]+", "_", name).strip("._") or "dataset"
        found.append(f"{plain}_{place + 1}" if plain.lower() in map(str.lower, found) else plain)
    return found


def in_columns(figure: Figure, columns: int) -> Figure:
    """The figure with small letters and narrow legends from where a column is no wider than a phone."""
    return replace(figure, chart=_narrower(figure.chart, columns))


def _narrower(chart: Any, columns: int) -> Any:
    match chart:
        case str():
            return chart.replace("windowSize()[0] < 600", f"windowSize()[0] < {max(600, 480 * columns)}")
        case Mapping():
            return {key: _narrower(value, columns) for key, value in chart.items()}
        case list() | tuple():
            return [_narrower(value, columns) for value in chart]
        case _:
            return chart
