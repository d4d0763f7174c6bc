"""The figures of a comparison: of all datasets in one, and each figure of one beside that of the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from gmr.evaluation.figures import figures
from gmr.evaluation.figures.compared_coverage import compared_coverage
from gmr.evaluation.figures.compared_trials import compared_trials
from gmr.evaluation.figures.same_axes import on_same_axes
from gmr.evaluation.result import Evaluation
from gmr.pages.figure import Figure

__all__ = ["ComparedFigures", "comparison_figures"]

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
        """All of them."""
        return [self.trials, self.coverage, *(figure for row in self.rows.values() for _, figure in row)]


def comparison_figures(evaluations: Sequence[Evaluation]) -> ComparedFigures:
    """Draw several evaluations of the same trials."""
    drawn: dict[str, list[tuple[int, Figure]]] = {}
    for place, evaluation in enumerate(evaluations):
        for figure in figures(evaluation):
            if figure.name not in _REPLACED:
                drawn.setdefault(figure.name, []).append((place, figure))
    rows = {
        name: [
            (place, replace(figure, name=f"{name}--{place + 1}", chart=_narrower(figure.chart, len(row))))
            for (place, _), figure in zip(row, on_same_axes([figure for _, figure in row]), strict=True)
        ]
        for name, row in drawn.items()
    }
    return ComparedFigures(compared_trials(evaluations), compared_coverage(evaluations), rows)


def _narrower(chart: Any, columns: int) -> Any:
    """The chart with small letters and narrow legends from where a column is no wider than a phone."""
    match chart:
        case str():
            return chart.replace("windowSize()[0] < 600", f"windowSize()[0] < {max(600, 480 * columns)}")
        case Mapping():
            return {key: _narrower(value, columns) for key, value in chart.items()}
        case list() | tuple():
            return [_narrower(value, columns) for value in chart]
        case _:
            return chart
