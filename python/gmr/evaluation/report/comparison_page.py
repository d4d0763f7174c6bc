"""The page of a comparison: its words, figures and scripts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from gmr.evaluation.comparison import Comparison
from gmr.evaluation.figures.clip_usage import recordings
from gmr.evaluation.figures.comparison import comparison_figures
from gmr.evaluation.figures.transition_matrix import flows
from gmr.evaluation.report.comparison_sections import comparison_sections
from gmr.evaluation.report.film import film_of
from gmr.evaluation.result import Evaluation
from gmr.evaluation.words import duration, listing
from gmr.pages.document import own
from gmr.pages.page import Page
from gmr.table import Table

__all__ = ["comparison_page"]

_SCRIPTS: Final = ("tables.js", "camera.js", "drawing.js", "film.js", "player.js", "maps.js")


def comparison_page(comparison: Comparison) -> str:
    """The report of a comparison as HTML."""
    evaluations = comparison.evaluations
    drawn = comparison_figures(evaluations)
    tables = {
        "trials": comparison.tables()["trials"],
        "clips": _together(evaluations, lambda each: recordings(each.measured.clips)),
        "jumps": _together(evaluations, lambda each: flows(each.measured.transitions)),
    }
    films = [film_of(each) for each in evaluations]
    return Page(
        title=f"{listing(comparison.datasets)}: locomotion datasets compared",
        eyebrow="Locomotion datasets compared",
        heading=listing(comparison.datasets),
        facts={
            "Datasets": f"{len(evaluations):,}",
            "Clips": f"{sum(each.summary.clip_count for each in evaluations):,}",
            _duration_of(evaluations): duration(sum(each.summary.seconds for each in evaluations)),
            "Trials each": f"{len(evaluations[0].measured.trials):,}",
        },
        sections=comparison_sections(comparison, drawn, tables),
        figures=drawn.every(),
        tables=tables,
        data={"films": [film for film in films if film is not None]},
        scripts=[own(__package__, name) for name in _SCRIPTS],
        without_scripts="the charts and the moving skeleton need JavaScript, which is off in this browser",
        wide=True,
    ).html()


def _duration_of(evaluations: tuple[Evaluation, ...]) -> str:
    return f"Duration{' with copies' if any(each.summary.mirrored_count for each in evaluations) else ''}"


def _together(evaluations: tuple[Evaluation, ...], made: Callable[[Evaluation], Table]) -> Table:
    """A table of every dataset, one after the other, with the dataset in front."""
    tables = [(each.dataset, made(each)) for each in evaluations]
    columns = tables[0][1].column_names
    return Table(
        {
            "dataset": np.concatenate([np.full(len(table), name, object) for name, table in tables]),
            **{column: np.concatenate([table[column] for _, table in tables]) for column in columns},
        }
    )
