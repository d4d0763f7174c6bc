"""The completion's page: words first, then the maps, then the clips."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from gmr.completion.complete import Completion
from gmr.completion.figures import figures
from gmr.completion.words import headline, sentences
from gmr.evaluation.report.tables import Column, html_table
from gmr.evaluation.words import count, duration
from gmr.pages.document import element, items, own, section, text
from gmr.pages.figure import Figure
from gmr.pages.page import Page
from gmr.table import Table

__all__ = ["page"]

_CLIPS = (
    Column("clip", "Clip"),
    Column("speed", "Speed, m/s", "g"),
    Column("turn_rate_deg", "Turn, deg/s", "g"),
    Column("seconds", "Length, s", ".1f"),
    Column("played_seconds", "Played, s", ".1f"),
    Column("mark", "Its trial"),
)


_CHOICES = (
    Column("step", "Step", "d"),
    Column("clip", "Clip"),
    Column("how", "How"),
    Column("seconds", "Length, s", ".1f"),
    Column("cost_before", "Lacking before", ".2f"),
    Column("cost_after", "Lacking after", ".2f"),
    Column("gain", "Taken away per s", ".4f"),
    Column("held", "Trials that hold", "d"),
    Column("played_seconds", "Played, s", ".1f"),
)


def page(of: Completion, strips: Mapping[str, str]) -> str:
    """The page as HTML.

    Args:
        of: what to show.
        strips: SVG pictures of some of the clips that were made, by clip.
    """
    drawn = list(figures(of))
    return Page(
        title=f"{of.dataset}: completed",
        eyebrow="Locomotion dataset, its holes filled",
        heading=of.dataset,
        facts=_facts(of),
        sections="\n".join(
            filter(
                None,
                [
                    _verdict(of),
                    _maps(drawn),
                    _strips(strips),
                    _clips(of),
                    _spoken(of),
                    section("method", "Method", "", element("ul", items(_CHOSEN if of.source else _METHOD))),
                ],
            )
        ),
        figures=drawn,
        tables={"trials": of.trials, "clips": of.clips, **({"chosen": of.chosen} if of.source else {})},
        scripts=[own("gmr.evaluation.report", "tables.js")],
    ).html()


_METHOD = (
    "Both evaluations run the same trials; the second one on the dataset and the made clips together.",
    "A clip is made for each trial that did not hold, and one straight ahead for each such speed, on the "
    "skeleton of the dataset's first clip: actionlets on a body of its proportions, laid on its joints.",
    "All made clips are kept, also those that do not help: what they cost is in the figures.",
    "The features are scaled anew with the made clips, so trials far from any hole may change too.",
)


_CHOSEN = (
    "Both evaluations run the same trials; the second one on the dataset and the chosen clips together.",
    "Candidates are clips as they are, mirrored, and played 0.8, 0.9, 1.1 and 1.25 times as fast; "
    "synthesised ones too where that was asked for.",
    "They are ranked by what searches for the speed and turn rate of the failing trials could save by them, "
    "per second and in all; with the best eight all trials are run again. The one that takes away most of "
    "what the trials lack, per second recorded, is kept, so long as no fewer trials hold and it takes away "
    "1% or more; then the next one is looked for.",
    "For choosing, features are scaled as in the dataset by itself; for the second evaluation anew over "
    "both.",
)


def _facts(of: Completion) -> dict[str, str]:
    return {
        "clips": f"{of.before.summary.clip_count:,}",
        "chosen clips" if of.source else "made clips": f"{len(of.added):,}",
        "of the dataset": duration(of.before.summary.seconds),
        "chosen" if of.source else "made": duration(float(of.clips["seconds"].sum())),
    }


def _verdict(of: Completion) -> str:
    body = element("h2", text(headline(of))) + element("ul", items(sentences(of)))
    return element("section", body, id="verdict")


def _maps(drawn: Sequence[Figure]) -> str:
    before, after, change = (_figure(figure) for figure in drawn)
    lead = "A cell is a trial: the character is sent along a circle, or straight ahead, at one speed."
    return section("maps", "Before and after", lead, element("div", before + after, class_="pairs") + change)


def _strips(strips: Mapping[str, str]) -> str:
    pictures = "".join(
        element(
            "figure",
            element("figcaption", element("h3", text(name))) + element("div", svg, class_="strip"),
            class_="figure",
        )
        for name, svg in strips.items()
    )
    lead = "Some of the clips, from the side, time running to the right."
    return section("strips", "What was added", lead, pictures) if strips else ""


def _clips(of: Completion) -> str:
    if not of.added:
        return ""
    if of.source:
        return _chosen(of)
    shown = Table(
        {
            **dict(of.clips),
            "mark": ["holds" if held else "still fails" for held in of.clips["holds"].tolist()],
        }
    )
    title = f"{count(len(of.added), 'clip')} made"
    save = element(
        "div", element("button", "Save clips.csv", type="button", data_save="clips"), class_="controls"
    )
    return section("clips", title, "", save + html_table(shown, _CLIPS, f"{title}, sortable"))


def _chosen(of: Completion) -> str:
    played = of.clips["played_seconds"]
    shown = Table({**dict(of.chosen), "step": np.arange(1, len(played) + 1), "played_seconds": played})
    title = f"{count(len(of.added), 'clip')} chosen from {of.source}"
    save = element(
        "div", element("button", "Save chosen.csv", type="button", data_save="chosen"), class_="controls"
    )
    lead = (
        "What trials lack, added up: nothing for one that holds, half for one whose worst error is twice the "
        "limit, nearly one for one that is hopeless."
    )
    return section("clips", title, lead, save + html_table(shown, _CHOICES, f"{title}, sortable"))


def _spoken(of: Completion) -> str:
    parts = ""
    for when, evaluation in (("Before", of.before), ("After", of.after)):
        said = element("p", element("strong", text(evaluation.verdict.headline)))
        said += element("ul", items(evaluation.verdict.sentences))
        parts += element("details", element("summary", f"{when}: the evaluation in words") + said)
    return section("spoken", "Both evaluations", "", parts)


def _figure(figure: Figure) -> str:
    caption = element("figcaption", element("h3", text(figure.title)) + element("p", text(figure.sentence)))
    chart = element("div", "", class_="chart", data_figure=figure.name)
    return element("figure", caption + chart, class_="figure", id=figure.name)
