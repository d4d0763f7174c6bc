"""The pruning as a section of a report."""

from __future__ import annotations

from typing import Final

import numpy as np

from gmr.evaluation.report.parts import shown_figure
from gmr.evaluation.report.tables import Column, html_table
from gmr.evaluation.words import capital
from gmr.pages.document import element, items, section, text
from gmr.pages.section import Section
from gmr.pruning.figures import figures
from gmr.pruning.manifest import files_words, scores
from gmr.pruning.prune import Pruning
from gmr.pruning.words import headline, opening_sentences
from gmr.pruning.writing import Written
from gmr.table import Table

__all__ = ["pruning_section"]

_IMPORTANCE = (
    Column("clip", "Clip"),
    Column("seconds", "Length, s", ".1f"),
    Column("runs", "Trials that need it", "d"),
    Column("offset_change", "Offset without it, m", "+.4f"),
    Column("held_change", "Trials that hold", "+.0f"),
)


_FILES: Final = (
    Column("what", "What plays"),
    Column("offset_mean", "Mean offset, m", ".3f"),
    Column("held", "Trials that hold", "d"),
    Column("runs", "Of", "d"),
)


def pruning_section(of: Pruning, written: Written | None = None) -> Section:
    """What can go, quality for size, and what every clip is worth: HTML, charts and tables.

    Args:
        of: the pruning.
        written: the files, where they were: what they do is told too, and by themselves.
    """
    drawn = list(figures(of))
    table = html_table(of.importance, list(_IMPORTANCE), "Importance of the clips, sortable")
    save = element("button", "Save importance.csv", type="button", data_save="importance")
    folded = element(
        "details",
        element("summary", text(f"Every clip left out, alone ({len(of.importance):,})"))
        + element("div", element("div", save, class_="controls") + table, class_="inside"),
    )
    # The figures say what the other sentences would.
    told = opening_sentences(of)
    files = ""
    if written is not None:
        told.append(files_words(written))
        files = html_table(_files(written), list(_FILES), "What the smaller dataset does")
    content = element("ul", items(told)) + files + "".join(map(shown_figure, drawn)) + folded
    return Section(
        name="pruning",
        title="What can go",
        html=section("pruning", "What can go", headline(of, written), content),
        figures=tuple(drawn),
        tables={"importance": of.importance, "curve": of.curve.table},
    )


def _files(written: Written) -> Table:
    """One row for the whole dataset, and one for the files by either scale."""
    rows = scores(written, "the new folder's files")
    return Table(
        {
            "what": np.array([capital(what) for what in rows], object),
            "offset_mean": np.array([score.offset for score in rows.values()]),
            "held": np.array([score.held for score in rows.values()], np.int64),
            "runs": np.array([score.runs for score in rows.values()], np.int64),
        }
    )
