"""The small tables of the page: plain HTML, which reads without scripts; scripts only sort them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from gmr.pages.document import element, text
from gmr.table import Table

__all__ = ["MOST_ROWS", "Column", "clip_columns", "flow_columns", "html_table", "trial_columns"]

MOST_ROWS: Final = 500
"""More rows than anyone reads, and the page must stay small; the CSV files have them all."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column as it is shown.

    Attributes:
        name: the column of the table.
        title: its header, with the unit.
        form: format of its numbers, as in an f-string; "" for text.
    """

    name: str
    title: str
    form: str = ""


def trial_columns(trials: Table) -> list[Column]:
    """What the page shows of the trials; scenario and tracking only where there is more than one."""
    named = [Column("scenario", "Scenario"), Column("tracking", "Tracking")]
    return [
        *(column for column in named if len(set(trials[column.name].tolist())) > 1),
        Column("speed", "Speed, m/s", "g"),
        Column("turn_rate_deg", "Turn, deg/s", "g"),
        Column("offset_mean", "Offset mean, m", ".2f"),
        Column("offset_p95", "Offset 95%, m", ".2f"),
        Column("offset_max", "Offset max, m", ".2f"),
        Column("speed_error", "Speed error, m/s", "+.2f"),
        Column("turn_rate_error_deg", "Turn error, deg/s", "+.1f"),
        Column("transitions_per_second", "Jumps per s", ".1f"),
        Column("search_cost_mean", "Search cost", ".2f"),
        Column("pose_discontinuity_mean", "Pose gap, m", ".3f"),
    ]


def clip_columns() -> list[Column]:
    """What the page shows of the clips."""
    return [
        Column("clip", "Clip"),
        Column("seconds", "Length, s", ".1f"),
        Column("played_seconds", "Played, s", ".1f"),
        Column("played_share", "Of all playing", ".1%"),
        Column("share_mirrored", "Of it mirrored", ".1%"),
        Column("used_share", "Frames played", ".0%"),
    ]


def flow_columns() -> list[Column]:
    """What the page shows of the jumps."""
    return [Column("from_clip", "From"), Column("to_clip", "To"), Column("count", "Jumps", ",d")]


def html_table(table: Table, columns: Sequence[Column], label: str) -> str:
    """The first rows of a table, in a box of its own that scrolls: no page is to be wider than a phone."""
    head = "".join(
        element(
            "th",
            element("button", text(column.title), type="button"),
            scope="col",
            class_=None if column.form else "text",
        )
        for column in columns
    )
    shown = [table[column.name][:MOST_ROWS].tolist() for column in columns]
    body = "".join(
        element("tr", "".join(_cell(value, column) for value, column in zip(row, columns, strict=True)))
        for row in zip(*shown, strict=True)
    )
    more = (
        element("p", text(f"The first {MOST_ROWS} of {len(table):,} rows.")) if len(table) > MOST_ROWS else ""
    )
    return more + element(
        "div",
        element("table", element("thead", element("tr", head)) + element("tbody", body)),
        class_="scroll",
        tabindex=0,
        role="region",
        aria_label=label,
    )


def _cell(value: Any, column: Column) -> str:
    if not column.form:
        return element("td", text(value), class_="text", title=value, data_value=value)
    if not math.isfinite(value):
        return element("td", "–", data_value="")
    return element("td", text(format(value, column.form)), data_value=f"{value:g}")
