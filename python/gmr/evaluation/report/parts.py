"""Parts of the page that a report of one dataset and one of several share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from gmr.evaluation.figures.measures import MEASURES
from gmr.evaluation.figures.trial_maps import set_label
from gmr.evaluation.report.tables import Column, clip_columns, flow_columns, html_table, trial_columns
from gmr.evaluation.words import count
from gmr.pages.document import element, items, section, text
from gmr.pages.figure import Figure
from gmr.table import Table

__all__ = [
    "VIEWS",
    "failed_notice",
    "folded",
    "map_choice",
    "map_controls",
    "shown_figure",
    "tables_section",
    "verdict_section",
]

VIEWS: Final = {"holds": "Verdict", **{measure.column: measure.label for measure in MEASURES}}
"""What the maps of the trials may show, by the name in their figures' names."""


def verdict_section(headline: str, sentences: Sequence[str], places: Mapping[str, str]) -> str:
    """The words that come first, and links to the sections: their titles by their places on the page."""
    links = "".join(
        element("li", element("a", text(title), href=f"#{place}")) for place, title in places.items()
    )
    return element(
        "section",
        element("h2", text(headline))
        + element("ul", items(sentences))
        + element("nav", element("ul", links), aria_label="Sections"),
        id="verdict",
    )


def failed_notice(failed: Mapping[str, str]) -> str:
    """The files that could not be used, and why."""
    if not failed:
        return ""
    rows = "".join(
        element("li", element("code", text(file)) + ": " + text(reason)) for file, reason in failed.items()
    )
    title = f"{count(len(failed), 'file')} could not be used"
    return element("div", element("h2", text(title)) + element("ul", rows), class_="notice", id="failed")


def folded(title: str, content: str, name: str | None = None) -> str:
    """What is shown when its title is opened."""
    return element(
        "details", element("summary", text(title)) + element("div", content, class_="inside"), id=name
    )


def shown_figure(figure: Figure) -> str:
    """A figure below its title and its sentence."""
    caption = element("figcaption", element("h3", text(figure.title)) + element("p", text(figure.sentence)))
    chart = element("div", "", class_="chart", data_figure=figure.name)
    return element("figure", caption + chart, class_="figure", id=figure.name)


def map_controls(sets: Sequence[tuple[str, str]]) -> str:
    """The choice of what the maps show and, where there are several, of which set of trials."""
    buttons = "".join(
        element(
            "label",
            f"<input{' checked' if place == 0 else ''} type='radio' name='measure' autocomplete='off' "
            f"value='{name}'>" + element("span", text(label)),
        )
        for place, (name, label) in enumerate(VIEWS.items())
    )
    views = element("fieldset", element("legend", "Colour by") + buttons, class_="controls choices")
    if len(sets) < 2:
        return views
    options = "".join(
        element("option", text(set_label(*each)), value=str(number)) for number, each in enumerate(sets)
    )
    label = element("label", "Trials", for_="set-select")
    select = element("select", options, id="set-select", autocomplete="off")
    return views + element("div", label + select, class_="controls")


def map_choice(view: str, number: int, sets: Sequence[tuple[str, str]]) -> str:
    """What :func:`map_controls` say when a view of a set is chosen."""
    return view + (f" {number}" if len(sets) > 1 else "")


def tables_section(tables: Mapping[str, Table], *first: Column) -> str:
    """The tables of trials, clips and jumps, to be opened and saved; ``first`` columns stand in front."""
    shown = {
        "trials": ("Trials", trial_columns(tables["trials"])),
        "clips": ("Clips", clip_columns()),
        "jumps": ("Jumps from clip to clip", flow_columns()),
    }
    return section(
        "tables",
        "Tables",
        "Metres, seconds, degrees. A header sorts; the CSV files hold every column and row.",
        "".join(
            folded(
                f"{title} ({len(tables[name]):,})",
                _save_button(name) + html_table(tables[name], [*first, *columns], f"{title}, sortable"),
                f"table-{name}",
            )
            for name, (title, columns) in shown.items()
        ),
    )


def _save_button(name: str) -> str:
    button = element("button", f"Save {name}.csv", type="button", data_save=name)
    return element("div", button, class_="controls")
