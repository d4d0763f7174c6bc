"""The pruning as a section of a report."""

from __future__ import annotations

from gmr.evaluation.report.parts import shown_figure
from gmr.evaluation.report.tables import Column, html_table
from gmr.pages.document import element, items, section, text
from gmr.pages.section import Section
from gmr.pruning.figures import figures
from gmr.pruning.prune import Pruning
from gmr.pruning.words import headline, sentences

__all__ = ["pruning_section"]

_IMPORTANCE = (
    Column("clip", "Clip"),
    Column("seconds", "Length, s", ".1f"),
    Column("runs", "Trials that need it", "d"),
    Column("offset_change", "Offset without it, m", "+.4f"),
    Column("held_change", "Trials that hold", "+.0f"),
)


def pruning_section(of: Pruning) -> Section:
    """What can go, quality for size, and what every clip is worth: HTML, charts and tables."""
    drawn = list(figures(of))
    table = html_table(of.importance, list(_IMPORTANCE), "Importance of the clips, sortable")
    save = element("button", "Save importance.csv", type="button", data_save="importance")
    folded = element(
        "details",
        element("summary", text(f"Every clip left out, alone ({len(of.importance):,})"))
        + element("div", element("div", save, class_="controls") + table, class_="inside"),
    )
    # The figures say what the other sentences would.
    content = element("ul", items(sentences(of)[:1])) + "".join(map(shown_figure, drawn)) + folded
    return Section(
        name="pruning",
        title="What can go",
        html=section("pruning", "What can go", headline(of), content),
        figures=tuple(drawn),
        tables={"importance": of.importance, "curve": of.curve.table},
    )
