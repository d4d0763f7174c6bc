"""The report's page: its words, figures and scripts."""

from __future__ import annotations

from typing import Final

from gmr.evaluation.figures import figures
from gmr.evaluation.figures.clip_usage import recordings
from gmr.evaluation.figures.transition_matrix import flows
from gmr.evaluation.report.replay import packed_replay
from gmr.evaluation.report.sections import clip_groups, facts, sections
from gmr.evaluation.result import Evaluation
from gmr.pages.document import own
from gmr.pages.page import Page

__all__ = ["page"]

_SCRIPTS: Final = ("scatter.js", "tables.js", "camera.js", "drawing.js", "player.js")


def page(evaluation: Evaluation) -> str:
    """The report as HTML."""
    drawn = list(figures(evaluation))
    clips, groups = clip_groups(evaluation)
    return Page(
        title=f"{evaluation.dataset}: locomotion dataset evaluation",
        eyebrow="Locomotion dataset evaluation",
        heading=evaluation.dataset,
        facts=facts(evaluation.summary),
        sections=sections(evaluation, drawn),
        figures=drawn,
        tables={
            "trials": evaluation.measured.trials,
            "clips": recordings(evaluation.measured.clips),
            "jumps": flows(evaluation.measured.transitions),
        },
        data={
            "clips": clips,
            "clipGroups": list(groups.values()),
            "replay": packed_replay(evaluation.replay, evaluation.summary.joints.get("hips")),
        },
        scripts=[own(__package__, name) for name in _SCRIPTS],
        without_scripts="the charts and the moving skeleton need JavaScript, which is off in this browser",
    ).html()
