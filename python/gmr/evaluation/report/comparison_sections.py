"""The sections of a comparison in reading order: what tells the datasets apart, then each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, TypeAlias

import numpy as np

from gmr.evaluation.comparison import Comparison
from gmr.evaluation.comparison_words import grids_of
from gmr.evaluation.figures import Figure
from gmr.evaluation.figures.comparison import ComparedFigures
from gmr.evaluation.figures.trial_maps import set_suffix, trial_sets
from gmr.evaluation.replay import worst_trial
from gmr.evaluation.report.method import SOURCE, terms
from gmr.evaluation.report.parts import (
    VIEWS,
    failed_notice,
    folded,
    map_choice,
    map_controls,
    tables_section,
    verdict_section,
)
from gmr.evaluation.report.replay import replay_sentence
from gmr.evaluation.report.tables import Column, html_table
from gmr.evaluation.result import Evaluation
from gmr.pages.document import element, items, own, section, text
from gmr.table import Table

__all__ = ["comparison_sections"]

Rows: TypeAlias = "Mapping[str, Sequence[tuple[int, Figure]]]"

_PLACES: Final = {
    "datasets": "Each dataset",
    "coverage": "Coverage",
    "accuracy": "Accuracy",
    "relevance": "Clips",
    "transitions": "Transitions",
    "replay": "Replay",
    "tables": "Tables",
    "method": "Method",
}
_RELEVANCE: Final = ("clip_usage", "frame_usage")
_TRANSITIONS: Final = ("transition_kinds", "transition_matrix", "clip_circles")
_COVERAGE: Final = ("coverage_density", "pose_distance", "turn_symmetry")


def comparison_sections(comparison: Comparison, drawn: ComparedFigures, tables: Mapping[str, Table]) -> str:
    """The body of the page."""
    names, rows = comparison.datasets, drawn.rows
    replayed = all(each.replays is not None for each in comparison.evaluations)
    placed = {*_RELEVANCE, *_TRANSITIONS, *_COVERAGE}
    others = [name for name in rows if name not in placed and not name.startswith("trial_map_")]
    parts = [
        element(
            "div",
            verdict_section(comparison.verdict.headline, comparison.verdict.sentences, _PLACES)
            + _one(drawn.trials, film=-1 if replayed else None),
            class_="opening",
        ),
        failed_notice(comparison.failed),
        section(
            "datasets",
            "Each dataset by itself",
            "",
            _summaries(comparison.evaluations) + "".join(map(_spoken, comparison.evaluations)),
        ),
        section(
            "coverage",
            "What the datasets hold",
            "Speed and turn rate, as means over one second that slides through every clip.",
            _one(drawn.coverage) + _rows(rows, _COVERAGE, names),
        ),
        section(
            "accuracy",
            "How well they follow a path",
            "In every trial a character driven by motion matching is sent along a circle, or straight ahead. "
            "A cell is a trial; what stands after ± is its spread over time. A click replays it.",
            _maps(comparison, rows, replayed) + _rows(rows, others, names),
        ),
        section("relevance", "Which clips carry them", "", _rows(rows, _RELEVANCE, names)),
        section(
            "transitions",
            "How they get from clip to clip",
            "A jump is a step at which the frame shown is not the next one of its clip.",
            _rows(rows, _TRANSITIONS, names),
        ),
        _replay(comparison) if replayed else "",
        tables_section(tables, Column("dataset", "Dataset")),
        section("method", "How it was measured", SOURCE, "".join(map(_method, comparison.evaluations))),
    ]
    return "\n".join(filter(None, parts))


def _summaries(evaluations: Sequence[Evaluation]) -> str:
    summaries = [each.summary for each in evaluations]
    table = Table(
        {
            "dataset": np.array([each.dataset for each in evaluations], object),
            "clips": np.array([one.clip_count for one in summaries]),
            "mirrored": np.array([one.mirrored_count for one in summaries]),
            "minutes": np.array([one.seconds / 60 for one in summaries]),
            "frames": np.array([one.frame_count for one in summaries]),
            "joints": np.array([one.joint_count for one in summaries]),
            "done": np.array([float(grid.held.mean()) for grid in grids_of(evaluations)]),
        }
    )
    columns = [
        Column("dataset", "Dataset"),
        Column("clips", "Clips", ",d"),
        *([Column("mirrored", "Mirrored copies", ",d")] if table["mirrored"].any() else []),
        Column("minutes", "Minutes", ".1f"),
        Column("frames", "Frames", ",d"),
        Column("joints", "Joints", ",d"),
        Column("done", "Done as asked", ".0%"),
    ]
    return html_table(table, columns, "The datasets, sortable")


def _spoken(evaluation: Evaluation) -> str:
    said = [sentence for sentence in evaluation.verdict.sentences if sentence not in evaluation.notes]
    full = element("ul", items(said), class_="sentences")
    if evaluation.notes:
        notes = element("ul", items(evaluation.notes), class_="sentences")
        full += element("h4", "Noticed on the way") + notes
    return (
        element("h3", text(evaluation.dataset))
        + element("p", text(evaluation.verdict.headline))
        + folded("The verdict in full", full)
    )


def _one(figure: Figure, film: int | None = None) -> str:
    caption = element("figcaption", element("h3", text(figure.title)) + element("p", text(figure.sentence)))
    return element("figure", caption + _chart(figure, film), class_="figure", id=figure.name)


def _chart(figure: Figure, film: int | None) -> str:
    shape = "chart ring" if figure.chart["height"] == "container" else "chart"
    chart = element("div", "", class_=shape, data_figure=figure.name)
    return chart if film is None else element("div", chart, class_="map", data_film=film)


def _rows(rows: Rows, wanted: Sequence[str], names: Sequence[str]) -> str:
    return "".join(_row(rows[name], names) for name in wanted if name in rows)


def _row(
    row: Sequence[tuple[int, Figure]],
    names: Sequence[str],
    *,
    film: bool = False,
    choice: str | None = None,
    hidden: bool = False,
) -> str:
    """One figure of every dataset, side by side where there is room."""
    figures = "".join(
        element(
            "figure",
            element("figcaption", element("h4", text(names[place])) + element("p", text(figure.sentence)))
            + _chart(figure, place if film else None),
            class_="figure",
            id=figure.name,
        )
        for place, figure in row
    )
    title = element("h3", text(row[0][1].title))
    return element(
        "div",
        title + element("div", figures, class_="beside"),
        class_="row",
        data_choice=choice,
        hidden=hidden,
    )


def _maps(comparison: Comparison, rows: Rows, replayed: bool) -> str:
    """All maps of the trials, of which the controls show one measure of one set, for every dataset."""
    sets = trial_sets(comparison.evaluations[0])
    content = "".join(
        _row(
            rows[f"trial_map_{name}{set_suffix(*each)}"],
            comparison.datasets,
            film=replayed,
            choice=map_choice(name, number, sets),
            hidden=number + place > 0,
        )
        for number, each in enumerate(sets)
        for place, name in enumerate(VIEWS)
    )
    return element("div", map_controls(sets) + content, data_choose=True)


def _replay(comparison: Comparison) -> str:
    first = comparison.evaluations[0]
    assert first.replays is not None
    worst = first.replays.trials[worst_trial(first.measured.trials)]
    player = own(__package__, "player.html").replace("{{sentence}}", text(replay_sentence(worst)))
    lead = "A click on a cell of a map above replays its trial; so do these lists."
    return section("replay", "Any trial of any dataset, replayed", lead, player)


def _method(evaluation: Evaluation) -> str:
    return folded(evaluation.dataset, terms(evaluation.summary))
