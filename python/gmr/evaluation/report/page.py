"""The report's page: its words, figures and scripts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from gmr.evaluation.figures import figures
from gmr.evaluation.figures.clip_usage import recordings
from gmr.evaluation.figures.transition_matrix import flows
from gmr.evaluation.report.film import film_of
from gmr.evaluation.report.sections import clip_groups, facts, sections
from gmr.evaluation.result import Evaluation
from gmr.pages.document import own
from gmr.pages.page import Page
from gmr.pages.section import Section

__all__ = ["page"]

_SCRIPTS: Final = ("scatter.js", "tables.js", "camera.js", "drawing.js", "film.js", "player.js", "maps.js")


def page(evaluation: Evaluation, added: Sequence[Section] = ()) -> str:
    """The report as HTML; ``added`` are sections of what was done with the evaluation."""
    drawn = list(figures(evaluation))
    clips, groups = clip_groups(evaluation)
    tables = {
        "trials": evaluation.measured.trials,
        "clips": recordings(evaluation.measured.clips),
        "jumps": flows(evaluation.measured.transitions),
    }
    return Page(
        title=f"{evaluation.dataset}: locomotion dataset evaluation",
        eyebrow="Locomotion dataset evaluation",
        heading=evaluation.dataset,
        facts=facts(evaluation.summary),
        sections=sections(evaluation, drawn, tables, added),
        figures=[*drawn, *(figure for section in added for figure in section.figures)],
        tables={name: table for section in added for name, table in section.tables.items()} | tables,
        data={
            "clips": clips,
            "clipGroups": list(groups.values()),
            "films": [film for film in (film_of(evaluation),) if film is not None],
        },
        scripts=[own(__package__, name) for name in _SCRIPTS],
        without_scripts="the charts and the moving skeleton need JavaScript, which is off in this browser",
    ).html()
