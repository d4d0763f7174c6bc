"""The completion as a section of a report: what clips bring, before and after, and what got worse."""

from __future__ import annotations

from gmr.completion.complete import Completion
from gmr.completion.figures import figures
from gmr.completion.parts import LACKING, MAPS, clips_table, clips_title, maps, method
from gmr.completion.words import headline, sentences
from gmr.evaluation.report.parts import folded
from gmr.pages.document import element, items, section, text
from gmr.pages.section import Section

__all__ = ["completion_section"]

_TRIALS = "completion_trials"
_CLIPS = "completion_clips"


def completion_section(of: Completion) -> Section:
    """What a completion comes to, in words, maps of the trials before and after, and a table of the clips.

    It belongs into the report of the evaluation before: ``of.before.report(path, completion_section(of))``.
    """
    drawn = tuple(figures(of)) if of.added else ()
    content = element("ul", items(sentences(of)))
    if of.added:
        save = element("button", f"Save {_TRIALS}.csv", type="button", data_save=_TRIALS)
        content += element("p", text(MAPS)) + maps(drawn) + element("div", save, class_="controls")
        lead = element("p", text(LACKING)) if of.source else ""
        content += folded(clips_title(of), lead + clips_table(of, _CLIPS))
    title = f"Its holes filled from {of.source}" if of.source else "Its holes filled"
    how = "How clips were chosen" if of.source else "How clips were made"
    return Section(
        name="completion",
        title="Completion",
        html=section("completion", title, headline(of), content + folded(how, method(of))),
        figures=drawn,
        tables={_TRIALS: of.trials, _CLIPS: of.chosen if of.source else of.clips} if of.added else {},
    )
